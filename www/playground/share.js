// @ts-check
/** The card "Share": a link that holds everything, and the page in a frame of another. */
import { copyText } from '../common/clipboard.js';
import { PARTS } from './embed.js';
import { LINK_LIMITS, Refused, WorkerDied } from '../common/files.js';
import { flash } from './take.js';

/** What a frame hides unless it is asked for. */
const SHOWN_IN_FRAMES = ['exemplar', 'deck'];
/** What can be asked for, under the name it has in the address. */
const OFFERED = /** @type {const} */ ({
  gallery: 'Gallery',
  exemplar: 'Exemplar',
  loss: 'Loss',
  statistics: 'Statistics',
  deck: 'Buttons',
  settings: 'Settings',
});

/**
 * @typedef {object} Hooks
 * @property {() => { title: string, source: import('../common/messages.js').Source }} chosen
 * @property {() => import('./run.js').Plan | null} plan of the run, with all its parameters
 * @property {(pattern: import('../common/messages.js').PatternData) => void} adopt goes on with the points as a link holds them
 * @property {() => Promise<void>} saveProject
 * @property {(sentence: string) => void} announce
 */

/** @param {string} id */
const element = (id) => /** @type {HTMLElement} */ (document.getElementById(id));
/** @param {string} id */
const field = (id) => /** @type {HTMLInputElement | HTMLTextAreaElement} */ (element(id));

/** @param {string} text */
const escaped = (text) => text.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);

export class Share {
  #files;
  #hooks;

  /**
   * @param {import('../common/files.js').Files} files
   * @param {Hooks} hooks
   */
  constructor(files, hooks) {
    this.#files = files;
    this.#hooks = hooks;
    element('copy-link').addEventListener('click', () => void this.#copyLink());
    element('copy-frame').addEventListener('click', () => void this.#copyFrame());
    element('share-file').addEventListener('click', () => void this.#hooks.saveProject());
    const boxes = Object.entries(OFFERED).map(([part, words]) => {
      const label = document.createElement('label');
      label.className = 'check';
      const box = document.createElement('input');
      Object.assign(box, { type: 'checkbox', name: 'frame-part', value: part, checked: SHOWN_IN_FRAMES.includes(part) });
      label.append(box, ` ${words}`);
      return label;
    });
    element('frame-parts').append(...boxes);
    const refresh = () => {
      if (/** @type {HTMLDetailsElement} */ (element('frame')).open) void this.#showFrame();
    };
    element('frame').addEventListener('toggle', refresh);
    element('frame').addEventListener('change', refresh);
  }

  /** Another run has begun: what is shown is no more of this moment. */
  outdated() {
    element('link-made').hidden = true;
    element('share-file').hidden = true;
    this.#say('');
    if (/** @type {HTMLDetailsElement} */ (element('frame')).open) void this.#showFrame();
  }

  /** @param {string} sentence @param {boolean} [warns] */
  #say(sentence, warns = false) {
    element('link-note').textContent = sentence;
    element('link-note').toggleAttribute('data-warns', warns);
  }

  /** The address without anything behind it. */
  get #page() {
    return `${location.origin}${location.pathname}`;
  }

  /** The link to what is there now. @returns {Promise<import('../common/files-messages.js').LinkWrittenResponse>} */
  async write() {
    const plan = this.#hooks.plan();
    if (!plan) throw new Error('there is no run yet');
    const { source } = this.#hooks.chosen();
    const exemplar = source.source === 'gallery' ? { gallery: source.name } : { pattern: source.pattern };
    return this.#files.writeLink(exemplar, plan.method, plan.preset, plan.overrides);
  }

  /** @param {unknown} error @returns {string} */
  #because(error) {
    if (error instanceof Refused || error instanceof WorkerDied) {
      return error.message.charAt(0).toUpperCase() + error.message.slice(1).replace(/[.!?]?$/, '.');
    }
    throw error;
  }

  async #copyLink() {
    element('link-made').hidden = true;
    element('link-round').hidden = true;
    element('share-file').hidden = true;
    this.#say('');
    if (!this.#hooks.plan()) return this.#say('There is no run to share yet.', true);
    const written = this.write();
    try {
      const text = written.then(({ fragment }) => `${this.#page}#${fragment}`);
      // Begun before the link is there: some browsers forget that a button was pressed.
      const copied = copyText(text);
      // Where there is no link there is nothing to copy: told once, below.
      copied.catch(() => {});
      const { fragment, pattern, exact, note } = await written;
      field('link').value = await text;
      element('link-made').hidden = false;
      const done = await copied;
      if (done) flash(element('copy-link'), 'Copied');
      else field('link').select();
      const length = field('link').value.length.toLocaleString('en');
      const long = fragment.length > LINK_LIMITS.warn;
      element('share-file').hidden = !long;
      this.#say(
        `${done ? 'Copied' : 'Copy it from above'}: ${length} characters, and nothing was sent anywhere. ` +
          (long ? 'Some programs cut links that long; a file holds the same. ' : '') +
          (exact ? '' : `${note ?? 'In a link, points are rounded to 1/65535 of the pattern.'} The run of whoever opens it will differ in detail.`),
        long,
      );
      element('link-round').hidden = exact;
      element('link-round').onclick = () => this.#hooks.adopt(pattern);
      this.#hooks.announce(element('link-note').textContent ?? '');
    } catch (error) {
      element('share-file').hidden = false;
      this.#say(this.#because(error), true);
    }
  }

  /** @returns {Promise<string>} the frame as HTML */
  async #frame() {
    const { fragment } = await this.write();
    const shown = [...document.querySelectorAll('input[name="frame-part"]:checked')].map((box) => /** @type {HTMLInputElement} */ (box).value);
    const hide = Object.keys(PARTS).filter((part) => part in OFFERED ? !shown.includes(part) : ['take', 'share', 'theme'].includes(part));
    const address = `${this.#page}#${fragment}&embed=1${hide.length > 0 ? `&hide=${hide.join(',')}` : ''}`;
    const title = `Pointweave: ${this.#hooks.chosen().title}`;
    return `<iframe src="${escaped(address)}" title="${escaped(title)}" width="720" height="520" style="border:0" allow="clipboard-write" loading="lazy"></iframe>`;
  }

  async #showFrame() {
    try {
      if (this.#hooks.plan()) field('frame-code').value = await this.#frame();
    } catch (error) {
      field('frame-code').value = this.#because(error);
    }
  }

  async #copyFrame() {
    await this.#showFrame();
    if (await copyText(field('frame-code').value)) flash(element('copy-frame'), 'Copied');
    else field('frame-code').select();
  }
}
