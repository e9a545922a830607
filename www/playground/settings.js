// @ts-check
/** The form of the settings: its controls follow the state, and what a person changes goes there and starts a run. */
import { element, input } from '../common/elements.js';
import { withhold } from '../common/withhold.js';
import { times } from '../common/words.js';
import { Advanced } from './advanced.js';
import { Methods } from './methods.js';
import { advancedOf, changeSettings, methodOf, seedOf, sharedOf, without } from './state.js';
import { lack } from './tools.js';

/** @typedef {import('./state.js').PageStore} PageStore */
/** @typedef {import('./state.js').Settings} Values */
/** @typedef {import('../common/messages.js').MethodView} MethodView */
/** @typedef {import('../common/messages.js').Parameters} Parameters */

export class Settings {
  #store;
  #changed;
  #form = /** @type {HTMLFormElement} */ (element('settings'));
  #sliders = [input('expansion-x'), input('expansion-y')];
  #sizes = [element('expansion-x-value'), element('expansion-y-value')];
  #linked = input('linked');
  #seed = input('seed');
  #keepsPoints = input('keep-points');
  #tiles = input('tiles');
  #presets = element('presets');
  #presetHint = element('hint-preset');
  #beyond = element('beyond');
  #beyondText = element('beyond-text');
  #advanced;
  #methods;

