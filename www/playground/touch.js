// @ts-check
/**
 * Hands on the result: a point is dragged and held, a region is done again, by mouse, touch, pen or keyboard. The worker
 * does what is asked and answers with the points; until then a dragged point is drawn where the hand is.
 */
import { withhold } from '../common/withhold.js';
import { points as countPoints } from '../common/words.js';
import { lack } from './tools.js';

/** @typedef {import('./stage.js').Stage} Stage */
/** @typedef {import('./run.js').Run} Run */
/** @typedef {{ index: number, id: number, pointer: number, start: [number, number], from: [number, number], pinned: boolean, moved: boolean }} Drag */
/** @typedef {Drag & { timer: ReturnType<typeof setTimeout> }} Press */
/** @typedef {{ say: string, run: () => Promise<boolean> }} Undo */

/** A point is hit within so many pixels of its centre; a finger is wider than a mouse. */
const REACH = { mouse: 10, pen: 14, touch: 24 };
/** Less than this is a click; a finger is less steady. */
const CLICK_PX = 4;
const TAP_PX = 10;
/** A finger that rests this long on a point picks it up. Before that it may be about to scroll the page. */
const HOLD_MS = 300;
/** While a point is dragged the others learn of it no oftener: each time the scale is set up again. */
const TELL_MS = 250;
/** A lasso smaller than this, in pixels, was a slip. */
const LEAST_LASSO_PX = 12;
/** What the Delete key does again around a point, in mean spacings, and in how many corners. */
const [AROUND, CORNERS] = [2.5, 24];
/** Shift and an arrow move a point by this much, in mean spacings. */
const NUDGE = 0.25;
const MOST_UNDOS = 30;

/** @type {Record<string, [number, number]>} */
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/** @param {string} id */
const button = (id) => /** @type {HTMLButtonElement} */ (document.getElementById(id));

export class Touch {
  #canvas;
  #regionButton = button('touch-region');
  #undoButton = button('touch-undo');
  #unpinButton = button('touch-unpin');
  #hint = /** @type {HTMLElement} */ (document.getElementById('touch-hint'));
  #coarse = matchMedia('(pointer: coarse)');
  #stage;
  #run;
  #announce;
  /** @type {Drag | null} */
  #drag = null;
  /** A finger on a point that has not picked it up yet. @type {Press | null} */
  #press = null;
  /** Corners of the lasso being drawn. @type {[number, number][] | null} */
  #lasso = null;
  /** The point that keys act on, and the one under the mouse. */
  #chosen = -1;
  #hovered = -1;
  #telling = false;
  #toldAt = 0;
  /** @type {Undo[]} */
  #undos = [];
  #undoing = false;
  /** What the method can do. */
  #offers = { moves: true, pins: true, redoes: true };

