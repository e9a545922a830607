// @ts-check
/** The surface a pattern is drawn on: from places to pixels and back, and everything that is to be seen on it. */
import { prepare, readColours, traceMark } from '../../common/draw.js';
import { count, nearest, unit } from '../../common/pattern.js';

/** @typedef {import('../../common/pattern.js').Pattern} Pattern */
/** @typedef {[number, number]} Pair */
/**
 * @typedef {object} Scene
 * @property {Pattern} pattern
 * @property {ReadonlySet<number>} selection
 * @property {number} hovered index of a point, or -1
 * @property {number} attribute index of the attribute that shows as size, or -1
 * @property {{ from: Pair, to: Pair } | null} marquee
 * @property {{ at: Pair, reach: number } | null} brush
 * @property {Pair | null} cursor of the keyboard
 */

/** Room around the domain: marks on the border are whole, and the copies across a periodic border can be seen. */
const MARGIN = 22;
/** The handle of a size stands this far outside the mark, so that it can be told from the point. */
const HANDLE_GAP = 18;
const HANDLE_REACH = 14;
/** Smallest mark that can still be seen and told by its shape. */
const SMALLEST_MARK = 2.4;
/** An attribute that is no length shows from the smallest mark to this many pixels more. */
const LARGEST_RAMP = 9;

/** Attributes of these names are lengths in the pattern's own unit; the value is this many radii. */
const RADII = new Map([
  ['radius', 1],
  ['r', 1],
  ['size', 2],
  ['diameter', 2],
]);

/** How many radii a value of the attribute is; `undefined` where it is no length. @param {string} name */
export const radii = (name) => RADII.get(name.toLowerCase());

/**
 * Smallest and largest value of an attribute that can be set with the slider.
 *
 * @param {Pattern} pattern
 * @param {number} attribute
 * @returns {[number, number]}
 */
export function attributeRange(pattern, attribute) {
  const { name, values } = pattern.attributes[attribute];
  const [low, high] = values.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity]);
  const perRadius = radii(name);
  if (perRadius) return [0.002 * perRadius * unit(pattern), Math.max(0.15 * perRadius * unit(pattern), high)];
  if (low < high) return [low, high];
  const value = values[0] ?? 1;
  return value === 0 ? [-1, 1] : [Math.min(0, 2 * value), Math.max(0, 2 * value)];
}

export class DrawingBoard {
  #canvas;
  #colours = readColours();
  /** Pixels a unit of the pattern, and where its lower corner is. */
  #scale = 1;
  #width = 1;
  #height = 1;
  #frame = 0;
  /** @type {() => Scene} */
  #scene;
  /** @type {Scene['pattern']['domain'] | null} */
  #domain = null;
  /** The values whose range is known. @type {Float64Array | null} */
  #ranged = null;
  /** @type {[number, number]} */
  #range = [0, 1];

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {() => Scene} scene
   */
  constructor(canvas, scene) {
    this.#canvas = canvas;
    this.#scene = scene;
    new ResizeObserver(() => this.layout()).observe(/** @type {HTMLElement} */ (canvas.parentElement));
    window.addEventListener('resize', () => this.layout());
    window.addEventListener('themechange', () => {
      this.#colours = readColours();
      // Draws as well, where the editor is open.
      this.layout();
    });
  }

  /** Pixels a unit of the pattern. */
  get scale() {
    return this.#scale;
  }

