// @ts-check
/** The cards to choose an exemplar from: the gallery's, and above them those that a person opened or drew. */
import { areThings, drawPoints, markRadius, prepare, readColours } from '../common/draw.js';
import { element } from '../common/elements.js';

/** @typedef {import('./state.js').PageStore} PageStore */
/** @typedef {import('./state.js').Chosen} Chosen */
/** @typedef {import('./state.js').Boundary} Boundary */
/** @typedef {import('../common/messages.js').PatternView} PatternView */
/** @typedef {import('../common/messages.js').GalleryEntryView} GalleryEntryView */

/** A thumbnail has room for about so many things whose shape is to be seen; of more it shows a part. */
const THINGS_SEEN = 34;

export class Gallery {
  #place = element('gallery');
  #store;
  #look;
  #choose;
  /** @type {Map<HTMLCanvasElement, PatternView>} */
  #thumbnails = new Map();
  /** What the gallery's own exemplars are called. @type {Map<string, Chosen>} */
  #entries = new Map();

  /**
   * @param {PageStore} store
   * @param {import('./look.js').Look} look
   * @param {(choice: Chosen, boundary: Boundary) => void} choose what a person does with a card
   */
  constructor(store, look, choose) {
    this.#store = store;
    this.#look = look;
    this.#choose = choose;
    window.addEventListener('themechange', () => this.redraw());
    new ResizeObserver(() => this.redraw()).observe(this.#place);
    store.subscribe(({ chosen }) => chosen.value, (value) => {
      const input = this.#input(value);
      if (input) input.checked = true;
    });
  }

  /** @param {string} value @returns {HTMLInputElement | null} */
  #input(value) {
    return this.#place.querySelector(`input[value="${CSS.escape(value)}"]`);
  }

  /** @param {HTMLCanvasElement} canvas @param {PatternView} pattern */
  #drawThumbnail(canvas, pattern) {
    const { points, size: [width, height], spacing } = pattern;
    const side = canvas.clientWidth || 60;
    const colours = readColours();
    const styles = this.#look.styles(pattern, colours);
    const things = areThings(points, styles);
    // Dots stand within a margin; of things the middle is shown, to the border.
    const margin = things ? 0 : 4;
    const zoom = things ? Math.min(2, Math.max(1, Math.sqrt(points.classes.length / THINGS_SEEN))) : 1;
    const scale = (side - 2 * margin) * zoom;
    const context = prepare(canvas, side, side);
    drawPoints(context, colours, points, {
      left: (side - width * scale) / 2,
      top: (side - height * scale) / 2,
      scale,
      radius: (things ? 1.15 : 0.9) * Math.max(things ? 1.6 : 0.89, markRadius(spacing, scale, things)),
      styles,
    });
  }

  /** Draws the thumbnails with colours, glyphs and sizes as they are now. */
  redraw() {
    for (const [canvas, pattern] of this.#thumbnails) this.#drawThumbnail(canvas, pattern);
  }

  /** @param {Chosen} choice @param {PatternView} pattern */
  #card(choice, pattern) {
    const card = document.createElement('label');
    card.className = 'exemplar-card';
    const input = document.createElement('input');
    Object.assign(input, { type: 'radio', name: 'exemplar', value: choice.value, className: 'unseen' });
    input.checked = choice.value === this.#store.state.chosen.value;
    input.addEventListener('change', () => this.#choose(choice, pattern.boundary));
    const canvas = document.createElement('canvas');
    canvas.setAttribute('aria-hidden', 'true');
    const words = document.createElement('div');
    const title = document.createElement('strong');
    title.textContent = choice.title;
    const caption = document.createElement('span');
    caption.textContent = choice.caption;
    words.append(title, caption);
    card.append(input, canvas, words);
    this.#thumbnails.set(canvas, pattern);
    return card;
  }

  /**
   * Shows the gallery's entries, once.
   *
   * @param {GalleryEntryView[]} entries
   */
  show(entries) {
    if (this.#entries.size > 0) return;
    for (const { name, title, caption, pattern } of entries) {
      /** @type {Chosen} */
      const choice = { title, caption, source: { source: 'gallery', name }, value: name };
      this.#entries.set(name, choice);
      this.#place.append(this.#card(choice, pattern));
    }
    this.redraw();
  }

  /** An entry by its name, and the boundary it brings along. @param {string} name */
  entry(name) {
    return this.#entries.get(name) ?? null;
  }

  /** @param {string} value */
  has(value) {
    return this.#input(value) !== null;
  }

  /**
   * Puts a card that is not of the gallery on top of it, or in the place of the one with the same value.
   *
   * @param {Chosen} choice
   * @param {PatternView} pattern
   */
  keepOwn(choice, pattern) {
    const card = this.#card(choice, pattern);
    const before = this.#input(choice.value)?.closest('label');
    if (before) before.replaceWith(card);
    else this.#place.prepend(card);
    this.#place.scrollTo({ top: 0, left: 0 });
    this.#forgetThumbnails();
    this.redraw();
  }

  /** Removes a card that is not of the gallery. @param {string} value */
  remove(value) {
    this.#input(value)?.closest('label')?.remove();
    this.#forgetThumbnails();
  }

  #forgetThumbnails() {
    for (const canvas of this.#thumbnails.keys()) if (!canvas.isConnected) this.#thumbnails.delete(canvas);
  }

  /** A card's value that is free. @param {'own' | 'drawing'} kind @returns {{ value: string, number: number }} */
  freeValue(kind) {
    for (let number = 1; ; number++) {
      const value = `${kind}-${number}`;
      if (!this.has(value)) return { value, number };
    }
  }
}
