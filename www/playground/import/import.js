// @ts-check
/**
 * The one way in for a person's own points, wherever they come from: a drop, the clipboard, the picker, an address. Everything is
 * read on this machine, shown with what was understood of it, and used only when the person says so.
 */
import { areThings, drawPoints, markRadius, prepare, readColours, tracePreview } from '../../common/draw.js';
import { element, input } from '../../common/elements.js';
import { fetchBytes, nameOf, NotFetched, requestedAddress, webAddress } from '../../common/fetching.js';
import { LARGEST_FILE, Refused, WorkerDied } from '../../common/files.js';
import { viewOf } from '../../common/pattern-source.js';
import { points } from '../../common/words.js';
import { Columns } from './columns.js';
import { showExcerpt } from './excerpt.js';
import { Extent, number } from './extent.js';
import { showNotes } from './notes.js';
import { drawPicture, Picture } from './picture.js';

/** @typedef {import('../../common/messages.js').PatternData} PatternData */
/** @typedef {import('../../common/files-messages.js').Preview} Preview */
/** @typedef {import('../../common/files-messages.js').Project} Project */
/** @typedef {import('../../common/files-messages.js').ReadOptions} ReadOptions */
/** @typedef {import('../../common/files.js').BlobOptions} BlobOptions */
/** @typedef {import('./notes.js').Said} Said */
/** @typedef {import('../../common/worker-link.js').Refused['place']} Place */
/** @typedef {'ask' | 'paste' | 'reading' | 'preview' | 'error'} Stage */
/** @typedef {{ name: string, pattern: PatternData, preview: Preview, project: Project | null }} Imported */
/**
 * What is being looked at; `picture` is the decoded one, as it is shown, and `found` where its dots are parted from the rest.
 * @typedef {{ name: string, bytes: Uint8Array, picture: ImageBitmap | null, found: import('./picture.js').Found | null,
 *   pattern: PatternData | null, preview: Preview | null, project: Project | null, options: ReadOptions, blobs: BlobOptions,
 *   remark: Said | null }} Candidate
 */

/** A slider in motion is answered when it has come to rest for a moment. */
const SETTLE_MS = 60;

/** @param {string} words */
export const capital = (words) => words.charAt(0).toUpperCase() + words.slice(1);

/** @param {string} message */
const sentence = (message) => capital(message) + (/[.!?]$/.test(message) ? '' : '.');

