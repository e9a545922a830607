// @ts-check
/** What the page can't do with a method, in words. */

/** @typedef {import('../common/messages.js').MethodView} MethodView */
/** @typedef {import('../common/messages.js').Tool} Tool */

/** @type {Record<Tool, string>} */
const DOES = {
  move: 'move points',
  pin: 'pin points',
  'redo-region': 'do a region again',
  continue: 'go on from the points as they are',
  gpu: 'compute on a GPU',
};

/**
 * Why a tool is of no use with a method.
 *
 * @param {MethodView | null} method nothing is known of one that was not described yet
 * @param {Tool} tool
 * @returns {string | null} a sentence; null where the method has the tool
 */
export const lack = (method, tool) => (!method || method.tools.includes(tool) ? null : `${method.title} can’t ${DOES[tool]}.`);
