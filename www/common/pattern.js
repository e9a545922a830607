// @ts-check
/**
 * A point pattern as it is edited: plain data in its own unit. Nothing here changes a pattern in place, so the one
 * before is still there to go back to. The limits are those of `src/pattern.rs`.
 */

/** @typedef {import('./messages.js').PatternData} Pattern */

export const MAX_POINTS = 20_000;
export const MAX_CLASSES = 16;
export const MAX_ATTRIBUTES = 8;
export const MAX_NAME_LENGTH = 64;

/** An empty unit square. @returns {Pattern} */
export const blank = () => ({
  positions: new Float64Array(),
  classes: new Uint16Array(),
  classNames: ['points'],
  attributes: [],
  domain: [0, 0, 1, 1],
  boundary: 'open',
});

/** @param {Pattern} pattern */
export const count = (pattern) => pattern.classes.length;

/** The longer side of the domain, which the method takes as its unit. @param {Pattern} pattern */
export const unit = ({ domain }) => Math.max(domain[2], domain[3]);

/**
 * A position inside the domain: wrapped where there is no border, else at the border.
 *
 * @param {Pattern} pattern
 * @param {number} x
 * @param {number} y
 * @returns {[number, number]}
 */
export function inside({ domain, boundary }, x, y) {
  const [left, top] = [x, y].map((value, axis) => {
    const [low, side] = [domain[axis], domain[2 + axis]];
    if (boundary === 'open') return Math.min(Math.max(value, low), low + side);
    const offset = value - low;
    const wrapped = offset - side * Math.floor(offset / side);
    // Rounding can give the side itself for a tiny negative value.
    return low + (wrapped < side ? wrapped : 0);
  });
  return [left, top];
}

/** @param {Pattern} pattern @param {number} x @param {number} y */
export function contains({ domain: [left, top, width, height] }, x, y) {
  return x >= left && y >= top && x <= left + width && y <= top + height;
}

/**
 * From one place to another, the short way round where there is no border.
 *
 * @param {Pattern} pattern
 * @param {number} x
 * @param {number} y
 * @param {number} toX
 * @param {number} toY
 * @returns {[number, number]}
 */
export function way({ domain: [, , width, height], boundary }, x, y, toX, toY) {
  const [dx, dy] = [toX - x, toY - y];
  if (boundary === 'open') return [dx, dy];
  return [dx - width * Math.round(dx / width), dy - height * Math.round(dy / height)];
}

/**
 * The point nearest to a place.
 *
 * @param {Pattern} pattern
 * @param {number} x
 * @param {number} y
 * @param {number} reach how far away it may be
 * @returns {number} its index, or -1
 */
export function nearest(pattern, x, y, reach) {
  let [best, least] = [-1, reach * reach];
  for (let i = 0; i < count(pattern); i++) {
    const [dx, dy] = way(pattern, x, y, pattern.positions[2 * i], pattern.positions[2 * i + 1]);
    const square = dx * dx + dy * dy;
    if (square <= least) [best, least] = [i, square];
  }
  return best;
}

/**
 * The points within reach of a straight stroke.
 *
 * @param {Pattern} pattern
 * @param {[number, number]} from
 * @param {[number, number]} to
 * @param {number} reach
 */
export function along(pattern, from, to, reach) {
  const [lengthX, lengthY] = [to[0] - from[0], to[1] - from[1]];
  const square = lengthX * lengthX + lengthY * lengthY;
  const found = [];
  for (let i = 0; i < count(pattern); i++) {
    const [dx, dy] = way(pattern, from[0], from[1], pattern.positions[2 * i], pattern.positions[2 * i + 1]);
    const share = square > 0 ? Math.min(1, Math.max(0, (dx * lengthX + dy * lengthY) / square)) : 0;
    if (Math.hypot(dx - share * lengthX, dy - share * lengthY) <= reach) found.push(i);
  }
  return found;
}

