// @ts-check
/**
 * The statistics panel: how alike are exemplar and result, in curves, numbers and words.
 *
 * It asks the worker only while it is open, about once a second while the run plays, and so seldom that the run loses
 * less than a tenth of its time to it; after a pause, a step and at the end it asks at once.
 */
import { CurveChart, outline, peak } from '../common/curve-chart.js';
import { recall, remember } from '../common/memory.js';
import { Spectra } from './spectra.js';
import { Refused } from '../common/worker-link.js';

/** @typedef {import('../common/messages.js').AnalyzedResponse} Analyzed */

/** Name in the browser's storage. */
const OPEN_KEY = 'pointweave.statistics';
const ASK_EVERY_MS = 1000;
/** The run gets at least this many times as long as an answer took. */
const SHARE = 10;
/** From here on an independent sample is as good as a copy: a lattice. */
const COPY = 0.97;

/** @param {string} id */
const element = (id) => /** @type {HTMLElement} */ (document.getElementById(id));
/** @param {string} id */
const picture = (id) => /** @type {SVGSVGElement} */ (/** @type {unknown} */ (document.getElementById(id)));

/** Two digits, and no minus before a zero. @param {number} value */
const two = (value) => (Math.abs(value) < 0.005 ? 0 : value).toFixed(2).replace('-', '−');

export class Statistics {
  #panel = /** @type {HTMLDetailsElement} */ (element('statistics'));
  #pairs = new CurveChart(picture('pairs-chart'), { unit: 'd', chance: 1, least: 1.2 });
  #nearest = new CurveChart(picture('nearest-chart'), { unit: 'd', percent: true, least: 0.1 });
  #spectrum = new CurveChart(picture('spectrum-chart'), { unit: '/ d', chance: 1, least: 1.2 });
  #spectra = new Spectra();
  #link;
  #hooks;
  /** Whether the result has moved since the last question. */
  #stale = false;
  #asking = false;
  /** Not before this, while the run plays. */
  #notBefore = 0;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;
  /** @type {Analyzed | null} */
  #latest = null;
  #answers = 0;
  /** Whether the person has just opened it. */
  #opened = false;

