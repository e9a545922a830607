// @ts-check
/**
 * One run at a time, pulled from the worker in short batches. While nobody asks nothing moves, so pausing is not
 * asking. Every few seconds the state is saved, for the case that the worker dies.
 */
import { Refused, WorkerDied } from '../common/worker-link.js';

/** @typedef {import('../common/messages.js').Source} Source */
/** @typedef {import('../common/messages.js').BatchResponse} BatchResponse */
/** @typedef {import('../common/messages.js').StartedResponse} StartedResponse */
/** @typedef {{ source: Source, method: string, preset: string, overrides: Record<string, number | string> }} Plan */

/**
 * - `empty`: nothing started yet
 * - `paused`: can go on
 * - `playing`: going on
 * - `finished`: nothing left to do
 * - `stopped`: it failed, the worker or the arithmetic
 *
 * @typedef {'empty' | 'paused' | 'playing' | 'finished' | 'stopped'} Status
 */

/**
 * @typedef {object} Hooks
 * @property {(started: StartedResponse) => void} started
 * @property {(batch: BatchResponse) => void} batch
 * @property {(status: Status) => void} status
 * @property {(message: string, onward?: boolean) => void} refused `onward`: what was to go on from the points as they are
 * @property {(state: string) => void} saved the run as it is now, to continue from another time
 */

/** How long the worker works before it answers: short enough to look alive, long enough to waste little. */
const BUDGET_MS = 40;
/** The same while a device is being checked in between, which takes a hundred short turns. */
const SHARING_BUDGET_MS = 8;
const SAVE_EVERY_MS = 3000;

export class Run {
  /** @type {Status} */
  #status = 'empty';
  /** Counts runs, so that answers to an older one can be told apart. */
  #epoch = 0;
  /** Whether the worker has something else to do beside the run. */
  shares = false;
  /** The one loop that may ask for more; another object or null ends it. */
  #loop = /** @type {object | null} */ (null);
  #stepping = false;
  /** @type {{ epoch: number, state: string, iterations: number } | null} */
  #saved = null;
  #savedAt = 0;
  /** @type {Plan | null} */
  #plan = null;
  #link;
  #hooks;

  /**
   * @param {import('../common/worker-link.js').WorkerLink} link
   * @param {Hooks} hooks
   */
  constructor(link, hooks) {
    this.#link = link;
    this.#hooks = hooks;
  }

  get status() {
    return this.#status;
  }

  /** How many iterations the last saved state of this run holds; null when there is none. */
  get savedIterations() {
    return this.#saved?.epoch === this.#epoch ? this.#saved.iterations : null;
  }

  /** What the run was started with. */
  get plan() {
    return this.#plan;
  }

  /** There is no run any more. */
  clear() {
    this.#epoch++;
    this.#plan = null;
    this.#become('empty');
  }