/**
 * The points in a rectangle between any two opposite corners.
 *
 * @param {Pattern} pattern
 * @param {[number, number]} from
 * @param {[number, number]} to
 */
export function within({ positions }, from, to) {
  const [left, right] = [Math.min(from[0], to[0]), Math.max(from[0], to[0])];
  const [top, bottom] = [Math.min(from[1], to[1]), Math.max(from[1], to[1])];
  const found = [];
  for (let i = 0; 2 * i < positions.length; i++) {
    const [x, y] = [positions[2 * i], positions[2 * i + 1]];
    if (x >= left && x <= right && y >= top && y <= bottom) found.push(i);
  }
  return found;
}

/** @param {ArrayLike<number>} values */
function median(values) {
  const sorted = Array.from(values).sort((a, b) => a - b);
  return sorted[sorted.length >> 1];
}

/**
 * @template {Float64Array | Uint16Array} A
 * @param {A} array
 * @param {number[]} values
 * @returns {A}
 */
function longer(array, ...values) {
  const result = new /** @type {any} */ (array.constructor)(array.length + values.length);
  result.set(array);
  result.set(values, array.length);
  return result;
}

/**
 * @param {Pattern} pattern
 * @param {[number, number]} at
 * @param {number} klass
 * @param {(number | undefined)[]} [values] of the attributes; the median of the others where there is none
 * @returns {Pattern}
 */
export function add(pattern, at, klass, values = []) {
  if (count(pattern) >= MAX_POINTS) return pattern;
  return {
    ...pattern,
    positions: longer(pattern.positions, ...inside(pattern, ...at)),
    classes: longer(pattern.classes, klass),
    attributes: pattern.attributes.map(({ name, values: those }, index) => ({
      name,
      values: longer(those, values[index] ?? (those.length > 0 ? median(those) : 1)),
    })),
  };
}

/**
 * @param {Pattern} pattern
 * @param {Iterable<number>} indices
 * @returns {Pattern}
 */
export function remove(pattern, indices) {
  const gone = new Set(indices);
  return {
    ...pattern,
    positions: pattern.positions.filter((_, i) => !gone.has(i >> 1)),
    classes: pattern.classes.filter((_, i) => !gone.has(i)),
    attributes: pattern.attributes.map(({ name, values }) => ({ name, values: values.filter((_, i) => !gone.has(i)) })),
  };
}

/**
 * Moves points together. At a border they stop together, so that their arrangement stays.
 *
 * @param {Pattern} pattern
 * @param {Iterable<number>} indices
 * @param {number} dx
 * @param {number} dy
 * @returns {Pattern}
 */
export function move(pattern, indices, dx, dy) {
  const positions = pattern.positions.slice();
  const moved = [...indices];
  const step = [dx, dy];
  if (pattern.boundary === 'open') {
    const { domain } = pattern;
    for (const i of moved) {
      for (const axis of [0, 1]) {
        const value = positions[2 * i + axis];
        step[axis] = Math.min(Math.max(step[axis], domain[axis] - value), domain[axis] + domain[2 + axis] - value);
      }
    }
  }
  for (const i of moved) {
    const at = inside(pattern, positions[2 * i] + step[0], positions[2 * i + 1] + step[1]);
    positions.set(at, 2 * i);
  }
  return { ...pattern, positions };
}

/**
 * @param {Pattern} pattern
 * @param {Iterable<number>} indices
 * @param {number} klass
 * @returns {Pattern}
 */
export function assign(pattern, indices, klass) {
  const classes = pattern.classes.slice();
  for (const i of indices) classes[i] = klass;
  return { ...pattern, classes };
}

/**
 * Left and right change places, or top and bottom: all points in the domain, or some within the box around them.
 *
 * @param {Pattern} pattern
 * @param {0 | 1} axis 0 is left and right
 * @param {Iterable<number>} [indices]
 * @returns {Pattern}
 */
