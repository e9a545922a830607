// @ts-check
/** The drawing by keyboard alone: a cursor, points to go through, and a letter a tool. */
import { add, count, inside, MAX_POINTS, move, nearest, remove } from '../../common/pattern.js';
import { points } from '../../common/words.js';
import { many, NOTHING } from './drawing.js';

/** @typedef {[number, number]} Pair */
/** @typedef {import('./pointer.js').Tool} Tool */

/** Steps of the cursor, in the shorter side. */
const STEP = 1 / 60;
const LARGE_STEP = 1 / 12;

export class Keys {
  /** Whether the next Tab leaves the drawing. */
  #tabLeaves = false;
  #drawing;
  #pointer;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {import('./drawing.js').Drawing} drawing
   * @param {import('./pointer.js').Pointer} pointer
   */
  constructor(canvas, drawing, pointer) {
    this.#drawing = drawing;
    this.#pointer = pointer;
    canvas.addEventListener('keydown', (event) => this.#key(event));
    canvas.addEventListener('focus', () => {
      this.#tabLeaves = false;
      // Who comes by keyboard must see where the cursor is.
      drawing.showsCursor = canvas.matches(':focus-visible');
      drawing.board.draw();
    });
    canvas.addEventListener('blur', () => {
      drawing.putDown();
      drawing.showsCursor = false;
      drawing.board.draw();
    });
    // Undo works wherever in the editor the focus is.
    document.getElementById('editor')?.addEventListener('keydown', (event) => {
      const target = /** @type {HTMLElement} */ (event.target);
      if (target === canvas || (target instanceof HTMLInputElement && target.type === 'text')) return;
      if (event.key.toLowerCase() !== 'a' && this.#withControl(event)) event.preventDefault();
    });
  }

  /** What a key is about: the selection, else the point at the cursor. @returns {number[]} */
  #meant() {
    const { pattern, selection } = this.#drawing.present;
    if (selection.size > 0) return [...selection];
    const hit = nearest(pattern, ...this.#drawing.cursor, 12 / this.#drawing.board.scale);
    return hit >= 0 ? [hit] : [];
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    if (this.#pointer.isBusy) return;
    if (this.#withControl(event) || this.#keyAlone(event)) {
      event.preventDefault();
      event.stopPropagation();
      this.#drawing.board.draw();
    }
  }

  /** @param {KeyboardEvent} event @returns {boolean} whether it meant something here */
  #withControl(event) {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return false;
    const key = event.key.toLowerCase();
    if (key === 'z' && !event.shiftKey) this.#drawing.undo();
    else if (key === 'y' || key === 'z') this.#drawing.redo();
    else if (key === 'a') {
      this.#drawing.select(this.#drawing.pattern.classes.keys());
      this.#drawing.say(`${points(count(this.#drawing.pattern))} selected.`);
    } else return false;
    return true;
  }

  /** @param {KeyboardEvent} event @returns {boolean} whether it meant something here */
  #keyAlone(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    const { pattern } = this.#drawing.present;
    const { key } = event;
    const step = (event.shiftKey ? LARGE_STEP : STEP) * Math.min(pattern.domain[2], pattern.domain[3]);
    const arrows = /** @type {Record<string, Pair>} */ ({ ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] });
    const tools = /** @type {Record<string, Tool>} */ ({ d: 'draw', s: 'select', e: 'erase', c: 'paint' });
    if (key in arrows) this.#arrow(...arrows[key]);
    else if (key === 'Tab') return this.#tab(event.shiftKey);
    else if (key === 'Escape') this.#escape();
    else if (key === 'Enter') this.#enter();
    else if (key === 'Delete' || key === 'Backspace') {
      const meant = this.#meant();
      if (meant.length === 0) this.#drawing.say(`There is no point at ${this.#drawing.place(this.#drawing.cursor)}.`);
      else {
        this.#drawing.carried = null;
        this.#drawing.commit({ pattern: remove(pattern, meant), selection: NOTHING }, `Deleted ${many(meant.length)}`);
      }
    } else if (key.toLowerCase() === 'm') this.#pickUp();
    else if (key === '+' || key === '=' || key === '-') {
      const meant = this.#meant();
      if (meant.length > 0) this.#drawing.resize(meant, key === '-' ? -1 : 1);
    } else if (/^[1-9]$/.test(key)) {
      if (Number(key) > pattern.classNames.length) {
        this.#drawing.say(`There ${pattern.classNames.length === 1 ? 'is one class' : `are ${pattern.classNames.length} classes`}; + Class adds another.`);
      } else this.#drawing.chooseClass(Number(key) - 1);
    } else if (key.toLowerCase() in tools) this.#pointer.choose(tools[key.toLowerCase()]);
    else return false;
    this.#tabLeaves &&= key === 'Escape';
    return true;
  }

