// @ts-check
/** The card "Take it with you": the result as a table, a picture, a tile, a project, or on the clipboard. */
import { copy, takesPictures } from '../common/clipboard.js';
import { Refused, WorkerDied } from '../common/files.js';
import { points } from '../common/words.js';

/** @typedef {import('../common/messages.js').PatternData} PatternData */
/** @typedef {import('../common/files-messages.js').FileFormat} FileFormat */
/** @typedef {import('../common/files-messages.js').WrittenResponse} WrittenResponse */

/** Pixels a picture may be wide or high; the most that every browser's canvas holds. */
const SIDE = { least: 64, most: 8192 };
/** Most pixels of a picture: 256 MB of memory. */
const MOST_PIXELS = 64 * 1024 * 1024;
/** How long the page holds a file for the browser to fetch. */
const HOLD_MS = 10_000;

/**
 * @typedef {object} Hooks
 * @property {() => { glyphs: Record<string, string>, palette: string }} look
 * @property {() => import('./state.js').Chosen} chosen
 * @property {(sentence: string) => void} complain
 * @property {(sentence: string) => void} announce
 */

/** @param {string} id */
const element = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

/** @param {Uint8Array} bytes @param {string} type */
export const asBlob = (bytes, type) => new Blob([/** @type {Uint8Array<ArrayBuffer>} */ (bytes)], { type });

/**
 * Gives the person a file.
 *
 * @param {Blob} blob
 * @param {string} name
 */
export function give(blob, name) {
  const anchor = document.createElement('a');
  anchor.href = URL.createObjectURL(blob);
  anchor.download = name;
  anchor.click();
  setTimeout(() => URL.revokeObjectURL(anchor.href), HOLD_MS);
}

export class Take {
  #files;
  #link;
  #run;
  #stage;
  #hooks;
  #width = /** @type {HTMLInputElement} */ (element('picture-width'));

  /**
   * @param {import('../common/files.js').Files} files
   * @param {import('../common/worker-link.js').WorkerLink} link
   * @param {import('./run.js').Run} run
   * @param {import('./stage.js').Stage} stage
   * @param {Hooks} hooks
   */
  constructor(files, link, run, stage, hooks) {
    this.#files = files;
    this.#link = link;
    this.#run = run;
    this.#stage = stage;
    this.#hooks = hooks;
    for (const format of /** @type {const} */ (['csv', 'geojson', 'svg', 'npy'])) {
      this.#on(`download-${format}`, () => this.#file(format));
    }
    this.#on('download-tile-svg', () => this.#file('svg', true));
    this.#on('download-png', () => this.#picture(false));
    this.#on('download-tile-png', () => this.#picture(true));
    this.#on('download-project', () => this.project());
    this.#on('copy-table', () => this.#copyTable());
    this.#on('copy-picture', () => this.#copyPicture());
    element('copy-picture').hidden = !takesPictures;
    this.#width.addEventListener('input', () => this.#width.setAttribute('aria-invalid', String(this.#readWidth() === null)));
  }

  /**
   * What there is to take.
   *
   * @param {string} count of its points, in words
   * @param {boolean} periodic only what tiles can be had as a tile
   */
  describe(count, periodic) {
    element('download-csv').title = `${count}, one line each, with the exemplar's own columns and units`;
    const { format, origin } = this.#hooks.chosen();
    // What came from a map goes back to one.
    const isMap = format === 'GeoJSON' || Boolean(origin?.projection);
    const [csv, geojson] = [element('download-csv'), element('download-geojson')];
    if (isMap) csv.before(geojson);
    else csv.after(geojson);
    geojson.title = origin?.projection ? `${count}, in degrees where the exemplar's are` : `${count}, for a map or a GIS`;
    element('tile-downloads').hidden = !periodic;
  }

