// @ts-check
/** The buttons of the run, how far it is, and what remains. */
import { element, input } from '../common/elements.js';
import { withhold } from '../common/withhold.js';
import { duration } from '../common/words.js';
import { methodOf } from './state.js';
import { lack } from './tools.js';

/** @typedef {import('./state.js').PageStore} PageStore */

/** What the large button does in every state of the run. */
const DOES = /** @type {const} */ ({ empty: 'play', paused: 'play', playing: 'pause', finished: 'again', stopped: 'again' });

export class Transport {
  #play = element('play');
  #label = element('play-label');
  #step = input('step');
  #goOn = input('go-on');
  #scale = element('fact-scale');
  #iteration = element('fact-iteration');
  #left = element('fact-left');
  #bar = element('progress');

  /**
   * @param {PageStore} store
   * @param {import('./running.js').Running} running
   */
  constructor(store, running) {
    this.#play.addEventListener('click', () => running.toggle());
    this.#step.addEventListener('click', () => void running.run.step());
    element('reset').addEventListener('click', () => void running.reset());
    this.#goOn.addEventListener('click', () => void running.begin(true, true));
    store.subscribe(
      (state) => [state.status, (state.progress?.totalIterations ?? 0) > 0],
      () => this.#showButtons(store.state),
    );
    // What is still playing goes on by itself.
    store.subscribe(({ status }) => status === 'finished' || status === 'paused', (can) => withhold(this.#goOn, 'status', can ? null : ''));
    store.subscribe(
      (state) => lack(methodOf(state, state.settings.method), 'continue'),
      (reason) => withhold(this.#goOn, 'method', reason),
    );
    store.subscribe(
      ({ progress, status, secondsLeft }) => [progress, status, secondsLeft],
      () => this.#showProgress(store.state),
    );
    store.subscribe(({ status }) => status, (status) => void (document.body.dataset.status = status));
  }

  /** @param {import('./state.js').State} state */
  #showButtons({ status, progress }) {
    const does = DOES[status];
    this.#play.dataset.does = does;
    const continues = (progress?.totalIterations ?? 0) > 0;
    this.#label.textContent = does === 'pause' ? 'Pause' : does === 'again' ? 'Run again' : continues ? 'Continue' : 'Run';
    this.#step.disabled = status === 'finished' || status === 'stopped' || status === 'empty';
  }

  /** @param {import('./state.js').State} state */
  #showProgress({ progress, status, secondsLeft, shown }) {
    if (!progress) {
      for (const fact of [this.#scale, this.#iteration, this.#left]) fact.textContent = '';
      this.#bar.replaceChildren();
      this.#bar.setAttribute('aria-valuenow', '0');
      this.#bar.removeAttribute('aria-valuetext');
      return;
    }
    const { class: klass, turn, classes, scale, scales, restart, restarts, redoing, iteration, iterations } = progress;
    const { totalIterations, done } = progress;
    const finished = status === 'finished';
    const part = classes > 1 ? `Class ${turn + 1} of ${classes} (${shown?.classNames[klass] ?? ''}) · ` : '';
    const again = redoing ? ' · Redoing a region' : restart > 0 ? ` · Another try at the worst regions, ${restart} of ${restarts}` : '';
    this.#scale.textContent = finished ? 'Finished' : `${part}Scale ${scale + 1} of ${scales}${again}`;
    this.#iteration.textContent = `Iteration ${totalIterations}`;
    this.#left.textContent = secondsLeft === null ? '' : `about ${duration(secondsLeft)} left`;
    if (this.#bar.children.length !== scales) {
      this.#bar.replaceChildren(
        ...Array.from({ length: scales }, () => {
          const segment = document.createElement('span');
          segment.append(document.createElement('i'));
          return segment;
        }),
      );
    }
    for (const [index, segment] of [...this.#bar.children].entries()) {
      const share = finished || index < scale ? 1 : index > scale ? 0 : iteration / Math.max(iterations, 1);
      /** @type {HTMLElement} */ (segment.firstChild).style.transform = `translateX(${101 * Math.min(share, 1) - 101}%)`;
    }
    this.#bar.setAttribute('aria-valuenow', String(Math.round(100 * (finished ? 1 : done))));
    this.#bar.setAttribute('aria-valuetext', progressInWords(progress, finished));
  }
}

/** @param {import('../common/messages.js').Progress} progress @param {boolean} finished */
export const progressInWords = ({ scale, scales, iteration, iterations }, finished) =>
  finished ? 'Finished' : `Scale ${scale + 1} of ${scales}, iteration ${iteration} of ${iterations}`;