  /**
   * @param {PageStore} store
   * @param {() => void} changed a run with these settings is wanted
   */
  constructor(store, changed) {
    this.#store = store;
    this.#changed = changed;
    this.#methods = new Methods(element('methods').closest('fieldset') ?? this.#form, { chosen: (method) => this.#chooseMethod(method) });
    this.#advanced = new Advanced(element('advanced'), {
      changed: (overrides) => this.#change({ beyond: { ...sharedOf(this.#values), ...overrides } }),
    });
    this.#follow();
    this.#listen();
  }

  get #values() {
    return this.#store.state.settings;
  }

  /** @param {string} name @param {string} value @returns {HTMLInputElement | null} */
  #radio(name, value) {
    return this.#form.querySelector(`input[name="${name}"][value="${CSS.escape(value)}"]`);
  }

  /** @param {string} name @param {string} value */
  #check(name, value) {
    const radio = this.#radio(name, value);
    if (radio) radio.checked = true;
  }

  /** The controls show what the state says. */
  #follow() {
    const store = this.#store;
    store.subscribe((state) => methodOf(state, state.settings.method), (method) => method && this.#showMethod(method));
    store.subscribe(({ description, settings }) => [description, settings.method], () => {
      const { description, settings } = store.state;
      if (description) this.#methods.describe(description.methods, settings.method);
    });
    store.subscribe(({ settings }) => settings.preset, (preset) => this.#check('preset', preset));
    store.subscribe(({ settings, plan, parameters, description }) => [description, settings.method, settings.preset, plan, parameters], () => {
      const { settings: { method, preset }, plan, parameters } = store.state;
      const view = methodOf(store.state, method);
      // An exemplar may suit other values than the preset's; only a run of the same preset can tell, and not of what was set.
      const suited = parameters && plan?.method === method && plan.preset === preset ? without(parameters, ...Object.keys(plan.overrides)) : {};
      if (view) this.#advanced.describe(view, preset, suited);
    });
    store.subscribe(({ settings }) => settings.beyond, () => this.#showBeyond());
    store.subscribe(({ settings: { expansion, beyond } }) => [expansion, beyond], () => {
      const { expansion, beyond } = this.#values;
      for (const [axis, slider] of this.#sliders.entries()) {
        slider.value = String(expansion[axis]);
        this.#sizes[axis].textContent = times(Number(beyond[slider.id] ?? expansion[axis]));
      }
    });
    store.subscribe(({ settings }) => settings.linked, (linked) => void (this.#linked.checked = linked));
    store.subscribe(({ settings }) => settings.boundary, (boundary) => {
      this.#check('boundary', boundary);
      // Only a result that tiles can be shown as tiles.
      element('tiles-row').hidden = boundary !== 'periodic';
    });
    store.subscribe(({ settings }) => settings.tiles, (tiles) => void (this.#tiles.checked = tiles));
    store.subscribe(({ settings }) => settings.keepsPoints, (keeps) => void (this.#keepsPoints.checked = keeps));
    store.subscribe(
      (state) => lack(methodOf(state, state.settings.method), 'continue'),
      (reason) => withhold(this.#keepsPoints, 'method', reason),
    );
    store.subscribe(({ settings }) => settings.seed, (seed) => {
      if (this.#seed.value !== seed) this.#seed.value = seed;
      this.#seed.setAttribute('aria-invalid', String(seedOf(this.#values) === null));
    });
  }

  /** The presets and words of the chosen method. @param {MethodView} method */
  #showMethod({ presets, parameters }) {
    this.#presets.replaceChildren(
      ...presets.map(({ name, title }) => {
        const label = document.createElement('label');
        const radio = document.createElement('input');
        Object.assign(radio, { type: 'radio', name: 'preset', value: name, checked: name === this.#values.preset });
        radio.setAttribute('aria-describedby', this.#presetHint.id);
        const words = document.createElement('span');
        words.textContent = title;
        label.append(radio, words);
        return label;
      }),
    );
    this.#presetHint.textContent = presets.map(({ title, meaning }) => `${title}: ${meaning}`).join('\n');
    for (const { name, meaning, kind } of parameters) {
      if ('choice' in kind) continue;
      const hint = document.getElementById(`hint-${name}`);
      if (hint) hint.textContent = meaning;
    }
  }

  /** Shows what differs from the preset. */
  #showBeyond() {
    const advanced = advancedOf(this.#values);
    this.#advanced.show(advanced);
    const count = Object.keys(advanced).length;
    this.#beyond.hidden = count === 0;
    this.#beyond.title = Object.entries(advanced).map(([name, value]) => `${name} ${value}`).join('\n');
    this.#beyondText.textContent = count === 1 ? '1 advanced setting differs from the preset’s.' : `${count} advanced settings differ from the preset’s.`;
  }

  /** What a person changes starts a run. @param {Partial<Values>} patch */
  #change(patch) {
    changeSettings(this.#store, patch);
    this.#changed();
  }

  /** @param {string} name */
  #chooseMethod(name) {
    const presets = methodOf(this.#store.state, name)?.presets ?? [];
    const { preset } = this.#values;
    // A preset of the same name means the same to a person; the parameters of another method mean nothing here.
    const next = presets.some((candidate) => candidate.name === preset) ? preset : (presets[0]?.name ?? preset);
    this.#change({ method: name, preset: next, beyond: sharedOf(this.#values) });
  }

  #listen() {
    for (const [axis, slider] of this.#sliders.entries()) {
      slider.addEventListener('input', () => {
        const { expansion, linked, beyond } = this.#values;
        const value = Number(slider.value);
        const next = /** @type {[number, number]} */ (linked ? [value, value] : expansion.with(axis, value));
        this.#change({ expansion: next, beyond: without(beyond, 'expansion-x', 'expansion-y') });
      });
    }
    this.#linked.addEventListener('change', () => {
      const linked = this.#linked.checked;
      const { expansion: [x, y], beyond } = this.#values;
      if (!linked || x === y) changeSettings(this.#store, { linked });
      else this.#change({ linked, expansion: [x, x], beyond: without(beyond, 'expansion-x', 'expansion-y') });
    });
    this.#presets.addEventListener('change', (event) => {
      const { value: preset } = /** @type {HTMLInputElement} */ (event.target);
      // It stands for all that was set beside it, but not for the size.
      this.#change({ preset, beyond: without(sharedOf(this.#values), 'boundary', 'seed') });
    });
    for (const boundary of /** @type {const} */ (['open', 'periodic'])) {
      this.#radio('boundary', boundary)?.addEventListener('change', () => {
        this.#change({ boundary, knowsBoundary: true, beyond: without(this.#values.beyond, 'boundary') });
      });
    }
    this.#seed.addEventListener('input', () => {
      changeSettings(this.#store, { seed: this.#seed.value, beyond: without(this.#values.beyond, 'seed') });
      if (seedOf(this.#values) !== null) this.#changed();
    });
    element('dice').addEventListener('click', () => {
      const seed = String(crypto.getRandomValues(new Uint32Array(1))[0] % 1_000_000);
      this.#change({ seed, beyond: without(this.#values.beyond, 'seed') });
    });
    this.#tiles.addEventListener('change', () => changeSettings(this.#store, { tiles: this.#tiles.checked }));
    this.#keepsPoints.addEventListener('change', () => changeSettings(this.#store, { keepsPoints: this.#keepsPoints.checked }));
    element('beyond-clear').addEventListener('click', () => this.#change({ beyond: sharedOf(this.#values) }));
    this.#form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.#changed();
    });
  }

  /**
   * Sets the controls to a preset and what differs from it; what the sliders can't show is kept beside them.
   *
   * @param {string} method
   * @param {string} preset
   * @param {Parameters} overrides
   */
  apply(method, preset, overrides) {
    const { boundary, seed, 'expansion-x': x = 2, 'expansion-y': y = 2 } = overrides;
    const expansion = /** @type {[number, number]} */ ([x, y].map((value, axis) => this.#onSlider(axis, Number(value))));
    changeSettings(this.#store, {
      method,
      preset,
      expansion,
      linked: x === y,
      beyond: { ...overrides },
      ...(seed !== undefined && { seed: String(seed) }),
      ...((boundary === 'open' || boundary === 'periodic') && { boundary, knowsBoundary: true }),
    });
  }

  /** The nearest that a slider can say. @param {number} axis @param {number} value */
  #onSlider(axis, value) {
    const { min, max, step } = this.#sliders[axis];
    const steps = Math.round((value - Number(min)) / Number(step));
    return Math.min(Math.max(Number(min) + steps * Number(step), Number(min)), Number(max));
  }
}
