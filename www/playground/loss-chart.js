// @ts-check
/** The terms of the loss in every iteration, whatever the method calls them, on a logarithmic axis, with a line where a scale begins. */
import { prepare, readColours } from '../common/draw.js';

/** Below this a loss is zero as far as a picture goes. */
const SMALLEST = 1e-9;
const AXIS = 50;
const FOOT = 18;

export class LossChart {
  #canvas = /** @type {HTMLCanvasElement} */ (document.getElementById('loss-canvas'));
  #colours = readColours();
  #key = /** @type {HTMLElement} */ (document.getElementById('loss-key'));
  /** The method's terms, in the order of their colours. @type {import('../common/messages.js').LossView[]} */
  #terms = [];
  /** For every iteration the terms by their names. @type {Record<string, number>[]} */
  #losses = [];
  /** @type {number[]} iterations before each scale */
  #scales = [];
  #frame = 0;

  constructor() {
    new ResizeObserver(() => this.#redraw()).observe(this.#canvas);
    window.addEventListener('themechange', () => {
      this.#colours = readColours();
      this.#redraw();
    });
  }

  /** Total loss of every iteration so far. */
  get totals() {
    return this.#losses.map((terms) => Object.values(terms).reduce((sum, value) => sum + value, 0));
  }

  /** Shows the terms of a method from now on. @param {import('../common/messages.js').LossView[]} terms */
  describe(terms) {
    this.#terms = terms;
    this.#key.replaceChildren(
      ...terms.flatMap(({ title }, index) => {
        const mark = document.createElement('i');
        mark.className = `term-${index}`;
        return [mark, `${title} `];
      }),
    );
    this.#redraw();
  }

  /** The curve as numbers, for another visit. */
  get record() {
    return { losses: this.#losses, scales: this.#scales };
  }

  set record({ losses, scales }) {
    this.#losses = [...losses];
    this.#scales = [...scales];
    this.#redraw();
  }

  /** @param {number} [iterations] how many of the first ones to keep */
  keep(iterations = 0) {
    this.#losses.length = Math.min(this.#losses.length, iterations);
    this.#scales = this.#scales.filter((start) => start < iterations);
    this.#redraw();
  }

  beginScale() {
    if (this.#losses.length > 0) this.#scales.push(this.#losses.length);
  }

  /** @param {import('../common/messages.js').Loss[]} losses */
  add(losses) {
    this.#losses.push(Object.fromEntries(losses.map(({ name, value }) => [name, value])));
    this.#redraw();
  }

  #redraw() {
    this.#frame ||= requestAnimationFrame(() => {
      this.#frame = 0;
      this.#draw();
    });
  }

  #draw() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    if (width === 0 || height === 0) return;
    const context = prepare(this.#canvas, width, height);
    const count = this.#losses.length;
    context.font = `12px ${getComputedStyle(this.#canvas).fontFamily}`;
    context.lineWidth = 1;
    let [low, high] = [Infinity, -Infinity];
    for (const terms of this.#losses) {
      for (const value of Object.values(terms)) {
        if (value <= SMALLEST) continue;
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
    }
    const [top, bottom, left, right] = [6, height - FOOT, AXIS, width - 2];
    context.strokeStyle = this.#colours.line;
    context.fillStyle = this.#colours.soft;
    context.textBaseline = 'middle';
    if (count === 0 || high < 0) {
      context.strokeRect(left + 0.5, top + 0.5, right - left - 1, bottom - top - 1);
      context.textAlign = 'center';
      context.fillText('The curve begins with the first iteration.', (left + right) / 2, (top + bottom) / 2);
      return;
    }
    let [from, to] = [Math.log10(low), Math.log10(high)];
    const slack = Math.max(0.08, 0.05 * (to - from));
    [from, to] = [from - slack, to + slack];
    const x = (/** @type {number} */ index) => left + ((index + 0.5) / Math.max(count, 20)) * (right - left);
    const y = (/** @type {number} */ value) =>
      bottom - ((Math.log10(Math.max(value, SMALLEST)) - from) / (to - from)) * (bottom - top);

    context.textAlign = 'right';
    // Powers of ten; with fewer than two in sight, halves and fifths too.
    const factors = Math.floor(to) - Math.ceil(from) >= 1 ? [1] : [1, 2, 5];
    let below = Infinity;
    for (let power = Math.floor(from); power <= Math.ceil(to); power++) {
      for (const factor of factors) {
        const value = factor * 10 ** power;
        const at = Math.round(y(value)) + 0.5;
        // In a low chart labels would stand on one another.
        if (at < top || at > bottom || below - at < 14) continue;
        below = at;
        context.beginPath();
        context.moveTo(left, at);
        context.lineTo(right, at);
        context.stroke();
        context.fillText(tick(value), left - 6, at);
      }
    }
    context.setLineDash([2, 3]);
    context.strokeStyle = this.#colours.lineStrong;
    for (const start of this.#scales) {
      const at = Math.round(x(start)) + 0.5;
      context.beginPath();
      context.moveTo(at, top);
      context.lineTo(at, bottom);
      context.stroke();
    }
    context.setLineDash([]);
    context.textAlign = 'left';
    context.fillText('1', left, height - 7);
    context.textAlign = 'right';
    context.fillText(`${Math.max(count, 20)} iterations`, right, height - 7);

    context.lineJoin = 'round';
    context.lineWidth = 1.5;
    for (const [place, { name }] of this.#terms.entries()) {
      context.strokeStyle = this.#colours.terms[place % this.#colours.terms.length];
      context.beginPath();
      // At most a few vertices a pixel, however long the run.
      const stride = Math.max(1, Math.floor(count / (4 * width)));
      for (let index = 0; index < count; index += stride) context.lineTo(x(index), y(this.#losses[index][name] ?? 0));
      if (count === 1) context.lineTo(x(0) + 2, y(this.#losses[0][name] ?? 0));
      context.stroke();
    }
    const last = this.#losses[count - 1];
    const words = this.#terms.map(({ name, title }) => `${title} ${(last[name] ?? 0).toPrecision(2)}`);
    this.#canvas.setAttribute('aria-label', `Loss after ${count} iterations: ${words.join(', ')}`);
  }
}

/** A power of ten, or a multiple of one, as a label. @param {number} value */
function tick(value) {
  if (value >= 0.009 && value < 10_000) return String(Number(value.toPrecision(1)));
  const power = Math.floor(Math.log10(value) + 1e-9);
  const factor = Math.round(value / 10 ** power);
  const superscript = [...String(power)].map((sign) => '⁰¹²³⁴⁵⁶⁷⁸⁹'[Number(sign)] ?? '⁻').join('');
  return `${factor === 1 ? '' : `${factor}·`}10${superscript}`;
}
