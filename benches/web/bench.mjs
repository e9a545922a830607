// @ts-check
/** The page of the benchmark: hands a workload to a fresh worker, as the playground would. */

/**
 * @param {string} workload as JSON
 * @returns {Promise<string>} the report, as JSON
 */
function bench(workload) {
  return new Promise((resolve, reject) => {
    const worker = new Worker(new URL('./worker.mjs', import.meta.url), { type: 'module' });
    const end = (/** @type {() => void} */ settle) => {
      worker.terminate();
      settle();
    };
    worker.onmessage = ({ data: { report, error } }) =>
      end(() => (error === undefined ? resolve(report) : reject(new Error(error))));
    // A module that can't be loaded gives an event without a message.
    worker.onerror = ({ message }) => end(() => reject(new Error(message ?? 'the worker could not be loaded')));
    worker.postMessage(workload);
  });
}

Object.assign(window, { bench });
