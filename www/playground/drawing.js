// @ts-check
/** Exemplars drawn here: hands them to the editor, takes them back, and keeps their cards. */
import { element } from '../common/elements.js';
import { blank, count } from '../common/pattern.js';
import { sourceOf, viewOf } from '../common/pattern-source.js';
import { Refused, WorkerDied } from '../common/worker-link.js';
import { points } from '../common/words.js';
import { leaveLink } from './address.js';
import { Editor } from './editor/editor.js';
import { chooseExemplar, fromFile } from './state.js';

/** @typedef {import('./state.js').PageStore} PageStore */
/** @typedef {import('./state.js').Chosen} Chosen */
/** @typedef {import('../common/pattern.js').Pattern} Pattern */

/**
 * The drawing under way: the card it has or will have, and what there was before it began.
 *
 * @typedef {{ value: string, title: string, isNew: boolean, woven: Pattern | null, file: import('./state.js').FromFile,
 *   before: Pick<import('./state.js').State, 'chosen' | 'settings'> }} Underway
 */

/** @param {Chosen} choice */
const isDrawing = ({ value }) => value.startsWith('drawing-');

export class Drawing {
  #store;
  #running;
  #gallery;
  #notices;
  #stage;
  #link;
  #editButton = element('edit');
  /** @readonly */
  editor = new Editor({ weave: (pattern) => this.#weave(pattern), closed: (kept) => this.#closed(kept) });
  /** @type {Underway | null} */
  #underway = null;

  /**
   * @param {PageStore} store
   * @param {import('./running.js').Running} running
   * @param {import('./gallery.js').Gallery} gallery
   * @param {import('./notices.js').Notices} notices
   * @param {import('./stage.js').Stage} stage
   * @param {import('../common/worker-link.js').WorkerLink} link
   */
  constructor(store, running, gallery, notices, stage, link) {
    this.#store = store;
    this.#running = running;
    this.#gallery = gallery;
    this.#notices = notices;
    this.#stage = stage;
    this.#link = link;
    element('draw-own').addEventListener('click', () => this.#draw(blank(), 'A new blank exemplar', {}));
    this.#editButton.addEventListener('click', () => {
      const { chosen } = this.#store.state;
      if (chosen.source.source === 'pattern') {
        const again = isDrawing(chosen);
        this.#draw(chosen.source.pattern, again ? `Editing ${chosen.title}` : `Editing a copy of ${chosen.title}`, chosen, again);
      } else {
        void this.#drawCopy();
      }
    });
  }

  /** Another exemplar takes the place of what is drawn, which keeps its card. */
  leave() {
    this.editor.close(true);
  }

  /**
   * @param {Pattern} pattern
   * @param {string} label what was done, for people
   * @param {import('./state.js').FromFile} file that the pattern comes from
   * @param {boolean} again whether it goes on with the drawing that is chosen
   */
  #draw(pattern, label, file, again = false) {
    if (!this.editor.isOpen) {
      const { chosen, settings } = this.#store.state;
      const { value, number } = this.#gallery.freeValue('drawing');
      this.#underway = {
        value: again ? chosen.value : value,
        title: again ? chosen.title : number === 1 ? 'Your drawing' : `Your drawing ${number}`,
        isNew: !again,
        woven: null,
        file: fromFile(file),
        before: { chosen, settings },
      };
    }
    this.editor.open(pattern, label);
    this.#stage.editing = true;
    this.editor.reveal();
  }

  /** The exemplar to the last digit is only the worker's to give. */
  async #drawCopy() {
    const { title, source } = this.#store.state.chosen;
    try {
      const { pattern } = await this.#link.ask({ type: 'open', exemplar: source });
      if (this.#store.state.chosen.source === source) this.#draw(pattern, `Editing a copy of ${title}`, {});
    } catch (error) {
      if (error instanceof Refused) this.#notices.complain(error.message);
      else if (!(error instanceof WorkerDied)) throw error;
    }
  }

  /** @param {Underway} underway @param {Pattern} pattern @returns {Chosen} */
  #keep({ title, value, file }, pattern) {
    /** @type {Chosen} */
    const choice = { title, caption: `Drawn here, ${points(count(pattern))}.`, source: sourceOf(pattern), isOwn: true, value, ...file };
    this.#gallery.keepOwn(choice, viewOf(pattern));
    return choice;
  }

  /** @param {Pattern} pattern */
  #weave(pattern) {
    if (!this.#underway) return;
    this.#notices.unnotify();
    leaveLink();
    const { shown } = this.#store.state;
    const chosen = this.#keep(this.#underway, pattern);
    // The border is the drawing's, but also the person's to change while the drawing keeps its own.
    if (pattern.boundary !== (this.#underway.woven ?? shown)?.boundary) chooseExemplar(this.#store, chosen, pattern.boundary);
    else this.#store.update({ chosen });
    this.#underway.woven = pattern;
    void this.#running.begin(true);
  }

  /** @param {boolean} kept */
  #closed(kept) {
    this.#stage.editing = false;
    const underway = this.#underway;
    if (!underway) return;
    if (kept) {
      // Another exemplar was chosen before the latest strokes were woven.
      const { pattern, isChanged } = this.editor;
      if (isChanged && pattern !== underway.woven && count(pattern) > 0) this.#keep(underway, pattern);
    } else {
      this.#discard(underway);
    }
    this.#editButton.focus();
  }

  /** Goes back to what there was before. @param {Underway} underway */
  #discard(underway) {
    const { before: { chosen, settings }, value, isNew, woven } = underway;
    if (isNew) this.#gallery.remove(value);
    else if (chosen.source.source === 'pattern') this.#gallery.keepOwn({ ...chosen, value }, viewOf(chosen.source.pattern));
    const { boundary, beyond } = settings;
    this.#store.update({ chosen, settings: { ...this.#store.state.settings, boundary, knowsBoundary: true, beyond } });
    if (woven) void this.#running.begin(true);
    if (!this.editor.isChanged) return;
    this.#notices.notify('The drawing was discarded.', {
      label: 'Bring it back',
      act: () => {
        this.#stage.editing = true;
        underway.woven = null;
        this.editor.reopen();
      },
    });
  }
}
