// @ts-check
/** How drawn points get to where they are: on the short way, a share of it every frame. */

/** @typedef {import('../common/messages.js').PatternView} PatternView */
/** @typedef {import('../common/messages.js').Points} Points */

/** The drawn points cover this share of their way in about 60 ms. */
const GLIDE_MS = 70;

/**
 * Where points that came and went are drawn: those that stayed go on from where they are, new ones stand where they belong.
 *
 * @param {Float32Array<ArrayBuffer>} drawn so far
 * @param {Uint32Array} before the ids so far
 * @param {Points} points
 * @returns {Float32Array<ArrayBuffer>}
 */
export function carried(drawn, before, { ids, positions }) {
  if (before.length === ids.length && before.every((id, index) => id === ids[index])) return drawn;
  const places = new Map(Array.from(before, (id, index) => [id, index]));
  const next = new Float32Array(positions);
  for (const [index, id] of ids.entries()) {
    const place = places.get(id);
    if (place !== undefined) next.set(drawn.subarray(2 * place, 2 * place + 2), 2 * index);
  }
  return next;
}

/**
 * Moves drawn points on towards where they are.
 *
 * @param {Float32Array} drawn where they are drawn; changed
 * @param {PatternView} output
 * @param {number} elapsedMs
 * @param {number} close what is as near as this has arrived, in exemplar units
 * @param {{ index: number, place: [number, number] } | null} held the point that a hand holds, and where
 * @returns {boolean} whether all have arrived
 */
export function glide(drawn, { points: { positions: target }, size, boundary }, elapsedMs, close, held) {
  const periodic = boundary === 'periodic';
  const share = 1 - Math.exp(-elapsedMs / GLIDE_MS);
  let arrived = true;
  for (let i = 0; i < target.length; i++) {
    if (held?.index === i >> 1) {
      drawn[i] = held.place[i % 2];
      continue;
    }
    const side = size[i % 2];
    let way = target[i] - drawn[i];
    // On a torus the short way may lead across the border.
    if (periodic) way -= side * Math.round(way / side);
    if (Math.abs(way) <= close) {
      drawn[i] = target[i];
      continue;
    }
    arrived = false;
    let next = drawn[i] + share * way;
    if (periodic) next -= side * Math.floor(next / side);
    drawn[i] = next;
  }
  return arrived;
}
