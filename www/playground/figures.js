// @ts-check
/** The words beside exemplar and result, also for those who can't see them. */
import { element } from '../common/elements.js';
import { points, times } from '../common/words.js';
import { progressInWords } from './transport.js';

/** @typedef {import('./state.js').PageStore} PageStore */

export class Figures {
  #title = element('exemplar-title');
  #caption = element('exemplar-caption');
  #exemplarCount = element('exemplar-count');
  #outputCount = element('output-count');

  /**
   * @param {PageStore} store
   * @param {import('./stage.js').Stage} stage
   */
  constructor(store, stage) {
    store.subscribe(({ exemplar }) => exemplar, ({ title, caption, points: count }) => {
      this.#title.textContent = title;
      this.#caption.textContent = caption;
      this.#exemplarCount.textContent = count === null ? '' : points(count);
      stage.label('exemplar', count === null ? 'The exemplar' : `The exemplar ${title}: ${points(count)}. ${caption}`);
    });
    store.subscribe(({ result, points: count }) => [result, count], () => {
      const { result, points: count } = store.state;
      this.#outputCount.textContent = result ? `${points(count)} · ${result.factors.map(times).join(' ')}` : '';
    });
    store.subscribe(
      ({ progress, status, showsKept, exemplar, points: count }) => [progress, status, showsKept, exemplar, count],
      () => {
        const { progress, status, showsKept, exemplar, points: count } = store.state;
        const result = progress
          ? `The result: ${points(count)} with the structure of ${exemplar.title}. ${progressInWords(progress, status === 'finished')}.`
          : 'The result';
        stage.label('output', showsKept ? 'A, the result that was kept.' : result);
      },
    );
  }

  /** How many points the result has, and how large it is. */
  get count() {
    return this.#outputCount.textContent ?? '';
  }
}
