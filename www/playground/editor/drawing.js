// @ts-check
/**
 * The drawing: the pattern with its history, what is selected, what the next point will be, and every act on them. The
 * pattern is never changed in place; a gesture drafts another one and hands it to the history when it ends, so that undo
 * takes back what a person did and not what an event did.
 */
import { History } from '../../common/history.js';
import {
  adjust, assign, MAX_ATTRIBUTES, MAX_CLASSES, mirror, remove, unit, withAttribute, withClass,
} from '../../common/pattern.js';
import { points } from '../../common/words.js';
import { attributeRange, DrawingBoard, radii } from './drawing-board.js';

/** @typedef {import('../../common/pattern.js').Pattern} Pattern */
/** @typedef {[number, number]} Pair */
/** @typedef {{ pattern: Pattern, selection: ReadonlySet<number> }} State */

/** One notch of the wheel, and one press of + or −. */
const WHEEL_FACTOR = 1.12;

/** @type {ReadonlySet<number>} */
export const NOTHING = new Set();

/** @param {number} number */
export const many = (number) => (number === 1 ? 'the point' : points(number));

export class Drawing {
  /** @type {History<State>} */
  #history = new History({ pattern: /** @type {any} */ (null), selection: NOTHING });
  #hooks;
  /** What a gesture under way would make of the present. @type {State | null} */
  draft = null;
  /** Whether arrows carry the selection, and what there was before. @type {State | null} */
  carried = null;
  /** Of the next points. */
  klass = 0;
  /** The attribute that shows as size, or -1. */
  attribute = -1;
  /** Size of the next points; those that are there decide where it is undefined. @type {number | undefined} */
  size;
  /** The point under the pointer or the cursor, or -1. */
  hovered = -1;
  /** @type {{ from: Pair, to: Pair } | null} */
  marquee = null;
  /** @type {{ at: Pair, reach: number } | null} */
  brush = null;
  /** Where the keyboard's cursor is, and whether it is shown. @type {Pair} */
  cursor = [0, 0];
  showsCursor = false;
  board;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {object} hooks
   * @param {(text: string) => void} hooks.say
   * @param {() => void} hooks.refresh something that is shown is another
   * @param {() => void} hooks.changed another pattern has become the present one
   * @param {() => void} hooks.endGesture what a hand is doing counts as done
   */
  constructor(canvas, hooks) {
    this.#hooks = hooks;
    this.board = new DrawingBoard(canvas, () => ({
      ...this.state,
      hovered: this.hovered,
      attribute: this.attribute,
      marquee: this.marquee,
      brush: this.brush,
      cursor: this.showsCursor ? this.cursor : null,
    }));
  }

  /** Begins with a pattern, and with no past. @param {Pattern} pattern */
  begin(pattern) {
    this.#history = new History({ pattern, selection: NOTHING });
  }

  /** Nothing is chosen of what the pattern before had. */
  forgetChoices() {
    this.klass = Math.min(this.klass, this.pattern.classNames.length - 1);
    this.attribute = -1;
    this.size = undefined;
    const [left, top, width, height] = this.pattern.domain;
    this.cursor = [left + width / 2, top + height / 2];
  }

  /** As it stands, with what a gesture drafts. @returns {State} */
  get state() {
    return this.draft ?? this.present;
  }

  /** As the history has it. */
  get present() {
    return this.#history.present;
  }

  get pattern() {
    return this.state.pattern;
  }

  get canUndo() {
    return this.#history.canUndo;
  }

  get canRedo() {
    return this.#history.canRedo;
  }

  /** The next act is a step of its own, also where it is of the same key. */
  settle() {
    this.#history.settle();
  }

  /** @param {string} text */
  say(text) {
    this.#hooks.say(text);
  }

  /** Shows everything as it stands. */
  refresh() {
    this.#hooks.refresh();
  }

  /**
   * @param {State} state
   * @param {string} label what was done, for people
   * @param {string | null} [key] acts of one key in a row are one step
   */
  commit(state, label, key = null) {
    this.draft = null;
    this.#history.push(state, label, key);
    this.say(`${label}.`);
    this.#hooks.changed();
  }

  /** @param {Iterable<number>} selection */
  select(selection) {
    this.#history.amend({ pattern: this.present.pattern, selection: new Set(selection) });
    this.refresh();
  }

  undo() {
    this.#hooks.endGesture();
    const label = this.#history.undo();
    this.carried = null;
    this.say(label ? `Undone: ${label.charAt(0).toLowerCase()}${label.slice(1)}.` : 'There is nothing to undo.');
    this.#hooks.changed();
  }

