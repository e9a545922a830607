// @ts-check
/** Patterns on canvases: sharp on every screen, one colour and one shape a class, y downwards as in the SVG files. */

/** @typedef {import('./messages.js').Points} Points */

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
    gram: get('--gram'),
    correlation: get('--correlation'),
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

/**
 * Traces one mark. Areas are alike, so that no class looks heavier than another.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {number} shape
 * @param {number} x
 * @param {number} y
 * @param {number} r radius of the disk
 */
export function trace(context, shape, x, y, r) {
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
  trace(context, many ? klass : 0, 7, 7, 4.6);
  context.fillStyle = many ? colours.classes[klass % colours.classes.length] : colours.point;
  context.fill();
}

/**
 * Draws all points, one path a class.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Colours} colours
 * @param {Float32Array} positions
 * @param {Uint16Array} classes
 * @param {{ left: number, top: number, scale: number, radius: number, many: boolean }} how `many`: more than one class
 */
export function drawPoints(context, colours, positions, classes, { left, top, scale, radius, many }) {
  const last = many ? classes.reduce((a, b) => Math.max(a, b), 0) : 0;
  for (let shape = 0; shape <= last; shape++) {
    context.beginPath();
    for (let i = 0; i < classes.length; i++) {
      if (many && classes[i] !== shape) continue;
      trace(context, shape, left + positions[2 * i] * scale, top + positions[2 * i + 1] * scale, radius);
    }
    context.fillStyle = many ? colours.classes[shape % colours.classes.length] : colours.point;
    context.fill();
  }
}

/**
 * Radius of a point's mark in CSS pixels: a share of the mean distance between neighbours, so that structure shows.
 *
 * @param {number | null} spacing in exemplar units
 * @param {number} scale pixels an exemplar unit
 * @param {number} [most] the largest that looks well on the page
 */
export function markRadius(spacing, scale, most = 6) {
  return Math.min(most, Math.max(0.9, 0.22 * (spacing ?? 0.05) * scale));
}