  /** As large as its place and the window allow. */
  layout() {
    const place = /** @type {HTMLElement} */ (this.#canvas.parentElement);
    if (place.clientWidth === 0) return;
    const [, , width, height] = this.#scene().pattern.domain;
    const room = Math.max(260, Math.min(window.innerHeight - 410, 760));
    this.#scale = Math.min((place.clientWidth - 2 * MARGIN) / width, (room - 2 * MARGIN) / height);
    this.#width = width * this.#scale + 2 * MARGIN;
    this.#height = height * this.#scale + 2 * MARGIN;
    this.#canvas.style.width = `${this.#width}px`;
    this.#canvas.style.height = `${this.#height}px`;
    this.#paint();
  }

  /** @param {{ clientX: number, clientY: number }} event @returns {Pair} in the pattern's own unit */
  at({ clientX, clientY }) {
    const { left, top, width, height } = this.#canvas.getBoundingClientRect();
    const [x0, y0] = this.#scene().pattern.domain;
    const x = ((clientX - left) / width) * this.#width;
    const y = ((clientY - top) / height) * this.#height;
    return [x0 + (x - MARGIN) / this.#scale, y0 + (y - MARGIN) / this.#scale];
  }

  /** @param {Pair} at @returns {Pair} in CSS pixels from the canvas's corner */
  pixel([x, y]) {
    const [x0, y0] = this.#scene().pattern.domain;
    return [MARGIN + (x - x0) * this.#scale, MARGIN + (y - y0) * this.#scale];
  }

  /**
   * The point that a finger or a mouse means.
   *
   * @param {Pair} at
   * @param {boolean} coarse whether a finger is pointing
   * @returns {number} its index, or -1
   */
  hit(at, coarse) {
    const { pattern, attribute } = this.#scene();
    const close = nearest(pattern, ...at, (coarse ? 18 : 9) / this.#scale);
    if (close >= 0 || attribute < 0) return close;
    // Anywhere on a large disk, the smallest where several lie under each other.
    let [best, least] = [-1, Infinity];
    for (let i = 0; i < count(pattern); i++) {
      const radius = this.#radius(i);
      const [dx, dy] = [pattern.positions[2 * i] - at[0], pattern.positions[2 * i + 1] - at[1]];
      if (radius < least && Math.hypot(dx, dy) * this.#scale <= radius) [best, least] = [i, radius];
    }
    return best;
  }

  /** Radius of a mark without a size, in pixels. */
  get mark() {
    const { pattern } = this.#scene();
    const [, , width, height] = pattern.domain;
    const spacing = 0.7 * Math.sqrt((width * height) / Math.max(count(pattern), 12));
    return Math.min(6, Math.max(SMALLEST_MARK, 0.22 * spacing * this.#scale));
  }

  /** @param {number} i @returns {number} radius of its mark in pixels */
  #radius(i) {
    const { pattern, attribute } = this.#scene();
    if (attribute < 0) return this.mark;
    const { name, values } = pattern.attributes[attribute];
    const perRadius = radii(name);
    if (perRadius) return Math.max(SMALLEST_MARK, (values[i] / perRadius) * this.#scale);
    if (this.#ranged !== values) {
      this.#ranged = values;
      this.#range = attributeRange(pattern, attribute);
    }
    const [low, high] = this.#range;
    return SMALLEST_MARK + ((values[i] - low) / (high - low)) * LARGEST_RAMP;
  }

  /** Where the one selected point's handle is, in pixels. @returns {{ point: number, at: Pair, centre: Pair } | null} */
  handle() {
    const { pattern, selection, attribute } = this.#scene();
    if (attribute < 0 || selection.size !== 1) return null;
    const [point] = selection;
    const centre = this.pixel([pattern.positions[2 * point], pattern.positions[2 * point + 1]]);
    const reach = this.#radius(point) + HANDLE_GAP;
    // Towards the inside, so that it is always on the canvas.
    const side = centre[0] + reach + 10 > this.#width ? -1 : 1;
    return { point, at: [centre[0] + side * reach, centre[1]], centre };
  }

  /** @param {Pair} at in the pattern's own unit */
  hitsHandle(at) {
    const handle = this.handle();
    if (!handle) return null;
    const [x, y] = this.pixel(at);
    return Math.hypot(x - handle.at[0], y - handle.at[1]) <= HANDLE_REACH ? handle : null;
  }

  /**
   * The value that a handle pulled to a place gives.
   *
   * @param {{ centre: Pair }} handle
   * @param {Pair} at in the pattern's own unit
   */
  pulled({ centre }, at) {
    const { pattern, attribute } = this.#scene();
    const [x, y] = this.pixel(at);
    const radius = Math.max(0, Math.hypot(x - centre[0], y - centre[1]) - HANDLE_GAP);
    const [low, high] = attributeRange(pattern, attribute);
    const perRadius = radii(pattern.attributes[attribute].name);
    const value = perRadius ? (radius * perRadius) / this.#scale : low + ((radius - SMALLEST_MARK) / LARGEST_RAMP) * (high - low);
    return Math.min(Math.max(value, low), high);
  }

  /** Draws with the next frame; another domain is laid out first. */
  draw() {
    this.#frame ||= requestAnimationFrame(() => {
      this.#frame = 0;
      const { domain } = this.#scene().pattern;
      if (domain !== this.#domain) {
        this.#domain = domain;
        this.layout();
      } else {
        this.#paint();
      }
    });
  }

  #paint() {
    if (this.#width <= 1) return;
    const context = prepare(this.#canvas, this.#width, this.#height);
    const scene = this.#scene();
    const { pattern } = scene;
    const [width, height] = pattern.domain.slice(2).map((side) => side * this.#scale);
    const periodic = pattern.boundary === 'periodic';
    context.strokeStyle = this.#colours.lineStrong;
    context.setLineDash(periodic ? [4, 4] : []);
    context.strokeRect(MARGIN - 0.5, MARGIN - 0.5, width + 1, height + 1);
    context.setLineDash([]);
    if (periodic) {
      context.globalAlpha = 0.3;
      for (const [column, row] of [[-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]]) {
        this.#points(context, column * width, row * height);
      }
      context.globalAlpha = 1;
    }
    if (count(pattern) === 0) {
      context.fillStyle = this.#colours.soft;
      context.font = `15px ${getComputedStyle(this.#canvas).fontFamily}`;
      context.textAlign = 'center';
      context.textBaseline = 'middle';
      context.fillText('Click, tap or drag here', this.#width / 2, this.#height / 2);
    }
    this.#points(context, 0, 0);
    this.#rings(context, scene);
    if (scene.marquee) {
      const [[x, y], [right, bottom]] = [this.pixel(scene.marquee.from), this.pixel(scene.marquee.to)];
      context.fillStyle = context.strokeStyle = this.#colours.accent;
      context.globalAlpha = 0.1;
      context.fillRect(x, y, right - x, bottom - y);
      context.globalAlpha = 1;
      context.strokeRect(x, y, right - x, bottom - y);
    }
    if (scene.brush) {
      context.beginPath();
      context.arc(...this.pixel(scene.brush.at), scene.brush.reach * this.#scale, 0, 2 * Math.PI);
      context.strokeStyle = this.#colours.soft;
      context.stroke();
    }
    if (scene.cursor) this.#cross(context, this.pixel(scene.cursor));
  }

  /**
   * @param {CanvasRenderingContext2D} context
   * @param {number} left
   * @param {number} top
   */
  #points(context, left, top) {
    const { pattern } = this.#scene();
    const { positions, classes, classNames } = pattern;
    const many = classNames.length > 1;
    for (let klass = 0; klass < classNames.length; klass++) {
      context.beginPath();
      for (let i = 0; i < classes.length; i++) {
        if (classes[i] !== klass) continue;
        const [x, y] = this.pixel([positions[2 * i], positions[2 * i + 1]]);
        traceMark(context, many ? klass : 0, left + x, top + y, this.#radius(i));
      }
      context.fillStyle = many ? this.#colours.classes[klass % this.#colours.classes.length] : this.#colours.point;
      context.fill();
    }
  }

  /**
   * What is selected, pointed at, and the handle.
   *
   * @param {CanvasRenderingContext2D} context
   * @param {Scene} scene
   */
  #rings(context, { pattern, selection, hovered }) {
    context.strokeStyle = this.#colours.accent;
    context.lineWidth = 2;
    context.beginPath();
    for (const i of new Set([...selection, ...(hovered >= 0 ? [hovered] : [])])) {
      const [x, y] = this.pixel([pattern.positions[2 * i], pattern.positions[2 * i + 1]]);
      const radius = Math.max(1.35 * this.#radius(i), this.#radius(i) + 2) + 2;
      context.moveTo(x + radius, y);
      context.arc(x, y, radius, 0, 2 * Math.PI);
    }
    context.globalAlpha = selection.size > 0 ? 1 : 0.6;
    context.stroke();
    context.globalAlpha = 1;
    const handle = this.handle();
    if (handle) {
      context.lineWidth = 1;
      context.beginPath();
      context.moveTo(...handle.centre);
      context.lineTo(...handle.at);
      context.stroke();
      context.beginPath();
      context.arc(...handle.at, 5.5, 0, 2 * Math.PI);
      context.fillStyle = this.#colours.card;
      context.fill();
      context.lineWidth = 2;
      context.stroke();
    }
    context.lineWidth = 1;
  }

  /** @param {CanvasRenderingContext2D} context @param {Pair} at */
  #cross(context, [x, y]) {
    const path = () => {
      context.beginPath();
      for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
        context.moveTo(x + 5 * dx, y + 5 * dy);
        context.lineTo(x + 14 * dx, y + 14 * dy);
      }
      context.stroke();
    };
    context.strokeStyle = this.#colours.card;
    context.lineWidth = 5;
    path();
    context.strokeStyle = this.#colours.accent;
    context.lineWidth = 2;
    path();
    context.lineWidth = 1;
  }
}
