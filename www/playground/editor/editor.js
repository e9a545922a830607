// @ts-check
/**
 * Drawing the exemplar: tools, gestures, keys. The pattern is never changed in place; a gesture drafts another one and
 * hands it to the history when it ends, so that undo takes back what a person did and not what an event did.
 */
import { readColours, tracePreview } from '../../common/draw.js';
import { attributeRange, DrawingBoard, radii } from './drawing-board.js';
import { History } from '../../common/history.js';
import {
  add, adjust, along, assign, clear, contains, count, inside, MAX_ATTRIBUTES, MAX_CLASSES, MAX_POINTS, mirror, move, nearest,
  remove, renamed, unit, withAttribute, withBoundary, withClass, within, withoutAttribute,
} from '../../common/pattern.js';
import { points } from '../../common/words.js';

/** @typedef {import('../../common/pattern.js').Pattern} Pattern */
/** @typedef {[number, number]} Pair */
/** @typedef {'draw' | 'select' | 'erase' | 'paint'} Tool */
/** @typedef {{ pattern: Pattern, selection: ReadonlySet<number> }} State */
/** @typedef {{ move: (at: Pair, event: PointerEvent) => void, end: () => void }} Gesture */

/** A stroke of a few points is one restart. */
const SETTLE_MS = 400;
/** Fewer points have no structure that could be learnt. */
export const FEWEST_POINTS = 2;
/** Brushes and the spacing of a stroke, in pixels. */
const BRUSH_PX = { mouse: 12, touch: 20 };
const STROKE_PX = 16;
/** A pointer that stays this close has clicked. */
const CLICK_PX = 4;
/** Steps of the keyboard's cursor, in the shorter side. */
const STEP = 1 / 60;
const LARGE_STEP = 1 / 12;
/** One notch of the wheel, and one press of + or −. */
const WHEEL_FACTOR = 1.12;

/** @type {ReadonlySet<number>} */
const NOTHING = new Set();

/**
 * @template {HTMLElement} [E=HTMLElement]
 * @param {string} id
 */
const element = (id) => /** @type {E} */ (document.getElementById(id));
const input = (/** @type {string} */ id) => /** @type {HTMLInputElement} */ (element(id));

/** @param {number} number */
const many = (number) => (number === 1 ? 'the point' : points(number));

export class Editor {
  /** @type {History<State>} */
  #history = new History({ pattern: /** @type {any} */ (null), selection: NOTHING });
  /** What a gesture under way would make of the present. @type {State | null} */
  #draft = null;
  /** @type {{ id: number, gesture: Gesture } | null} */
  #pointer = null;
  /** @type {Tool} */
  #tool = 'draw';
  #class = 0;
  /** The attribute that shows as size, or -1. */
  #attribute = -1;
  /** Size of the next points; those that are there decide where it is undefined. @type {number | undefined} */
  #size;
  #hovered = -1;
  /** @type {{ from: Pair, to: Pair } | null} */
  #marquee = null;
  /** @type {{ at: Pair, reach: number } | null} */
  #brush = null;
  /** Where the keyboard's cursor is, and whether it is shown. @type {Pair} */
  #cursor = [0, 0];
  #showsCursor = false;
  /** Whether arrows carry the selection, and what there was before. @type {State | null} */
  #carried = null;
  /** Whether the next Tab leaves the drawing. */
  #tabLeaves = false;
  #open = false;
  /** The pattern the run at hand has learnt from. @type {Pattern | null} */
  #woven = null;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #settling;
  #canvas = /** @type {HTMLCanvasElement} */ (element('editor-canvas'));
  #board;
  #hooks;