  /** The run as it is now, to continue from another time. */
  async state() {
    return (await this.#link.ask({ type: 'save' })).state;
  }

  /** @param {Status} status */
  #become(status) {
    if (status !== 'playing') this.#loop = null;
    if (this.#status === status) return;
    this.#status = status;
    this.#hooks.status(status);
  }

  /**
   * Starts a run in place of the one before. If it is refused, the one before stays, and pauses.
   *
   * @param {Plan} plan
   * @param {boolean} play whether to go on by itself
   * @returns {Promise<boolean>} whether this run is now the one
   */
  async start(plan, play) {
    const before = this.#epoch;
    const epoch = ++this.#epoch;
    this.#loop = null;
    try {
      const { source, method, preset, overrides } = plan;
      const started = await this.#link.ask({ type: 'start', exemplar: source, method, preset, overrides });
      if (epoch !== this.#epoch) return false;
      this.#plan = plan;
      this.#adopt(started, play);
      return true;
    } catch (error) {
      if (epoch !== this.#epoch) return false;
      if (error instanceof Refused) {
        this.#epoch = before;
        if (this.#status === 'playing') this.#become('paused');
      }
      this.#fail(error);
      return false;
    }
  }

  /** The same run from its first iteration, paused. */
  reset() {
    return this.#plan ? this.start(this.#plan, false) : Promise.resolve(false);
  }

  /** The same run from its first iteration. */
  again() {
    return this.#plan ? this.start(this.#plan, true) : Promise.resolve(false);
  }

  /**
   * Goes on with other settings from the points as they are. If it is refused, the run stays as it is.
   *
   * @param {Plan} plan
   */
  async continueWith(plan) {
    const epoch = this.#epoch;
    this.#loop = null;
    const playing = this.#status === 'playing';
    try {
      const { method, preset, overrides } = plan;
      const started = await this.#link.ask({ type: 'continue', method, preset, overrides });
      if (epoch !== this.#epoch) return false;
      this.#epoch++;
      this.#plan = plan;
      this.#adopt(started, true);
      return true;
    } catch (error) {
      if (epoch !== this.#epoch) return false;
      if (!(error instanceof Refused)) {
        this.#fail(error);
        return false;
      }
      this.#hooks.refused(error.message, true);
      if (playing && this.#status === 'playing') {
        this.#become('paused');
        this.play();
      }
      return false;
    }
  }

  /**
   * Puts a hand on the result. A region to be done again sets a run going that was done.
   *
   * @param {import('../common/messages.js').TouchRequest | import('../common/messages.js').ResynthesizeRequest} request
   * @returns {Promise<boolean>} whether it was done
   */
  async touch(request) {
    const epoch = this.#epoch;
    try {
      const batch = await this.#link.ask(request);
      if (epoch !== this.#epoch) return false;
      if (this.#status === 'finished' && !batch.finished) this.#become('paused');
      this.#hooks.batch(batch);
      void this.#save();
      if (request.type === 'resynthesize') this.play();
      return true;
    } catch (error) {
      // The run goes on as it was.
      if (error instanceof Refused) this.#hooks.refused(error.message);
      else if (!(error instanceof WorkerDied)) throw error;
      return false;
    }
  }

  /** Continues from the last saved state, in a new worker if the old one died. */
  recover() {
    return this.#saved && this.#plan ? this.resume(this.#plan, this.#saved.state, true) : this.again();
  }

  /**
   * Continues a run that was saved.
   *
   * @param {Plan} plan what it was started with
   * @param {string} state
   * @param {boolean} play whether to go on by itself
   * @returns {Promise<boolean>} whether this run is now the one
   */
  async resume(plan, state, play) {
    const epoch = ++this.#epoch;
    this.#loop = null;
    try {
      const started = await this.#link.ask({ type: 'resume', state });
      if (epoch !== this.#epoch) return false;
      this.#plan = plan;
      this.#saved = { epoch, state, iterations: started.progress.totalIterations };
      this.#adopt(started, play);
      return true;
    } catch (error) {
      if (epoch === this.#epoch) this.#fail(error);
      return false;
    }
  }

  /**
   * @param {StartedResponse} started
   * @param {boolean} play
   */
  #adopt(started, play) {
    this.#hooks.started(started);
    this.#become('paused');
    void this.#save();
    if (play) this.play();
  }

  play() {
    if (this.#status !== 'paused') return;
    this.#become('playing');
    void this.#pull();
  }

  pause() {
    if (this.#status === 'playing') this.#become('paused');
  }

  async #pull() {
    const loop = {};
    this.#loop = loop;
    const epoch = this.#epoch;
    try {
      while (this.#loop === loop) {
        const budgetMs = this.shares ? SHARING_BUDGET_MS : BUDGET_MS;
        const batch = await this.#link.ask({ type: 'run', budgetMs, maxIterations: 1_000_000 });
        if (epoch !== this.#epoch) return;
        // Also after a pause: these iterations were done.
        this.#take(batch);
        if (this.#loop === loop && performance.now() - this.#savedAt > SAVE_EVERY_MS) await this.#save();
      }
      if (this.#status === 'paused') void this.#save();
    } catch (error) {
      if (epoch === this.#epoch) this.#fail(error);
    }
  }

  /** Exactly one iteration. */
  async step() {
    this.pause();
    if (this.#status !== 'paused' || this.#stepping) return;
    this.#stepping = true;
    const epoch = this.#epoch;
    try {
      // An iteration may take longer than a batch.
      for (let done = false; !done && epoch === this.#epoch; ) {
        const batch = await this.#link.ask({ type: 'run', budgetMs: BUDGET_MS, maxIterations: 1 });
        if (epoch !== this.#epoch) return;
        this.#take(batch);
        done = batch.finished || batch.events.some((event) => event.type === 'iterated');
      }
      if (this.#status === 'paused') void this.#save();
    } catch (error) {
      if (epoch === this.#epoch) this.#fail(error);
    } finally {
      this.#stepping = false;
    }
  }

  /** @param {BatchResponse} batch */
  #take(batch) {
    this.#hooks.batch(batch);
    if (batch.finished) {
      this.#become('finished');
      void this.#save();
    }
  }

  async #save() {
    const epoch = this.#epoch;
    this.#savedAt = performance.now();
    try {
      const { state, progress } = await this.#link.ask({ type: 'save' });
      if (epoch !== this.#epoch) return;
      this.#saved = { epoch, state, iterations: progress.totalIterations };
      this.#hooks.saved(state);
    } catch (error) {
      // The death of a worker is announced by the link; a refusal costs only the safety net.
      if (error instanceof Refused) console.warn(error.message);
    }
  }

  /** The output to the last digit. */
  async export() {
    return (await this.#link.ask({ type: 'export' })).pattern;
  }

  /** The worker is gone, and with it whatever it did after the last save. */
  workerDied() {
    this.#become('stopped');
  }

  /** @param {unknown} error */
  #fail(error) {
    if (error instanceof WorkerDied) return;
    this.#hooks.refused(error instanceof Error ? error.message : String(error));
    if (this.#status === 'playing') this.#become('stopped');
  }
}
