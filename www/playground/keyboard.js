// @ts-check
/** Keys that work anywhere on the page, unless a control has them for itself. */

/** @param {import('./running.js').Running} running */
export function listenToKeys(running) {
  window.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    const target = /** @type {HTMLElement} */ (event.target);
    const type = target instanceof HTMLInputElement ? target.type : '';
    const writes = type !== '' && !['radio', 'checkbox', 'range', 'file'].includes(type);
    if (writes || target.closest('textarea, select')) return;
    // A control keeps the keys it answers to; a chosen radio does not answer to Space.
    const ownsSpace = target.closest('button, summary, a') || ['checkbox', 'file'].includes(type);
    const ownsArrows = type === 'radio' || type === 'range';
    if (event.key === ' ' && !ownsSpace) running.toggle();
    else if (event.key === 'ArrowRight' && !ownsArrows) void running.run.step();
    else if (event.key.toLowerCase() === 'r' && !event.repeat) void running.reset();
    else return;
    event.preventDefault();
  });
}
