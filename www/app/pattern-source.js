// @ts-check
/** Edited patterns to the engine and back. */
import { compact, count, inside, unit } from './pattern.js';

/** @typedef {import('./pattern.js').Pattern} Pattern */
/** @typedef {import('./messages.js').Source} Source */

/**
 * A pattern as an exemplar the engine can read. Every digit arrives: numbers are written so that they read back the same.
 *
 * @param {Pattern} pattern
 * @param {string} [name] what the page calls it
 * @returns {Source}
 */
export function sourceOf(pattern, name = 'drawing') {
  const { positions, classes, classNames, attributes, domain, boundary } = compact(pattern);
  const text = JSON.stringify({
    domain: { min: domain.slice(0, 2), size: domain.slice(2) },
    boundary,
    positions: Array.from(classes, (_, i) => [positions[2 * i], positions[2 * i + 1]]),
    classes: [...classes],
    class_names: classNames,
    attributes: attributes.map(({ name, values }) => ({ name, values: [...values] })),
  });
  return { source: 'file', name: `${name}.json`, bytes: new TextEncoder().encode(text) };
}

/**
 * What is drawn of an exemplar, as a pattern to edit: as exact as the picture, a ten-millionth of its side.
 *
 * @param {import('./messages.js').PatternView} view
 * @returns {Pattern}
 */
export function patternOf({ points, classNames, size, min, unit, boundary }) {
  /** @type {Pattern} */
  const pattern = {
    positions: new Float64Array(points.positions.length),
    classes: points.classes.slice(),
    classNames: [...classNames],
    attributes: [],
    domain: [min[0], min[1], size[0] * unit, size[1] * unit],
    boundary,
  };
  // Rounding must not carry a point on the border outside.
  const bounded = { ...pattern, boundary: /** @type {const} */ ('open') };
  for (let i = 0; i < pattern.positions.length; i += 2) {
    const [x, y] = [points.positions[i], points.positions[i + 1]];
    pattern.positions.set(inside(bounded, min[0] + x * unit, min[1] + y * unit), i);
  }
  return pattern;
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
      positions: Float32Array.from(pattern.positions, (value, i) => (value - (i % 2 === 0 ? left : top)) / side),
      classes: pattern.classes,
    },
    classNames: pattern.classNames,
    size: [width / side, height / side],
    min: [left, top],
    unit: side,
    boundary: pattern.boundary,
    spacing: (0.7 * Math.sqrt(width * height / Math.max(count(pattern), 1))) / side,
  };
}
