// @ts-check
/**
 * What computes: the person's choice, what came of it, and the places of the page that say so.
 *
 * The worker begins on the processor and is told the choice once a run has started, so that no device delays the
 * first picture. A new worker has to be told again.
 */
import { recall, remember } from '../common/memory.js';
import { withhold } from '../common/withhold.js';
import { rate } from '../common/words.js';

/** @typedef {import('../common/messages.js').EngineChoice} EngineChoice */
/** @typedef {import('../common/messages.js').EngineView} EngineView */

const CHOICES = /** @type {const} */ (['auto', 'gpu', 'cpu']);
/** Names in the browser's storage. */
const CHOICE_KEY = 'pointweave.engine';
const DISMISSED_KEY = 'pointweave.dismissed';

/** @param {string | null} text */
const asChoice = (text) => CHOICES.find((choice) => choice === text) ?? null;

/** @param {string} id */
const element = (id) => /** @type {HTMLElement} */ (document.getElementById(id));

export class Engine {
  /** @type {EngineChoice} */
  #choice;
  /** Whether the worker at hand knows the choice. */
  #told = false;
  /** The latest question that has no answer yet. */
  #asking = /** @type {object | null} */ (null);
  /** Workers that died on the GPU since the person chose. */
  #deaths = 0;
  /** @type {EngineView | null} */
  #cpu = null;
  /** @type {EngineView | null} */
  #view = null;
  #link;
  #hooks;

  /**
   * @param {import('../common/worker-link.js').WorkerLink} link
   * @param {{ announce: (text: string) => void, checks: (checks: boolean) => void, shows: (view: EngineView) => void }} hooks
   *   `checks` hears when the worker begins and ends to open a device, `shows` what computes now
   */
  constructor(link, hooks) {
    this.#link = link;
    this.#hooks = hooks;
    const wanted = asChoice(new URLSearchParams(location.search).get('engine'));
    this.#choice = wanted ?? asChoice(recall(CHOICE_KEY)) ?? 'auto';
    this.#check(this.#choice);
    for (const choice of CHOICES) this.#radio(choice).addEventListener('change', () => this.#choose(choice));
    element('engine-note-close').addEventListener('click', () => this.#dismiss());
  }

  /** @param {EngineChoice} choice */
  #radio(choice) {
    return /** @type {HTMLInputElement} */ (document.querySelector(`input[name="engine"][value="${choice}"]`));
  }

  /** @param {EngineChoice} choice */
  #check(choice) {
    const input = this.#radio(choice);
    if (input.disabled) this.#check('auto');
    else input.checked = true;
  }

  /** The person chose. @param {EngineChoice} choice */
  #choose(choice) {
    this.#choice = choice;
    this.#deaths = 0;
    remember(CHOICE_KEY, choice);
    // The newest word counts, also after a reload.
    const address = new URL(location.href);
    if (address.searchParams.has('engine')) {
      address.searchParams.delete('engine');
      history.replaceState(history.state, '', address);
    }
    void this.#tell(false);
  }

  /** What a worker begins with. @param {EngineView} view */
  describe(view) {
    this.#cpu = view;
    if (!this.#view) this.#show(view);
  }

  /** Tells the worker the choice if it does not know yet. */
  ensure() {
    if (!this.#told) void this.#tell(true);
  }

  /** @param {boolean} unasked whether nobody pressed anything */
  async #tell(unasked) {
    this.#told = true;
    const question = {};
    this.#asking = question;
    this.#checks(this.#choice !== 'cpu');
    try {
      const { engine, note, adapter } = await this.#link.ask({ type: 'engine', choice: this.#choice });
      if (this.#asking !== question) return;
      if (!adapter) this.#disable();
      // Without any GPU the words below the switch say all.
      this.change(engine, !adapter && this.#choice === 'auto' ? null : note, unasked);
    } catch {
      // Another choice came after it, or the worker died; both say so themselves.
    } finally {
      if (this.#asking === question) {
        this.#asking = null;
        this.#checks(false);
      }
    }
  }

  /** @param {boolean} checks */
  #checks(checks) {
    element('engine-line').toggleAttribute('data-checks', checks);
    this.#hooks.checks(checks);
  }

  /** There is no GPU to choose. */
  #disable() {
    withhold(this.#radio('gpu'), 'engine', '');
    element('engine-reason').textContent = isSecureContext
      ? 'This browser offers no WebGPU here, so there is no GPU to choose.'
      : 'WebGPU needs a secure address (https), so there is no GPU to choose.';
    this.#check(this.#choice);
  }

  /** There is no GPU to choose for the method. @param {string | null} reason null where there is */
  withholdGpu(reason) {
    withhold(this.#radio('gpu'), 'method', reason);
    this.#check(this.#choice);
  }

  /**
   * Something else may compute now.
   *
   * @param {EngineView} view
   * @param {string | null} note why, in one sentence
   * @param {boolean} [unasked] whether nobody pressed anything: what was dismissed then is not said again
   */
  change(view, note, unasked = false) {
    const changed = this.#view && this.#view.name !== view.name;
    this.#show(view);
    if (note && !(unasked && note === recall(DISMISSED_KEY))) this.#say(note, unasked);
    else if (!note) this.#unsay();
    if (changed && !note) this.#hooks.announce(`Now computing on ${view.gpu ? 'the GPU' : 'the processor'}: ${view.name}.`);
  }

  /** @param {EngineView} view */
  #show(view) {
    this.#view = view;
    this.#hooks.shows(view);
    element('engine').textContent = view.gpu ? `${view.name} · WebGPU` : view.name;
    element('engine').title = view.meaning;
    element('engine-line').toggleAttribute('data-gpu', view.gpu);
  }

  /** @param {number | null} perSecond */
  set speed(perSecond) {
    element('fact-rate').textContent = perSecond ? rate(perSecond) : '';
  }

  /** @param {string} note @param {boolean} unasked */
  #say(note, unasked) {
    const box = element('engine-note');
    box.toggleAttribute('data-unasked', unasked);
    element('engine-note-text').textContent = note;
    element('engine-note-close').hidden = false;
  }

  #unsay() {
    element('engine-note-text').textContent = '';
    element('engine-note-close').hidden = true;
  }

  #dismiss() {
    if (element('engine-note').hasAttribute('data-unasked')) {
      remember(DISMISSED_KEY, element('engine-note-text').textContent ?? '');
    }
    this.#unsay();
  }

  /** The next worker begins on the processor. What dies twice on a GPU, or while it is tried, stays there. */
  workerDied() {
    const tried = this.#asking !== null && this.#choice !== 'cpu';
    if (this.#view?.gpu) this.#deaths++;
    this.#asking = null;
    this.#checks(false);
    const distrusted = tried || this.#deaths > 1;
    this.#told = distrusted;
    if (!this.#cpu) return;
    if (distrusted) {
      this.change(this.#cpu, 'The computation stopped on the GPU, so the processor computes until you choose an engine or reload.');
    } else {
      this.#show(this.#cpu);
    }
  }
}