  /** @param {string} id @param {() => Promise<void>} act */
  #on(id, act) {
    element(id).addEventListener('click', async () => {
      try {
        await act();
      } catch (error) {
        // The death of the engine's worker is announced by its link; that of the files' worker is told here.
        if (error instanceof Refused || error instanceof WorkerDied) this.#hooks.complain(error.message);
        else throw error;
      }
    });
  }

  /** @param {string} extension with its dot @param {string} [suffix] */
  #name(extension, suffix = '') {
    const { source } = this.#hooks.chosen();
    return `pointweave-${source.name.replace(/\.[^.]*$/, '').replace(/[\\/:*?"<>|]+/g, '-')}${suffix}${extension}`;
  }

  /** @param {FileFormat} format @param {boolean} [tile] */
  async #file(format, tile = false) {
    const pattern = await this.#run.export();
    const { title, origin } = this.#hooks.chosen();
    const { bytes, mime, extension } = await this.#files.write(format, pattern, { title, tile, origin, ...this.#hooks.look() });
    give(asBlob(bytes, mime), this.#name(extension, tile ? '-tile' : ''));
    this.#hooks.announce(`${points(pattern.classes.length)} saved as ${format === 'geojson' ? 'GeoJSON' : extension.slice(1).toUpperCase()}.`);
  }

  #readWidth() {
    const width = Number(this.#width.value);
    return Number.isInteger(width) && width >= SIDE.least && width <= SIDE.most ? width : null;
  }

  /** @param {boolean} tile @returns {Promise<Blob | null>} null when it was refused, and said why */
  async #png(tile) {
    const width = this.#readWidth();
    if (width === null) {
      this.#hooks.complain(`A picture is ${SIDE.least} to ${SIDE.most} pixels wide, in whole pixels.`);
      return null;
    }
    const height = this.#stage.heightOf(width, tile);
    if (height > SIDE.most || width * height > MOST_PIXELS) {
      this.#hooks.complain(`${width} × ${height} pixels are too many for a picture; at most ${SIDE.most} a side and 64 million together.`);
      return null;
    }
    const canvas = this.#stage.render(width, height, tile);
    const blob = await new Promise((resolve) => canvas.toBlob(resolve, 'image/png'));
    // Its memory, now rather than some time.
    canvas.width = canvas.height = 0;
    if (!blob) this.#hooks.complain(`This browser can't make a picture of ${width} × ${height} pixels.`);
    return blob;
  }

  /** @param {boolean} tile */
  async #picture(tile) {
    const blob = await this.#png(tile);
    if (blob) give(blob, this.#name('.png', tile ? '-tile' : ''));
  }

  async #copyTable() {
    const written = this.#run.export().then((pattern) => this.#files.write('tsv', pattern, { origin: this.#hooks.chosen().origin }));
    const done = await copy('text/plain', written.then(({ bytes }) => asBlob(bytes, 'text/plain')));
    if (done) this.#hooks.announce('The table is on the clipboard.');
    this.#tell('copy-table', done, 'Copied');
  }

  async #copyPicture() {
    const blob = await this.#png(false);
    if (blob) this.#tell('copy-picture', await copy('image/png', Promise.resolve(blob)), 'Copied');
  }

  /** @param {string} id @param {boolean} done @param {string} word */
  #tell(id, done, word) {
    if (done) flash(element(id), word);
    else this.#hooks.complain('This browser does not let the page write to the clipboard. Download the file instead.');
  }

  /** Everything in one file, to go on with later. */
  async project() {
    const { plan } = this.#run;
    if (!plan) return;
    const { title, source, origin = {} } = this.#hooks.chosen();
    // Asked for in one breath, so that both are of the same moment.
    const [{ pattern }, output, state] = await Promise.all([
      this.#link.ask({ type: 'open', exemplar: source }),
      this.#run.export(),
      this.#run.state(),
    ]);
    const { bytes, mime, extension } = await this.#files.writeProject({
      title,
      method: plan.method,
      preset: plan.preset,
      overrides: plan.overrides,
      exemplar: pattern,
      origin,
      output,
      state,
    });
    give(asBlob(bytes, mime), this.#name(extension, '-project'));
    this.#hooks.announce('The project is saved. Drop it on the page to go on.');
  }
}

/**
 * Says on a button what it has just done.
 *
 * @param {HTMLElement} button
 * @param {string} word
 */
export function flash(button, word) {
  button.dataset.label ??= button.textContent ?? '';
  button.textContent = word;
  setTimeout(() => (button.textContent = button.dataset.label ?? ''), 1800);
}
