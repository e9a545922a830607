// @ts-check
/**
 * The worker for files: one request in, one response out, in order. Everything it does is in `src/web/files.rs`, save that pictures are
 * decoded here, by the browser.
 *
 * After a trap the wasm's memory is in an unknown state, so the worker says `died` and is replaced.
 */
import init, { answer } from './pkg/pointweave_files.js';

/** @typedef {import('./common/files-messages.js').BlobOptions} BlobOptions */
/** @typedef {import('./common/files-messages.js').Note} Note */

const ready = init();

/** Most pixels of a picture, as in `src/formats/picture.rs`; what has more is made smaller before its points are looked for. */
const MOST_PIXELS = 4096 ** 2;
/** Longest side of a canvas that every browser has. */
const LONGEST_SIDE = 16_384;

/** The picture that was read last, so that a slider need not decode it anew. */
let picture = /** @type {{ image: ImageData, notes: Note[] } | null} */ (null);

/** @param {string} message */
const refusal = (message) => ({ type: 'error', message, place: null, columns: [] });

/** @param {BlobOptions} options */
function findBlobs(options) {
  if (!picture) return refusal('no picture has been read yet');
  const { image: { width, height, data }, notes } = picture;
  const pixels = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
  const response = answer({ type: 'blobs', width, height, pixels, options });
  if (response.type === 'blobs') response.preview.notes.unshift(...notes);
  return { ...response, width, height };
}

/** A picture the way up that its camera says, or null. @param {Uint8Array} bytes */
async function bitmapOf(bytes) {
  const blob = new Blob([/** @type {Uint8Array<ArrayBuffer>} */ (bytes)]);
  return createImageBitmap(blob, { imageOrientation: 'from-image' })
    // Browsers that don't know the word turn pictures the right way by themselves.
    .catch((error) => (error instanceof TypeError ? createImageBitmap(blob) : null))
    .catch(() => null);
}

/**
 * Keeps a picture's pixels, by way of a canvas, and looks for its points.
 *
 * @param {ImageBitmap} whole is closed
 * @returns what was found, and the picture as it was looked at
 */
function decode(whole) {
  const sides = [whole.width, whole.height];
  const shrink = Math.min(1, Math.sqrt(MOST_PIXELS / (sides[0] * sides[1])), LONGEST_SIDE / Math.max(...sides));
  const [width, height] = sides.map((side) => Math.max(1, Math.floor(side * shrink)));
  const canvas = new OffscreenCanvas(width, height);
  const context = canvas.getContext('2d', { willReadFrequently: true });
  if (!context) return refusal('this browser gives no pixels of pictures');
  context.imageSmoothingQuality = 'high';
  context.drawImage(whole, 0, 0, width, height);
  whole.close();
  const size = (/** @type {number[]} */ pixels) => pixels.map((side) => side.toLocaleString('en')).join(' × ');
  const text = `The picture has ${size(sides)} pixels. It was made smaller, to ${size([width, height])}, before its points were looked for.`;
  picture = { image: context.getImageData(0, 0, width, height), notes: shrink < 1 ? [{ kind: 'changed', text }] : [] };
  return { type: 'decoded', bitmap: canvas.transferToImageBitmap(), found: findBlobs({}) };
}

/** @param {any} request */
async function respond(request) {
  await ready;
  if (request.type === 'blobs-again') return findBlobs(request.options);
  const response = answer(request);
  // Browsers know more kinds of pictures than the reader does.
  const isPicture = response.type === 'picture';
  if (!isPicture && !(request.type === 'read' && response.type === 'error' && response.place === null)) return response;
  const bitmap = await bitmapOf(request.bytes);
  if (bitmap) return decode(bitmap);
  if (!isPicture) return response;
  const named = request.name ? `${request.name}: ` : '';
  return refusal(`${named}it looks like ${response.kind}, but this browser can't decode it: the file is damaged, or the browser does not know this kind; a PNG is always read`);
}

let line = Promise.resolve();
let dead = false;
self.onmessage = ({ data: { id, request } }) => {
  // The link to a worker hands on compiled WebAssembly first; this one fetches its own.
  if (!request) return;
  line = line.then(async () => {
    if (dead) return;
    try {
      const response = await respond(request);
      self.postMessage({ id, response }, { transfer: response.bitmap ? [response.bitmap] : [] });
    } catch (error) {
      dead = true;
      self.postMessage({ died: error instanceof Error ? error.message : String(error) });
    }
  });
};
