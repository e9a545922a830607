// @ts-check
/** Writes down where this tab stands, for a reload, and goes on from there. */
import { linkInAddress } from './address.js';
import { FIRST_SETTINGS } from './state.js';

/** @typedef {import('./state.js').PageStore} PageStore */
/** @typedef {import('./state.js').Settings} Settings */
/** @typedef {import('./session.js').Kept} Kept */

/** Settings under the names of their controls, as they have always been kept. @param {Settings} settings @returns {Kept['settings']} */
export const settingsToKeep = ({ method, preset, expansion: [x, y], linked, boundary, seed, keepsPoints, tiles }) => ({
  method,
  preset,
  'expansion-x': String(x),
  'expansion-y': String(y),
  linked,
  boundary,
  seed,
  'keep-points': keepsPoints,
  tiles,
});

/** What was kept, each as far as it has the right kind. @param {Kept} kept @returns {Settings} */
export function keptSettings({ settings: values, beyond }) {
  /** @param {string} name @param {string} otherwise */
  const text = (name, otherwise) => (typeof values[name] === 'string' ? values[name] : otherwise);
  /** @param {string} name @param {number} otherwise */
  const number = (name, otherwise) => Number(text(name, '')) || otherwise;
  /** @param {string} name @param {boolean} otherwise */
  const flag = (name, otherwise) => (typeof values[name] === 'boolean' ? values[name] : otherwise);
  const first = FIRST_SETTINGS;
  const { boundary } = values;
  return {
    method: text('method', first.method),
    preset: text('preset', first.preset),
    expansion: [number('expansion-x', first.expansion[0]), number('expansion-y', first.expansion[1])],
    linked: flag('linked', first.linked),
    ...(boundary === 'open' || boundary === 'periodic'
      ? { boundary, knowsBoundary: true }
      : { boundary: first.boundary, knowsBoundary: first.knowsBoundary }),
    seed: text('seed', first.seed),
    keepsPoints: flag('keep-points', first.keepsPoints),
    tiles: flag('tiles', first.tiles),
    beyond,
  };
}

export class SessionView {
  #store;
  #running;
  #session;
  #chart;
  #notices;

  /**
   * @param {PageStore} store
   * @param {import('./running.js').Running} running
   * @param {import('./session.js').Session} session
   * @param {import('./loss-chart.js').LossChart} chart
   * @param {import('./notices.js').Notices} notices
   */
  constructor(store, running, session, chart, notices) {
    this.#store = store;
    this.#running = running;
    this.#session = session;
    this.#chart = chart;
    this.#notices = notices;
  }

  /** @param {string} state of the run */
  keep(state) {
    const { chosen, settings, status } = this.#store.state;
    this.#session.keep({
      chosen,
      settings: settingsToKeep(settings),
      fragment: linkInAddress(),
      beyond: settings.beyond,
      status,
      state,
      curve: this.#chart.record,
    });
  }

  /** Goes on with what this tab did before it was loaded again; false when there is nothing. */
  async resume() {
    const kept = await this.#session.recall();
    // A link that was opened goes before what the tab did until then.
    if (!kept || (linkInAddress() !== '' && kept.fragment !== linkInAddress())) return false;
    const { chosen } = kept;
    const value = chosen.value ?? (chosen.source.source === 'gallery' ? chosen.source.name : 'own');
    this.#store.update({ chosen: { ...chosen, value }, settings: keptSettings(kept) });
    this.#chart.record = kept.curve;
    const plan = this.#running.settingsPlan;
    if (plan === null || kept.state === null) return this.#running.begin(true);
    if (await this.#running.run.resume(plan, kept.state, kept.status !== 'paused')) return true;
    this.#notices.unnotify();
    return this.#running.begin(true);
  }
}
