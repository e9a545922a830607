// @ts-check
/** Disables what the chosen method can't do, and says so. */
import { withhold } from '../common/withhold.js';

/** @typedef {import('../common/messages.js').MethodView} MethodView */

/** @param {string} id */
const control = (id) => /** @type {HTMLButtonElement | HTMLInputElement} */ (document.getElementById(id));

/**
 * @param {Pick<MethodView, 'title' | 'tools'>} method
 * @param {{ touch: import('./touch.js').Touch, engine: import('./engine.js').Engine }} page
 */
export function disableMissingTools({ title, tools }, { touch, engine }) {
  const can = (/** @type {MethodView['tools'][number]} */ tool, /** @type {string} */ words) =>
    tools.includes(tool) ? null : `${title} can’t ${words}.`;
  const onward = can('continue', 'go on from the points as they are');
  withhold(control('go-on'), 'method', onward);
  withhold(control('keep-points'), 'method', onward);
  withhold(control('touch-region'), 'method', can('redo-region', 'do a region again'));
  touch.offer({ moves: tools.includes('move'), pins: tools.includes('pin'), redoes: tools.includes('redo-region') });
  engine.withholdGpu(can('gpu', 'compute on a GPU'));
}
