// @ts-check
/**
 * The worker: one request in, one response out, in order. Everything it does is in `src/web/session.rs`.
 *
 * Only the choice of an engine is out of order: opening a device and checking that it computes correctly takes a
 * while, and the run goes on meanwhile. A session of its own does it; the one with the run takes over what came of it.
 *
 * A trap in the wasm leaves its memory in an unknown state, so the worker does not go on after one: it says `died`
 * and the page replaces it.
 */
import init, { WorkerSession } from './pkg/pointweave.js';

/** Only a page opened for a test may ask the worker to die. */
const isTest = new URL(self.location.href).searchParams.get('test') === '1';

/** The page has the module compiled, or null where it could not: then it is fetched here. @type {(module: WebAssembly.Module | null) => void} */
let give = () => {};
/** @type {Promise<WebAssembly.Module | null>} */
const given = new Promise((resolve) => void (give = resolve));
/** @type {Promise<WorkerSession>} */
const session = given
  .then((module) => (module ? init({ module_or_path: module }) : init()))
  .then(() => new WorkerSession());

/** A real trap, as a bug in the wasm would cause: `(module (func (export "f") unreachable))`. */
const TRAP = Uint8Array.of(
  0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 7, 5, 1, 1, 102, 0, 0, 10, 5, 1, 3, 0, 0, 11,
);

/** @param {'trap' | 'silence'} how */
async function crash(how) {
  if (how === 'silence') return new Promise(() => {});
  const { instance } = await WebAssembly.instantiate(TRAP);
  return /** @type {() => void} */ (instance.exports.f)();
}

/** Browsers write names in small letters: `nvidia ampere`, `amd rdna-2`. @param {string} word */
function spelled(word) {
  if (/^(amd|nvidia|rdna|gcn)/.test(word)) return word.toUpperCase();
  return word === 'swiftshader' ? 'SwiftShader' : word.charAt(0).toUpperCase() + word.slice(1);
}

/**
 * What the browser tells about the adapter that the module will get; the module itself can't ask.
 *
 * @returns {Promise<import('./common/messages.js').AdapterView | null>}
 */
async function describeAdapter() {
  const adapter = await navigator.gpu?.requestAdapter({ powerPreference: 'high-performance' }).catch(() => null);
  if (!adapter) return null;
  const { vendor, architecture, device, description, isFallbackAdapter } = adapter.info;
  const name = description || [vendor, device || architecture].filter(Boolean).map(spelled).join(' ');
  return { name, software: isFallbackAdapter || /swiftshader|llvmpipe|basic render/i.test(`${architecture} ${name}`) };
}

/** Compiling the kernels may take long; a driver that hangs is not waited for. */
const ENGINE_PATIENCE_MS = 60_000;
/** How many times an engine was chosen. */
let choices = 0;

/**
 * Opens what was chosen.
 *
 * @param {import('./common/messages.js').EngineRequest} request
 */
async function prepareEngine(request) {
  await session;
  const adapter = await describeAdapter();
  let chooser = new WorkerSession();
  const late = new Promise((resolve) => void setTimeout(resolve, ENGINE_PATIENCE_MS, null));
  let response = await Promise.race([chooser.answer({ ...request, adapter }), late]);
  if (!response) {
    // The one that waits still waits.
    chooser = new WorkerSession();
    response = await chooser.answer({ type: 'engine', choice: 'cpu' });
    response.note = `The GPU was not ready within ${ENGINE_PATIENCE_MS / 1000} s. The processor computes instead.`;
  }
  return { chooser, response: { ...response, adapter } };
}

/** Requests are answered one after the other, also while the wasm is still loading. */
let line = Promise.resolve();
let dead = false;

/**
 * Puts something at the end of the line.
 *
 * @param {(ready: WorkerSession) => Promise<void>} work
 */
function inLine(work) {
  line = line.then(async () => {
    if (dead) return;
    try {
      await work(await session);
    } catch (error) {
      die(error);
    }
  });
}

/** @param {unknown} error */
function die(error) {
  dead = true;
  self.postMessage({ died: error instanceof Error ? error.message : String(error) });
}

self.onmessage = ({ data: { id, request, module } }) => {
  if (module !== undefined) return give(module);
  if (request.type === 'engine') {
    const choice = ++choices;
    prepareEngine(request).then(
      ({ chooser, response }) =>
        inLine(async (ready) => {
          if (choice === choices) {
            ready.takeEngine(chooser);
            self.postMessage({ id, response });
          } else {
            chooser.free();
            self.postMessage({ id, response: { type: 'error', message: 'another engine was chosen', place: null } });
          }
        }),
      die,
    );
    return;
  }
  inLine(async (ready) => {
    if (isTest && request.type === 'crash') {
      if (request.how === 'device') ready.destroyDevice();
      else await crash(request.how);
    }
    self.postMessage({ id, response: await ready.answer(request) });
  });
};
