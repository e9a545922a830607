// @ts-check
/**
 * The result kept as A beside the one at hand, B, or in its place: what differs between their parameters, and how good
 * each is.
 */
import { Refused, WorkerDied } from '../common/worker-link.js';

/** @typedef {import('../common/messages.js').Parameters} Parameters */

/** @typedef {import('../common/messages.js').Source} Source */

/** So many differences are named; the rest are in the title. */
const NAMED = 4;

/** @param {string} id */
const element = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

/**
 * A built-in exemplar is the same by its name, any other by what it holds.
 *
 * @param {Source | null} a
 * @param {Source} b
 */
const isSame = (a, b) => a === b || (a?.source === 'gallery' && b.source === 'gallery' && a.name === b.name);

export class Compare {
  #stage;
  #link;
  #hooks;
  #letters = element('letters');
  #comparison = element('comparison');
  /** @type {Parameters | null} */
  #kept = null;
  /** @type {Parameters | null} */
  #present = null;
  /** What the results are made from; an A of another exemplar says nothing. */
  #source = /** @type {Source | null} */ (null);

  /**
   * @param {import('./stage.js').Stage} stage
   * @param {import('../common/worker-link.js').WorkerLink} link
   * @param {{ announce: (text: string) => void, turned: () => void, count: () => string }} hooks `turned`: from one result to the
   *   other; `count`: how large the result at hand is, in words
   */
  constructor(stage, link, hooks) {
    this.#stage = stage;
    this.#link = link;
    this.#hooks = hooks;
    stage.leaveRoomFor(this.#comparison);
    element('keep-a').addEventListener('click', () => void this.#keep());
    element('drop-a').addEventListener('click', () => this.#drop());
    this.#letters.addEventListener('change', (event) => {
      const showsA = /** @type {HTMLInputElement} */ (event.target).value === 'a';
      this.#turn(showsA);
      this.#hooks.announce(showsA ? 'This is A, as it was kept.' : 'This is B, the result at hand.');
    });
  }

  /** @param {boolean} showsA whether the result kept is shown, in the place of the one at hand */
  #turn(showsA) {
    for (const letter of this.#letters.querySelectorAll('input')) letter.checked = (letter.value === 'a') === showsA;
    if (this.#stage.showsKept === showsA) return;
    this.#stage.showsKept = showsA;
    this.#hooks.turned();
  }

  /**
   * Another run is shown.
   *
   * @param {Parameters} parameters
   * @param {Source} source
   */
  started(parameters, source) {
    if (!isSame(this.#source, source)) this.#drop();
    this.#turn(false);
    this.#source = source;
    this.#present = parameters;
    element('quality-b').textContent = '';
    this.#describe();
  }

  /** The run at hand is done. */
  finished() {
    if (this.#kept) void this.#judge('quality-b', 'B');
  }

  async #keep() {
    if (!this.#present) return;
    this.#kept = this.#present;
    this.#turn(false);
    this.#stage.keep();
    element('kept-count').textContent = this.#hooks.count();
    this.#comparison.hidden = false;
    this.#letters.hidden = false;
    element('quality-b').textContent = '';
    this.#describe();
    this.#hooks.announce('Kept as A. Change a setting: the next result is B.');
    await this.#judge('quality-a', 'A');
  }

  #drop() {
    this.#kept = null;
    this.#turn(false);
    this.#stage.unkeep();
    this.#comparison.hidden = true;
    this.#letters.hidden = true;
    element('quality-a').textContent = element('quality-b').textContent = '';
  }

  /**
   * @param {string} id
   * @param {string} letter
   */
  async #judge(id, letter) {
    try {
      const { quality, iterations } = await this.#link.ask({ type: 'analyze' });
      element(id).textContent = `Quality of ${letter}: ${quality.score.toFixed(2)}.`;
      element(id).title = `After ${iterations} iterations`;
    } catch (error) {
      if (error instanceof Refused) element(id).textContent = '';
      else if (!(error instanceof WorkerDied)) throw error;
    }
  }

  #describe() {
    const [a, b] = [this.#kept, this.#present];
    if (!a || !b) return;
    const names = [...new Set([...Object.keys(a), ...Object.keys(b)])].filter((name) => a[name] !== b[name]);
    const differences = names.map((name) => `${name} ${a[name]} → ${b[name]}`);
    const rest = differences.length - NAMED;
    const seed = a.seed === b.seed ? `Same seed, ${a.seed}. ` : '';
    const words = differences.length === 0
      ? 'No parameter differs yet.'
      : `A → B: ${differences.slice(0, NAMED).join(', ')}${rest > 0 ? ` and ${rest} more` : ''}.`;
    element('differences').textContent = seed + words;
    element('differences').title = differences.join('\n');
  }
}
