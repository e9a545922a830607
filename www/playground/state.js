// @ts-check
/** What the page knows, in one place. Views subscribe to it; whoever learns something puts it here. */
import { Store } from '../common/store.js';

/** @typedef {import('../common/messages.js').Source} Source */
/** @typedef {import('../common/messages.js').Parameters} Parameters */
/** @typedef {import('../common/messages.js').MethodView} MethodView */
/** @typedef {import('../common/messages.js').PatternView} PatternView */
/** @typedef {PatternView['boundary']} Boundary */

/**
 * How the exemplar's file named and placed things, and what kind of file it was: goes along with the exemplar, for what is written of it.
 * @typedef {{ format?: string, origin?: import('../common/files-messages.js').Origin }} FromFile
 */
/**
 * An exemplar: what it is called, where it comes from, whether it is the person's own (opened or drawn here), and the value of its card.
 * @typedef {{ title: string, caption: string, source: Source, isOwn?: boolean, value: string } & FromFile} Chosen
 */

/**
 * What the controls say.
 *
 * @typedef {object} Settings
 * @property {string} method
 * @property {string} preset
 * @property {[number, number]} expansion what the sliders say, along x and y
 * @property {boolean} linked whether the sliders move together
 * @property {Boundary} boundary
 * @property {boolean} knowsBoundary whether an exemplar or a person has said what the boundary is; until then the worker, which knows, decides
 * @property {string} seed as it is written
 * @property {boolean} keepsPoints whether a change of settings goes on from the points as they are
 * @property {boolean} tiles whether the result is shown three by three times
 * @property {Parameters} beyond advanced settings, and what a link or a project says between what the sliders can show
 */

/**
 * @typedef {object} State
 * @property {boolean} booted whether the worker has answered
 * @property {import('../common/messages.js').DescriptionResponse | null} description
 * @property {Chosen} chosen
 * @property {Settings} settings
 * @property {import('./run.js').Status} status
 * @property {import('./run.js').Plan | null} plan what the run at hand was started with
 * @property {Parameters | null} parameters all of the run at hand, under their names in files
 * @property {import('../common/messages.js').Progress | null} progress
 * @property {number | null} iterationsPerSecond
 * @property {number | null} secondsLeft
 * @property {PatternView | null} shown the exemplar of the run at hand
 * @property {{ title: string, caption: string, points: number | null }} exemplar words for the exemplar that is drawn
 * @property {{ factors: [number, number], boundary: Boundary } | null} result what the result drawn is, or will be
 * @property {number} points how many it has
 * @property {boolean} showsKept whether the result kept for comparison is drawn in its place
 * @property {import('../common/messages.js').EngineView | null} engine what computes
 */

/** @typedef {Store<State>} PageStore */

/** The parameters that have controls of their own; the others are advanced. */
const SHARED = ['expansion-x', 'expansion-y', 'boundary', 'seed'];

/** @type {Settings} */
export const FIRST_SETTINGS = {
  // Presets and methods come with the worker's first answer; a run does not wait for it.
  method: 'network',
  preset: 'fast',
  expansion: [2, 2],
  linked: true,
  boundary: 'open',
  knowsBoundary: false,
  seed: '1',
  keepsPoints: false,
  tiles: false,
  beyond: {},
};

/** What the page shows first. @type {Chosen} */
export const FIRST_EXEMPLAR = { title: 'Rings', caption: '', source: { source: 'gallery', name: 'rings' }, value: 'rings' };

/** @returns {PageStore} */
export const pageStore = () =>
  new Store(
    /** @type {State} */ ({
      booted: false,
      description: null,
      chosen: FIRST_EXEMPLAR,
      settings: FIRST_SETTINGS,
      status: 'empty',
      plan: null,
      parameters: null,
      progress: null,
      iterationsPerSecond: null,
      secondsLeft: null,
      shown: null,
      exemplar: { title: '', caption: '', points: null },
      result: null,
      points: 0,
      showsKept: false,
      engine: null,
    }),
  );

/** @param {PageStore} store @param {Partial<Settings>} patch */
export const changeSettings = (store, patch) => store.update({ settings: { ...store.state.settings, ...patch } });

/** @param {Parameters} parameters @param {string[]} names */
export const without = (parameters, ...names) =>
  Object.fromEntries(Object.entries(parameters).filter(([name]) => !names.includes(name)));

/** What a link, a project or a person says about advanced parameters. @param {Settings} settings */
export const advancedOf = ({ beyond }) => without(beyond, ...SHARED);

/** The rest: what the controls can't show to the last digit. @param {Settings} settings */
export const sharedOf = ({ beyond }) => without(beyond, ...Object.keys(without(beyond, ...SHARED)));

/**
 * Makes an exemplar the chosen one. It brings its own boundary along; the person may change that afterwards.
 *
 * @param {PageStore} store
 * @param {Chosen} chosen
 * @param {Boundary} boundary
 */
export function chooseExemplar(store, chosen, boundary) {
  const { settings } = store.state;
  const beyond = without(settings.beyond, 'boundary');
  store.update({ chosen, settings: { ...settings, boundary, knowsBoundary: true, beyond } });
}

/** What a file has left with an exemplar, for another that is made of it. @param {FromFile} chosen @returns {FromFile} */
export const fromFile = ({ format, origin }) => ({ format, origin });

/** Whether the exemplar is the person's own, not the gallery's, a link's, or the page's around this one. @param {State} state */
export const isPrivate = ({ chosen }) => chosen.source.source !== 'gallery' && chosen.isOwn === true;

/** The seed that the settings say; null when that is none. @param {Settings} settings */
export function seedOf({ seed }) {
  const text = seed.trim();
  const number = /^\d+$/.test(text) ? Number(text) : Number.NaN;
  return Number.isSafeInteger(number) ? number : null;
}

/** What the settings say, for a run. @param {State} state @param {number} seed @returns {import('./run.js').Plan} */
export function settingsPlan({ chosen, settings }, seed) {
  const { method, preset, expansion, boundary, knowsBoundary, beyond } = settings;
  return {
    source: chosen.source,
    method,
    preset,
    overrides: {
      'expansion-x': expansion[0],
      'expansion-y': expansion[1],
      ...(knowsBoundary && { boundary }),
      seed,
      ...beyond,
    },
  };
}

/** The run at hand with all its parameters, as links keep it; null when there is none. @param {State} state */
export const currentPlan = ({ plan, parameters }) => plan && parameters && { ...plan, overrides: parameters };

/** A method in its own words; null before the worker has said them. @param {State} state @param {string} name @returns {MethodView | null} */
export const methodOf = ({ description }, name) => description?.methods.find((method) => method.name === name) ?? null;