  /** @param {number} dx @param {number} dy */
  #arrow(dx, dy) {
    const { pattern, selection } = this.#drawing.present;
    this.#drawing.showsCursor = true;
    if (this.#drawing.carried) {
      const [first] = selection;
      const moved = move(pattern, selection, dx, dy);
      this.#drawing.cursor = /** @type {Pair} */ ([...moved.positions.slice(2 * first, 2 * first + 2)]);
      this.#drawing.commit({ pattern: moved, selection }, `Moved ${many(selection.size)} to ${this.#drawing.place(this.#drawing.cursor)}`, 'carry');
      return;
    }
    this.#drawing.cursor = inside(pattern, this.#drawing.cursor[0] + dx, this.#drawing.cursor[1] + dy);
    if (selection.size > 0) this.#drawing.select([]);
    const [hit = -1] = this.#meant();
    this.#drawing.hovered = hit;
    this.#drawing.say(hit >= 0 ? `${this.#drawing.describe(hit)}.` : `Cursor at ${this.#drawing.place(this.#drawing.cursor)}.`);
  }

  #enter() {
    if (this.#drawing.carried) {
      this.#pickUp();
      return;
    }
    const { pattern } = this.#drawing.present;
    this.#drawing.showsCursor = true;
    if (count(pattern) >= MAX_POINTS) {
      this.#drawing.say(`An exemplar has at most ${points(MAX_POINTS)}.`);
      return;
    }
    const hit = nearest(pattern, ...this.#drawing.cursor, 0.5 * Math.min(this.#drawing.board.mark, 5) / this.#drawing.board.scale);
    if (hit >= 0) {
      this.#drawing.say('There is a point already.');
      return;
    }
    const added = add(pattern, this.#drawing.cursor, this.#drawing.klass, this.#drawing.newValues());
    const total = points(count(added));
    this.#drawing.commit({ pattern: added, selection: NOTHING }, `Added a point at ${this.#drawing.place(this.#drawing.cursor)}`);
    this.#drawing.say(`Added a point at ${this.#drawing.place(this.#drawing.cursor)}. ${total}.`);
  }

  /** @param {boolean} backwards @returns {boolean} whether there was another point to go to */
  #tab(backwards) {
    const { pattern, selection } = this.#drawing.present;
    if (this.#tabLeaves) return false;
    const [current = backwards ? count(pattern) : -1] = selection;
    const next = current + (backwards ? -1 : 1);
    this.#drawing.putDown();
    if (next < 0 || next >= count(pattern)) {
      this.#drawing.select([]);
      return false;
    }
    this.#drawing.cursor = /** @type {Pair} */ ([...pattern.positions.slice(2 * next, 2 * next + 2)]);
    this.#drawing.showsCursor = true;
    this.#drawing.select([next]);
    this.#drawing.say(`${this.#drawing.describe(next)}.`);
    return true;
  }

  #escape() {
    if (this.#drawing.carried) {
      const { pattern, selection } = this.#drawing.carried;
      this.#drawing.carried = null;
      this.#drawing.commit({ pattern, selection }, 'Put back');
    } else if (this.#drawing.state.selection.size > 0) {
      this.#drawing.select([]);
      this.#tabLeaves = true;
      this.#drawing.say('Nothing selected. Tab leaves the drawing now.');
    } else {
      this.#tabLeaves = true;
      this.#drawing.say('Tab leaves the drawing now.');
    }
  }

  /** Picks the selection up or puts it down. */
  #pickUp() {
    if (this.#drawing.carried) {
      this.#drawing.putDown();
      this.#drawing.say(`Put down at ${this.#drawing.place(this.#drawing.cursor)}.`);
      return;
    }
    const meant = this.#meant();
    if (meant.length === 0) {
      this.#drawing.say(`There is no point at ${this.#drawing.place(this.#drawing.cursor)} to pick up.`);
      return;
    }
    this.#drawing.select(meant);
    this.#drawing.carried = this.#drawing.present;
    this.#drawing.say(`Picked up ${many(meant.length)}. Arrows carry, M puts down, Escape puts back.`);
  }
}