export function mirror(pattern, axis, indices = []) {
  const positions = pattern.positions.slice();
  let mirrored = [...indices];
  let sum = 2 * pattern.domain[axis] + pattern.domain[2 + axis];
  if (mirrored.length > 0) {
    const values = mirrored.map((i) => positions[2 * i + axis]);
    sum = values.reduce((a, b) => Math.min(a, b)) + values.reduce((a, b) => Math.max(a, b));
  } else {
    mirrored = Array.from(pattern.classes, (_, i) => i);
  }
  for (const i of mirrored) {
    const at = /** @type {[number, number]} */ ([positions[2 * i], positions[2 * i + 1]]);
    at[axis] = sum - at[axis];
    positions.set(inside(pattern, ...at), 2 * i);
  }
  return { ...pattern, positions };
}

/** @param {Pattern} pattern @returns {Pattern} */
export const clear = (pattern) => remove(pattern, pattern.classes.keys());

/**
 * @param {Pattern} pattern
 * @param {'open' | 'periodic'} boundary
 * @returns {Pattern}
 */
export const withBoundary = (pattern, boundary) => ({ ...pattern, boundary });

/**
 * A name that can be used: not empty, not too long, not taken.
 *
 * @param {string[]} taken
 * @param {string} wanted
 */
function freeName(taken, wanted) {
  const name = [...wanted.trim()].slice(0, MAX_NAME_LENGTH - 4).join('') || 'class';
  if (!taken.includes(name)) return name;
  for (let number = 2; ; number++) {
    if (!taken.includes(`${name} ${number}`)) return `${name} ${number}`;
  }
}

/** @param {Pattern} pattern @returns {Pattern} */
export function withClass(pattern) {
  const { classNames } = pattern;
  if (classNames.length >= MAX_CLASSES) return pattern;
  return { ...pattern, classNames: [...classNames, freeName(classNames, `class ${classNames.length + 1}`)] };
}

/**
 * @param {Pattern} pattern
 * @param {number} klass
 * @param {string} name
 * @returns {Pattern}
 */
export function renamed(pattern, klass, name) {
  const others = pattern.classNames.toSpliced(klass, 1);
  return { ...pattern, classNames: pattern.classNames.with(klass, freeName(others, name)) };
}

/**
 * @param {Pattern} pattern
 * @param {string} name
 * @param {number} value of every point
 * @returns {Pattern}
 */
export function withAttribute(pattern, name, value) {
  if (pattern.attributes.length >= MAX_ATTRIBUTES) return pattern;
  const values = new Float64Array(count(pattern)).fill(value);
  return { ...pattern, attributes: [...pattern.attributes, { name, values }] };
}

/**
 * @param {Pattern} pattern
 * @param {number} attribute
 * @returns {Pattern}
 */
export const withoutAttribute = (pattern, attribute) => ({
  ...pattern,
  attributes: pattern.attributes.toSpliced(attribute, 1),
});

/**
 * @param {Pattern} pattern
 * @param {number} attribute
 * @param {Iterable<number>} indices
 * @param {(value: number) => number} change
 * @returns {Pattern}
 */
export function adjust(pattern, attribute, indices, change) {
  const { name, values } = pattern.attributes[attribute];
  const changed = values.slice();
  for (const i of indices) changed[i] = change(values[i]);
  return { ...pattern, attributes: pattern.attributes.with(attribute, { name, values: changed }) };
}

/** Without classes that no point is of: nothing could be learnt about them. @param {Pattern} pattern @returns {Pattern} */
export function compact(pattern) {
  const used = pattern.classNames.map((_, klass) => pattern.classes.includes(klass));
  if (used.every(Boolean)) return pattern;
  let next = 0;
  const number = used.map((is) => (is ? next++ : 0));
  return {
    ...pattern,
    classes: pattern.classes.map((klass) => number[klass]),
    classNames: pattern.classNames.filter((_, klass) => used[klass]),
  };
}
