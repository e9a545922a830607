// @ts-check
/** Starts, pauses and changes the run, and puts what it answers into the state. */
import { duration, points } from '../common/words.js';
import { leaveLink, replaced } from './address.js';
import { Run } from './run.js';
import { currentPlan, methodOf, seedOf, settingsPlan } from './state.js';
import { lack } from './tools.js';

/** @typedef {import('./state.js').PageStore} PageStore */
/** @typedef {import('../common/messages.js').PatternView} PatternView */
/** @typedef {import('../common/messages.js').StartedResponse} StartedResponse */
/** @typedef {import('../common/messages.js').BatchResponse} BatchResponse */

/**
 * @typedef {object} Hooks
 * @property {(started: StartedResponse) => void} started another run is to be shown; the state still is that of the one before
 * @property {(batch: BatchResponse) => void} batch
 * @property {(state: string) => void} saved
 */

/** A slider in motion starts one run, not thirty. */
const SETTLE_MS = 180;
const LARGEST_SEED = Number.MAX_SAFE_INTEGER;

export class Running {
  #store;
  #notices;
  #hooks;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #settling;
  /** @readonly */
  run;

  /**
   * @param {PageStore} store
   * @param {import('../common/worker-link.js').WorkerLink} link
   * @param {import('./notices.js').Notices} notices
   * @param {Hooks} hooks
   */
  constructor(store, link, notices, hooks) {
    this.#store = store;
    this.#notices = notices;
    this.#hooks = hooks;
    this.run = new Run(link, {
      started: (started) => this.#started(started),
      batch: (batch) => this.#batch(batch),
      status: (status) => this.#store.update({ status, ...(status !== 'playing' && { iterationsPerSecond: null, secondsLeft: null }) }),
      refused: (message, onward) =>
        this.#notices.complain(message, onward ? { label: 'Start anew', act: () => void this.begin(true) } : undefined),
      saved: hooks.saved,
    });
  }

  /** What the settings say, and what a test replaces of it; null when the seed is none. */
  get settingsPlan() {
    const seed = seedOf(this.#store.state.settings);
    if (seed === null) return null;
    const plan = settingsPlan(this.#store.state, seed);
    return { ...plan, overrides: { ...plan.overrides, ...replaced } };
  }

  /** The run at hand with all its parameters, as links keep it; null when there is none. */
  get currentPlan() {
    return currentPlan(this.#store.state);
  }

  /**
   * Starts a run with the settings as they are.
   *
   * @param {boolean} play
   * @param {boolean} [onward] from the points as they are
   */
  begin(play, onward = false) {
    clearTimeout(this.#settling);
    const plan = this.settingsPlan;
    if (plan === null) {
      this.#notices.complain(`the seed must be a whole number between 0 and ${LARGEST_SEED}`);
      return Promise.resolve(false);
    }
    return onward ? this.run.continueWith(plan) : this.run.start(plan, play);
  }

  /** @param {boolean} [mayKeep] whether the points may be kept */
  beginSoon(mayKeep = true) {
    clearTimeout(this.#settling);
    this.#settling = setTimeout(() => {
      this.#notices.unnotify();
      leaveLink();
      const { settings, status } = this.#store.state;
      const keeps = settings.keepsPoints && lack(methodOf(this.#store.state, settings.method), 'continue') === null;
      void this.begin(true, mayKeep && keeps && status !== 'empty' && status !== 'stopped');
    }, SETTLE_MS);
  }

  toggle() {
    const { status, booted } = this.#store.state;
    if (status === 'playing') this.run.pause();
    else if (status === 'paused') this.run.play();
    else if (status === 'finished' || status === 'stopped') void this.run.again();
    else if (booted) {
      // A link that waited for this.
      this.#notices.unnotify();
      void this.begin(true);
    }
  }

  reset() {
    return this.run.reset();
  }

  /**
   * Shows an exemplar whose run would take long, and waits for a person to start it.
   *
   * @param {PatternView} exemplar
   * @param {import('../common/files-messages.js').LinkReadResponse} asked
   */
  wait(exemplar, { parameters, notes, cost }) {
    this.run.clear();
    const { title, caption } = this.#store.state.chosen;
    this.#store.update({
      progress: null,
      plan: null,
      parameters: null,
      exemplar: { title, caption, points: exemplar.points.classes.length },
      result: {
        factors: [Number(parameters['expansion-x']), Number(parameters['expansion-y'])],
        boundary: parameters['boundary'] === 'periodic' ? 'periodic' : 'open',
      },
      points: cost.points,
    });
    const words = `This link asks for ${points(cost.points)}; on the processor that takes about ${duration(cost.seconds)}.`;
    this.#notices.notify([...notes.map(({ text }) => text), words].join(' '), { label: 'Run', act: () => void this.begin(true) });
    this.#notices.announce(words);
  }

  /** The worker is gone. @param {string} reason */
  workerDied(reason) {
    this.run.workerDied();
    const saved = this.run.savedIterations;
    if (saved === null) {
      this.#notices.notify(`The computation stopped unexpectedly (${reason}).`, { label: 'Start again', act: () => void this.begin(true) });
    } else {
      this.#notices.notify(`The computation stopped unexpectedly (${reason}). Its state after iteration ${saved} is safe.`, {
        label: saved === 0 ? 'Start again' : `Continue from iteration ${saved}`,
        act: () => void this.run.recover(),
      });
    }
  }

  /** @param {StartedResponse} started */
  #started(started) {
    this.#hooks.started(started);
    const { exemplar, output, parameters, progress } = started;
    const { chosen: { title, caption }, settings } = this.#store.state;
    this.#store.update({
      // The worker has decided what nobody had said.
      ...(!settings.knowsBoundary && { settings: { ...settings, boundary: output.boundary, knowsBoundary: true } }),
      plan: this.run.plan,
      parameters,
      progress,
      iterationsPerSecond: null,
      secondsLeft: null,
      shown: exemplar,
      exemplar: { title, caption, points: exemplar.points.classes.length },
      result: { factors: [Number(parameters['expansion-x']), Number(parameters['expansion-y'])], boundary: output.boundary },
      points: output.points.classes.length,
    });
  }

  /** @param {BatchResponse} batch */
  #batch(batch) {
    const scaleBefore = this.#store.state.progress?.scale;
    const { progress, iterationsPerSecond, secondsLeft, points: moved } = batch;
    this.#hooks.batch(batch);
    const plays = this.#store.state.status === 'playing';
    this.#store.update({
      progress,
      iterationsPerSecond: plays ? iterationsPerSecond : null,
      secondsLeft: plays ? secondsLeft : null,
      ...(moved && { points: moved.classes.length }),
    });
    if (progress.scale !== scaleBefore) this.#notices.announce(`Scale ${progress.scale + 1} of ${progress.scales} has begun.`);
  }
}
