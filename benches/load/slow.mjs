// @ts-check
/**
 * Slows the processor down for a page as a whole.
 *
 * Chromium's own switch (`Emulation.setCPUThrottlingRate`) reaches a page's main thread, but no worker and no thread that
 * compiles WebAssembly, where most of this page's work is. So whole processes are stopped and let go on by signals:
 * within each period, every process that runs pages or workers runs for one part of `slowdown` parts. The browser's own
 * process, with its network and drawing, is not slowed. Linux and macOS have these signals.
 */

/** Long enough for the timers here, short enough that no frame takes notice. */
const PERIOD_MS = 16;

/** Work of about 40 ms, on a processor of its own. Is put into a page and into a worker. */
const WORK = `(() => {
  const begin = performance.now();
  let value = 1;
  for (let turn = 0; turn < 3e7; turn++) value = (value * 1664525 + 1013904223) | 0;
  return value === 0.5 ? 0 : performance.now() - begin;
})()`;

/**
 * @param {import('playwright-core').BrowserContext} context
 * @param {number} slowdown 1 or more; 1 leaves everything as it is
 */
export async function slowDown(context, slowdown) {
  if (slowdown === 1) return { stop: async () => {} };
  const browser = context.browser();
  const session = await browser?.newBrowserCDPSession();
  if (!session) throw new Error('this Chromium does not tell its processes');
  let ended = false;
  /** @type {number[]} */
  let processes = [];
  /** @param {'SIGSTOP' | 'SIGCONT'} signal */
  const signal = (signal) => {
    for (const process_ of processes) {
      try {
        process.kill(process_, signal);
      } catch {
        // It has ended; the next list is without it.
      }
    }
  };
  const look = async () => {
    const { processInfo } = await session.send('SystemInfo.getProcessInfo');
    processes = processInfo.filter(({ type }) => type === 'renderer').map(({ id }) => id);
  };
  await look();
  const wait = (/** @type {number} */ milliseconds) => new Promise((resolve) => void setTimeout(resolve, milliseconds));
  const turns = (async () => {
    let due = performance.now();
    for (let turn = 0; !ended; turn++) {
      signal('SIGCONT');
      const begin = performance.now();
      await wait(PERIOD_MS / slowdown);
      signal('SIGSTOP');
      // As long as it ran, times what is missing: timers are late by a millisecond or more.
      due = performance.now() + (performance.now() - begin) * (slowdown - 1);
      // A worker may have got a process of its own.
      if (turn % 8 === 0) look().catch(() => {});
      await wait(due - performance.now());
    }
    signal('SIGCONT');
  })();
  return {
    stop: async () => {
      ended = true;
      await turns;
      await session.detach();
    },
  };
}

/**
 * How much slower a page and a worker are, measured.
 *
 * @param {import('playwright-core').Page} page any that may start workers
 * @param {() => Promise<{ stop: () => Promise<void> }>} slow
 * @returns {Promise<{ page: number, worker: number }>}
 */
export async function measureSlowdown(page, slow) {
  const measure = () =>
    page.evaluate(async (work) => {
      const run = /** @type {() => number} */ (new Function(`return ${work}`));
      const source = URL.createObjectURL(new Blob([`onmessage = () => postMessage(${work})`]));
      const worker = new Worker(source);
      const ask = () =>
        new Promise((resolve) => {
          worker.onmessage = ({ data }) => resolve(data);
          worker.postMessage(0);
        });
      // The first time it is compiled.
      run();
      await ask();
      const result = { page: run(), worker: /** @type {number} */ (await ask()) };
      worker.terminate();
      return result;
    }, WORK);
  const fast = await measure();
  const { stop } = await slow();
  const slowed = await measure();
  await stop();
  return { page: slowed.page / fast.page, worker: slowed.worker / fast.worker };
}
