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

/** The page is kept for when there is no network once it has settled. */
const KEEP_AFTER_MS = 1500;

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
      const hasLink = linkInAddress() !== '';
      this.#describe(await link.ask({ type: 'describe' }));
      // A link's exemplar may be one of the gallery's cards. Everybody else sees points move first.
      if (hasLink) await this.#askForGallery();
      if (!(await continued) && (!hasLink || !(await links.openAddress()))) {
        this.#forgetUnusable();
        await running.begin(true);
      }
      if (!hasLink) {
        await this.#firstMove();
        await this.#askForGallery();
      }
      store.update({ booted: true });
      host.listen();
      // Its forty files would come between the visitor and the first iterations.
      setTimeout(() => void keepForOffline(), KEEP_AFTER_MS);
    } catch (error) {
      if (!(error instanceof WorkerDied)) throw error;
    }
  }

  async #askForGallery() {
    const { entries } = await this.#parts.link.ask({ type: 'gallery' });
    this.#showGallery(entries);
  }

  /** Until the points have moved, or will not by themselves. @returns {Promise<void>} */
  #firstMove() {
    const { store } = this.#parts;
    const isOver = (/** @type {import('./state.js').State} */ { status, progress }) =>
      status !== 'playing' || (progress?.totalIterations ?? 0) > 0;
    if (isOver(store.state)) return Promise.resolve();
    return new Promise((resolve) => {
      const end = store.subscribe(isOver, (over) => {
        if (!over) return;
        queueMicrotask(() => end());
        resolve();
      });
    });
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
