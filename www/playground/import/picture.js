// @ts-check
/** A picture of dots: what counts as a dot, and the picture as that is seen. */
import { element, input } from '../../common/elements.js';

/** @typedef {import('../../common/files.js').BlobOptions} BlobOptions */
/** @typedef {import('../../common/files.js').BlobsResponse} BlobsResponse */
/** @typedef {Pick<BlobsResponse, 'threshold' | 'ink'>} Found where dark and light are parted, and which of them are dots */

/** Twenty steps of the sliders for areas are a factor of ten. */
const STEPS_A_DECADE = 20;
/** How much of the picture is covered: of what is a dot by the accent, of the rest by the ground. */
const COVER = { dot: 0.6, rest: 0.6 };

export class Picture {
  /** @param {(changed: BlobOptions) => void} look looks for the dots again */
  constructor(look) {
    input('import-threshold').addEventListener('input', () => {
      const threshold = input('import-threshold').valueAsNumber;
      element('import-threshold-value').textContent = String(threshold);
      look({ threshold });
    });
    element('import-otsu').addEventListener('click', () => look({ threshold: null }));
    for (const radio of this.#inks) {
      radio.addEventListener('change', () => look({ ink: /** @type {'auto' | 'dark' | 'light'} */ (radio.value) }));
    }
    for (const id of ['import-smallest', 'import-largest']) {
      input(id).addEventListener('input', () => {
        this.#showAreas();
        look(this.#areas());
      });
    }
  }

  get #inks() {
    return /** @type {NodeListOf<HTMLInputElement>} */ (document.querySelectorAll('input[name="import-ink"]'));
  }

  /** Another picture is looked at as if nobody had chosen anything. */
  reset() {
    input('import-threshold').value = '128';
    element('import-threshold-value').textContent = '';
    input('import-smallest').value = input('import-smallest').min;
    input('import-largest').value = input('import-largest').max;
    for (const radio of this.#inks) radio.checked = radio.value === 'auto';
    this.#showAreas();
  }

  /** @param {number} threshold that was used @param {boolean} isAutomatic @param {boolean} isLocal by the ground around each dot */
  show(threshold, isAutomatic, isLocal) {
    input('import-threshold').value = String(threshold);
    element('import-threshold-value').textContent = isLocal ? 'by the ground around' : String(threshold);
    element('import-otsu').setAttribute('aria-pressed', String(isAutomatic));
  }

  /** Areas of the sliders in pixels; null at the end where nothing is asked. */
  #areas() {
    const [smallest, largest] = [input('import-smallest'), input('import-largest')];
    const area = (/** @type {HTMLInputElement} */ slider) => Math.round(10 ** (Number(slider.value) / STEPS_A_DECADE));
    return {
      minArea: smallest.value === smallest.min ? null : area(smallest),
      maxArea: largest.value === largest.max ? null : area(largest),
    };
  }

  #showAreas() {
    const { minArea, maxArea } = this.#areas();
    element('import-smallest-value').textContent = minArea === null ? 'auto' : `${minArea} px`;
    element('import-largest-value').textContent = maxArea === null ? 'any' : `${maxArea} px`;
  }
}

/** Red, green and blue of a colour in any of CSS's words. @param {string} colour */
function parts(colour) {
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (new OffscreenCanvas(1, 1).getContext('2d'));
  context.fillStyle = colour;
  context.fillRect(0, 0, 1, 1);
  return context.getImageData(0, 0, 1, 1).data;
}

/**
 * A picture, pale, with what counts as a dot in the accent's colour.
 *
 * @param {HTMLCanvasElement} canvas which it fills
 * @param {ImageBitmap} picture
 * @param {Found | null} found null: nothing is known of its dots, or no one threshold parts them
 * @param {{ accent: string, card: string }} colours
 */
export function drawPicture(canvas, picture, found, colours) {
  const { width, height } = canvas;
  const layer = /** @type {OffscreenCanvasRenderingContext2D} */ (new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true }));
  // What is transparent shows white, for the reader of pictures, too.
  layer.fillStyle = '#fff';
  layer.fillRect(0, 0, width, height);
  layer.drawImage(picture, 0, 0, width, height);
  const image = layer.getImageData(0, 0, width, height);
  const { data } = image;
  const [dot, rest] = [parts(colours.accent), parts(colours.card)];
  for (let i = 0; i < data.length; i += 4) {
    // As `src/formats/picture.rs` has it: ITU-R BT.601.
    const brightness = (299 * data[i] + 587 * data[i + 1] + 114 * data[i + 2]) / 1000;
    const isDot = found !== null && brightness <= found.threshold === (found.ink === 'dark');
    const [cover, share] = isDot ? [dot, COVER.dot] : [rest, COVER.rest];
    for (let k = 0; k < 3; k++) data[i + k] += share * (cover[k] - data[i + k]);
  }
  layer.putImageData(image, 0, 0);
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  context.save();
  context.resetTransform();
  context.drawImage(layer.canvas, 0, 0);
  context.restore();
}
