// @ts-check
/** Patterns of the page as the engine learns from them, and as the page draws them. */
import { compact, count, unit } from './pattern.js';

/** @typedef {import('./pattern.js').Pattern} Pattern */

/** Marks of classes that nothing is known of. */
const MARKS = ['disk', 'square', 'triangle', 'diamond'];

/**
 * A pattern as an exemplar of the engine.
 *
 * @param {Pattern} pattern
 * @param {string} [name] what the page calls it
 * @returns {import('./messages.js').Source}
 */
export function sourceOf(pattern, name = 'drawing') {
  return { source: 'pattern', name, pattern: compact(pattern) };
}

/**
 * A pattern as it is drawn in small.
 *
 * @param {Pattern} pattern
 * @returns {import('./messages.js').PatternView}
 */
export function viewOf(pattern) {
  const [left, top, width, height] = pattern.domain;
  const side = unit(pattern);
  return {
    points: {
      ids: Uint32Array.from(pattern.classes.keys()),
      positions: Float32Array.from(pattern.positions, (value, i) => (value - (i % 2 === 0 ? left : top)) / side),
      classes: pattern.classes,
      radii: Float32Array.from(pattern.attributes.find(({ name }) => name === 'radius')?.values ?? [], (r) => r / side),
      scales: new Float32Array(),
      turns: new Float32Array(),
      depths: new Float32Array(),
      pinned: new Uint32Array(),
    },
    looks: pattern.classNames.map((_, color) => ({ glyph: MARKS[color % MARKS.length], color })),
    classNames: pattern.classNames,
    size: [width / side, height / side],
    min: [left, top],
    unit: side,
    boundary: pattern.boundary,
    spacing: (0.7 * Math.sqrt(width * height / Math.max(count(pattern), 1))) / side,
  };
}
