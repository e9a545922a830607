// @ts-check
/**
 * The one way in for a person's own points, wherever they come from: a drop, the clipboard, the picker, an address. Everything is
 * read on this machine, shown with what was understood of it, and used only when the person says so.
 */
import { areThings, drawPoints, markRadius, prepare, readColours, tracePreview } from '../../common/draw.js';
import { fetchBytes, nameOf, NotFetched, requestedAddress, webAddress } from '../../common/fetching.js';
import { LARGEST_FILE, Refused, WorkerDied } from '../../common/files.js';
import { offending } from './offending.js';
import { viewOf } from '../../common/pattern-source.js';
import { points } from '../../common/words.js';

/** @typedef {import('../../common/messages.js').PatternData} PatternData */
/** @typedef {import('../../common/files-messages.js').Preview} Preview */
/** @typedef {import('../../common/files-messages.js').Project} Project */
/** @typedef {import('../../common/files-messages.js').ReadOptions} ReadOptions */
/** @typedef {import('../../common/files.js').BlobOptions} BlobOptions */
/** @typedef {'ask' | 'paste' | 'reading' | 'preview' | 'error'} Stage */
/** @typedef {{ name: string, pattern: PatternData, preview: Preview, project: Project | null }} Imported */
/**
 * What is being looked at; `picture` is the decoded one, as it is shown.
 * @typedef {{ name: string, bytes: Uint8Array, picture: ImageBitmap | null, pattern: PatternData | null, preview: Preview | null,
 *   project: Project | null, options: ReadOptions, blobs: BlobOptions, remark: string }} Candidate
 */

/** A slider in motion is answered when it has come to rest for a moment. */
const SETTLE_MS = 60;
/** Twenty steps of the sliders for areas are a factor of ten. */
const STEPS_A_DECADE = 20;

/**
 * @template {HTMLElement} [E=HTMLElement]
 * @param {string} id
 */
const element = (id) => /** @type {E} */ (document.getElementById(id));
const input = (/** @type {string} */ id) => /** @type {HTMLInputElement} */ (element(id));

