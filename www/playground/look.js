// @ts-check
/**
 * The look of the classes: a glyph for each, also one's own as SVG path data, and the palette. The module for files reads and
 * checks paths, so that the page draws what a file would hold; what was chosen stays in this browser.
 */
import { prepare, readColours } from '../common/draw.js';
import { DISK, fill, glyph } from '../common/glyphs.js';
import { recall, remember } from '../common/memory.js';
import { Refused, WorkerDied } from '../common/files.js';

/** @typedef {import('../common/glyphs.js').Glyph} Glyph */
/** @typedef {import('../common/messages.js').PatternView} PatternView */
/** @typedef {import('../common/draw.js').Colours} Colours */

/** Name in the browser's storage. */
const KEY = 'pointweave.look';
const PALETTES = ['okabe-ito', 'bright', 'ink'];
/** What a name begins with that is path data. */
const PATH = 'path:';
/** Most classes whose choice is remembered. */
const MOST_REMEMBERED = 64;
/** A path is asked about when the person stops typing. */
const SETTLE_MS = 250;
/** An own path to begin with: a leaf. */
const FIRST_PATH = 'M0 -10C9 -6 9 6 0 10C-9 6 -9 -6 0 -10Z';

export class Look {
  #files;
  #changed;
  /** Built-in glyphs by their names. @type {Map<string, Glyph>} */
  #glyphs = new Map([['disk', DISK]]);
  /** What was chosen, by class: a glyph's name or `path:` and path data. @type {Map<string, string>} */
  #chosen = new Map();
  /** Own paths that were found good, by their `path:` names. @type {Map<string, Glyph>} */
  #own = new Map();
  #palette = PALETTES[0];
  /** @type {PatternView | null} */
  #pattern = null;
  #rows = /** @type {HTMLElement} */ (document.getElementById('look-classes'));
  #palettes = /** @type {HTMLElement} */ (document.getElementById('look-palette'));
  /** Swatches and the class each shows. @type {[HTMLCanvasElement, number][]} */
  #swatches = [];

  /**
   * @param {import('../common/files.js').Files} files
   * @param {() => void} changed
   */
  constructor(files, changed) {
    this.#files = files;
    this.#changed = changed;
    this.#recall();
    for (const input of this.#palettes.querySelectorAll('input')) {
      input.checked = input.value === this.#palette;
      input.addEventListener('change', () => {
        this.#palette = input.value;
        this.#keep();
      });
    }
    document.documentElement.dataset.palette = this.#palette;
    window.addEventListener('themechange', () => this.#drawSwatches());
  }

  #recall() {
    try {
      const { palette, glyphs } = JSON.parse(recall(KEY) ?? '{}');
      if (PALETTES.includes(palette)) this.#palette = palette;
      for (const [name, chosen] of Object.entries(glyphs ?? {})) {
        if (typeof chosen === 'string') this.#chosen.set(name, chosen);
      }
    } catch {
      // What can't be read is as good as nothing.
    }
  }

