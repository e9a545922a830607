// @ts-check
/** Numbers in words for people. */

/** @param {number} count */
export const points = (count) => `${count.toLocaleString('en')} ${count === 1 ? 'point' : 'points'}`;

/** @param {number} factor */
export const times = (factor) => `×${Number(factor.toFixed(2))}`;

/** @param {number} seconds */
export function duration(seconds) {
  if (seconds < 1) return '1 s';
  if (seconds < 90) return `${Math.round(seconds)} s`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min`;
  return `${(seconds / 3600).toFixed(1)} h`;
}

/** @param {number} perSecond */
export function rate(perSecond) {
  if (perSecond >= 10) return `${Math.round(perSecond)} it/s`;
  if (perSecond >= 1) return `${perSecond.toFixed(1)} it/s`;
  return `${(1 / perSecond).toFixed(1)} s/it`;
}