  redo() {
    this.#hooks.endGesture();
    const label = this.#history.redo();
    this.say(label ? `Done again: ${label.charAt(0).toLowerCase()}${label.slice(1)}.` : 'There is nothing to redo.');
    this.#hooks.changed();
  }

  deleteSelection() {
    const { pattern, selection } = this.present;
    if (selection.size === 0) return;
    this.carried = null;
    this.commit({ pattern: remove(pattern, selection), selection: NOTHING }, `Deleted ${many(selection.size)}`);
  }

  /** @param {0 | 1} axis */
  mirror(axis) {
    const { pattern, selection } = this.present;
    const what = selection.size > 0 ? many(selection.size) : 'everything';
    this.commit({ pattern: mirror(pattern, axis, selection), selection }, `Mirrored ${what} ${axis === 0 ? 'left and right' : 'top and bottom'}`);
  }

  /** The class of the selection and of the next points. @param {number} klass */
  chooseClass(klass) {
    const { pattern, selection } = this.present;
    this.klass = klass;
    const name = pattern.classNames[klass];
    if (selection.size > 0 && [...selection].some((i) => pattern.classes[i] !== klass)) {
      this.commit({ pattern: assign(pattern, selection, klass), selection }, `Made ${many(selection.size)} ‘${name}’`);
    } else {
      this.say(`New points will be ‘${name}’.`);
      this.refresh();
    }
  }

  addClass() {
    const { pattern, selection } = this.present;
    if (pattern.classNames.length >= MAX_CLASSES) {
      this.say(`A pattern has at most ${MAX_CLASSES} classes.`);
      return;
    }
    const grown = withClass(pattern);
    const klass = grown.classNames.length - 1;
    const name = grown.classNames[klass];
    this.klass = klass;
    this.commit({ pattern: assign(grown, selection, klass), selection }, `Added the class ‘${name}’`);
  }

  /** Sizes by hand begin where the marks are. @returns {number} the attribute, or -1 where there can be none */
  ensureSizes() {
    if (this.attribute >= 0) return this.attribute;
    const { pattern, selection } = this.present;
    if (pattern.attributes.length >= MAX_ATTRIBUTES) return -1;
    const taken = pattern.attributes.map(({ name }) => name);
    const name = ['radius', 'size', 'diameter'].find((free) => !taken.includes(free));
    if (!name) return -1;
    const sized = withAttribute(pattern, name, (radii(name) ?? 1) * (this.board.mark / this.board.scale));
    this.attribute = pattern.attributes.length;
    this.commit({ pattern: sized, selection }, 'Gave every point a size');
    return this.attribute;
  }

  /**
   * @param {Iterable<number>} indices
   * @param {number} notches up is larger
   */
  resize(indices, notches) {
    const attribute = this.ensureSizes();
    if (attribute < 0) return;
    const { pattern, selection } = this.present;
    const [low, high] = attributeRange(pattern, attribute);
    const isLength = radii(pattern.attributes[attribute].name) !== undefined;
    const resized = [...indices];
    const change = (/** @type {number} */ value) =>
      isLength
        ? Math.min(Math.max(value * WHEEL_FACTOR ** notches, low), high)
        : value + (notches * (high - low)) / 25;
    const changed = adjust(pattern, attribute, resized, change);
    const { name, values } = changed.attributes[attribute];
    const said = resized.length === 1 ? `${name} ${this.number(values[resized[0]])}` : `${name} of ${points(resized.length)} changed`;
    this.commit({ pattern: changed, selection }, said.charAt(0).toUpperCase() + said.slice(1), `size ${resized.join()}`);
  }

  /** @returns {(number | undefined)[]} */
  newValues() {
    return this.pattern.attributes.map((_, index) => (index === this.attribute ? this.size : undefined));
  }

  putDown() {
    if (!this.carried) return;
    this.carried = null;
    this.#history.settle();
  }

  /** @param {number} value in the pattern's own unit */
  number(value) {
    const digits = Math.max(0, 3 - Math.ceil(Math.log10(unit(this.pattern))));
    return value.toFixed(Math.min(digits, 12));
  }

  /** @param {Pair} at */
  place(at) {
    return at.map((value) => this.number(value)).join(', ');
  }

  /** @param {number} i */
  describe(i) {
    const { positions, classes, classNames, attributes } = this.pattern;
    const klass = classNames.length > 1 ? `, ${classNames[classes[i]]}` : '';
    const values = attributes.map(({ name, values }) => `, ${name} ${this.number(values[i])}`).join('');
    return `Point ${i + 1} of ${classes.length} at ${this.place([positions[2 * i], positions[2 * i + 1]])}${klass}${values}`;
  }
}