  /** Remembers the choice and shows it. */
  #keep() {
    const glyphs = Object.fromEntries([...this.#chosen].slice(-MOST_REMEMBERED));
    remember(KEY, JSON.stringify({ palette: this.#palette, glyphs }));
    document.documentElement.dataset.palette = this.#palette;
    this.#drawSwatches();
    this.#changed();
  }

  /** @param {import('../common/messages.js').GlyphView[]} views what the worker can draw */
  learn(views) {
    this.#glyphs = new Map(views.map(({ name, outline }) => [name, glyph(name, outline)]));
    for (const chosen of new Set(this.#chosen.values())) {
      // A path that was good once is; one that somebody else put there is asked about like any other.
      if (chosen.startsWith(PATH)) void this.#check(chosen).catch(() => {});
    }
    if (this.#pattern) this.show(this.#pattern);
  }

  /** For files: the palette, and the glyphs chosen for the classes at hand. */
  get choice() {
    /** @type {Record<string, string>} */
    const glyphs = {};
    for (const name of this.#pattern?.classNames ?? []) {
      const chosen = this.#chosen.get(name);
      if (chosen !== undefined && this.#find(chosen)) glyphs[name] = chosen;
    }
    return { glyphs, palette: this.#palette };
  }

  /** @param {string} name */
  #find(name) {
    return this.#glyphs.get(name) ?? this.#own.get(name);
  }

  /**
   * How the classes of a pattern look.
   *
   * @param {PatternView} pattern
   * @param {Colours} colours
   * @returns {import('../common/draw.js').Style[]}
   */
  styles({ classNames, looks }, colours) {
    return looks.map((look, number) => {
      const chosen = this.#chosen.get(classNames[number]);
      const shape = (chosen !== undefined && this.#find(chosen)) || this.#find(look.glyph) || DISK;
      // A class alone needs no colour of its own, unless its name asks for one.
      const plain = looks.length === 1 && look.color === 0;
      return { glyph: shape, colour: plain ? colours.point : colours.classes[look.color % colours.classes.length] };
    });
  }

  /**
   * Asks for the outline of a path; one that is none is refused in words.
   *
   * @param {string} name
   */
  async #check(name) {
    if (this.#own.has(name)) return;
    this.#own.set(name, glyph('path', await this.#files.glyph(name)));
    this.#drawSwatches();
    this.#changed();
  }

  /** Lists the classes of a pattern. @param {PatternView} pattern */
  show(pattern) {
    this.#pattern = pattern;
    this.#swatches = [];
    this.#rows.replaceChildren(...pattern.classNames.map((name, number) => this.#row(name, number)));
    this.#drawSwatches();
  }

  /**
   * @param {string} name of a class
   * @param {number} number
   */
  #row(name, number) {
    const row = document.createElement('div');
    row.className = 'look-class';
    const swatch = document.createElement('canvas');
    swatch.setAttribute('aria-hidden', 'true');
    this.#swatches.push([swatch, number]);
    const label = document.createElement('label');
    label.textContent = name;
    const select = document.createElement('select');
    select.id = `look-class-${number}`;
    label.htmlFor = select.id;
    const own = document.createElement('div');
    own.className = 'look-own';
    const choices = [...this.#glyphs.keys()].map((choice) => [choice, choice.charAt(0).toUpperCase() + choice.slice(1)]);
    for (const [value, words] of [...choices, [PATH, 'Own path…']]) {
      const option = document.createElement('option');
      Object.assign(option, { value, textContent: words });
      select.append(option);
    }
    const chosen = this.#chosen.get(name);
    select.value = chosen?.startsWith(PATH) ? PATH : (chosen ?? this.#pattern?.looks[number].glyph ?? 'disk');
    select.addEventListener('change', () => {
      if (select.value === PATH) {
        this.#askForPath(own, name, FIRST_PATH).focus();
      } else {
        own.replaceChildren();
        this.#chosen.set(name, select.value);
        this.#keep();
      }
    });
    row.append(swatch, label, select, own);
    if (chosen?.startsWith(PATH)) this.#askForPath(own, name, chosen.slice(PATH.length));
    return row;
  }

  /**
   * A field for path data and a line for what is wrong with it.
   *
   * @param {HTMLElement} room
   * @param {string} name of the class
   * @param {string} first
   */
  #askForPath(room, name, first) {
    const field = document.createElement('textarea');
    Object.assign(field, { rows: 2, spellcheck: false, value: first, maxLength: 4000 });
    field.setAttribute('aria-label', `SVG path data for ${name}`);
    const words = document.createElement('p');
    words.className = 'look-error';
    words.id = `${room.previousElementSibling?.id}-error`;
    words.setAttribute('role', 'status');
    field.setAttribute('aria-describedby', words.id);
    room.replaceChildren(field, words);
    /** @type {ReturnType<typeof setTimeout> | undefined} */
    let settling;
    const take = async () => {
      const text = field.value;
      try {
        await this.#check(PATH + text);
        if (text !== field.value || !field.isConnected) return;
        field.setAttribute('aria-invalid', 'false');
        words.textContent = '';
        this.#chosen.set(name, PATH + text);
        this.#keep();
      } catch (error) {
        if (error instanceof WorkerDied) return;
        if (!(error instanceof Refused)) throw error;
        if (text !== field.value) return;
        field.setAttribute('aria-invalid', 'true');
        words.textContent = `${error.message.charAt(0).toUpperCase()}${error.message.slice(1)}.`;
      }
    };
    field.addEventListener('input', () => {
      clearTimeout(settling);
      settling = setTimeout(() => void take(), SETTLE_MS);
    });
    void take();
    return field;
  }

  #drawSwatches() {
    if (!this.#pattern) return;
    const styles = this.styles(this.#pattern, readColours());
    for (const [canvas, number] of this.#swatches) {
      const side = 22;
      const context = prepare(canvas, side, side);
      const { glyph: shape, colour } = styles[number];
      context.fillStyle = colour;
      fill(context, shape, side / 2, side / 2, 5.6, 0, null);
    }
  }
}
