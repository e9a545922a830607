// @ts-check
/** Elements of the page by their ids. Every id belongs to one module; what others show there goes through that module. */

/**
 * @template {HTMLElement} [E=HTMLElement]
 * @param {string} id
 * @returns {E}
 */
export function element(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no element '${id}'`);
  return /** @type {E} */ (found);
}

/** An input field, a slider or a box. @param {string} id */
export const input = (id) => /** @type {HTMLInputElement} */ (element(id));
