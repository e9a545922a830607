// @ts-check
/**
 * Glyphs: what stands for a point. The worker knows their outlines (`src/formats/glyph.rs`), so that a picture on the
 * page and one in a file look the same. Shapes with straight sides are traced, a whole class in one path; what a person
 * drew is a `Path2D` of its own.
 */

/**
 * In radii, y downwards. A circle has neither corners nor a path.
 *
 * @typedef {{ name: string, corners: number[] | null, path: Path2D | null }} Glyph
 */

/** @type {Glyph} */
export const DISK = { name: 'disk', corners: null, path: null };

/** A ring's line is this share of its radius, as in the files. */
const RING = 0.4;
/** Nothing reaches farther from its middle, in radii. */
export const REACH = 1.9;

/**
 * @param {string} name
 * @param {string} outline path data of `M`, `L`, `C` and `Z`; empty for circles
 * @returns {Glyph}
 */
export function glyph(name, outline) {
  if (outline === '') return { name, corners: null, path: null };
  const straight = /^M[^A-Z]+(L[^A-Z]+)+Z$/.test(outline);
  if (!straight) return { name, corners: null, path: new Path2D(outline) };
  return { name, corners: (outline.match(/-?[\d.]+/g) ?? []).map(Number), path: null };
}

/**
 * Adds a glyph that is a circle or has straight sides to the path at hand.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Glyph} shape
 * @param {number} x
 * @param {number} y
 * @param {number} r
 * @param {number} turn degrees, counter-clockwise as one sees it
 */
export function trace(context, { name, corners }, x, y, r, turn) {
  if (!corners) {
    context.moveTo(x + r, y);
    context.arc(x, y, r, 0, 2 * Math.PI);
    if (name === 'ring') {
      // Backwards, so that it is a hole.
      const inner = r - Math.min(r, Math.max(RING * r, 1));
      context.moveTo(x + inner, y);
      context.arc(x, y, inner, 0, 2 * Math.PI, true);
    }
    return;
  }
  // y points down, so turning back is counter-clockwise.
  const angle = (-turn * Math.PI) / 180;
  const [cos, sin] = turn === 0 ? [r, 0] : [r * Math.cos(angle), r * Math.sin(angle)];
  for (let k = 0; k < corners.length; k += 2) {
    const [u, v] = [corners[k], corners[k + 1]];
    if (k === 0) context.moveTo(x + u * cos - v * sin, y + u * sin + v * cos);
    else context.lineTo(x + u * cos - v * sin, y + u * sin + v * cos);
  }
  context.closePath();
}

/**
 * Fills one glyph by itself, with a line around it where `halo` is a colour.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Glyph} shape
 * @param {number} x
 * @param {number} y
 * @param {number} r
 * @param {number} turn degrees, counter-clockwise as one sees it
 * @param {string | null} halo
 */
export function fill(context, shape, x, y, r, turn, halo) {
  const line = 1.6;
  if (halo) context.strokeStyle = halo;
  if (!shape.path) {
    context.beginPath();
    trace(context, shape, x, y, r, turn);
    context.lineWidth = line;
    if (halo) context.stroke();
    context.fill();
    return;
  }
  context.save();
  context.translate(x, y);
  context.rotate((-turn * Math.PI) / 180);
  context.scale(r, r);
  context.lineWidth = line / r;
  if (halo) context.stroke(shape.path);
  context.fill(shape.path);
  context.restore();
}