  /**
   * @param {import('../common/worker-link.js').WorkerLink} link
   * @param {{ status: () => import('./run.js').Status, announce: (text: string) => void }} hooks
   */
  constructor(link, hooks) {
    this.#link = link;
    this.#hooks = hooks;
    this.#panel.open = recall(OPEN_KEY) === 'open';
    this.#panel.addEventListener('toggle', () => {
      remember(OPEN_KEY, this.#panel.open ? 'open' : 'closed');
      // What is still of this moment needs no new answer.
      if (this.#latest && !this.#stale) this.#reveal();
      this.#ask();
    });
    this.#panel.querySelector('summary')?.addEventListener('click', () => {
      // Scrolled to once its words are there and it has its height; what a visit begins with does not move the page.
      this.#opened = !this.#panel.open;
    });
  }

  /** The latest answer, and how many there were. */
  get state() {
    return { answers: this.#answers, latest: this.#latest };
  }

  #reveal() {
    if (!this.#opened) return;
    this.#opened = false;
    const calm = matchMedia('(prefers-reduced-motion: reduce)').matches;
    this.#panel.querySelector('.statistics-body')?.scrollIntoView({ block: 'nearest', behavior: calm ? 'auto' : 'smooth' });
  }

  /** Another run has begun. */
  restart() {
    this.#notBefore = 0;
    this.#panel.toggleAttribute('data-outdated', true);
    this.moved();
  }

  /** The points have moved. */
  moved() {
    this.#stale = true;
    this.#ask();
  }

  /** The run pauses, goes on or ends. */
  turned() {
    this.#ask();
  }

  #ask() {
    clearTimeout(this.#timer);
    const status = this.#hooks.status();
    if (!this.#panel.open || !this.#stale || this.#asking || status === 'empty' || status === 'stopped') return;
    const wait = status === 'playing' ? this.#notBefore - performance.now() : 0;
    if (wait > 0) {
      this.#timer = setTimeout(() => this.#ask(), wait);
      return;
    }
    this.#stale = false;
    this.#asking = true;
    void this.#answer().finally(() => {
      this.#asking = false;
      this.#ask();
    });
  }

  async #answer() {
    try {
      const answer = await this.#link.ask({ type: 'analyze' });
      this.#notBefore = performance.now() + Math.max(ASK_EVERY_MS, SHARE * answer.workMs);
      this.#latest = answer;
      this.#answers++;
      this.#show(answer);
    } catch (error) {
      // The death of a worker is announced by the link.
      if (!(error instanceof Refused)) return;
      this.#notBefore = performance.now() + ASK_EVERY_MS;
      this.#panel.toggleAttribute('data-outdated', true);
      element('verdict').textContent = error.message.charAt(0).toUpperCase() + error.message.slice(1) + '.';
    }
  }

  /** @param {Analyzed} answer */
  #show({ exemplar, output, periodogram, distance, interval, quality, verdict }) {
    this.#panel.toggleAttribute('data-outdated', false);
    element('verdict').textContent = verdict;
    this.#showQuality(quality);

    const pairs = [exemplar, output].map(({ pairCorrelation }) => ({ x: distance, y: pairCorrelation }));
    const [wanted, found] = pairs.map((curve) => peak(curve));
    this.#pairs.show(
      pairs[0],
      pairs[1],
      `Pair correlation: most neighbours at ${two(wanted.x)} mean spacings in the exemplar, ${two(wanted.y)} times chance; ` +
        `at ${two(found.x)} in the result, ${two(found.y)} times chance.`,
    );
    const shares = [exemplar, output].map(({ nearest }) => outline(nearest, interval));
    this.#nearest.show(
      shares[0],
      shares[1],
      `Nearest neighbours: on average at ${two(exemplar.spacing)} mean spacings in the exemplar and ${two(output.spacing)} in the result.`,
    );
    const spectra = [exemplar, output].map(({ frequency, power }) => ({ x: frequency, y: power }));
    const [strongest, own] = spectra.map((curve) => peak(curve));
    this.#spectrum.show(
      spectra[0],
      spectra[1],
      `Periodogram: strongest at ${two(strongest.x)} cycles per mean spacing in the exemplar, ${two(strongest.y)} times chance; ` +
        `at ${two(own.x)} in the result, ${two(own.y)} times chance.`,
    );
    this.#spectra.show(periodogram);
    element('rho-exemplar').textContent = exemplar.relativeRadius.toFixed(3);
    element('rho-output').textContent = output.relativeRadius.toFixed(3);
    this.#reveal();
    if (this.#hooks.status() === 'finished') this.#hooks.announce(`Finished. ${verdict}`);
  }

  /** @param {import('../common/messages.js').QualityView} quality */
  #showQuality({ score, arrangement, detail, variety, independent }) {
    const share = (/** @type {number} */ value) => `${100 * Math.min(Math.max(value, 0), 1)}%`;
    const random = independent < COPY;
    element('quality-score').textContent = two(score);
    element('quality-fill').style.width = share(score);
    const meter = element('quality-meter');
    meter.setAttribute('aria-valuenow', String(Math.min(Math.max(score, 0), 1)));
    meter.setAttribute(
      'aria-valuetext',
      `${two(score)}, where 0 is chance and 1 the exemplar tiled` +
        (random ? `; another sample of the same random process would get about ${two(independent)}` : ''),
    );
    const mark = element('quality-independent');
    mark.hidden = !random;
    mark.style.left = share(independent);
    // Its label stays within the meter.
    mark.dataset.side = independent < 0.3 ? 'right' : independent > 0.7 ? 'left' : 'middle';
    element('quality-independent-value').textContent = `another sample ≈ ${two(independent)}`;
    for (const [name, value] of Object.entries({ arrangement, detail, variety })) {
      element(`quality-${name}`).textContent = two(value);
      element(`quality-${name}-fill`).style.width = share(value);
    }
  }
}
