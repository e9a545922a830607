// @ts-check
/** Opens links: the one in the address, now and whenever it changes, and one that the page around this one sends. */
import { element } from '../common/elements.js';
import { Refused, WorkerDied } from '../common/worker-link.js';
import { points } from '../common/words.js';
import { linkInAddress } from './address.js';
import { applyEmbedOptions, embedOptions } from './embed.js';
import { chooseExemplar } from './state.js';

/** @typedef {import('./opening.js').Parts} Parts */
/** @typedef {import('../common/messages.js').PatternView} PatternView */

export class Links {
  #parts;
  #stage;

  /**
   * @param {Parts} parts
   * @param {import('./stage.js').Stage} stage
   * @param {import('./share.js').Share} share
   * @param {boolean} embedded
   */
  constructor(parts, stage, share, embedded) {
    this.#parts = parts;
    this.#stage = stage;
    window.addEventListener('hashchange', () => {
      if (embedOptions(location).embed !== embedded) return location.reload();
      applyEmbedOptions();
      if (linkInAddress() === '') return;
      parts.notices.unnotify();
      void this.openAddress();
    });
    element('open-whole').addEventListener('click', (event) => {
      event.preventDefault();
      // Opened at once: later, a browser would take it for an unasked window.
      const tab = window.open('about:blank', '_blank');
      void share.write().then(
        ({ fragment }) => tab && (tab.location.href = `${location.origin}${location.pathname}#${fragment}`),
        (error) => {
          tab?.close();
          parts.notices.complain(error instanceof Error ? error.message : String(error));
        },
      );
    });
  }

  /**
   * Does what a link says. Whatever would take long waits for a person to start it.
   *
   * @param {string} fragment
   * @param {boolean} play
   */
  async open(fragment, play) {
    const { files, link, drawing, gallery, settings, running, store, notices } = this.#parts;
    const asked = await files.readLink(fragment);
    const { exemplar } = asked;
    const chosen = 'gallery' in exemplar ? this.#entry(exemplar.gallery) : this.#shared(exemplar.pattern);
    const { exemplar: shown } = await link.ask({ type: 'open', exemplar: chosen.source });
    drawing.leave();
    if (chosen.source.source === 'pattern') gallery.keepOwn(chosen, shown);
    chooseExemplar(store, chosen, shown.boundary);
    settings.apply(asked.method, asked.preset, asked.overrides);
    if (play && asked.cost.autoRun) {
      await running.begin(true);
      if (asked.notes.length > 0) notices.notify(asked.notes.map(({ text }) => text).join(' '));
      return;
    }
    running.wait(shown, asked);
    this.#showEmpty(shown);
  }

  /** @param {string} name @returns {import('./state.js').Chosen} */
  #entry(name) {
    return this.#parts.gallery.entry(name) ?? { title: name, caption: '', source: { source: 'gallery', name }, value: name };
  }

  /** @param {import('../common/messages.js').PatternData} pattern @returns {import('./state.js').Chosen} */
  #shared(pattern) {
    const caption = `From a link, ${points(pattern.classes.length)}.`;
    return { title: 'Shared pattern', caption, source: { source: 'pattern', name: 'Shared pattern', pattern }, value: 'own' };
  }

  /** The exemplar beside a result without points. @param {PatternView} exemplar */
  #showEmpty(exemplar) {
    this.#parts.chart.keep();
    const { factors: [x, y], boundary } = this.#parts.store.state.result ?? { factors: [1, 1], boundary: exemplar.boundary };
    const nothing = new Float32Array();
    const none = { positions: nothing, radii: nothing, scales: nothing, turns: nothing, depths: nothing };
    const noIds = { ids: new Uint32Array(), pinned: new Uint32Array(), classes: new Uint16Array() };
    this.#stage.show(exemplar, { ...exemplar, points: { ...none, ...noIds }, size: [exemplar.size[0] * x, exemplar.size[1] * y], boundary });
  }

  /** Opens the address's link; says why when it can't. @returns {Promise<boolean>} whether it did */
  async openAddress() {
    try {
      await this.open(linkInAddress(), true);
      return true;
    } catch (error) {
      if (!(error instanceof Refused || error instanceof WorkerDied)) throw error;
      this.#parts.notices.complainAbout('This link can’t be opened: ', error.message);
      return false;
    }
  }
}
