// @ts-check
/** Opens points as the exemplar: files, projects, what the import hands over, what the page around this one sends. */
import { sourceOf } from '../common/pattern-source.js';
import { Refused, WorkerDied } from '../common/worker-link.js';
import { points } from '../common/words.js';
import { leaveLink } from './address.js';
import { capital } from './import/import.js';
import { chooseExemplar, fromFile } from './state.js';

/** @typedef {import('../common/messages.js').PatternData} PatternData */
/** @typedef {import('../common/files-messages.js').Project} Project */

/**
 * @typedef {object} Parts
 * @property {import('./state.js').PageStore} store
 * @property {import('./running.js').Running} running
 * @property {import('./gallery.js').Gallery} gallery
 * @property {import('./settings.js').Settings} settings
 * @property {import('./drawing.js').Drawing} drawing
 * @property {import('./notices.js').Notices} notices
 * @property {import('./loss-chart.js').LossChart} chart
 * @property {import('../common/files.js').Files} files
 * @property {import('../common/worker-link.js').WorkerLink} link
 */

export class Opening {
  #parts;

  /** @param {Parts} parts */
  constructor(parts) {
    this.#parts = parts;
  }

  /**
   * Opens points in any format the page reads, or a project, from the page around this one.
   *
   * @param {string} name
   * @param {Uint8Array} bytes
   * @param {boolean} play
   */
  async data(name, bytes, play) {
    const { pattern, preview, ...read } = await this.#parts.files.read(name, bytes);
    const project = read.type === 'read' ? read.project : null;
    if (project) return this.#project(project, pattern, preview, false);
    await this.#pattern(name, `From the page around this one, ${points(pattern.classes.length)}.`, pattern, preview, false);
    await this.#parts.running.begin(play);
  }

  /** @param {import('./import/import.js').Imported} imported */
  async imported({ name, pattern, preview, project }) {
    const { notices, gallery, running } = this.#parts;
    notices.unnotify();
    try {
      if (project) {
        await this.#project(project, pattern, preview, true);
        return;
      }
      const { value } = gallery.freeValue('own');
      await this.#pattern(name, `${capital(preview.format)}, ${points(preview.points)}.`, pattern, preview, true, value);
      leaveLink();
      await running.begin(true);
    } catch (error) {
      if (error instanceof Refused) notices.complain(error.message);
      else if (!(error instanceof WorkerDied)) throw error;
    }
  }

  /** The exemplar as a link holds it, so that whoever opens the link has the same run. @param {PatternData} pattern */
  async adopt(pattern) {
    const { chosen } = this.#parts.store.state;
    await this.#pattern(chosen.title, chosen.caption, pattern, chosen, chosen.isOwn ?? false);
    await this.#parts.running.begin(true);
  }

  /**
   * Makes a pattern the exemplar, without starting anything.
   *
   * @param {string} title
   * @param {string} caption
   * @param {PatternData} pattern
   * @param {import('./state.js').FromFile} file that it comes from
   * @param {boolean} isOwn whether the person gave it, not another page
   * @param {string} [value] of its card
   */
  async #pattern(title, caption, pattern, file, isOwn, value = 'own') {
    const { link, drawing, gallery, store } = this.#parts;
    /** @type {import('./state.js').Chosen} */
    const choice = { title, caption, source: sourceOf(pattern, title), isOwn, value, ...fromFile(file) };
    const { exemplar } = await link.ask({ type: 'open', exemplar: choice.source });
    drawing.leave();
    gallery.keepOwn(choice, exemplar);
    chooseExemplar(store, choice, exemplar.boundary);
  }

  /**
   * Goes on with a project, paused, where it was saved.
   *
   * @param {Project} project
   * @param {PatternData} pattern
   * @param {import('./state.js').FromFile} file
   * @param {boolean} isOwn
   */
  async #project({ title, method, preset, overrides, state }, pattern, file, isOwn) {
    const { settings, chart, running, notices } = this.#parts;
    await this.#pattern(title || 'Project', `From a project, ${points(pattern.classes.length)}.`, pattern, file, isOwn);
    settings.apply(method, preset, overrides);
    leaveLink();
    chart.keep();
    const plan = running.settingsPlan;
    if (state === null || plan === null) await running.begin(true);
    else if (await running.run.resume(plan, state, false)) notices.announce('The project goes on where it was saved.');
  }
}
