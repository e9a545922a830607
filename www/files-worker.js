// @ts-check
/**
 * The worker for files: one request in, one response out, in order. Everything it does is in `src/web/files.rs`, save that pictures are
 * decoded here, by the browser.
 *
 * After a trap the wasm's memory is in an unknown state, so the worker says `died` and is replaced.
 */
import init, { answer } from './pkg/pointweave_files.js';

/** @typedef {import('./common/files-messages.js').BlobOptions} BlobOptions */

const ready = init();

/** Longer side of a picture in pixels, beyond which it is made smaller before its points are looked for. */
const LARGEST_PICTURE = 2048;

/** The picture that was read last, so that a slider need not decode it anew. */
let picture = /** @type {{ name: string, image: ImageData } | null} */ (null);

/** @param {string} message */
const refusal = (message) => ({ type: 'error', message, place: null });

/** @param {BlobOptions} options */
function findBlobs(options) {
  if (!picture) return refusal('no picture has been read yet');
  const { width, height, data } = picture.image;
  const pixels = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
  return { ...answer({ type: 'blobs', width, height, pixels, options }), width, height };
}

/**
 * Pixels by way of a canvas: any picture that the browser can show.
 *
 * @param {string} name
 * @param {Uint8Array} bytes
 */
async function decode(name, bytes) {
  const bitmap = await createImageBitmap(new Blob([/** @type {Uint8Array<ArrayBuffer>} */ (bytes)])).catch(() => null);
  if (!bitmap) return refusal(`${name || 'the picture'}: the browser can't decode this picture`);
  const shrink = Math.min(1, LARGEST_PICTURE / Math.max(bitmap.width, bitmap.height));
  const [width, height] = [bitmap.width, bitmap.height].map((side) => Math.max(1, Math.round(side * shrink)));
  const context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
  if (!context) return refusal('this browser gives no pixels of pictures');
  context.drawImage(bitmap, 0, 0, width, height);
  bitmap.close();
  picture = { name, image: context.getImageData(0, 0, width, height) };
  return findBlobs({});
}

/** @param {any} request */
async function respond(request) {
  await ready;
  if (request.type === 'blobs-again') return findBlobs(request.options);
  const response = answer(request);
  return response.type === 'picture' ? decode(request.name, request.bytes) : response;
}

let line = Promise.resolve();
let dead = false;
self.onmessage = ({ data: { id, request } }) => {
  // The link to a worker hands on compiled WebAssembly first; this one fetches its own.
  if (!request) return;
  line = line.then(async () => {
    if (dead) return;
    try {
      self.postMessage({ id, response: await respond(request) });
    } catch (error) {
      dead = true;
      self.postMessage({ died: error instanceof Error ? error.message : String(error) });
    }
  });
};