  /**
   * @param {object} hooks
   * @param {(pattern: Pattern) => void} hooks.weave the pattern has changed and should be woven from
   * @param {(kept: boolean) => void} hooks.closed
   */
  constructor(hooks) {
    this.#hooks = hooks;
    this.#board = new DrawingBoard(this.#canvas, () => ({
      ...this.#state,
      hovered: this.#hovered,
      attribute: this.#attribute,
      marquee: this.#marquee,
      brush: this.#brush,
      cursor: this.#showsCursor ? this.#cursor : null,
    }));
    this.#listen();
  }

  get isOpen() {
    return this.#open;
  }

  /** The pattern as it stands. */
  get pattern() {
    return this.#state.pattern;
  }

  /** @returns {State} */
  get #state() {
    return this.#draft ?? this.#history.present;
  }

  /**
   * Opens a pattern. In an open editor it becomes the next step, so that it can be undone.
   *
   * @param {Pattern} pattern
   * @param {string} label what was done, for people
   */
  open(pattern, label) {
    this.#endGesture(false);
    if (this.#open) {
      this.#commit({ pattern, selection: NOTHING }, label);
    } else {
      this.#history = new History({ pattern, selection: NOTHING });
      // The exemplar at hand has been woven already, a copy of it as well.
      this.#woven = pattern;
      this.#open = true;
      element('editor').hidden = false;
      this.#say(`${label}. ${count(pattern) === 0 ? 'Click or tap to add points; a stroke adds a row.' : ''}`);
    }
    this.#class = Math.min(this.#class, pattern.classNames.length - 1);
    this.#attribute = -1;
    this.#size = undefined;
    this.#cursor = this.#centre();
    this.#refresh();
    this.#board.layout();
    this.#canvas.focus({ preventScroll: true });
  }

  /** Opens once more what was closed last, with everything that can be undone. */
  reopen() {
    this.#woven = null;
    this.#open = true;
    element('editor').hidden = false;
    this.#changed();
    this.#board.layout();
    this.#canvas.focus({ preventScroll: true });
  }

  /** Whether anything was done. */
  get isChanged() {
    return this.#history.canUndo;
  }

  /** The drawing becomes the exemplar, if it can be one. */
  use() {
    this.#endGesture(true);
    if (count(this.pattern) < FEWEST_POINTS) {
      this.#say(`An exemplar needs at least ${FEWEST_POINTS} points; a dozen or more show a structure.`);
      return;
    }
    this.#weave();
    this.close(true);
  }

  /** @param {boolean} kept whether the drawing is kept */
  close(kept) {
    if (!this.#open) return;
    this.#endGesture(kept);
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

  /** @returns {Pair} */
  #centre() {
    const [left, top, width, height] = this.pattern.domain;
    return [left + width / 2, top + height / 2];
  }

  // -------------------------------------------------------------------------------------------- states

  /**
   * @param {State} state
   * @param {string} label what was done, for people
   * @param {string | null} [key] acts of one key in a row are one step
   */
  #commit(state, label, key = null) {
    this.#draft = null;
    this.#history.push(state, label, key);
    this.#say(`${label}.`);
    this.#changed();
  }

  /** @param {Iterable<number>} selection */
  #select(selection) {
    this.#history.amend({ pattern: this.#history.present.pattern, selection: new Set(selection) });
    this.#refresh();
  }

  /** After another pattern has become the present one. */
  #changed() {
    this.#refresh();
    clearTimeout(this.#settling);
    if (input('editor-live').checked && count(this.pattern) >= FEWEST_POINTS) {
      this.#settling = setTimeout(() => {
        // While a hand is at work nothing begins anew.
        if (this.#pointer) this.#changed();
        else this.#weave();
      }, SETTLE_MS);
    }
  }

  /** @param {string} text */
  #say(text) {
    element('editor-status').textContent = text;
  }

  #undo() {
    this.#endGesture(true);
    const label = this.#history.undo();
    this.#carried = null;
    this.#say(label ? `Undone: ${label.charAt(0).toLowerCase()}${label.slice(1)}.` : 'There is nothing to undo.');
    this.#changed();
  }

  #redo() {
    this.#endGesture(true);
    const label = this.#history.redo();
    this.#say(label ? `Done again: ${label.charAt(0).toLowerCase()}${label.slice(1)}.` : 'There is nothing to redo.');
    this.#changed();
  }

  #deleteSelection() {
    const { pattern, selection } = this.#history.present;
    if (selection.size === 0) return;
    this.#carried = null;
    this.#commit({ pattern: remove(pattern, selection), selection: NOTHING }, `Deleted ${many(selection.size)}`);
  }

  /** @param {0 | 1} axis */
  #mirror(axis) {
    const { pattern, selection } = this.#history.present;
    const what = selection.size > 0 ? many(selection.size) : 'everything';
    this.#commit({ pattern: mirror(pattern, axis, selection), selection }, `Mirrored ${what} ${axis === 0 ? 'left and right' : 'top and bottom'}`);
  }

  /** The class of the selection and of the next points. @param {number} klass */
  #chooseClass(klass) {
    const { pattern, selection } = this.#history.present;
    this.#class = klass;
    const name = pattern.classNames[klass];
    if (selection.size > 0 && [...selection].some((i) => pattern.classes[i] !== klass)) {
      this.#commit({ pattern: assign(pattern, selection, klass), selection }, `Made ${many(selection.size)} ‘${name}’`);
    } else {
      this.#say(`New points will be ‘${name}’.`);
      this.#refresh();
    }
  }

  #addClass() {
    const { pattern, selection } = this.#history.present;
    if (pattern.classNames.length >= MAX_CLASSES) {
      this.#say(`A pattern has at most ${MAX_CLASSES} classes.`);
      return;
    }
    const grown = withClass(pattern);
    const klass = grown.classNames.length - 1;
    const name = grown.classNames[klass];
    this.#class = klass;
    this.#commit({ pattern: assign(grown, selection, klass), selection }, `Added the class ‘${name}’`);
  }

  /** Sizes by hand begin where the marks are. @returns {number} the attribute, or -1 where there can be none */
  #ensureSizes() {
    if (this.#attribute >= 0) return this.#attribute;
    const { pattern, selection } = this.#history.present;
    if (pattern.attributes.length >= MAX_ATTRIBUTES) return -1;
    const taken = pattern.attributes.map(({ name }) => name);
    const name = ['radius', 'size', 'diameter'].find((free) => !taken.includes(free));
    if (!name) return -1;
    const sized = withAttribute(pattern, name, (radii(name) ?? 1) * (this.#board.mark / this.#board.scale));
    this.#attribute = pattern.attributes.length;
    this.#commit({ pattern: sized, selection }, 'Gave every point a size');
    return this.#attribute;
  }

  /**
   * @param {Iterable<number>} indices
   * @param {number} notches up is larger
   */
  #resize(indices, notches) {
    const attribute = this.#ensureSizes();
    if (attribute < 0) return;
    const { pattern, selection } = this.#history.present;
    const [low, high] = attributeRange(pattern, attribute);
    const isLength = radii(pattern.attributes[attribute].name) !== undefined;
    const resized = [...indices];
    const change = (/** @type {number} */ value) =>
      isLength
        ? Math.min(Math.max(value * WHEEL_FACTOR ** notches, low), high)
        : value + (notches * (high - low)) / 25;
    const changed = adjust(pattern, attribute, resized, change);
    const { name, values } = changed.attributes[attribute];
    const said = resized.length === 1 ? `${name} ${this.#number(values[resized[0]])}` : `${name} of ${points(resized.length)} changed`;
    this.#commit({ pattern: changed, selection }, said.charAt(0).toUpperCase() + said.slice(1), `size ${resized.join()}`);
  }

  // -------------------------------------------------------------------------------------------- what is shown

  /** @param {number} value in the pattern's own unit */
  #number(value) {
    const digits = Math.max(0, 3 - Math.ceil(Math.log10(unit(this.pattern))));
    return value.toFixed(Math.min(digits, 12));
  }

  /** @param {Pair} at */
  #place(at) {
    return at.map((value) => this.#number(value)).join(', ');
  }

  /** @param {number} i */
  #describe(i) {
    const { positions, classes, classNames, attributes } = this.pattern;
    const klass = classNames.length > 1 ? `, ${classNames[classes[i]]}` : '';
    const values = attributes.map(({ name, values }) => `, ${name} ${this.#number(values[i])}`).join('');
    return `Point ${i + 1} of ${classes.length} at ${this.#place([positions[2 * i], positions[2 * i + 1]])}${klass}${values}`;
  }

  /** Everything but the picture. */
  #refresh() {
    const { pattern, selection } = this.#state;
    const { classNames, attributes, boundary } = pattern;
    this.#class = Math.min(this.#class, classNames.length - 1);
    if (this.#attribute >= attributes.length) this.#attribute = -1;
    if (this.#attribute < 0) this.#attribute = attributes.length > 0 ? Math.max(0, attributes.findIndex(({ name }) => radii(name))) : -1;
    if (this.#hovered >= count(pattern)) this.#hovered = -1;
    const chosen = selection.size > 0 ? ` · ${selection.size} selected` : '';
    element('editor-count').textContent = points(count(pattern)) + chosen;
    input('editor-undo').disabled = !this.#history.canUndo;
    input('editor-redo').disabled = !this.#history.canRedo;
    input('editor-delete').disabled = selection.size === 0;
    input('editor-clear').disabled = count(pattern) === 0;
    input('editor-mirror-x').disabled = input('editor-mirror-y').disabled = count(pattern) === 0;
    for (const radio of document.querySelectorAll('input[name="editor-boundary"]')) {
      /** @type {HTMLInputElement} */ (radio).checked = /** @type {HTMLInputElement} */ (radio).value === boundary;
    }
    this.#canvas.setAttribute('aria-label', `The exemplar, ${points(count(pattern))}${chosen}`);
    this.#showClasses();
    this.#showSizes();
    this.#board.draw();
  }

  #showClasses() {
    const { classNames } = this.pattern;
    const row = element('editor-classes');
    const colours = readColours();
    while (row.children.length > classNames.length + 1) row.children[0].remove();
    if (row.children.length === 0) {
      const more = document.createElement('button');
      more.type = 'button';
      more.className = 'chip more';
      more.id = 'editor-add-class';
      more.textContent = '+ Class';
      more.addEventListener('click', () => this.#addClass());
      row.append(more);
    }
    while (row.children.length < classNames.length + 1) {
      const chip = document.createElement('button');
      chip.type = 'button';
      chip.className = 'chip';
      const sign = document.createElement('canvas');
      sign.setAttribute('aria-hidden', 'true');
      chip.append(sign, document.createElement('span'));
      chip.addEventListener('click', () => this.#chooseClass([...row.children].indexOf(chip)));
      row.insertBefore(chip, row.lastElementChild);
    }
    for (const [klass, name] of classNames.entries()) {
      const chip = row.children[klass];
      chip.setAttribute('aria-pressed', String(klass === this.#class));
      /** @type {HTMLElement} */ (chip.lastElementChild).textContent = name;
      tracePreview(/** @type {HTMLCanvasElement} */ (chip.firstElementChild), colours, klass, classNames.length > 1);
    }
    input('editor-add-class').disabled = classNames.length >= MAX_CLASSES;
    const name = input('editor-name');
    if (document.activeElement !== name) name.value = classNames[this.#class];
    /** @type {HTMLElement} */ (name.parentElement).hidden = classNames.length < 2;
  }

  #showSizes() {
    const { pattern, selection } = this.#state;
    const has = pattern.attributes.length > 0;
    // Attributes of the person's own data can't be lost with a tick.
    const own = has && pattern.attributes.some(({ name }) => !radii(name));
    input('editor-sized').checked = has;
    input('editor-sized').disabled = own;
    element('editor-size-row').hidden = !has;
    if (!has) return;
    const choice = /** @type {HTMLSelectElement} */ (element('editor-attribute'));
    const names = pattern.attributes.map(({ name }) => name);
    if ([...choice.options].map(({ text }) => text).join('\n') !== names.join('\n')) {
      choice.replaceChildren(...names.map((name, index) => new Option(name, String(index))));
    }
    choice.value = String(this.#attribute);
    choice.hidden = names.length < 2;
    const { values } = pattern.attributes[this.#attribute];
    const [low, high] = attributeRange(pattern, this.#attribute);
    const slider = input('editor-size');
    slider.min = String(low);
    slider.max = String(high);
    const [first] = selection;
    const shown = first === undefined ? (this.#size ?? values[values.length >> 1] ?? low) : values[first];
    if (document.activeElement !== slider) slider.value = String(shown);
    slider.setAttribute('aria-valuetext', this.#number(shown));
  }

  // -------------------------------------------------------------------------------------------- gestures

  /** @returns {(number | undefined)[]} */
  #newValues() {
    return this.pattern.attributes.map((_, index) => (index === this.#attribute ? this.#size : undefined));
  }

  /** @param {PointerEvent} event */
  #down(event) {
    if (this.#pointer) return;
    const erases = event.button === 2 || (event.buttons & 32) !== 0;
    if (event.button !== 0 && !erases) return;
    event.preventDefault();
    this.#canvas.focus({ preventScroll: true });
    this.#canvas.setPointerCapture(event.pointerId);
    this.#showsCursor = false;
    this.#putDown();
    const at = this.#board.at(event);
    const coarse = event.pointerType === 'touch';
    const gesture = this.#begin(erases ? 'erase' : this.#tool, at, coarse, event.shiftKey);
    this.#pointer = { id: event.pointerId, gesture };
    gesture.move(at, event);
    this.#board.draw();
  }

  /**
   * @param {Tool} tool
   * @param {Pair} at
   * @param {boolean} coarse
   * @param {boolean} adds whether to the selection
   * @returns {Gesture}
   */
  #begin(tool, at, coarse, adds) {
    if (tool === 'erase' || tool === 'paint') return this.#rub(tool, at, coarse);
    const handle = this.#board.hitsHandle(at);
    if (handle) return this.#pull(handle);
    const hit = this.#board.hit(at, coarse);
    if (hit >= 0) return this.#drag(hit, at, adds && tool === 'select');
    return tool === 'draw' ? this.#stroke(at) : this.#frame(at, adds);
  }

  /** Adds points along the way, at a distance from one another. @param {Pair} start @returns {Gesture} */
  #stroke(start) {
    const before = this.#history.present;
    let { pattern } = before;
    const values = this.#newValues();
    const gap = Math.max(STROKE_PX, 2.6 * this.#board.mark) / this.#board.scale;
    const slack = CLICK_PX / this.#board.scale;
    let last = start;
    const put = (/** @type {Pair} */ at) => {
      if (count(pattern) >= MAX_POINTS) return;
      pattern = add(pattern, at, this.#class, values);
      this.#draft = { pattern, selection: new Set([count(pattern) - 1]) };
    };
    const [x, y] = inside({ ...pattern, boundary: 'open' }, ...start);
    // A click just outside the border means the border; one far out means nothing.
    if (Math.hypot(x - start[0], y - start[1]) <= slack) put([x, y]);
    return {
      move: (at) => {
        for (let length = Math.hypot(at[0] - last[0], at[1] - last[1]); length >= gap; length -= gap) {
          last = [last[0] + ((at[0] - last[0]) * gap) / length, last[1] + ((at[1] - last[1]) * gap) / length];
          if (contains(pattern, ...last) && nearest(pattern, ...last, 0.6 * gap) < 0) put(last);
        }
      },
      end: () => {
        const added = count(pattern) - count(before.pattern);
        if (added === 0) {
          if (count(pattern) >= MAX_POINTS) this.#say(`An exemplar has at most ${points(MAX_POINTS)}.`);
          return;
        }
        const newest = /** @type {Pair} */ ([...pattern.positions.slice(-2)]);
        this.#cursor = newest;
        const selection = new Set(added === 1 ? [count(pattern) - 1] : []);
        this.#commit({ pattern, selection }, added === 1 ? `Added a point at ${this.#place(newest)}` : `Added ${points(added)}`);
      },
    };
  }

  /**
   * Moves the point that was hit, with the selection if it is of it.
   *
   * @param {number} hit
   * @param {Pair} start
   * @param {boolean} adds
   * @returns {Gesture}
   */
  #drag(hit, start, adds) {
    const { pattern, selection: before } = this.#history.present;
    let selection = before;
    if (adds) {
      const toggled = new Set(before);
      if (!toggled.delete(hit)) toggled.add(hit);
      selection = toggled;
    } else if (!before.has(hit)) {
      selection = new Set([hit]);
    }
    const moved = selection.has(hit) ? selection : new Set([hit]);
    let travelled = false;
    this.#draft = { pattern, selection };
    return {
      move: (at) => {
        const [dx, dy] = [at[0] - start[0], at[1] - start[1]];
        if (!travelled && Math.hypot(dx, dy) * this.#board.scale < CLICK_PX) return;
        travelled = true;
        this.#draft = { pattern: move(pattern, moved, dx, dy), selection };
      },
      end: () => {
        const state = this.#state;
        this.#cursor = /** @type {Pair} */ ([...state.pattern.positions.slice(2 * hit, 2 * hit + 2)]);
        if (travelled) {
          this.#commit(state, `Moved ${many(moved.size)} to ${this.#place(this.#cursor)}`);
          return;
        }
        // A click on one of several means that one.
        this.#draft = null;
        this.#select(adds ? selection : [hit]);
        this.#say(this.#state.selection.size > 1 ? `${this.#state.selection.size} points selected.` : `${this.#describe(hit)}.`);
      },
    };
  }

  /** @param {Pair} start @param {boolean} adds @returns {Gesture} */
  #frame(start, adds) {
    const { pattern, selection } = this.#history.present;
    const kept = adds ? selection : NOTHING;
    return {
      move: (at) => {
        this.#marquee = { from: start, to: at };
        this.#draft = { pattern, selection: new Set([...kept, ...within(pattern, start, at)]) };
      },
      end: () => {
        const chosen = this.#state.selection;
        this.#draft = null;
        this.#select(chosen);
        this.#say(chosen.size === 0 ? 'Nothing selected.' : `${chosen.size} of ${points(count(pattern))} selected. Drag them, choose a class, or delete.`);
      },
    };
  }

  /**
   * Erases or classifies what the brush touches.
   *
   * @param {'erase' | 'paint'} tool
   * @param {Pair} start
   * @param {boolean} coarse
   * @returns {Gesture}
   */
  #rub(tool, start, coarse) {
    const before = this.#history.present;
    let { pattern } = before;
    let touched = 0;
    let last = start;
    const reach = BRUSH_PX[coarse ? 'touch' : 'mouse'] / this.#board.scale;
    return {
      move: (at) => {
        let found = along(pattern, last, at, reach);
        last = at;
        this.#brush = { at, reach };
        if (tool === 'paint') found = found.filter((i) => pattern.classes[i] !== this.#class);
        if (found.length === 0) return;
        touched += found.length;
        pattern = tool === 'erase' ? remove(pattern, found) : assign(pattern, found, this.#class);
        this.#draft = { pattern, selection: tool === 'erase' ? NOTHING : before.selection };
      },
      end: () => {
        if (touched === 0) return;
        const name = pattern.classNames[this.#class];
        this.#commit(this.#state, tool === 'erase' ? `Erased ${many(touched)}` : `Made ${many(touched)} ‘${name}’`);
      },
    };
  }

  /** Sizes by the handle. @param {{ point: number, centre: Pair }} handle @returns {Gesture} */
  #pull(handle) {
    const { pattern, selection } = this.#history.present;
    const attribute = this.#attribute;
    const { name } = pattern.attributes[attribute];
    return {
      move: (at) => {
        const value = this.#board.pulled(handle, at);
        this.#draft = { pattern: adjust(pattern, attribute, [handle.point], () => value), selection };
      },
      end: () => {
        const value = this.#state.pattern.attributes[attribute].values[handle.point];
        this.#size = value;
        this.#commit(this.#state, `${name.charAt(0).toUpperCase()}${name.slice(1)} ${this.#number(value)}`);
      },
    };
  }

  /** @param {PointerEvent} event */
  #moved(event) {
    const at = this.#board.at(event);
    if (this.#pointer) {
      if (event.pointerId !== this.#pointer.id) return;
      const path = event.getCoalescedEvents?.() ?? [];
      for (const part of path.length > 0 ? path : [event]) this.#pointer.gesture.move(this.#board.at(part), event);
      this.#hovered = -1;
      element('editor-count').textContent = points(count(this.pattern));
    } else if (event.pointerType !== 'touch') {
      const rubs = this.#tool === 'erase' || this.#tool === 'paint';
      this.#hovered = rubs ? -1 : this.#board.hit(at, false);
      this.#brush = rubs ? { at, reach: BRUSH_PX.mouse / this.#board.scale } : null;
      this.#canvas.dataset.over = this.#board.hitsHandle(at) ? 'handle' : this.#hovered >= 0 ? 'point' : rubs ? 'brush' : this.#tool;
    }
    this.#board.draw();
  }

  /** @param {boolean} counts whether what the gesture did stays */
  #endGesture(counts) {
    const pointer = this.#pointer;
    this.#pointer = null;
    if (pointer && counts) pointer.gesture.end();
    this.#draft = null;
    this.#marquee = null;
    if (pointer) this.#brush = null;
    if (this.#open) this.#refresh();
  }

  /** @param {WheelEvent} event */
  #wheel(event) {
    if (event.ctrlKey || event.deltaY === 0 || this.#pointer) return;
    const hit = this.#board.hit(this.#board.at(event), false);
    // Elsewhere the wheel scrolls, as it does on the rest of the page.
    if (hit < 0) return;
    event.preventDefault();
    const { selection } = this.#history.present;
    const notches = Math.abs(event.deltaY) < 50 ? -event.deltaY / 50 : -Math.sign(event.deltaY);
    this.#resize(selection.has(hit) ? selection : [hit], notches);
  }

  // -------------------------------------------------------------------------------------------- keyboard

  /** What a key is about: the selection, else the point at the cursor. @returns {number[]} */
  #meant() {
    const { pattern, selection } = this.#history.present;
    if (selection.size > 0) return [...selection];
    const hit = nearest(pattern, ...this.#cursor, 12 / this.#board.scale);
    return hit >= 0 ? [hit] : [];
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    if (this.#pointer) return;
    if (this.#keyWithControl(event) || this.#keyAlone(event)) {
      event.preventDefault();
      event.stopPropagation();
      this.#board.draw();
    }
  }

  /** @param {KeyboardEvent} event @returns {boolean} whether it meant something here */
  #keyWithControl(event) {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return false;
    const key = event.key.toLowerCase();
    if (key === 'z' && !event.shiftKey) this.#undo();
    else if (key === 'y' || key === 'z') this.#redo();
    else if (key === 'a') {
      this.#select(this.pattern.classes.keys());
      this.#say(`${points(count(this.pattern))} selected.`);
    } else return false;
    return true;
  }

  /** @param {KeyboardEvent} event @returns {boolean} whether it meant something here */
  #keyAlone(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return false;
    const { pattern } = this.#history.present;
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
      if (meant.length === 0) this.#say(`There is no point at ${this.#place(this.#cursor)}.`);
      else {
        this.#carried = null;
        this.#commit({ pattern: remove(pattern, meant), selection: NOTHING }, `Deleted ${many(meant.length)}`);
      }
    } else if (key.toLowerCase() === 'm') this.#pickUp();
    else if (key === '+' || key === '=' || key === '-') {
      const meant = this.#meant();
      if (meant.length > 0) this.#resize(meant, key === '-' ? -1 : 1);
    } else if (/^[1-9]$/.test(key)) {
      if (Number(key) > pattern.classNames.length) {
        this.#say(`There ${pattern.classNames.length === 1 ? 'is one class' : `are ${pattern.classNames.length} classes`}; + Class adds another.`);
      } else this.#chooseClass(Number(key) - 1);
    } else if (key.toLowerCase() in tools) this.#choose(tools[key.toLowerCase()]);
    else return false;
    this.#tabLeaves &&= key === 'Escape';
    return true;
  }

  /** @param {number} dx @param {number} dy */
  #arrow(dx, dy) {
    const { pattern, selection } = this.#history.present;
    this.#showsCursor = true;
    if (this.#carried) {
      const [first] = selection;
      const moved = move(pattern, selection, dx, dy);
      this.#cursor = /** @type {Pair} */ ([...moved.positions.slice(2 * first, 2 * first + 2)]);
      this.#commit({ pattern: moved, selection }, `Moved ${many(selection.size)} to ${this.#place(this.#cursor)}`, 'carry');
      return;
    }
    this.#cursor = inside(pattern, this.#cursor[0] + dx, this.#cursor[1] + dy);
    if (selection.size > 0) this.#select([]);
    const [hit = -1] = this.#meant();
    this.#hovered = hit;
    this.#say(hit >= 0 ? `${this.#describe(hit)}.` : `Cursor at ${this.#place(this.#cursor)}.`);
  }

  #enter() {
    if (this.#carried) {
      this.#pickUp();
      return;
    }
    const { pattern } = this.#history.present;
    this.#showsCursor = true;
    if (count(pattern) >= MAX_POINTS) {
      this.#say(`An exemplar has at most ${points(MAX_POINTS)}.`);
      return;
    }
    const hit = nearest(pattern, ...this.#cursor, 0.5 * Math.min(this.#board.mark, 5) / this.#board.scale);
    if (hit >= 0) {
      this.#say('There is a point already.');
      return;
    }
    const added = add(pattern, this.#cursor, this.#class, this.#newValues());
    const total = points(count(added));
    this.#commit({ pattern: added, selection: NOTHING }, `Added a point at ${this.#place(this.#cursor)}`);
    this.#say(`Added a point at ${this.#place(this.#cursor)}. ${total}.`);
  }

  /** @param {boolean} backwards @returns {boolean} whether there was another point to go to */
  #tab(backwards) {
    const { pattern, selection } = this.#history.present;
    if (this.#tabLeaves) return false;
    const [current = backwards ? count(pattern) : -1] = selection;
    const next = current + (backwards ? -1 : 1);
    this.#putDown();
    if (next < 0 || next >= count(pattern)) {
      this.#select([]);
      return false;
    }
    this.#cursor = /** @type {Pair} */ ([...pattern.positions.slice(2 * next, 2 * next + 2)]);
    this.#showsCursor = true;
    this.#select([next]);
    this.#say(`${this.#describe(next)}.`);
    return true;
  }

  #escape() {
    if (this.#carried) {
      const { pattern, selection } = this.#carried;
      this.#carried = null;
      this.#commit({ pattern, selection }, 'Put back');
    } else if (this.#state.selection.size > 0) {
      this.#select([]);
      this.#tabLeaves = true;
      this.#say('Nothing selected. Tab leaves the drawing now.');
    } else {
      this.#tabLeaves = true;
      this.#say('Tab leaves the drawing now.');
    }
  }

  /** Picks the selection up or puts it down. */
  #pickUp() {
    if (this.#carried) {
      this.#putDown();
      this.#say(`Put down at ${this.#place(this.#cursor)}.`);
      return;
    }
    const meant = this.#meant();
    if (meant.length === 0) {
      this.#say(`There is no point at ${this.#place(this.#cursor)} to pick up.`);
      return;
    }
    this.#select(meant);
    this.#carried = this.#history.present;
    this.#say(`Picked up ${many(meant.length)}. Arrows carry, M puts down, Escape puts back.`);
  }

  #putDown() {
    if (!this.#carried) return;
    this.#carried = null;
    this.#history.settle();
  }

  // -------------------------------------------------------------------------------------------- controls

  /** @param {Tool} tool */
  #choose(tool) {
    this.#tool = tool;
    const radio = /** @type {HTMLInputElement} */ (document.querySelector(`input[name="tool"][value="${tool}"]`));
    radio.checked = true;
    this.#brush = null;
    this.#hovered = -1;
    this.#canvas.dataset.over = tool;
    if (tool === 'paint' && this.pattern.classNames.length < 2) this.#say('There is one class; + Class adds another to paint with.');
    else this.#say({ draw: 'Draw: click or drag adds points.', select: 'Select: drag a frame around points.', erase: 'Erase: drag over points.', paint: `Class: drag over points to make them ‘${this.pattern.classNames[this.#class]}’.` }[tool]);
    this.#board.draw();
  }

  #listen() {
    const canvas = this.#canvas;
    canvas.addEventListener('pointerdown', (event) => this.#down(event));
    canvas.addEventListener('pointermove', (event) => this.#moved(event));
    canvas.addEventListener('pointerup', (event) => {
      if (this.#pointer?.id === event.pointerId) this.#endGesture(true);
    });
    // A second finger that pinches takes the first one's gesture back.
    canvas.addEventListener('pointercancel', (event) => {
      if (this.#pointer?.id === event.pointerId) this.#endGesture(false);
    });
    canvas.addEventListener('pointerleave', () => {
      if (this.#pointer) return;
      this.#hovered = -1;
      this.#brush = null;
      this.#board.draw();
    });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => this.#wheel(event), { passive: false });
    canvas.addEventListener('keydown', (event) => this.#key(event));
    canvas.addEventListener('focus', () => {
      this.#tabLeaves = false;
      // Who comes by keyboard must see where the cursor is.
      this.#showsCursor = canvas.matches(':focus-visible');
      this.#board.draw();
    });
    canvas.addEventListener('blur', () => {
      this.#putDown();
      this.#showsCursor = false;
      this.#board.draw();
    });
    // Undo works wherever in the editor the focus is.
    element('editor').addEventListener('keydown', (event) => {
      const target = /** @type {HTMLElement} */ (event.target);
      if (target === canvas || (target instanceof HTMLInputElement && target.type === 'text')) return;
      if (event.key.toLowerCase() !== 'a' && this.#keyWithControl(event)) event.preventDefault();
    });
    for (const radio of document.querySelectorAll('input[name="tool"]')) {
      radio.addEventListener('change', () => this.#choose(/** @type {Tool} */ (/** @type {HTMLInputElement} */ (radio).value)));
    }
    for (const radio of document.querySelectorAll('input[name="editor-boundary"]')) {
      radio.addEventListener('change', () => {
        const boundary = /** @type {Pattern['boundary']} */ (/** @type {HTMLInputElement} */ (radio).value);
        const { pattern, selection } = this.#history.present;
        const words = boundary === 'open' ? 'Made it a window' : 'Made it a tile: left meets right and top meets bottom';
        this.#commit({ pattern: withBoundary(pattern, boundary), selection }, words);
      });
    }
    /** @type {[string, () => void][]} */
    const buttons = [
      ['editor-undo', () => this.#undo()],
      ['editor-redo', () => this.#redo()],
      ['editor-mirror-x', () => this.#mirror(0)],
      ['editor-mirror-y', () => this.#mirror(1)],
      ['editor-delete', () => this.#deleteSelection()],
      ['editor-clear', () => this.#commit({ pattern: clear(this.pattern), selection: NOTHING }, `Cleared ${points(count(this.pattern))}`)],
      ['editor-use', () => this.use()],
      ['editor-discard', () => this.close(false)],
    ];
    for (const [id, act] of buttons) {
      element(id).addEventListener('click', () => {
        act();
        // A button that has just been disabled loses the focus to nowhere.
        if (input(id).disabled && this.#open) canvas.focus({ preventScroll: true });
      });
    }
    input('editor-live').addEventListener('change', () => this.#changed());
    const name = input('editor-name');
    name.addEventListener('change', () => {
      const { pattern, selection } = this.#history.present;
      if (name.value.trim() === pattern.classNames[this.#class]) return;
      const changed = renamed(pattern, this.#class, name.value);
      name.value = changed.classNames[this.#class];
      this.#commit({ pattern: changed, selection }, `Named the class ‘${name.value}’`);
    });
    input('editor-sized').addEventListener('change', () => {
      if (input('editor-sized').checked) this.#ensureSizes();
      else {
        const { pattern, selection } = this.#history.present;
        this.#commit({ pattern: withoutAttribute(pattern, this.#attribute), selection }, 'Took the sizes away');
      }
    });
    element('editor-attribute').addEventListener('change', (event) => {
      this.#attribute = Number(/** @type {HTMLSelectElement} */ (event.target).value);
      this.#size = undefined;
      this.#refresh();
    });
    const slider = input('editor-size');
    slider.addEventListener('input', () => {
      const value = Number(slider.value);
      const { pattern, selection } = this.#history.present;
      this.#size = value;
      if (selection.size === 0) {
        this.#say(`New points will have ${pattern.attributes[this.#attribute].name} ${this.#number(value)}.`);
        return;
      }
      const { name } = pattern.attributes[this.#attribute];
      const changed = adjust(pattern, this.#attribute, selection, () => value);
      this.#commit({ pattern: changed, selection }, `Set the ${name} of ${many(selection.size)} to ${this.#number(value)}`, `slide ${[...selection].join()}`);
    });
    slider.addEventListener('change', () => this.#history.settle());
    window.addEventListener('themechange', () => {
      if (this.#open) this.#showClasses();
    });
  }
}
