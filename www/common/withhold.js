// @ts-check
/**
 * Disables a control for reasons of several owners: it is enabled when nobody has one left. What the title says is the
 * first reason in words, or what it said before.
 */

/** @typedef {HTMLButtonElement | HTMLInputElement} Control */
/** @typedef {{ title: string, reasons: Map<string, string> }} Withheld */

/** @type {WeakMap<Control, Withheld>} */
const known = new WeakMap();

/**
 * @param {Control} control
 * @param {string} owner whose reason it is; a later one of the same owner replaces it
 * @param {string | null} reason in a sentence, or empty where the page says it elsewhere; null where there is none (any more)
 */
export function withhold(control, owner, reason) {
  // A control that is drawn by its label shows no title of its own.
  const titled = control instanceof HTMLInputElement ? (control.closest('label') ?? control) : control;
  const state = known.get(control) ?? { title: titled.title, reasons: new Map() };
  known.set(control, state);
  if (reason === null) state.reasons.delete(owner);
  else state.reasons.set(owner, reason);
  control.disabled = state.reasons.size > 0;
  titled.title = [...state.reasons.values()].find((words) => words !== '') ?? state.title;
}
