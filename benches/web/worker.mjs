// @ts-check
/** Times the module where the playground runs it: in a worker. */
import init, { bench_iterations } from '/pkg/pointweave.js';

self.onmessage = async ({ data: workload }) => {
  try {
    await init();
    self.postMessage({ report: bench_iterations(workload) });
  } catch (error) {
    self.postMessage({ error: error instanceof Error ? error.message : String(error) });
  }
};