export class Import {
  #dialog = /** @type {HTMLDialogElement} */ (element('import'));
  #files;
  #styling;
  #hooks;
  /** @type {Candidate | null} */
  #candidate = null;
  /** Counts what was opened, so that answers about something else can be told apart. */
  #epoch = 0;
  #abort = new AbortController();
  /** @type {URL | null} */
  #address = null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #settling;
  /** Whether something of this page is being dragged; it is no import. */
  #dragsOwn = false;
  #columns = new Columns({
    choose: (choice) => this.#reread(({ columns: before, ...options }) => {
      // Other columns lie elsewhere.
      const stays = (before?.x ?? null) === (choice?.x ?? null) && (before?.y ?? null) === (choice?.y ?? null);
      return { ...options, ...(choice && { columns: choice }), domain: stays ? options.domain : null };
    }),
    object: (message) => this.#incomplete(message),
  });
  #extent = new Extent({
    domain: (domain) => this.#reread((options) => ({ ...options, domain })),
    // A rectangle in metres is none in degrees.
    degrees: (keepsDegrees) => this.#reread((options) => ({ ...options, keepsDegrees, domain: null })),
    object: (message) => this.#incomplete(message),
  });
  #picture = new Picture((changed) => this.#look(changed));

  /**
   * @param {import('../../common/files.js').Files} files
   * @param {import('../look.js').Look} styling
   * @param {{ use: (imported: Imported) => void }} hooks
   */
  constructor(files, styling, hooks) {
    this.#files = files;
    this.#styling = styling;
    this.#hooks = hooks;
    this.#listenToPage();
    this.#listenToDialog();
  }

  // -------------------------------------------------------------------------------------------- ways in

  /** @param {File} file @param {Said | null} [remark] */
  async openFile(file, remark = null) {
    const epoch = this.#begin(file.name);
    if (file.size > LARGEST_FILE) {
      this.#fail(`it has ${Math.ceil(file.size / 1e6)} MB; at most ${LARGEST_FILE / 1e6} MB are read`);
      return;
    }
    try {
      const bytes = new Uint8Array(await file.arrayBuffer());
      if (epoch === this.#epoch) await this.#read(file.name, bytes, remark);
    } catch (error) {
      if (epoch === this.#epoch) this.#fail(`it could not be read: ${error instanceof Error ? error.message : error}`);
    }
  }

  /** @param {string} text */
  async openText(text) {
    this.#begin('Pasted points');
    await this.#read('', new TextEncoder().encode(text), null);
  }

  /** Asks before anything is fetched. @param {string} text an address, relative to the page if it is of the same site */
  openAddress(text) {
    this.#begin('Load points from the web?');
    try {
      this.#address = requestedAddress(text, location.href);
    } catch (error) {
      this.#fail(error instanceof Error ? error.message : String(error));
      return;
    }
    const isOwn = this.#address.origin === location.origin;
    element('import-origin').textContent = isOwn ? `${this.#address.host} (this site)` : this.#address.host;
    element('import-address').textContent = this.#address.href;
    element('import-asked').textContent = isOwn
      ? 'The file comes from where this page comes from.'
      : 'That site is asked for this one file, without cookies. Like any site you visit it sees your network address, but nothing of what you do here.';
    this.#show('ask');
    // Nothing is fetched by a key pressed too soon.
    element('import-cancel').focus();
  }

  /** A place to paste into, for those without a keyboard and for addresses. */
  openPaste() {
    this.#begin('Paste points or a web address');
    const field = /** @type {HTMLTextAreaElement} */ (element('import-text'));
    field.value = '';
    this.#show('paste');
    field.focus();
  }

  /**
   * Whatever was dropped or pasted.
   *
   * @param {DataTransfer} transfer
   * @returns {boolean} whether there was anything in it
   */
  #take(transfer) {
    const [file, ...others] = transfer.files;
    if (file) {
      void this.openFile(file, others.length > 0 ? { kind: 'left-out', text: `Only the first of ${others.length + 1} files is opened.` } : null);
      return true;
    }
    const links = transfer.getData('text/uri-list').split(/\r?\n/).filter((line) => line && !line.startsWith('#'));
    const text = links[0] ?? transfer.getData('text/plain');
    if (text.trim() === '') return false;
    this.#takeText(text);
    return true;
  }

  /** @param {string} text */
  #takeText(text) {
    const address = webAddress(text);
    if (address) this.openAddress(address.href);
    else void this.openText(text);
  }

  async #fetch() {
    const address = this.#address;
    if (!address) return;
    const epoch = this.#begin(nameOf(address));
    try {
      const bytes = await fetchBytes(address, LARGEST_FILE, this.#abort.signal);
      if (epoch === this.#epoch) await this.#read(nameOf(address), bytes, { kind: 'told', text: `From ${address.host}.` });
    } catch (error) {
      if (epoch !== this.#epoch) return;
      if (error instanceof NotFetched) this.#fail(error.message);
      else this.#fail(`it could not be fetched: ${error instanceof Error ? error.message : error}`);
    }
  }

  // -------------------------------------------------------------------------------------------- reading

  /** @param {string} title */
  #begin(title) {
    this.#abort.abort();
    this.#abort = new AbortController();
    clearTimeout(this.#settling);
    this.#address = null;
    this.#forget();
    element('import-title').textContent = title;
    this.#show('reading');
    return ++this.#epoch;
  }

  #forget() {
    this.#candidate?.picture?.close();
    this.#candidate = null;
  }

  /**
   * @param {string} name empty for text from the clipboard
   * @param {Uint8Array} bytes
   * @param {Said | null} remark what to say beside the notes of the file
   */
  async #read(name, bytes, remark) {
    this.#candidate = {
      name, bytes, picture: null, found: null, pattern: null, preview: null, project: null, options: {}, blobs: {}, remark,
    };
    this.#columns.reset();
    this.#extent.reset();
    this.#picture.reset();
    element('import-status').textContent = '';
    await this.#readAgain();
  }

  /** The person knows something better. @param {(options: ReadOptions) => ReadOptions} change */
  #reread(change) {
    if (!this.#candidate) return;
    this.#candidate.options = change(this.#candidate.options);
    void this.#readAgain();
  }

  /** Reads the candidate with its options as they are now. */
  async #readAgain() {
    const candidate = this.#candidate;
    if (!candidate) return;
    const { name, bytes, options } = candidate;
    try {
      const answer = await this.#files.read(name, bytes, options, (bitmap) => this.#decoded(candidate, bitmap));
      // What has been chosen since is being read, too.
      if (candidate !== this.#candidate || options !== candidate.options) return;
      if (answer.type === 'blobs') this.#found(answer);
      else {
        Object.assign(candidate, { pattern: answer.pattern, preview: answer.preview, project: answer.project });
        this.#columns.read(answer.preview.columns);
        this.#showPreview();
      }
    } catch (error) {
      if (candidate !== this.#candidate || options !== candidate.options) return;
      const { place, columns } = error instanceof Refused ? error : { place: null, columns: [] };
      const isFirst = candidate.preview === null && candidate.picture === null;
      // A wrong choice leaves what there was, so that it can be put right.
      if (isFirst && columns.length === 0) return this.#fail(this.#wordsFor(error), place);
      this.#columns.refused(columns);
      this.#object(this.#wordsFor(error), place);
    }
  }

  /** @param {Candidate} candidate @param {ImageBitmap} bitmap */
  #decoded(candidate, bitmap) {
    if (candidate !== this.#candidate) return bitmap.close();
    candidate.picture?.close();
    candidate.picture = bitmap;
  }

  async #findAgain() {
    const candidate = this.#candidate;
    if (!candidate) return;
    try {
      const answer = await this.#files.blobs(candidate.blobs);
      if (candidate === this.#candidate) this.#found(answer);
    } catch (error) {
      if (candidate === this.#candidate) this.#object(this.#wordsFor(error));
    }
  }

  /** @param {import('../../common/files.js').BlobsResponse} answer */
  #found({ pattern, preview, threshold, ink, local }) {
    const candidate = this.#candidate;
    if (!candidate) return;
    const boundary = candidate.options.boundary ?? pattern.boundary;
    Object.assign(candidate, { pattern: { ...pattern, boundary }, preview: { ...preview, boundary }, found: local ? null : { threshold, ink } });
    this.#picture.show(threshold, (candidate.blobs.threshold ?? null) === null, local);
    this.#showPreview();
  }

  /** @param {unknown} error @returns {string} a sentence of the library; those begin small and have no full stop */
  #wordsFor(error) {
    // The title says the name already.
    const prefix = `${this.#candidate?.name}: `;
    if (error instanceof Refused) return error.message.startsWith(prefix) ? error.message.slice(prefix.length) : error.message;
    if (error instanceof WorkerDied) return `it takes too long or can't be read (${error.message})`;
    return error instanceof Error ? error.message : String(error);
  }

  // -------------------------------------------------------------------------------------------- what is shown

  /** @param {Stage} stage */
  #show(stage) {
    this.#dialog.dataset.stage = stage;
    element('import-use').hidden = stage !== 'preview';
    element('import-load').hidden = stage !== 'ask';
    element('import-read').hidden = stage !== 'paste';
    element('import-another').hidden = stage !== 'error';
    element('import-cancel').textContent = stage === 'error' ? 'Close' : 'Cancel';
    element('import-said').hidden = true;
    for (const section of this.#dialog.querySelectorAll('section')) section.hidden = section.dataset.stage !== stage;
    if (!this.#dialog.open) this.#dialog.showModal();
  }

  /** @param {string} message @param {Place} [place] */
  #fail(message, place = null) {
    element('import-error').textContent = sentence(message);
    showExcerpt(element('import-excerpt'), this.#candidate?.bytes ?? null, place);
    this.#show('error');
    element('import-another').focus();
  }

  /** Nothing can be read as the choices are now, and what is being read is out of date. @param {string} message */
  #incomplete(message) {
    if (this.#candidate) this.#candidate.options = { ...this.#candidate.options };
    this.#object(message);
  }

  /** Something about the choices in the preview is wrong; what is there stays. @param {string} message @param {Place} [place] */
  #object(message, place = null) {
    const candidate = this.#candidate;
    if (candidate) candidate.pattern = null;
    this.#showPreview({ message: sentence(message), place });
  }

  /** @param {{ message: string, place: Place }} [objection] why nothing can be used */
  #showPreview({ message, place } = { message: '', place: null }) {
    const candidate = this.#candidate;
    if (!candidate) return;
    const { preview, picture, pattern, bytes } = candidate;
    const wasShown = this.#dialog.dataset.stage === 'preview';
    this.#show('preview');
    element('import-objection').textContent = message;
    element('import-said').hidden = message === '';
    showExcerpt(element('import-place'), bytes, place);
    input('import-use').disabled = pattern === null;
    // Nothing has been read yet: perhaps it is the file that is wrong.
    const isNothing = preview === null && picture === null;
    element('import-another').hidden = !isNothing;
    element('import-use').hidden = isNothing;
    element('import-picture').hidden = picture === null;
    for (const id of ['import-facts', 'import-choices']) element(id).hidden = preview === null;
    if (preview) this.#showFacts(candidate, preview);
    else showNotes([]);
    if (!pattern) element('import-canvas').setAttribute('aria-label', 'No points');
    this.#draw();
    if (wasShown) element('import-status').textContent = preview && pattern ? this.#summary(preview) : '';
    else if (pattern) input('import-use').focus();
    else if (picture) input('import-threshold').focus();
    else this.#columns.focus();
    // What it is about may have been pushed out of sight.
    if (wasShown && message) document.activeElement?.scrollIntoView({ block: 'nearest' });
  }

  /** For those who don't see what another choice has changed. @param {Preview} preview */
  #summary({ points: total, notes }) {
    const noted = notes.length === 0 ? '' : notes.length === 1 ? ' One note.' : ` ${notes.length} notes.`;
    return `${points(total)}.${noted}`;
  }

  /** @param {Candidate} candidate @param {Preview} preview */
  #showFacts({ remark, project, picture, options }, preview) {
    const { format, points: total, classes, attributes, domain, boundary, notes } = preview;
    const [x0, y0, x1, y1] = domain.map(number);
    element('import-format').textContent = project ? `${capital(format)}, a session that goes on where it was saved` : capital(format);
    element('import-points').textContent = points(total);
    const colours = readColours();
    element('import-classes').replaceChildren(
      ...classes.map(({ name, count }, klass) => {
        const item = document.createElement('span');
        item.className = 'import-class';
        const sign = document.createElement('canvas');
        sign.setAttribute('aria-hidden', 'true');
        tracePreview(sign, colours, klass, classes.length > 1);
        item.append(sign, `${name} `, Object.assign(document.createElement('small'), { textContent: count.toLocaleString('en') }));
        return item;
      }),
    );
    element('import-attributes').textContent =
      attributes.map(({ name, min, max }) => `${name} ${min === max ? number(min) : `${number(min)} to ${number(max)}`}`).join(', ') || 'none';
    this.#extent.show(preview, options, picture !== null);
    for (const radio of this.#dialog.querySelectorAll('input[name="import-boundary"]')) {
      /** @type {HTMLInputElement} */ (radio).checked = /** @type {HTMLInputElement} */ (radio).value === boundary;
    }
    showNotes([...(remark ? [remark] : []), ...notes]);
    element('import-canvas').setAttribute('aria-label', `${points(total)} in a rectangle from ${x0}, ${y0} to ${x1}, ${y1}`);
  }

  /** The points, over the picture if they are of one. */
  #draw() {
    const candidate = this.#candidate;
    const canvas = /** @type {HTMLCanvasElement} */ (element('import-canvas'));
    const place = /** @type {HTMLElement} */ (canvas.parentElement);
    if (!candidate || place.clientWidth === 0) return;
    const { pattern, picture, found } = candidate;
    const ratio = picture ? picture.width / picture.height : pattern ? pattern.domain[2] / pattern.domain[3] : 1;
    const [roomX, most] = [place.clientWidth, Math.min(340, 0.42 * window.innerHeight)];
    // A picture stays as large as it is; the rectangle of points may change with every choice.
    const roomY = picture ? Math.min(most, roomX / ratio) : most;
    place.style.height = picture ? `${roomY}px` : '';
    const margin = picture ? 0 : 8;
    const width = Math.min(roomX - 2 * margin, (roomY - 2 * margin) * ratio);
    const height = width / ratio;
    canvas.style.width = `${width + 2 * margin}px`;
    canvas.style.height = `${height + 2 * margin}px`;
    const context = prepare(canvas, width + 2 * margin, height + 2 * margin);
    const colours = readColours();
    if (picture) drawPicture(canvas, picture, found, colours);
    if (!pattern) return;
    const view = viewOf(pattern);
    const scale = Math.max(width, height);
    if (!picture) {
      const styles = this.#styling.styles(view, colours);
      drawPoints(context, colours, view.points, {
        left: margin,
        top: margin,
        scale,
        radius: markRadius(view.spacing, scale, areThings(view.points, styles)),
        styles,
      });
      return;
    }
    const radius = pattern.attributes.find(({ name }) => name === 'radius')?.values;
    context.strokeStyle = colours.accent;
    context.lineWidth = 2;
    context.beginPath();
    for (let i = 0; i < pattern.classes.length; i++) {
      const [x, y] = [view.points.positions[2 * i] * scale, view.points.positions[2 * i + 1] * scale];
      const r = Math.max(2.5, ((radius?.[i] ?? 0) / view.unit) * scale);
      context.moveTo(x + r, y);
      context.arc(x, y, r, 0, 2 * Math.PI);
    }
    context.stroke();
  }

  // -------------------------------------------------------------------------------------------- pictures

  /** @param {BlobOptions} changed */
  #look(changed) {
    const candidate = this.#candidate;
    if (!candidate) return;
    Object.assign(candidate.blobs, changed);
    // The picture follows at once; where its points are is answered a moment later.
    if (candidate.found && changed.threshold != null) {
      candidate.found = { ...candidate.found, threshold: changed.threshold };
      this.#draw();
    }
    clearTimeout(this.#settling);
    this.#settling = setTimeout(() => void this.#findAgain(), SETTLE_MS);
  }

  // -------------------------------------------------------------------------------------------- listening

  #listenToPage() {
    const veil = element('drop-veil');
    const carries = (/** @type {DragEvent} */ { dataTransfer }) =>
      !this.#dragsOwn && ['Files', 'text/uri-list', 'text/plain'].some((type) => dataTransfer?.types.includes(type));
    window.addEventListener('dragstart', () => (this.#dragsOwn = true));
    window.addEventListener('dragend', () => (this.#dragsOwn = false));
    window.addEventListener('dragover', (event) => {
      if (!carries(event)) return;
      event.preventDefault();
      veil.hidden = false;
    });
    window.addEventListener('dragleave', (event) => {
      if (event.relatedTarget === null) veil.hidden = true;
    });
    window.addEventListener('drop', (event) => {
      veil.hidden = true;
      if (!carries(event)) return;
      event.preventDefault();
      if (event.dataTransfer) this.#take(event.dataTransfer);
    });
    window.addEventListener('paste', (event) => {
      const target = /** @type {HTMLElement} */ (event.target);
      const writes = target instanceof HTMLTextAreaElement || (target instanceof HTMLInputElement && /^(text|number|url|search)$/.test(target.type));
      // What is pasted into a field is meant for the field, save into the one that is there for this.
      if ((writes && target.id !== 'import-text') || !event.clipboardData) return;
      if (this.#take(event.clipboardData)) event.preventDefault();
    });
    const picker = input('file');
    picker.addEventListener('change', () => {
      const file = picker.files?.[0];
      // So that the same file can be chosen again after it was mended.
      if (file) void this.openFile(file).finally(() => (picker.value = ''));
    });
    element('paste-own').addEventListener('click', () => this.openPaste());
  }

  #listenToDialog() {
    const dialog = this.#dialog;
    const close = () => dialog.close();
    element('import-cancel').addEventListener('click', close);
    element('import-close').addEventListener('click', close);
    dialog.addEventListener('close', () => {
      // The event comes a task later than the closing: what was begun in between has put the rest away itself.
      if (dialog.open) return;
      this.#epoch++;
      this.#abort.abort();
      clearTimeout(this.#settling);
      this.#forget();
    });
    // The keys of the run are not those of the dialog.
    dialog.addEventListener('keydown', (event) => event.stopPropagation());
    element('import-load').addEventListener('click', () => void this.#fetch());
    element('import-read').addEventListener('click', () => {
      const { value } = /** @type {HTMLTextAreaElement} */ (element('import-text'));
      if (value.trim() !== '') this.#takeText(value);
    });
    element('import-another').addEventListener('click', () => {
      close();
      input('file').click();
    });
    element('import-use').addEventListener('click', () => {
      const { name, pattern, preview, project } = this.#candidate ?? {};
      if (!pattern || !preview) return;
      close();
      this.#hooks.use({ name: name || 'Pasted points', pattern, preview, project: project ?? null });
    });
    for (const radio of dialog.querySelectorAll('input[name="import-boundary"]')) {
      radio.addEventListener('change', () => {
        const candidate = this.#candidate;
        if (!candidate) return;
        const boundary = /** @type {PatternData['boundary']} */ (/** @type {HTMLInputElement} */ (radio).value);
        if (!candidate.picture) return this.#reread((options) => ({ ...options, boundary }));
        candidate.options.boundary = boundary;
        if (candidate.pattern) candidate.pattern = { ...candidate.pattern, boundary };
      });
    }
    new ResizeObserver(() => this.#draw()).observe(element('import-board'));
  }
}
