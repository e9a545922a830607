// @ts-check
/** Undo and redo: states that are never changed in place, each with the name of the act that led to it. */

/** Steps that can be undone. */
const STEPS = 200;

/** @template T */
export class History {
  /** @type {{ state: T, label: string, key: string | null }[]} */
  #entries;
  #index = 0;
  #steps;

  /**
   * @param {T} state what there is before anything is done
   * @param {number} [steps] how many acts can be undone
   */
  constructor(state, steps = STEPS) {
    this.#entries = [{ state, label: '', key: null }];
    this.#steps = steps;
  }

  get present() {
    return this.#entries[this.#index].state;
  }

  /** Whether anything was done and not undone. */
  get canUndo() {
    return this.#index > 0;
  }

  get canRedo() {
    return this.#index + 1 < this.#entries.length;
  }

  /**
   * Adds an act; what was undone before it can't be redone any more.
   *
   * @param {T} state
   * @param {string} label what was done, for people
   * @param {string | null} [key] acts of the same key in a row are one: the turns of a wheel, the steps of an arrow key
   */
  push(state, label, key = null) {
    const merges = key !== null && this.canUndo && !this.canRedo && this.#entries[this.#index].key === key;
    this.#entries.length = this.#index + (merges ? 0 : 1);
    this.#entries.push({ state, label, key });
    if (this.#entries.length > this.#steps + 1) this.#entries.shift();
    this.#index = this.#entries.length - 1;
  }

  /** Replaces the present without making a step of it, such as for a selection. @param {T} state */
  amend(state) {
    this.#entries[this.#index] = { ...this.#entries[this.#index], state };
  }

  /** Ends a row of acts of one key. */
  settle() {
    this.#entries[this.#index] = { ...this.#entries[this.#index], key: null };
  }

  /** @returns {string | null} what was undone */
  undo() {
    if (!this.canUndo) return null;
    const { label } = this.#entries[this.#index];
    this.#index--;
    this.settle();
    return label;
  }

  /** @returns {string | null} what was done again */
  redo() {
    if (!this.canRedo) return null;
    this.#index++;
    this.settle();
    return this.#entries[this.#index].label;
  }
}
