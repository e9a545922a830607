// @ts-check
/**
 * For tests and for the curious, in the browser's console: what the page knows, as numbers, under `window.pointweave`.
 * `crash` works only on a page opened with `?test=1`.
 */

/**
 * @typedef {object} Parts
 * @property {import('./state.js').PageStore} store
 * @property {import('./running.js').Running} running
 * @property {import('./stage.js').Stage} stage
 * @property {import('./drawing.js').Drawing} drawing
 * @property {import('./loss-chart.js').LossChart} chart
 * @property {import('./look.js').Look} look
 * @property {import('./statistics.js').Statistics} statistics
 * @property {import('../common/worker-link.js').WorkerLink} link
 */

/** @param {Parts} parts */
export function openConsole({ store, running, stage, drawing: { editor }, chart, look, statistics, link }) {
  Object.assign(window, {
    pointweave: {
      get status() {
        return running.run.status;
      },
      get progress() {
        const { progress } = store.state;
        return progress && { ...progress };
      },
      /** All parameters of the run, under their names in files. */
      get parameters() {
        const { parameters } = store.state;
        return parameters && { ...parameters };
      },
      /** Where the points are, not where they are drawn on their way there: `[x, y, x, y, …]` in exemplar units. */
      get positions() {
        return Array.from(stage.positions);
      },
      /** The exemplar as it stands in the open editor. */
      get drawing() {
        return editor.isOpen ? structuredClone(editor.pattern) : null;
      },
      /** Total loss of every iteration so far. */
      get losses() {
        return chart.totals;
      },
      get savedIterations() {
        return running.run.savedIterations;
      },
      get engine() {
        const { engine } = store.state;
        return engine && { ...engine };
      },
      /** Which points are pinned, as places in `positions`. */
      get pinned() {
        return Array.from(stage.pinned);
      },
      /** The glyph and colour of every class of the exemplar, and what is chosen for files. */
      get look() {
        return look.choice;
      },
      /** How often statistics were worked out, and the latest. */
      get statistics() {
        return statistics.state;
      },
      crash: (/** @type {'trap' | 'silence' | 'device'} */ how) => link.crash(how),
    },
  });
}