/** Five digits are enough to recognise a number. @param {number} value */
const number = (value) => String(Number(value.toPrecision(5)));

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

  /** @param {File} file @param {string} [remark] */
  async openFile(file, remark = '') {
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
    await this.#read('', new TextEncoder().encode(text), '');
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
      void this.openFile(file, others.length > 0 ? `Only the first of ${others.length + 1} files is opened.` : '');
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
      if (epoch === this.#epoch) await this.#read(nameOf(address), bytes, `From ${address.host}.`);
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
   * @param {string} remark what to say beside the notes of the file
   */
  async #read(name, bytes, remark) {
    const epoch = this.#epoch;
    const blob = new Blob([/** @type {Uint8Array<ArrayBuffer>} */ (bytes)]);
    // Only pictures can be decoded so; an SVG needs its type to be taken for one.
    const picture = name === '' ? null : await createImageBitmap(blob).catch(() => null);
    if (epoch !== this.#epoch) {
      picture?.close();
      return;
    }
    const candidate = { name, bytes, picture, pattern: null, preview: null, project: null, options: {}, blobs: {}, remark };
    this.#candidate = candidate;
    if (picture) this.#resetBlobs();
    await this.#readAgain();
  }

  /** Reads the candidate with its options as they are now. */
  async #readAgain() {
    const candidate = this.#candidate;
    if (!candidate) return;
    const { name, bytes, options, picture } = candidate;
    // A wrong choice leaves what there was, so that it can be put right.
    const stays = candidate.preview !== null || picture !== null;
    try {
      const answer = await this.#files.read(name, bytes, options);
      if (candidate !== this.#candidate) return;
      if (answer.type === 'blobs') this.#found(answer);
      else {
        Object.assign(candidate, { pattern: answer.pattern, preview: answer.preview, project: answer.project });
        this.#showPreview();
      }
    } catch (error) {
      if (candidate !== this.#candidate) return;
      const message = this.#wordsFor(error);
      if (stays) this.#object(message);
      else this.#fail(message, error instanceof Refused ? error.place : null);
    }
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
  #found({ pattern, preview, threshold }) {
    const candidate = this.#candidate;
    if (!candidate) return;
    const boundary = candidate.options.boundary ?? pattern.boundary;
    Object.assign(candidate, { pattern: { ...pattern, boundary }, preview: { ...preview, boundary } });
    input('import-threshold').value = String(threshold);
    element('import-threshold-value').textContent = String(threshold);
    element('import-otsu').setAttribute('aria-pressed', String((candidate.blobs.threshold ?? null) === null));
    this.#showPreview();
  }

  /** @param {unknown} error */
  #wordsFor(error) {
    if (error instanceof Refused) return error.message;
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
    for (const section of this.#dialog.querySelectorAll('section')) section.hidden = section.dataset.stage !== stage;
    if (!this.#dialog.open) this.#dialog.showModal();
  }

  /**
   * @param {string} message a sentence of the library; those begin small and have no full stop
   * @param {import('../../common/worker-link.js').Refused['place']} [place]
   */
  #fail(message, place = null) {
    const candidate = this.#candidate;
    // The title says the name already.
    const prefix = `${candidate?.name}: `;
    element('import-error').textContent = sentence(message.startsWith(prefix) ? message.slice(prefix.length) : message);
    const excerpt = element('import-excerpt');
    const lines = place && candidate ? offending(new TextDecoder().decode(candidate.bytes), place) : [];
    excerpt.hidden = lines.length === 0;
    excerpt.replaceChildren(
      ...lines.map(({ number, text, mark }) => {
        const row = document.createElement('span');
        row.className = 'line';
        row.toggleAttribute('data-wrong', number === place?.line);
        const count = document.createElement('span');
        count.className = 'line-number';
        count.textContent = String(number);
        const words = document.createElement('code');
        if (mark) {
          const wrong = document.createElement('mark');
          wrong.textContent = text.slice(...mark);
          words.append(text.slice(0, mark[0]), wrong, text.slice(mark[1]));
        } else {
          words.textContent = text;
        }
        row.append(count, words);
        return row;
      }),
    );
    this.#show('error');
    element('import-another').focus();
  }

  /** Something about the choices in the preview is wrong; what is there stays. @param {string} message */
  #object(message) {
    const candidate = this.#candidate;
    if (candidate) candidate.pattern = null;
    this.#showPreview();
    element('import-objection').textContent = sentence(message);
    input('import-use').disabled = true;
  }

  #showPreview() {
    const candidate = this.#candidate;
    if (!candidate) return;
    const { preview, picture, pattern, remark, project } = candidate;
    const wasShown = this.#dialog.dataset.stage === 'preview';
    this.#show('preview');
    element('import-objection').textContent = '';
    input('import-use').disabled = pattern === null;
    element('import-picture').hidden = picture === null;
    element('import-domain').hidden = picture !== null || preview === null;
    element('import-facts').hidden = preview === null;
    if (preview) this.#showFacts(preview, remark, project);
    this.#draw();
    if (!wasShown) input('import-use').focus();
  }

  /** @param {Preview} preview @param {string} remark @param {Project | null} project */
  #showFacts({ format, points: total, classes, attributes, domain, declared, boundary, notes }, remark, project) {
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
    element('import-extent').textContent = `${x0} to ${x1} × ${y0} to ${y1}${declared ? '' : ', found from the points'}`;
    for (const [i, id] of ['x0', 'y0', 'x1', 'y1'].entries()) {
      const field = input(`import-${id}`);
      if (document.activeElement !== field) field.value = String(domain[i]);
    }
    for (const radio of this.#dialog.querySelectorAll('input[name="import-boundary"]')) {
      /** @type {HTMLInputElement} */ (radio).checked = /** @type {HTMLInputElement} */ (radio).value === boundary;
    }
    const list = element('import-notes');
    const said = [remark, ...notes.map(({ text }) => text)].filter(Boolean);
    list.hidden = said.length === 0;
    list.replaceChildren(...said.map((note) => Object.assign(document.createElement('li'), { textContent: note })));
    element('import-canvas').setAttribute('aria-label', `${points(total)} in a rectangle from ${x0}, ${y0} to ${x1}, ${y1}`);
  }

  /** The points, over the picture if they are of one. */
  #draw() {
    const candidate = this.#candidate;
    const canvas = /** @type {HTMLCanvasElement} */ (element('import-canvas'));
    const place = /** @type {HTMLElement} */ (canvas.parentElement);
    if (!candidate || place.clientWidth === 0) return;
    const { pattern, picture } = candidate;
    const ratio = picture ? picture.width / picture.height : pattern ? pattern.domain[2] / pattern.domain[3] : 1;
    const [roomX, roomY] = [place.clientWidth, Math.min(340, 0.42 * window.innerHeight)];
    const margin = picture ? 0 : 8;
    const width = Math.min(roomX - 2 * margin, (roomY - 2 * margin) * ratio);
    const height = width / ratio;
    canvas.style.width = `${width + 2 * margin}px`;
    canvas.style.height = `${height + 2 * margin}px`;
    const context = prepare(canvas, width + 2 * margin, height + 2 * margin);
    const colours = readColours();
    if (picture) {
      context.drawImage(picture, 0, 0, width, height);
      // Less contrast, so that the rings are seen on any picture.
      context.fillStyle = colours.card;
      context.globalAlpha = 0.55;
      context.fillRect(0, 0, width, height);
      context.globalAlpha = 1;
    }
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

  #resetBlobs() {
    input('import-threshold').value = '128';
    element('import-threshold-value').textContent = '';
    input('import-smallest').value = input('import-smallest').min;
    input('import-largest').value = input('import-largest').max;
    /** @type {HTMLInputElement} */ (this.#dialog.querySelector('input[name="import-ink"][value="auto"]')).checked = true;
    this.#showAreas();
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

  /** @param {BlobOptions} changed */
  #look(changed) {
    if (!this.#candidate) return;
    Object.assign(this.#candidate.blobs, changed);
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
        candidate.options.boundary = boundary;
        if (candidate.picture) {
          if (candidate.pattern) candidate.pattern = { ...candidate.pattern, boundary };
        } else void this.#readAgain();
      });
    }
    const corners = ['x0', 'y0', 'x1', 'y1'].map((id) => input(`import-${id}`));
    for (const field of corners) {
      field.addEventListener('change', () => {
        const candidate = this.#candidate;
        if (!candidate) return;
        const domain = corners.map(({ valueAsNumber }) => valueAsNumber);
        if (domain.some(Number.isNaN)) {
          this.#object('each corner of the domain must be a number');
          return;
        }
        candidate.options.domain = /** @type {[number, number, number, number]} */ (domain);
        void this.#readAgain();
      });
    }
    input('import-threshold').addEventListener('input', () => {
      const threshold = input('import-threshold').valueAsNumber;
      element('import-threshold-value').textContent = String(threshold);
      this.#look({ threshold });
    });
    element('import-otsu').addEventListener('click', () => this.#look({ threshold: null }));
    for (const radio of dialog.querySelectorAll('input[name="import-ink"]')) {
      radio.addEventListener('change', () => {
        this.#look({ ink: /** @type {'auto' | 'dark' | 'light'} */ (/** @type {HTMLInputElement} */ (radio).value) });
      });
    }
    for (const id of ['import-smallest', 'import-largest']) {
      input(id).addEventListener('input', () => {
        this.#showAreas();
        this.#look(this.#areas());
      });
    }
    new ResizeObserver(() => this.#draw()).observe(element('import-board'));
  }
}
