// @ts-check
/** Where the points of a file lie: their rectangle, others they may have been cut from, and whether degrees became metres. */
import { element, input } from '../../common/elements.js';

/** @typedef {import('../../common/files-messages.js').Corners} Corners */
/** @typedef {import('../../common/files-messages.js').Preview} Preview */
/** @typedef {import('../../common/files-messages.js').ReadOptions} ReadOptions */

/**
 * @typedef {object} Hooks
 * @property {(domain: Corners | null) => void} domain null: the one that is found
 * @property {(keeps: boolean) => void} degrees
 * @property {(message: string) => void} object
 */

const CORNERS = ['x0', 'y0', 'x1', 'y1'];

/** Five digits are enough to recognise a number. @param {number} value */
export const number = (value) => String(Number(value.toPrecision(5)));

/** A degree's ten-thousandth is eleven metres. @param {number} degrees @param {string} positive @param {string} negative */
const degrees = (degrees, positive, negative) => `${Math.abs(degrees).toFixed(4)}° ${degrees < 0 ? negative : positive}`;

export class Extent {
  #hooks;
  #fields = CORNERS.map((id) => input(`import-${id}`));
  /** The rectangle that was found, and the others: they are told only while nobody has chosen. @type {{ name: string, domain: Corners | null }[]} */
  #choices = [];

  /** @param {Hooks} hooks */
  constructor(hooks) {
    this.#hooks = hooks;
    for (const field of this.#fields) {
      field.addEventListener('change', () => {
        const domain = this.#fields.map(({ valueAsNumber }) => valueAsNumber);
        if (domain.some(Number.isNaN)) hooks.object('each corner of the domain must be a number');
        else hooks.domain(/** @type {Corners} */ (domain));
      });
    }
    input('import-keeps-degrees').addEventListener('change', () => hooks.degrees(input('import-keeps-degrees').checked));
  }

  reset() {
    this.#choices = [];
    element('import-domains').replaceChildren();
    /** @type {HTMLDetailsElement} */ (element('import-domain')).open = false;
  }

  /** @param {Preview} preview @param {ReadOptions} options @param {boolean} isPicture whose rectangle is its own */
  show({ domain, declared, domains, origin }, options, isPicture) {
    const [x0, y0, x1, y1] = domain.map(number);
    element('import-extent').textContent = `${x0} to ${x1} × ${y0} to ${y1}${declared ? '' : ', found from the points'}`;
    element('import-domain').hidden = isPicture;
    for (const [i, field] of this.#fields.entries()) if (document.activeElement !== field) field.value = String(domain[i]);
    this.#showDegrees(origin, options.keepsDegrees === true);
    const chosen = options.domain ?? null;
    if (chosen === null) this.#offer(domains);
    for (const [i, button] of [...element('import-domains').children].entries()) {
      const { domain: offered } = this.#choices[i];
      const isIt = offered && chosen ? offered.every((corner, k) => corner === chosen[k]) : offered === chosen;
      button.setAttribute('aria-pressed', String(isIt));
    }
  }

  /** @param {Preview['domains']} domains */
  #offer(domains) {
    const choices = domains.length === 0 ? [] : [{ name: 'As found', domain: null }, ...domains];
    const group = element('import-domains');
    group.hidden = choices.length === 0;
    if (JSON.stringify(choices) === JSON.stringify(this.#choices)) return;
    this.#choices = choices;
    group.replaceChildren(
      ...choices.map(({ name, domain }) => {
        const words = domain === null ? name : `Use the ${name.replace(/^the /, '')}`;
        const button = Object.assign(document.createElement('button'), { type: 'button', className: 'quiet', textContent: words });
        if (domain) button.title = `${number(domain[0])} to ${number(domain[2])} × ${number(domain[1])} to ${number(domain[3])}`;
        button.addEventListener('click', () => this.#hooks.domain(domain));
        return button;
      }),
    );
  }

  /** @param {Preview['origin']} origin @param {boolean} keeps */
  #showDegrees({ projection }, keeps) {
    element('import-degrees').hidden = !projection && !keeps;
    input('import-keeps-degrees').checked = keeps;
    element('import-projection').textContent = keeps
      ? 'Degrees are taken as they are. Away from the equator the pattern is too wide.'
      : projection
        ? `Degrees became metres about ${degrees(projection.latitude, 'N', 'S')}, ${degrees(projection.longitude, 'E', 'W')}`
        : '';
  }
}
