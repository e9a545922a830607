// @ts-check
/**
 * Files, pictures and links, read and written by a module of its own in a worker of its own: loaded when first needed, put to an end
 * when a hostile file takes too long, started again for the next. Everything it does is in `src/web/files.rs`.
 *
 * A refusal is a {@link Refused} with a sentence for a person and, for a file, the line and column; a worker that died or took too
 * long is a {@link WorkerDied}.
 */
import { Refused, WorkerDied, WorkerLink } from './worker-link.js';

export { Refused, WorkerDied };

/** @typedef {import('./messages.js').PatternData} PatternData */
/** @typedef {import('./messages.js').Parameters} Parameters */
/** @typedef {import('./files-messages.js').FilesRequest} FilesRequest */
/** @typedef {import('./files-messages.js').ReadOptions} ReadOptions */
/** @typedef {import('./files-messages.js').BlobOptions} BlobOptions */
/** @typedef {import('./files-messages.js').LinkExemplar} LinkExemplar */
/** @typedef {import('./files-messages.js').FileFormat} FileFormat */
/** @typedef {import('./files-messages.js').Origin} Origin */
/** @typedef {import('./files-messages.js').ReadResponse} ReadResponse */
/** @typedef {import('./files-messages.js').BlobsResponse} BlobsResponse */
/** @typedef {import('./files-messages.js').WrittenResponse} WrittenResponse */
/** @typedef {import('./files-messages.js').LinkWrittenResponse} LinkWrittenResponse */
/** @typedef {import('./files-messages.js').LinkReadResponse} LinkReadResponse */
/** @typedef {{ width: number, height: number }} PictureSize */

/** Most bytes of a file, as in `src/formats/mod.rs`: what is larger need not be read from the disk at all. */
export const LARGEST_FILE = 20_000_000;
/** Longest link that is made and opened, in characters after the `#`; over the first, a person is warned. */
export const LINK_LIMITS = { warn: 2000, refuse: 32_768 };
/** What a file picker offers; anything else can be dropped all the same. */
export const ACCEPTED = '.csv,.tsv,.txt,.json,.geojson,.svg,.npy,.png,.jpg,.jpeg,.webp,.gif,.avif,text/plain,text/csv,application/json,image/*';

/** The largest file takes about a second on a slow machine; a hostile one is not waited for. */
const PATIENCE_MS = 20_000;

export class Files {
  #link = new WorkerLink('./files-worker.js', PATIENCE_MS, () => {});

  /** @param {FilesRequest | { type: 'blobs-again', options: BlobOptions }} request @returns {Promise<any>} */
  #ask(request) {
    return this.#link.ask(/** @type {any} */ (request));
  }

  /**
   * Reads a file of any known kind, pictures included. Text from the clipboard is a file without a name.
   *
   * @param {string} name of the file; its extension helps where the bytes leave a doubt
   * @param {Uint8Array} bytes
   * @param {ReadOptions} [options] what the person knows better than the file
   * @param {(bitmap: ImageBitmap) => void} [decoded] takes a picture as its points were looked for, also when there are none
   * @returns {Promise<ReadResponse | (BlobsResponse & PictureSize)>} `blobs` when it is a picture
   */
  async read(name, bytes, options = {}, decoded = (bitmap) => bitmap.close()) {
    const answer = await this.#ask({ type: 'read', name, bytes, options });
    if (answer.type !== 'decoded') return answer;
    decoded(answer.bitmap);
    if (answer.found.type === 'error') throw new Refused(answer.found);
    return answer.found;
  }

  /**
   * Finds the points of a picture again, with another threshold or other sizes: of the picture that was read last.
   *
   * @param {BlobOptions} options
   * @returns {Promise<BlobsResponse & PictureSize>}
   */
  blobs(options) {
    return this.#ask({ type: 'blobs-again', options });
  }

  /**
   * A pattern as a file. `tsv` is what a spreadsheet takes from the clipboard.
   *
   * @param {FileFormat} format
   * @param {PatternData} pattern
   * @param {{ title?: string, tile?: boolean, glyphs?: Record<string, string>, palette?: string, origin?: Origin }} [options] `tile`: an
   *   SVG that ends at the domain's border, so that copies side by side are seamless; `glyphs` and `palette`: how its classes look, see
   *   `look.js`; `origin`: of the exemplar's file, whose words and coordinates CSV and GeoJSON go on with
   * @returns {Promise<WrittenResponse>}
   */
  write(format, pattern, { title = '', tile = false, glyphs = {}, palette = '', origin = {} } = {}) {
    return this.#ask({ type: 'write', format, pattern, title, tile, glyphs, palette, origin });
  }

  /**
   * The outline of a glyph as path data, in radii.
   *
   * @param {string} name of a built-in one, or `path:` and SVG path data
   * @returns {Promise<string>}
   */
  async glyph(name) {
    return (await this.#ask({ type: 'glyph', name })).outline;
  }

  /**
   * The whole session as a JSON file. Read again it goes on as the very same run: `state` is what the engine's `save` answers.
   *
   * @param {{ title: string, method: string, preset: string, overrides: Parameters, exemplar: PatternData, origin: Origin,
   *   output: PatternData | null, state: string | null }} project
   * @returns {Promise<WrittenResponse>}
   */
  writeProject(project) {
    return this.#ask({ type: 'write-project', ...project });
  }

  /**
   * The fragment of a share link, without its `#`. Points in it are rounded to 1/65535 of the domain (or a little more,
   * which `note` says) and sorted: `pattern` is what the
   * receiver gets, `exact` whether that is the pattern given, so a page can go on with the very same one.
   *
   * @param {LinkExemplar} exemplar
   * @param {string} method
   * @param {string} preset
   * @param {Parameters} overrides all parameters or only some; what the preset has anyway is left out
   * @returns {Promise<LinkWrittenResponse>}
   */
  writeLink(exemplar, method, preset, overrides) {
    return this.#ask({ type: 'write-link', exemplar, method, preset, overrides });
  }

  /**
   * What a link says, every value within its range. Keys it does not know are the page's, see `embed` and `hide`.
   *
   * @param {string} fragment with or without its `#`
   * @returns {Promise<LinkReadResponse>}
   */
  readLink(fragment) {
    return this.#ask({ type: 'read-link', fragment });
  }
}