  /**
   * @param {Stage} stage
   * @param {Run} run
   * @param {(text: string) => void} announce
   */
  constructor(stage, run, announce) {
    this.#stage = stage;
    this.#run = run;
    this.#announce = announce;
    stage.overlay = (context) => this.#draw(context);
    const canvas = (this.#canvas = stage.surface);
    canvas.addEventListener('pointerdown', (event) => this.#down(event));
    canvas.addEventListener('pointermove', (event) => this.#move(event));
    canvas.addEventListener('pointerup', (event) => this.#up(event));
    canvas.addEventListener('pointercancel', () => this.#cancel());
    canvas.addEventListener('pointerleave', () => this.#hover(-1));
    canvas.addEventListener('keydown', (event) => this.#key(event));
    canvas.addEventListener('focus', () => stage.redraw());
    canvas.addEventListener('blur', () => stage.redraw());
    // What is in a hand does not scroll the page; everything else does.
    const takes = (/** @type {TouchEvent} */ event) => {
      if ((this.#drag || this.#lasso) && event.cancelable) event.preventDefault();
    };
    canvas.addEventListener('touchstart', takes, { passive: false });
    canvas.addEventListener('touchmove', takes, { passive: false });
    // A long press is no wish for a menu.
    canvas.addEventListener('contextmenu', (event) => {
      if (this.#press || this.#drag) event.preventDefault();
    });
    window.addEventListener('keydown', (event) => this.#anywhere(event));
    this.#coarse.addEventListener('change', () => this.changed());
    this.#regionButton.addEventListener('click', () => this.#chooseRegion(!this.#choosesRegion));
    this.#undoButton.addEventListener('click', () => void this.undo());
    this.#unpinButton.addEventListener('click', () => void this.unpinAll());
  }

  get #choosesRegion() {
    return this.#regionButton.getAttribute('aria-pressed') === 'true';
  }

  /** What the method can do. @param {import('../common/messages.js').MethodView} method */
  offer(method) {
    const lacksRegions = lack(method, 'redo-region');
    this.#offers = { moves: lack(method, 'move') === null, pins: lack(method, 'pin') === null, redoes: lacksRegions === null };
    if (lacksRegions && this.#choosesRegion) this.#chooseRegion(false);
    withhold(this.#regionButton, 'method', lacksRegions);
    this.changed();
  }

  /** Another run is shown. */
  started() {
    this.#cancel();
    this.#chosen = this.#hovered = -1;
    // What is undone was done to the run before, unless undoing brought this one.
    if (!this.#undoing) this.#undos = [];
    this.changed();
  }

  /** The points, and what is pinned of them, are others. */
  changed() {
    const pinned = this.#stage.pinned.length;
    this.#unpinButton.hidden = pinned === 0;
    this.#unpinButton.textContent = `Unpin ${pinned === 1 ? 'it' : `all ${pinned}`}`;
    this.#undoButton.disabled = this.#undos.length === 0;
    this.#undoButton.title = `${this.#undos.at(-1)?.say ?? 'Nothing to undo'} (Ctrl+Z)`;
    withhold(this.#regionButton, 'stage', this.#stage.touchable ? null : '');
    const hint = this.#says();
    if (this.#hint.textContent !== hint) this.#hint.textContent = hint;
  }

  /** What a hand can do now. */
  #says() {
    const { touchable, showsKept, positions, pinned } = this.#stage;
    if (showsKept) return 'This is A, as kept. What you take away is B.';
    if (positions.length === 0) return '';
    if (!touchable) return 'Leave the tiles to move points.';
    if (this.#choosesRegion) return `Draw around what is to be done again.${this.#coarse.matches ? '' : ' Esc leaves.'}`;
    const held = `${countPoints(pinned.length)} pinned.`;
    if (pinned.length > 0 && this.#run.status === 'playing') return `${held} The others make room.`;
    if (pinned.length > 0) return `${held} Go on: the others make room.`;
    const { moves, pins } = this.#offers;
    if (moves && pins) return this.#coarse.matches ? 'Hold a point, then drag it; a tap pins it.' : 'Drag a point: it stays put. A click pins it.';
    if (moves) return this.#coarse.matches ? 'Hold a point, then drag it.' : 'Drag a point to move it.';
    return pins ? `A ${this.#coarse.matches ? 'tap' : 'click'} pins a point.` : '';
  }

  /** @param {Undo} undo */
  #remember(undo) {
    this.#undos.push(undo);
    if (this.#undos.length > MOST_UNDOS) this.#undos.shift();
    this.changed();
  }

  async undo() {
    const last = this.#undos.pop();
    if (!last) return;
    this.#undoing = true;
    const done = await last.run();
    this.#undoing = false;
    this.changed();
    if (done) this.#announce('Undone.');
  }

  /** @param {number} index */
  #isPinned(index) {
    return this.#stage.pinned.includes(index);
  }

  /** @param {number} index @returns {[number, number]} */
  #position(index) {
    const { positions } = this.#stage;
    return [positions[2 * index], positions[2 * index + 1]];
  }

  /**
   * @param {number[]} ids
   * @param {number[]} positions
   * @param {boolean} pinned
   */
  #tell(ids, positions, pinned) {
    return this.#run.touch({
      type: 'touch',
      points: Uint32Array.from(ids),
      positions: Float64Array.from(positions),
      pinned,
    });
  }

  async unpinAll() {
    const held = Array.from(this.#stage.pinned, (index) => this.#stage.ids[index]);
    if (!(await this.#tell(held, [], false))) return;
    this.#remember({ say: `Undo: unpin ${countPoints(held.length)}`, run: () => this.#tell(held, [], true) });
    this.#announce('Nothing is pinned any more.');
  }

  /** @param {number} index */
  async #toggle(index) {
    const pinned = !this.#isPinned(index);
    const id = this.#stage.ids[index];
    if (!this.#offers.pins) {
      this.#announce('This method can’t pin points.');
      return;
    }
    if (!(await this.#tell([id], [], pinned))) return;
    this.#remember({ say: `Undo: ${pinned ? 'pin' : 'unpin'}`, run: () => this.#tell([id], [], !pinned) });
    this.#announce(`Point ${index + 1} ${pinned ? 'is pinned' : 'may move again'}.`);
  }

  /**
   * Holds the point at its new place, from where undoing takes it back.
   *
   * @param {number} index
   * @param {[number, number]} place
   * @param {[number, number]} from
   * @param {boolean} pinned whether it was held before
   */
  async #put(index, place, from, pinned) {
    if (!this.#offers.moves) {
      this.#announce('This method can’t move points.');
      return false;
    }
    const id = this.#stage.ids[index];
    const { pins } = this.#offers;
    const done = await this.#tell([id], place, pins);
    if (done) {
      this.#remember({ say: 'Undo: move a point', run: () => this.#tell([id], from, pinned) });
      this.#announce(`Point ${index + 1} is moved${pins ? ' and pinned' : ''}.`);
    }
    return done;
  }

  /** @param {[number, number][]} corners */
  async #redo(corners) {
    if (!this.#offers.redoes) {
      this.#announce('This method can’t do a region again.');
      return;
    }
    const { plan, status } = this.#run;
    // Without it, there is only no way back.
    const before = await this.#run.state().catch(() => null);
    const done = await this.#run.touch({ type: 'resynthesize', region: Float64Array.from(corners.flat()) });
    if (!done) return;
    if (plan && before !== null) {
      this.#remember({ say: 'Undo: redo a region', run: () => this.#run.resume(plan, before, status !== 'paused') });
    }
    this.#announce('The region is being done again; everything else stays.');
  }

  // -------------------------------------------------------------------------------------------- pointer

  /**
   * @param {number} clientX
   * @param {number} clientY
   * @param {string} kind
   */
  #hit(clientX, clientY, kind) {
    if (!this.#stage.touchable || !(this.#offers.moves || this.#offers.pins)) return -1;
    const reach = REACH[/** @type {keyof typeof REACH} */ (kind)] ?? REACH.mouse;
    return this.#stage.pointAt(this.#stage.place(clientX, clientY), reach);
  }

  /** @param {PointerEvent} event */
  #down(event) {
    // A second finger is about to zoom.
    this.#endPress();
    if (event.button !== 0 || this.#drag || this.#lasso || !this.#stage.touchable || !event.isPrimary) return;
    if (this.#choosesRegion) {
      this.#lasso = [this.#stage.place(event.clientX, event.clientY)];
      this.#canvas.setPointerCapture(event.pointerId);
      this.#stage.redraw();
      return;
    }
    const index = this.#hit(event.clientX, event.clientY, event.pointerType);
    if (index < 0) return;
    /** @type {Drag} */
    const drag = {
      index,
      id: this.#stage.ids[index],
      pointer: event.pointerId,
      start: [event.clientX, event.clientY],
      from: this.#position(index),
      pinned: this.#isPinned(index),
      moved: false,
    };
    if (event.pointerType === 'touch') this.#press = { ...drag, timer: setTimeout(() => this.#take(drag), HOLD_MS) };
    else this.#take(drag);
  }

  /** A point is in a hand. @param {Drag} drag */
  #take(drag) {
    const held = this.#press !== null;
    this.#endPress();
    // While a finger rested on it, it may have moved on by itself.
    this.#drag = { ...drag, from: this.#position(drag.index) };
    this.#chosen = drag.index;
    if (held) navigator.vibrate?.(10);
    this.#canvas.setPointerCapture(drag.pointer);
    this.#stage.redraw();
  }

  #endPress() {
    clearTimeout(this.#press?.timer);
    this.#press = null;
  }

  /** @param {PointerEvent} event */
  #move(event) {
    if (this.#lasso) {
      if (event.isPrimary) this.#lasso.push(this.#stage.place(event.clientX, event.clientY));
      this.#stage.redraw();
      return;
    }
    const from = (/** @type {Drag} */ { start }) => Math.hypot(event.clientX - start[0], event.clientY - start[1]);
    if (this.#press && from(this.#press) > TAP_PX) this.#endPress();
    const drag = this.#drag;
    if (!drag) {
      if (!this.#choosesRegion && event.pointerType !== 'touch') {
        this.#hover(this.#hit(event.clientX, event.clientY, event.pointerType));
      }
      return;
    }
    if (event.pointerId !== drag.pointer) return;
    if (!this.#offers.moves || (!drag.moved && from(drag) < CLICK_PX)) return;
    drag.moved = true;
    this.#canvas.classList.add('dragging');
    const place = this.#stage.inside(this.#stage.place(event.clientX, event.clientY));
    this.#stage.hold(drag.index, place);
    void this.#tellWhileDragged(drag.id, place);
  }

  /**
   * @param {number} id
   * @param {[number, number]} place
   */
  async #tellWhileDragged(id, place) {
    // Only what is playing has anyone to learn of it.
    if (this.#telling || this.#run.status !== 'playing' || performance.now() - this.#toldAt < TELL_MS) return;
    this.#telling = true;
    await this.#tell([id], place, this.#offers.pins);
    this.#telling = false;
    this.#toldAt = performance.now();
  }

  /** @param {PointerEvent} event */
  #up(event) {
    if (this.#drag && event.pointerId !== this.#drag.pointer) return;
    const [drag, lasso] = [this.#press ?? this.#drag, this.#lasso];
    this.#endPress();
    this.#drag = this.#lasso = null;
    this.#canvas.classList.remove('dragging');
    if (lasso) {
      this.#finishLasso(lasso);
    } else if (drag && !drag.moved) {
      this.#chosen = drag.index;
      void this.#toggle(drag.index);
    } else if (drag) {
      const place = this.#stage.inside(this.#stage.place(event.clientX, event.clientY));
      this.#stage.hold(drag.index, place);
      void this.#put(drag.index, place, drag.from, drag.pinned).finally(() => this.#stage.hold(-1));
    }
    this.#stage.redraw();
  }

  /** @param {[number, number][]} lasso */
  #finishLasso(lasso) {
    const width = (/** @type {0 | 1} */ axis) => {
      const values = lasso.map((corner) => corner[axis]);
      return (Math.max(...values) - Math.min(...values)) * this.#stage.scale;
    };
    if (lasso.length < 3 || Math.max(width(0), width(1)) < LEAST_LASSO_PX) {
      this.#announce('Draw around what is to be done again.');
      return;
    }
    this.#chooseRegion(false);
    void this.#redo(lasso);
  }

  #cancel() {
    this.#endPress();
    const drag = this.#drag;
    this.#drag = this.#lasso = null;
    this.#canvas.classList.remove('dragging');
    this.#stage.hold(-1);
    // What the worker has heard of meanwhile is taken back.
    if (drag?.moved) void this.#tell([drag.id], drag.from, drag.pinned);
  }

  /** @param {number} index */
  #hover(index) {
    if (index === this.#hovered) return;
    this.#hovered = index;
    this.#canvas.classList.toggle('over-point', index >= 0);
    this.#stage.redraw();
  }

  /** @param {boolean} on */
  #chooseRegion(on) {
    this.#regionButton.setAttribute('aria-pressed', String(on));
    this.#canvas.classList.toggle('choosing', on);
    this.#hover(-1);
    this.changed();
    if (on) this.#announce('Draw around what is to be done again, or choose a point with the arrow keys and press Delete. Escape leaves.');
  }

  // -------------------------------------------------------------------------------------------- keyboard

  /** Keys that mean the same wherever the focus is. @param {KeyboardEvent} event */
  #anywhere(event) {
    const target = /** @type {HTMLElement} */ (event.target);
    if (event.defaultPrevented || target.closest?.('input:not([type="radio"], [type="checkbox"]), textarea, select, dialog, .editor')) return;
    if (event.key === 'Escape' && (this.#drag || this.#choosesRegion)) {
      this.#cancel();
      this.#chooseRegion(false);
    } else if (event.key.toLowerCase() === 'z' && (event.ctrlKey || event.metaKey) && !event.shiftKey && this.#undos.length > 0) {
      void this.undo();
    } else {
      return;
    }
    event.preventDefault();
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || !this.#stage.touchable) return;
    const count = this.#stage.positions.length / 2;
    if (count === 0) return;
    const arrow = ARROWS[event.key];
    const chosen = this.#chosen >= 0 && this.#chosen < count;
    if (arrow && event.shiftKey && chosen) {
      const [x, y] = this.#position(this.#chosen);
      const step = NUDGE * this.#stage.spacing;
      const place = this.#stage.inside([x + arrow[0] * step, y + arrow[1] * step]);
      void this.#put(this.#chosen, place, [x, y], this.#isPinned(this.#chosen));
    } else if (arrow) {
      this.#chosen = chosen ? this.#next(arrow) : this.#stage.nearestToMiddle();
      const state = this.#isPinned(this.#chosen) ? ', pinned' : '';
      this.#announce(`Point ${this.#chosen + 1} of ${count}${state}.`);
    } else if (event.key.toLowerCase() === 'p' && chosen) {
      void this.#toggle(this.#chosen);
    } else if ((event.key === 'Delete' || event.key === 'Backspace') && chosen) {
      const [x, y] = this.#position(this.#chosen);
      const radius = AROUND * this.#stage.spacing;
      if (this.#choosesRegion) this.#chooseRegion(false);
      void this.#redo(
        Array.from({ length: CORNERS }, (_, i) => {
          const angle = (2 * Math.PI * i) / CORNERS;
          return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
        }),
      );
    } else if (event.key === 'Escape' && chosen && !this.#drag && !this.#choosesRegion) {
      this.#chosen = -1;
    } else {
      return;
    }
    event.preventDefault();
    this.#stage.redraw();
  }

  /**
   * The nearest point that lies more that way than any other; the chosen one where there is none.
   *
   * @param {[number, number]} direction
   */
  #next([dx, dy]) {
    const { positions } = this.#stage;
    const [x, y] = this.#position(this.#chosen);
    let [best, least] = [this.#chosen, Number.POSITIVE_INFINITY];
    for (let i = 0; i < positions.length / 2; i++) {
      const [wayX, wayY] = [positions[2 * i] - x, positions[2 * i + 1] - y];
      const along = wayX * dx + wayY * dy;
      const across = Math.abs(wayX * dy - wayY * dx);
      if (i === this.#chosen || along <= 0 || along < across) continue;
      if (along + 2 * across < least) [best, least] = [i, along + 2 * across];
    }
    return best;
  }

  // -------------------------------------------------------------------------------------------- drawing

  /** @param {CanvasRenderingContext2D} context */
  #draw(context) {
    const stage = this.#stage;
    if (!stage.touchable) return;
    const accent = getComputedStyle(this.#canvas).getPropertyValue('--accent').trim();
    context.strokeStyle = accent;
    context.fillStyle = accent;
    const radius = stage.radius + 3;
    const circle = (/** @type {number} */ index, /** @type {number} */ r) => {
      const [x, y] = stage.drawnAt(index);
      context.beginPath();
      context.arc(x, y, r, 0, 2 * Math.PI);
    };
    context.lineWidth = 1.75;
    for (const index of stage.pinned) {
      circle(index, radius);
      context.stroke();
    }
    const shown = this.#drag?.index ?? this.#hovered;
    if (shown >= 0) {
      circle(shown, radius + 2);
      context.globalAlpha = 0.25;
      context.fill();
      context.globalAlpha = 1;
    }
    if (this.#chosen >= 0 && document.activeElement === this.#canvas) {
      context.setLineDash([3, 3]);
      circle(this.#chosen, radius + 4);
      context.stroke();
      context.setLineDash([]);
    }
    if (this.#lasso) {
      context.beginPath();
      for (const corner of this.#lasso) context.lineTo(...stage.toCanvas(corner));
      context.closePath();
      context.globalAlpha = 0.15;
      context.fill();
      context.globalAlpha = 1;
      context.setLineDash([5, 4]);
      context.stroke();
      context.setLineDash([]);
    }
  }
}
