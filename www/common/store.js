// @ts-check
/**
 * A state in one place. It is never changed but replaced member by member, so a view that remembers what it has seen knows
 * whether there is something new for it.
 */

/** @template T @typedef {{ select: (state: T) => unknown, view: (value: any) => void, seen: unknown }} Subscription */

/**
 * Lists are the same when their items are, so that a selector can pick several members.
 *
 * @param {unknown} a
 * @param {unknown} b
 */
function isSame(a, b) {
  if (!Array.isArray(a) || !Array.isArray(b)) return Object.is(a, b);
  return a.length === b.length && a.every((item, index) => Object.is(item, b[index]));
}

/** @template {object} T */
export class Store {
  /** @type {T} */
  #state;
  /** @type {Set<Subscription<T>>} */
  #subscriptions = new Set();

  /** @param {T} state to begin with */
  constructor(state) {
    this.#state = state;
  }

  /** @returns {Readonly<T>} */
  get state() {
    return this.#state;
  }

  /**
   * Replaces members. Every view that looks at one of them is called before this returns, in the order of subscription; a view may
   * update the state in turn, and no view is shown a state that is already replaced.
   *
   * @param {Partial<T>} patch
   */
  update(patch) {
    this.#state = { ...this.#state, ...patch };
    for (const subscription of [...this.#subscriptions]) {
      const value = subscription.select(this.#state);
      if (!this.#subscriptions.has(subscription) || isSame(value, subscription.seen)) continue;
      subscription.seen = value;
      subscription.view(value);
    }
  }

  /**
   * Calls a view now and whenever what it looks at is another value.
   *
   * @template V
   * @param {(state: Readonly<T>) => V} select a value, or a list of several
   * @param {(value: V) => void} view
   * @returns {() => void} ends it
   */
  subscribe(select, view) {
    const subscription = { select, view, seen: /** @type {unknown} */ (select(this.#state)) };
    this.#subscriptions.add(subscription);
    view(/** @type {V} */ (subscription.seen));
    return () => void this.#subscriptions.delete(subscription);
  }
}
