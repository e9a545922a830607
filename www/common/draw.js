// @ts-check
/** Patterns on canvases: sharp on every screen, one colour and one shape a class, y downwards as in the SVG files. */
import { fill, REACH, trace } from './glyphs.js';

/** @typedef {import('./messages.js').Points} Points */
/** @typedef {{ glyph: import('./glyphs.js').Glyph, colour: string }} Style how a class looks */

/** Colours of the page, read from its style sheet so that they live in one place. */
export function readColours() {
  const style = getComputedStyle(document.documentElement);
  const get = (/** @type {string} */ name) => style.getPropertyValue(name).trim();
  return {
    point: get('--point'),
    line: get('--line'),
    lineStrong: get('--line-strong'),
    soft: get('--soft'),
    card: get('--card'),
    accent: get('--accent'),
    /** Of the terms of a loss, in the order of the method's description. */
    terms: ['--term-0', '--term-1', '--term-2', '--term-3'].map(get),
    classes: Array.from({ length: 8 }, (_, index) => get(`--class-${index}`)),
  };
}

/** @typedef {ReturnType<typeof readColours>} Colours */

/**
 * Sets a canvas to a size in CSS pixels and as many device pixels as the screen has.
 *
 * @param {HTMLCanvasElement} canvas
 * @param {number} width
 * @param {number} height
 */
export function prepare(canvas, width, height) {
  const density = window.devicePixelRatio || 1;
  const [columns, rows] = [Math.round(width * density), Math.round(height * density)];
  if (canvas.width !== columns || canvas.height !== rows) {
    canvas.width = columns;
    canvas.height = rows;
  }
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  context.setTransform(columns / width, 0, 0, rows / height, 0, 0);
  context.clearRect(0, 0, width, height);
  return context;
}

/** Marks are never smaller than this, in CSS pixels. */
const LEAST_RADIUS = 0.6;

/**
 * Traces the plain mark of a class, for drawing by hand. Areas are alike, so that no class looks heavier than another.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {number} shape
 * @param {number} x
 * @param {number} y
 * @param {number} r radius of the disk
 */
export function traceMark(context, shape, x, y, r) {
  switch (shape % 4) {
    case 1:
      context.rect(x - 0.89 * r, y - 0.89 * r, 1.78 * r, 1.78 * r);
      break;
    case 2:
      context.moveTo(x, y - 1.45 * r);
      context.lineTo(x + 1.26 * r, y + 0.73 * r);
      context.lineTo(x - 1.26 * r, y + 0.73 * r);
      context.closePath();
      break;
    case 3:
      context.moveTo(x, y - 1.3 * r);
      context.lineTo(x + 1.3 * r, y);
      context.lineTo(x, y + 1.3 * r);
      context.lineTo(x - 1.3 * r, y);
      context.closePath();
      break;
    default:
      context.moveTo(x + r, y);
      context.arc(x, y, r, 0, 2 * Math.PI);
  }
}

/**
 * The mark of a class alone, as a sign.
 *
 * @param {HTMLCanvasElement} canvas
 * @param {Colours} colours
 * @param {number} klass
 * @param {boolean} many whether there is more than one class
 */
export function tracePreview(canvas, colours, klass, many) {
  const context = prepare(canvas, 14, 14);
  context.beginPath();
  traceMark(context, many ? klass : 0, 7, 7, 4.6);
  context.fillStyle = many ? colours.classes[klass % colours.classes.length] : colours.point;
  context.fill();
}

/**
 * From behind to the front, for patterns with depth: worked out once for a list of depths.
 *
 * @type {WeakMap<Float32Array, Uint32Array>}
 */
const orders = new WeakMap();

/** @param {Points} points */
function depthOrder({ depths, classes }) {
  let order = orders.get(depths);
  if (!order) {
    order = Uint32Array.from(depths.keys()).sort((a, b) => depths[b] - depths[a] || classes[a] - classes[b]);
    orders.set(depths, order);
  }
  return order;
}

