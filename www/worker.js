// @ts-check
/**
 * The worker: one request in, one response out, in order. Everything it does is in `src/web/session.rs`.
 *
 * A trap in the wasm leaves its memory in an unknown state, so the worker does not go on after one: it says `died`
 * and the page replaces it.
 */
import init, { WorkerSession } from './pkg/pointweave.js';

/** Only a page opened for a test may ask the worker to die. */
const isTest = new URL(self.location.href).searchParams.get('test') === '1';

/** @type {Promise<WorkerSession>} */
const session = init().then(() => new WorkerSession());

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

/** What the browser tells about the adapter that the module will get; the module itself can't ask. */
async function describeAdapter() {
  const adapter = await navigator.gpu?.requestAdapter({ powerPreference: 'high-performance' }).catch(() => null);
  if (!adapter) return null;
  const { vendor, architecture, device, description, isFallbackAdapter } = adapter.info;
  const name = description || [vendor, device || architecture].filter(Boolean).join(' ');
  return { name, software: isFallbackAdapter || /swiftshader|llvmpipe|basic render/i.test(`${architecture} ${name}`) };
}

/** Requests are answered one after the other, also while the wasm is still loading. */
let line = Promise.resolve();
let dead = false;

self.onmessage = ({ data: { id, request } }) => {
  line = line.then(async () => {
    if (dead) return;
    try {
      const ready = await session;
      if (isTest && request.type === 'crash') {
        if (request.how === 'device') ready.destroyDevice();
        else await crash(request.how);
      }
      if (request.type === 'engine') request.adapter = await describeAdapter();
      const response = await ready.answer(request);
      self.postMessage({ id, response });
    } catch (error) {
      dead = true;
      self.postMessage({ died: error instanceof Error ? error.message : String(error) });
    }
  });
};
