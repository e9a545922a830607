// @ts-check
/**
 * The editor in which the exemplar is drawn: when it is open, and when what was drawn is woven from. What is drawn is in
 * `drawing.js`, what a hand does in `pointer.js` and `keys.js`, what stands around it in `bar.js`.
 */
import { count } from '../../common/pattern.js';
import { Bar } from './bar.js';
import { Drawing, NOTHING } from './drawing.js';
import { Keys } from './keys.js';
import { Pointer } from './pointer.js';

/** @typedef {import('../../common/pattern.js').Pattern} Pattern */

/** A stroke of a few points is one restart. */
const SETTLE_MS = 400;
/** Fewer points have no structure that could be learnt. */
export const FEWEST_POINTS = 2;

/** @param {string} id */
const element = (id) => /** @type {HTMLElement} */ (document.getElementById(id));
const live = /** @type {HTMLInputElement} */ (element('editor-live'));

export class Editor {
  #open = false;
  /** The pattern the run at hand has learnt from. @type {Pattern | null} */
  #woven = null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #settling;
  #canvas = /** @type {HTMLCanvasElement} */ (element('editor-canvas'));
  #drawing;
  #pointer;
  #hooks;

  /**
   * @param {object} hooks
   * @param {(pattern: Pattern) => void} hooks.weave the pattern has changed and should be woven from
   * @param {(kept: boolean) => void} hooks.closed
   */
  constructor(hooks) {
    this.#hooks = hooks;
    this.#drawing = new Drawing(this.#canvas, {
      say: (text) => void (element('editor-status').textContent = text),
      refresh: () => bar.refresh(),
      changed: () => this.#changed(),
      endGesture: () => this.#pointer.end(true),
    });
    this.#pointer = new Pointer(this.#canvas, this.#drawing);
    new Keys(this.#canvas, this.#drawing, this.#pointer);
    const bar = new Bar(this.#canvas, this.#drawing);
    element('editor-use').addEventListener('click', () => this.use());
    element('editor-discard').addEventListener('click', () => this.close(false));
    live.addEventListener('change', () => this.#changed());
  }

  get isOpen() {
    return this.#open;
  }

  /** The pattern as it stands. */
  get pattern() {
    return this.#drawing.pattern;
  }

  /** Whether anything was done. */
  get isChanged() {
    return this.#drawing.canUndo;
  }

  /**
   * Opens a pattern. In an open editor it becomes the next step, so that it can be undone.
   *
   * @param {Pattern} pattern
   * @param {string} label what was done, for people
   */
  open(pattern, label) {
    this.#pointer.end(false);
    if (this.#open) {
      this.#drawing.commit({ pattern, selection: NOTHING }, label);
    } else {
      this.#drawing.begin(pattern);
      // The exemplar at hand has been woven already, a copy of it as well.
      this.#woven = pattern;
      this.#open = true;
      element('editor').hidden = false;
      this.#drawing.say(`${label}. ${count(pattern) === 0 ? 'Click or tap to add points; a stroke adds a row.' : ''}`);
    }
    this.#drawing.forgetChoices();
    this.#drawing.refresh();
    this.#show();
  }

  /** Scrolls to it. */
  reveal() {
    element('editor').scrollIntoView({ block: 'start' });
  }

  /** Opens once more what was closed last, with everything that can be undone. */
  reopen() {
    this.#woven = null;
    this.#open = true;
    element('editor').hidden = false;
    this.#changed();
    this.#show();
  }

  #show() {
    this.#drawing.board.layout();
    this.#canvas.focus({ preventScroll: true });
  }

  /** The drawing becomes the exemplar, if it can be one. */
  use() {
    this.#pointer.end(true);
    if (count(this.pattern) < FEWEST_POINTS) {
      this.#drawing.say(`An exemplar needs at least ${FEWEST_POINTS} points; a dozen or more show a structure.`);
      return;
    }
    this.#weave();
    this.close(true);
  }

  /** @param {boolean} kept whether the drawing is kept */
  close(kept) {
    if (!this.#open) return;
    this.#pointer.end(kept);
    clearTimeout(this.#settling);
    this.#open = false;
    element('editor').hidden = true;
    this.#hooks.closed(kept);
  }

  #weave() {
    if (this.#woven === this.pattern) return;
    this.#woven = this.pattern;
    this.#hooks.weave(this.pattern);
  }

  /** After another pattern has become the present one. */
  #changed() {
    this.#drawing.refresh();
    clearTimeout(this.#settling);
    if (live.checked && count(this.pattern) >= FEWEST_POINTS) {
      this.#settling = setTimeout(() => {
        // While a hand is at work nothing begins anew.
        if (this.#pointer.isBusy) this.#changed();
        else this.#weave();
      }, SETTLE_MS);
    }
  }
}
