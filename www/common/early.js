// @ts-check
/**
 * Starts the worker and fetches its WebAssembly while the page's modules are still on the way: on a slow line that is a
 * second. A classic script at the head of the page, so that nothing comes before it. `worker-link.js` takes over what is
 * made here.
 */
(() => {
  const isTest = new URLSearchParams(location.search).get('test') === '1';
  const url = `./worker.js${isTest ? '?test=1' : ''}`;
  const worker = new Worker(url, { type: 'module' });
  // Null where it can't be compiled on the way: the worker then fetches it by itself, whatever type the host says it is.
  const module = fetch('./pkg/pointweave_bg.wasm').then(WebAssembly.compileStreaming).catch(() => null);
  /** @type {import('./worker-link.js').Early} */
  const early = { url, worker, module, failed: null };
  worker.onerror = (event) => {
    event.preventDefault();
    early.failed = event.message || 'it could not be loaded';
  };
  void module.then((made) => worker.postMessage({ module: made }));
  Object.assign(globalThis, { early });
})();
