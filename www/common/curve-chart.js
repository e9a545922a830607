// @ts-check
/**
 * A small chart with two curves on the same axes: the exemplar's is a shape to be filled, the result's a line that
 * should follow its edge. So they differ in form, not only in colour.
 */

/** @typedef {{ x: ArrayLike<number>, y: ArrayLike<number> }} Curve */
/**
 * @typedef {object} Axes
 * @property {string} unit of x, written at the last tick
 * @property {number} [chance] where independent points would lie
 * @property {boolean} [percent] whether y is a share
 * @property {number} least y that always has room
 */

const AXIS = 34;
const TOP = 8;
const FOOT = 20;
const RIGHT = 10;

/** @param {string} name @param {Record<string, string | number>} attributes @param {string} [text] */
function svg(name, attributes, text) {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  if (text !== undefined) element.textContent = text;
  return element;
}

/** Even steps of 1, 2 or 5 times a power of ten, at most `most` of them up to `end`. @param {number} end @param {number} most */
function step(end, most) {
  const rough = end / most;
  const power = 10 ** Math.floor(Math.log10(rough) + 1e-9);
  return power * (/** @type {number} */ ([1, 2, 5, 10].find((factor) => factor * power >= rough - 1e-12)) ?? 10);
}

/** @param {ArrayLike<number>} list */
const highest = (list) => Array.from(list).reduce((most, value) => Math.max(most, value), 0);

export class CurveChart {
  #svg;
  #axes;
  /** @type {Curve | null} */
  #exemplar = null;
  /** @type {Curve | null} */
  #output = null;

  /**
   * @param {SVGSVGElement} element
   * @param {Axes} axes
   */
  constructor(element, axes) {
    this.#svg = element;
    this.#axes = axes;
    new ResizeObserver(() => this.#draw()).observe(element);
  }

  /**
   * @param {Curve} exemplar
   * @param {Curve} output
   * @param {string} words what there is to see, for those who don't
   */
  show(exemplar, output, words) {
    this.#exemplar = exemplar;
    this.#output = output;
    this.#svg.setAttribute('aria-label', words);
    this.#draw();
  }

  #draw() {
    const { clientWidth: width, clientHeight: height } = this.#svg;
    if (!this.#exemplar || !this.#output || width === 0 || height === 0) return;
    const [exemplar, output] = [this.#exemplar, this.#output];
    const { unit, chance, percent, least } = this.#axes;
    this.#svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
    const [left, right, top, bottom] = [AXIS, width - RIGHT, TOP, height - FOOT];
    const end = Math.max(exemplar.x[exemplar.x.length - 1], 1e-9);
    const room = Math.max(1.05 * highest(exemplar.y), highest(output.y), least);
    const most = percent ? Math.min(room, 1) : room;
    const yStep = step(most, 3);
    // Whole steps, so that the axis keeps still while the curves move.
    const high = Math.ceil(most / yStep - 1e-6) * yStep;
    const x = (/** @type {number} */ value) => left + (Math.min(value, end) / end) * (right - left);
    const y = (/** @type {number} */ value) => bottom - (value / high) * (bottom - top);

    const parts = [];
    for (let i = 0; i * yStep <= high * 1.0001; i++) {
      const [value, at] = [i * yStep, Math.round(y(i * yStep)) + 0.5];
      const label = percent ? `${Number((100 * value).toFixed(1))} %` : String(Number(value.toPrecision(3)));
      parts.push(svg('line', { class: 'rule', x1: left, x2: right, y1: at, y2: at }));
      parts.push(svg('text', { class: 'tick', x: left - 6, y: at + 4, 'text-anchor': 'end' }, label));
    }
    const xStep = step(end, 4);
    const last = Math.floor(end / xStep + 1e-6);
    for (let i = 0; i <= last; i++) {
      const label = String(Number((i * xStep).toPrecision(3)));
      const at = x(i * xStep);
      // The last label carries the unit; it may not leave the picture.
      const anchor = i === last && at > right - 16 ? 'end' : 'middle';
      const shift = anchor === 'end' ? RIGHT - 1 : 0;
      parts.push(svg('line', { class: 'rule', x1: at, x2: at, y1: bottom, y2: bottom + 4 }));
      parts.push(
        svg('text', { class: 'tick', x: at + shift, y: height - 4, 'text-anchor': anchor }, i === last ? `${label} ${unit}` : label),
      );
    }
    const path = (/** @type {Curve} */ { x: xs, y: ys }) => {
      let d = '';
      for (let i = 0; i < xs.length && xs[i] <= end * 1.0001; i++) {
        d += `${d ? 'L' : 'M'}${x(xs[i]).toFixed(1)} ${y(ys[i]).toFixed(1)}`;
      }
      return d;
    };
    const edge = path(exemplar);
    const first = x(exemplar.x[0]).toFixed(1);
    parts.push(svg('path', { class: 'target', d: `${edge}L${x(end).toFixed(1)} ${bottom}L${first} ${bottom}Z` }));
    if (chance !== undefined) {
      const at = Math.round(y(chance)) + 0.5;
      parts.push(svg('line', { class: 'chance', x1: left, x2: right, y1: at, y2: at }));
    }
    parts.push(svg('path', { class: 'edge', d: edge }));
    parts.push(svg('path', { class: 'result', d: path(output) }));
    if (chance !== undefined) {
      parts.push(svg('text', { class: 'tick halo', x: right, y: y(chance) - 5, 'text-anchor': 'end' }, 'chance'));
    }
    this.#svg.replaceChildren(...parts);
  }
}

/** The outline of a histogram whose intervals begin at 0. @param {ArrayLike<number>} shares @param {number} interval @returns {Curve} */
export function outline(shares, interval) {
  const [x, y] = [[0], [0]];
  for (let i = 0; i < shares.length; i++) {
    x.push(i * interval, (i + 1) * interval);
    y.push(shares[i], shares[i]);
  }
  return { x, y };
}

/** Where a curve is highest. @param {Curve} curve @param {number} [from] the least x looked at */
export function peak({ x, y }, from = 0) {
  let best = -1;
  for (let i = 0; i < x.length; i++) if (x[i] >= from && (best < 0 || y[i] > y[best])) best = i;
  return best < 0 ? { x: 0, y: 0 } : { x: x[best], y: y[best] };
}
