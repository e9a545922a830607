// @ts-check
/** The choice of a method, where there is more than one, and what a page can't do with the one that was chosen. */

/** @typedef {import('../common/messages.js').MethodView} MethodView */

export class Methods {
  #fieldset;
  #row;
  #hint;
  #chosen;

  /**
   * @param {HTMLElement} fieldset with a row of segments and a hint; it is hidden while there is nothing to choose
   * @param {{ chosen: (name: string) => void }} hooks
   */
  constructor(fieldset, { chosen }) {
    this.#fieldset = fieldset;
    this.#row = /** @type {HTMLElement} */ (fieldset.querySelector('.segments'));
    this.#hint = /** @type {HTMLElement} */ (fieldset.querySelector('.hint'));
    this.#chosen = chosen;
  }

  /**
   * @param {MethodView[]} methods
   * @param {string} chosen its name
   */
  describe(methods, chosen) {
    this.#fieldset.hidden = methods.length < 2;
    const inputs = [...this.#row.querySelectorAll('input')];
    if (inputs.map(({ value }) => value).join() === methods.map(({ name }) => name).join()) {
      // The same again; a focus stays where it is.
      for (const input of inputs) input.checked = input.value === chosen;
      return;
    }
    this.#row.replaceChildren(
      ...methods.map(({ name, title, meaning }) => {
        const input = document.createElement('input');
        Object.assign(input, { type: 'radio', name: 'method', value: name, defaultChecked: name === chosen });
        input.setAttribute('aria-describedby', this.#hint.id);
        input.addEventListener('change', () => this.#chosen(name));
        const words = document.createElement('span');
        words.textContent = title;
        const label = document.createElement('label');
        label.title = meaning;
        label.append(input, words);
        return label;
      }),
    );
    this.#hint.textContent = methods.map(({ title, meaning }) => `${title}: ${meaning}`).join('\n');
  }
}
