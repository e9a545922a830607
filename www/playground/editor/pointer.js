// @ts-check
/** What the pointer does in the drawing: a gesture a tool, from pressing to letting go. */
import {
  add, adjust, along, assign, contains, count, inside, MAX_POINTS, move, nearest, remove, within,
} from '../../common/pattern.js';
import { points } from '../../common/words.js';
import { many, NOTHING } from './drawing.js';

/** @typedef {[number, number]} Pair */
/** @typedef {'draw' | 'select' | 'erase' | 'paint'} Tool */
/** @typedef {{ move: (at: Pair, event: PointerEvent) => void, end: () => void }} Gesture */

/** Brushes and the spacing of a stroke, in pixels. */
const BRUSH_PX = { mouse: 12, touch: 20 };
const STROKE_PX = 16;
/** A pointer that stays this close has clicked. */
const CLICK_PX = 4;

/** @param {string} id */
const element = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

export class Pointer {
  /** @type {{ id: number, gesture: Gesture } | null} */
  #hand = null;
  /** @type {Tool} */
  #tool = 'draw';
  #canvas;
  #drawing;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {import('./drawing.js').Drawing} drawing
   */
  constructor(canvas, drawing) {
    this.#canvas = canvas;
    this.#drawing = drawing;
    canvas.addEventListener('pointerdown', (event) => this.#down(event));
    canvas.addEventListener('pointermove', (event) => this.#moved(event));
    canvas.addEventListener('pointerup', (event) => {
      if (this.#hand?.id === event.pointerId) this.end(true);
    });
    // A second finger that pinches takes the first one's gesture back.
    canvas.addEventListener('pointercancel', (event) => {
      if (this.#hand?.id === event.pointerId) this.end(false);
    });
    canvas.addEventListener('pointerleave', () => {
      if (this.#hand) return;
      drawing.hovered = -1;
      drawing.brush = null;
      drawing.board.draw();
    });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => this.#wheel(event), { passive: false });
    for (const radio of document.querySelectorAll('input[name="tool"]')) {
      radio.addEventListener('change', () => this.choose(/** @type {Tool} */ (/** @type {HTMLInputElement} */ (radio).value)));
    }
  }

  /** Whether a hand is at work. */
  get isBusy() {
    return this.#hand !== null;
  }

  /** @param {Tool} tool */
  choose(tool) {
    this.#tool = tool;
    const radio = /** @type {HTMLInputElement} */ (document.querySelector(`input[name="tool"][value="${tool}"]`));
    radio.checked = true;
    this.#drawing.brush = null;
    this.#drawing.hovered = -1;
    this.#canvas.dataset.over = tool;
    if (tool === 'paint' && this.#drawing.pattern.classNames.length < 2) this.#drawing.say('There is one class; + Class adds another to paint with.');
    else this.#drawing.say({ draw: 'Draw: click or drag adds points.', select: 'Select: drag a frame around points.', erase: 'Erase: drag over points.', paint: `Class: drag over points to make them ‘${this.#drawing.pattern.classNames[this.#drawing.klass]}’.` }[tool]);
    this.#drawing.board.draw();
  }

  /** @param {PointerEvent} event */
  #down(event) {
    if (this.#hand) return;
    const erases = event.button === 2 || (event.buttons & 32) !== 0;
    if (event.button !== 0 && !erases) return;
    event.preventDefault();
    this.#canvas.focus({ preventScroll: true });
    this.#canvas.setPointerCapture(event.pointerId);
    this.#drawing.showsCursor = false;
    this.#drawing.putDown();
    const at = this.#drawing.board.at(event);
    const coarse = event.pointerType === 'touch';
    const gesture = this.#begin(erases ? 'erase' : this.#tool, at, coarse, event.shiftKey);
    this.#hand = { id: event.pointerId, gesture };
    gesture.move(at, event);
    this.#drawing.board.draw();
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
    const handle = this.#drawing.board.hitsHandle(at);
    if (handle) return this.#pull(handle);
    const hit = this.#drawing.board.hit(at, coarse);
    if (hit >= 0) return this.#drag(hit, at, adds && tool === 'select');
    return tool === 'draw' ? this.#stroke(at) : this.#frame(at, adds);
  }

  /** Adds points along the way, at a distance from one another. @param {Pair} start @returns {Gesture} */
  #stroke(start) {
    const before = this.#drawing.present;
    let { pattern } = before;
    const values = this.#drawing.newValues();
    const gap = Math.max(STROKE_PX, 2.6 * this.#drawing.board.mark) / this.#drawing.board.scale;
    const slack = CLICK_PX / this.#drawing.board.scale;
    let last = start;
    const put = (/** @type {Pair} */ at) => {
      if (count(pattern) >= MAX_POINTS) return;
      pattern = add(pattern, at, this.#drawing.klass, values);
      this.#drawing.draft = { pattern, selection: new Set([count(pattern) - 1]) };
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
          if (count(pattern) >= MAX_POINTS) this.#drawing.say(`An exemplar has at most ${points(MAX_POINTS)}.`);
          return;
        }
        const newest = /** @type {Pair} */ ([...pattern.positions.slice(-2)]);
        this.#drawing.cursor = newest;
        const selection = new Set(added === 1 ? [count(pattern) - 1] : []);
        this.#drawing.commit({ pattern, selection }, added === 1 ? `Added a point at ${this.#drawing.place(newest)}` : `Added ${points(added)}`);
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
    const { pattern, selection: before } = this.#drawing.present;
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
    this.#drawing.draft = { pattern, selection };
    return {
      move: (at) => {
        const [dx, dy] = [at[0] - start[0], at[1] - start[1]];
        if (!travelled && Math.hypot(dx, dy) * this.#drawing.board.scale < CLICK_PX) return;
        travelled = true;
        this.#drawing.draft = { pattern: move(pattern, moved, dx, dy), selection };
      },
      end: () => {
        const state = this.#drawing.state;
        this.#drawing.cursor = /** @type {Pair} */ ([...state.pattern.positions.slice(2 * hit, 2 * hit + 2)]);
        if (travelled) {
          this.#drawing.commit(state, `Moved ${many(moved.size)} to ${this.#drawing.place(this.#drawing.cursor)}`);
          return;
        }
        // A click on one of several means that one.
        this.#drawing.draft = null;
        this.#drawing.select(adds ? selection : [hit]);
        this.#drawing.say(this.#drawing.state.selection.size > 1 ? `${this.#drawing.state.selection.size} points selected.` : `${this.#drawing.describe(hit)}.`);
      },
    };
  }

  /** @param {Pair} start @param {boolean} adds @returns {Gesture} */
  #frame(start, adds) {
    const { pattern, selection } = this.#drawing.present;
    const kept = adds ? selection : NOTHING;
    return {
      move: (at) => {
        this.#drawing.marquee = { from: start, to: at };
        this.#drawing.draft = { pattern, selection: new Set([...kept, ...within(pattern, start, at)]) };
      },
      end: () => {
        const chosen = this.#drawing.state.selection;
        this.#drawing.draft = null;
        this.#drawing.select(chosen);
        this.#drawing.say(chosen.size === 0 ? 'Nothing selected.' : `${chosen.size} of ${points(count(pattern))} selected. Drag them, choose a class, or delete.`);
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
    const before = this.#drawing.present;
    let { pattern } = before;
    let touched = 0;
    let last = start;
    const reach = BRUSH_PX[coarse ? 'touch' : 'mouse'] / this.#drawing.board.scale;
    return {
      move: (at) => {
        let found = along(pattern, last, at, reach);
        last = at;
        this.#drawing.brush = { at, reach };
        if (tool === 'paint') found = found.filter((i) => pattern.classes[i] !== this.#drawing.klass);
        if (found.length === 0) return;
        touched += found.length;
        pattern = tool === 'erase' ? remove(pattern, found) : assign(pattern, found, this.#drawing.klass);
        this.#drawing.draft = { pattern, selection: tool === 'erase' ? NOTHING : before.selection };
      },
      end: () => {
        if (touched === 0) return;
        const name = pattern.classNames[this.#drawing.klass];
        this.#drawing.commit(this.#drawing.state, tool === 'erase' ? `Erased ${many(touched)}` : `Made ${many(touched)} ‘${name}’`);
      },
    };
  }

  /** Sizes by the handle. @param {{ point: number, centre: Pair }} handle @returns {Gesture} */
  #pull(handle) {
    const { pattern, selection } = this.#drawing.present;
    const attribute = this.#drawing.attribute;
    const { name } = pattern.attributes[attribute];
    return {
      move: (at) => {
        const value = this.#drawing.board.pulled(handle, at);
        this.#drawing.draft = { pattern: adjust(pattern, attribute, [handle.point], () => value), selection };
      },
      end: () => {
        const value = this.#drawing.state.pattern.attributes[attribute].values[handle.point];
        this.#drawing.size = value;
        this.#drawing.commit(this.#drawing.state, `${name.charAt(0).toUpperCase()}${name.slice(1)} ${this.#drawing.number(value)}`);
      },
    };
  }

  /** @param {PointerEvent} event */
  #moved(event) {
    const at = this.#drawing.board.at(event);
    if (this.#hand) {
      if (event.pointerId !== this.#hand.id) return;
      const path = event.getCoalescedEvents?.() ?? [];
      for (const part of path.length > 0 ? path : [event]) this.#hand.gesture.move(this.#drawing.board.at(part), event);
      this.#drawing.hovered = -1;
      element('editor-count').textContent = points(count(this.#drawing.pattern));
    } else if (event.pointerType !== 'touch') {
      const rubs = this.#tool === 'erase' || this.#tool === 'paint';
      this.#drawing.hovered = rubs ? -1 : this.#drawing.board.hit(at, false);
      this.#drawing.brush = rubs ? { at, reach: BRUSH_PX.mouse / this.#drawing.board.scale } : null;
      this.#canvas.dataset.over = this.#drawing.board.hitsHandle(at) ? 'handle' : this.#drawing.hovered >= 0 ? 'point' : rubs ? 'brush' : this.#tool;
    }
    this.#drawing.board.draw();
  }

  /** @param {boolean} counts whether what the gesture did stays */
  end(counts) {
    const hand = this.#hand;
    this.#hand = null;
    if (hand && counts) hand.gesture.end();
    this.#drawing.draft = null;
    this.#drawing.marquee = null;
    if (hand) this.#drawing.brush = null;
    if (hand) this.#drawing.refresh();
  }

  /** @param {WheelEvent} event */
  #wheel(event) {
    if (event.ctrlKey || event.deltaY === 0 || this.#hand) return;
    const hit = this.#drawing.board.hit(this.#drawing.board.at(event), false);
    // Elsewhere the wheel scrolls, as it does on the rest of the page.
    if (hit < 0) return;
    event.preventDefault();
    const { selection } = this.#drawing.present;
    const notches = Math.abs(event.deltaY) < 50 ? -event.deltaY / 50 : -Math.sign(event.deltaY);
    this.#drawing.resize(selection.has(hit) ? selection : [hit], notches);
  }
}
