// @ts-check
/** The start of the page: what the worker says of itself, the gallery, and what a visit begins with. */
import { keepForOffline } from '../common/offline.js';
import { WorkerDied } from '../common/worker-link.js';
import { linkInAddress } from './address.js';
import { FIRST_EXEMPLAR, FIRST_SETTINGS, chooseExemplar } from './state.js';

/**
 * @typedef {object} Others
 * @property {import('./engine.js').Engine} engine
 * @property {import('./look.js').Look} look
 * @property {import('./links.js').Links} links
 * @property {import('./session-view.js').SessionView} tab
 * @property {import('./embed.js').Host} host
 */

export class Start {
  #parts;
  #others;

  /**
   * @param {import('./opening.js').Parts} parts
   * @param {Others} others
   */
  constructor(parts, others) {
    this.#parts = parts;
    this.#others = others;
  }

  /** Begins with what this tab did before, a link, or the first exemplar. Once more after a worker that could not start. */
  async boot() {
    const { store, link, running } = this.#parts;
    const { links, tab, host } = this.#others;
    try {
      const continued = tab.resume();
      await Promise.all([
        link.ask({ type: 'describe' }).then((description) => this.#describe(description)),
        link.ask({ type: 'gallery' }).then(({ entries }) => this.#showGallery(entries)),
      ]);
      store.update({ booted: true });
      void keepForOffline();
      if (!(await continued) && (linkInAddress() === '' || !(await links.openAddress()))) {
        this.#forgetUnusable();
        await running.begin(true);
      }
      host.listen();
    } catch (error) {
      if (!(error instanceof WorkerDied)) throw error;
    }
  }

  /** @param {import('../common/messages.js').DescriptionResponse} description */
  #describe(description) {
    this.#others.engine.describe(description.engine);
    this.#others.look.learn(description.glyphs);
    this.#parts.store.update({ description });
  }

  /** @param {import('../common/messages.js').GalleryEntryView[]} entries */
  #showGallery(entries) {
    const { store, gallery } = this.#parts;
    gallery.show(entries);
    const { chosen: { source }, exemplar, settings } = store.state;
    const entry = source.source === 'gallery' ? gallery.entry(source.name) : null;
    if (!entry) return;
    store.update({ chosen: entry, exemplar: { ...exemplar, title: entry.title, caption: entry.caption } });
    const boundary = entries.find(({ name }) => name === source.name)?.pattern.boundary;
    if (boundary && !settings.knowsBoundary) chooseExemplar(store, entry, boundary);
  }

  /** What was kept of this tab and can't be used any more makes room for what a visit begins with. */
  #forgetUnusable() {
    const { store, gallery, notices } = this.#parts;
    const first = gallery.entry(FIRST_EXEMPLAR.value) ?? FIRST_EXEMPLAR;
    if (store.state.status !== 'empty' || store.state.chosen === first) return;
    notices.unnotify();
    store.update({ chosen: first, settings: FIRST_SETTINGS });
  }
}