/**
 * Draws all points: one path a class where nothing stands before anything, else one by one from behind to the front.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Colours} colours
 * @param {Points} points
 * @param {{ left: number, top: number, scale: number, radius: number, styles: Style[],
 *   wrap?: readonly [number, number] | null }} how
 *   `radius` of a mark whose size the pattern does not say, in CSS pixels; `wrap`: the size of a tile in exemplar
 *   units, where what crosses its border is to come in on the other side
 */
export function drawPoints(context, colours, points, { left, top, scale, radius, styles, wrap = null }) {
  const { positions, classes, radii, scales, turns, depths } = points;
  const size = (/** @type {number} */ i) =>
    Math.max(LEAST_RADIUS, i < radii.length ? radii[i] * scale : radius * (i < scales.length ? scales[i] : 1));
  /**
   * Calls `draw` wherever a point is to be seen.
   *
   * @param {number} i
   * @param {(x: number, y: number, r: number, turn: number) => void} draw
   */
  const place = (i, draw) => {
    const [x, y, r] = [positions[2 * i], positions[2 * i + 1], size(i)];
    const turn = i < turns.length ? turns[i] : 0;
    // As far as the margin around the tile, so that it shows what lies beyond the border.
    const reach = (REACH * r + left) / scale;
    for (const dx of wrap ? shifts(x, reach, wrap[0]) : HERE) {
      for (const dy of wrap ? shifts(y, reach, wrap[1]) : HERE) draw(left + (x + dx) * scale, top + (y + dy) * scale, r, turn);
    }
  };
  if (depths.length > 0) {
    for (const i of depthOrder(points)) {
      const style = styles[classes[i]];
      if (!style) continue;
      context.fillStyle = style.colour;
      place(i, (x, y, r, turn) => fill(context, style.glyph, x, y, r, turn, colours.card));
    }
  } else {
    for (const [number, style] of styles.entries()) {
      context.fillStyle = style.colour;
      const alone = style.glyph.path !== null;
      if (!alone) context.beginPath();
      for (let i = 0; i < classes.length; i++) {
        if (classes[i] !== number) continue;
        if (alone) place(i, (x, y, r, turn) => fill(context, style.glyph, x, y, r, turn, null));
        else place(i, (x, y, r, turn) => trace(context, style.glyph, x, y, r, turn));
      }
      if (!alone) context.fill();
    }
  }
}

const HERE = [0];

/**
 * Where else a mark on a torus has to be drawn, along one axis.
 *
 * @param {number} x
 * @param {number} reach
 * @param {number} side
 */
function shifts(x, reach, side) {
  if (x < reach) return [0, side];
  return x > side - reach ? [0, -side] : HERE;
}

/**
 * Whether a pattern is one of things rather than dots: its marks are worth seeing as shapes.
 *
 * @param {Points} points
 * @param {Style[]} styles
 */
export const areThings = (points, styles) =>
  points.radii.length > 0 || points.scales.length > 0 || points.turns.length > 0 ||
  styles.some(({ glyph }) => !PLAIN.includes(glyph.name));

/** Marks that are still what they are when they are small. */
const PLAIN = ['disk', 'ring', 'square', 'triangle', 'diamond'];

/**
 * Radius of a point's mark in CSS pixels: a share of the mean distance between neighbours, so that structure shows.
 *
 * @param {number | null} spacing in exemplar units
 * @param {number} scale pixels an exemplar unit
 * @param {boolean} things larger, so that shapes can be told apart
 * @param {number} [most] the largest that looks well on the page
 */
export function markRadius(spacing, scale, things = false, most = things ? 16 : 6) {
  const [share, least] = things ? [0.28, 1.1] : [0.22, 0.9];
  return Math.min(most, Math.max(least, share * (spacing ?? 0.05) * scale));
}
