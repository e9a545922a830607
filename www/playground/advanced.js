// @ts-check
/**
 * The advanced parameters: controls built from what a method says of itself.
 *
 * A control shows the preset's value until a person, a link, a project or a session gives another one. Only those
 * others are handed on. Input that can't be used is answered in words beside the control and not handed on.
 */

/** @typedef {import('../common/messages.js').MethodView} MethodView */
/** @typedef {import('../common/messages.js').ParameterView} ParameterView */
/** @typedef {import('../common/messages.js').Parameters} Parameters */
/** @typedef {{ min: number, max: number, whole: boolean }} Range */
/** @typedef {{ value: number | string } | { wrong: string } | null} Reading a value, what is wrong with it, or nothing at all */

/** While someone types, a number is looked at when so many milliseconds have passed without a key. */
const TYPING_MS = 500;
/** Sliders are for ranges whose steps can be told apart on a short track. */
const MOST_WHOLE_STEPS = 300;
const WIDEST_REAL = 16;
const LARGEST_RATIO = 1000;

/** What a value is in words, with few digits. @param {number | string} value */
export const inWords = (value) => (typeof value === 'number' ? String(Number(value.toPrecision(6))) : value);

/** The largest of 1, 2 and 5 times a power of ten up to `most`. @param {number} most */
function roundStep(most) {
  const exponent = Math.floor(Math.log10(most) + 1e-9);
  const factor = [5, 2, 1].find((candidate) => candidate * 10 ** exponent <= most * (1 + 1e-9)) ?? 1;
  // Written as a decimal, since 5 * 10 ** -3 has digits that nobody means.
  return Number(`${factor}e${exponent}`);
}

/**
 * Reads a number that someone typed.
 *
 * @param {string} text
 * @param {Range} range
 * @returns {Reading}
 */
export function readNumber(text, { min, max, whole }) {
  const kind = whole ? 'a whole number' : 'a number';
  const between = `between ${inWords(min)} and ${inWords(max)}`;
  if (text.trim() === '') return null;
  const value = Number(text);
  if (!Number.isFinite(value)) return { wrong: `This is not a number. It must be ${kind} ${between}.` };
  if (whole && !Number.isInteger(value)) return { wrong: `${inWords(value)} is not whole. It must be ${kind} ${between}.` };
  if (value < min) return { wrong: `${inWords(value)} is too small. It must be ${kind} ${between}.` };
  if (value > max) return { wrong: `${inWords(value)} is too large. It must be ${kind} ${between}.` };
  return { value };
}

/** @param {Range} range */
const suitsSlider = ({ min, max, whole }) =>
  whole ? max - min <= MOST_WHOLE_STEPS : max - min <= WIDEST_REAL && !(min > 0 && max / min > LARGEST_RATIO);

/**
 * @template {HTMLElement} E
 * @param {E} element
 * @param {Partial<E>} properties
 * @param {...Node} children
 */
function fitted(element, properties, ...children) {
  Object.assign(element, properties).append(...children);
  return element;
}

/** @template {keyof HTMLElementTagNameMap} K @param {K} tag */
const make = (tag) => document.createElement(tag);

/** One parameter: its label, its control, the way back, its meaning, and what is wrong. */
class Field {
  /** @type {number | string | undefined} what holds where nobody sets anything else */
  #base;
  /** @type {number | string | undefined} */
  #set;
  #isWrong = false;
  #parameter;
  #tell;
  /** @type {HTMLInputElement | HTMLSelectElement} */
  #control;
  /** @type {HTMLInputElement | null} */
  #slider = null;
  #hint;
  #wrong;
  #back;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #typing;

  /**
   * @param {ParameterView} parameter
   * @param {() => void} tell that someone has set it
   */
  constructor(parameter, tell) {
    const { name, title, kind } = parameter;
    const id = `advanced-${name}`;
    this.#parameter = parameter;
    this.#tell = tell;
    this.#hint = fitted(make('p'), { className: 'hint', id: `hint-${id}`, role: 'tooltip' });
    this.#wrong = fitted(make('p'), { className: 'reason', id: `wrong-${id}`, role: 'alert' });
    this.#back = fitted(make('button'), { type: 'button', className: 'back', textContent: '↺' });
    this.#back.addEventListener('click', () => {
      this.#choose(undefined);
      // The button is gone now; its focus would be lost.
      this.#control.focus();
    });
    if ('choice' in kind) {
      this.#control = fitted(make('select'), {}, ...kind.choice.options.map((option) => {
        const made = new Option(option.title, option.name);
        made.title = option.meaning;
        return made;
      }));
      this.#control.addEventListener('change', () => this.#choose(this.#control.value));
    } else {
      this.#control = this.#number(kind.number);
      if (suitsSlider(kind.number)) this.#slider = this.#range(kind.number);
    }
    this.#control.id = id;
    this.#control.setAttribute('aria-describedby', `${this.#wrong.id} ${this.#hint.id}`);
    // The form of the other settings keeps and restores its controls by itself; these are kept as what differs.
    for (const control of [this.#control, this.#slider]) control?.setAttribute('form', '');
    this.element = fitted(make('div'), { className: 'field parameter' },
      fitted(make('label'), { htmlFor: id, textContent: title }), this.#control, this.#back, ...(this.#slider ? [this.#slider] : []), this.#wrong, this.#hint);
    this.element.dataset.parameter = name;
  }

  /** @param {Range} range */
  #number({ min, max, whole }) {
    const control = fitted(make('input'), { type: 'number', inputMode: whole ? 'numeric' : 'decimal', max: String(max) });
    control.min = String(min);
    control.step = whole ? '1' : String(roundStep((max - min) / 100));
    control.addEventListener('input', () => {
      clearTimeout(this.#typing);
      // No complaint about the first digit of three.
      this.#typing = setTimeout(() => this.#read(false), TYPING_MS);
    });
    control.addEventListener('change', () => {
      clearTimeout(this.#typing);
      this.#read(true);
    });
    return control;
  }

  /** @param {Range} range */
  #range({ min, max, whole }) {
    const step = whole ? 1 : roundStep((max - min) / 100);
    // The number does the same by keyboard: one stop a parameter is enough.
    const slider = fitted(make('input'), { type: 'range', min: String(min), max: String(max), step: String(step), tabIndex: -1 });
    slider.setAttribute('aria-label', `${this.#parameter.title}, slider`);
    slider.addEventListener('input', () => this.#choose(Number(slider.value)));
    return slider;
  }

  /** Takes what stands in the number's field. @param {boolean} isDone whether the person has left it */
  #read(isDone) {
    const control = /** @type {HTMLInputElement} */ (this.#control);
    const range = /** @type {{ number: Range }} */ (this.#parameter.kind).number;
    // The browser gives no text where it is no number.
    const reading = readNumber(control.validity.badInput ? '?' : control.value, range);
    if (reading && 'wrong' in reading) {
      this.#complain(reading.wrong);
    } else if (reading) {
      this.#choose(reading.value);
    } else if (isDone) {
      this.#choose(undefined);
    } else {
      this.#complain('');
    }
  }

  /** Someone set it, or wants the preset's again. @param {number | string | undefined} value */
  #choose(value) {
    clearTimeout(this.#typing);
    const before = this.#set;
    this.#set = value === this.#base ? undefined : value;
    this.#complain('');
    this.#refresh();
    if (this.#set !== before) this.#tell();
  }

  /** @param {string} wrong in words; empty where nothing is */
  #complain(wrong) {
    this.#isWrong = wrong !== '';
    if (this.#isWrong) this.#control.setAttribute('aria-invalid', 'true');
    else this.#control.removeAttribute('aria-invalid');
    if (this.#wrong.textContent !== wrong) this.#wrong.textContent = wrong;
  }

  get name() {
    return this.#parameter.name;
  }

  get group() {
    return this.#parameter.group;
  }

  /** What replaces the preset's value; undefined where nothing does. */
  get set() {
    return this.#set;
  }

  /**
   * Shows a value that somebody gave elsewhere. It stays set even where the preset's is the same: an exemplar may suit
   * another one.
   *
   * @param {number | string | undefined} value
   */
  show(value) {
    clearTimeout(this.#typing);
    this.#set = value;
    this.#complain('');
    this.#refresh();
  }

  /** @param {number | string | undefined} base the value that holds where nothing is set */
  set base(base) {
    this.#base = base;
    // What is being typed, or wrong, is the person's to finish.
    if (!this.#isWrong && document.activeElement !== this.#control) this.#refresh();
    else this.#mark();
  }

  get base() {
    return this.#base;
  }

  #refresh() {
    const value = this.#set ?? this.#base;
    if (value === undefined) return;
    const { kind } = this.#parameter;
    const text = 'number' in kind ? inWords(value) : String(value);
    if (this.#control.value !== text) this.#control.value = text;
    if (this.#slider) {
      this.#slider.value = text;
      this.#slider.setAttribute('aria-valuetext', text);
    }
    this.#mark();
  }

  #mark() {
    const { title, meaning, kind } = this.#parameter;
    const differs = this.#set !== undefined;
    this.element.toggleAttribute('data-differs', differs);
    const options = 'choice' in kind ? kind.choice.options : [];
    const base = options.find(({ name }) => name === this.#base)?.title ?? inWords(this.#base ?? '');
    this.#back.title = `Back to ${base}`;
    this.#back.setAttribute('aria-label', `${title}: back to ${base}`);
    const now = this.#set ?? this.#base;
    const chosen = options.find(({ name }) => name === now);
    const range = 'number' in kind ? `${inWords(kind.number.min)} to ${inWords(kind.number.max)}.` : chosen ? `${chosen.title}: ${chosen.meaning}` : '';
    const preset = differs ? ` The preset has ${base}.` : '';
    const hint = `${meaning}\n${range}${preset}`;
    if (this.#hint.textContent !== hint) this.#hint.textContent = hint;
  }
}

export class Advanced {
  #container;
  #changed;
  /** Method and preset that the controls are about. */
  #method = '';
  #preset = '';
  /** @type {Field[]} */
  #fields = [];
  /** What was given before there were controls for it. @type {Parameters} */
  #waiting = {};

  /**
   * @param {HTMLElement} container
   * @param {{ changed: (overrides: Parameters) => void }} hooks `changed` hears of what a person sets, not of `show` and `reset`
   */
  constructor(container, { changed }) {
    this.#container = container;
    this.#changed = changed;
    // Keys and changes are about these controls alone.
    for (const type of ['input', 'change']) container.addEventListener(type, (event) => event.stopPropagation());
  }

  /**
   * Builds the controls of a method, and shows the values of a preset.
   *
   * @param {MethodView} method
   * @param {string} preset
   * @param {Parameters} [suited] what the run at hand uses, where the exemplar suits other values than the preset's
   */
  describe(method, preset, suited = {}) {
    if (method.name !== this.#method) this.#build(method);
    const isSame = preset === this.#preset;
    this.#preset = preset;
    const given = method.presets.find(({ name }) => name === preset)?.parameters ?? {};
    for (const field of this.#fields) {
      const { name } = field;
      // A run's value says nothing about the preset's where something else was set.
      if (field.set === undefined) field.base = suited[name] ?? given[name];
      else if (!isSame || field.base === undefined) field.base = given[name];
    }
  }

  /** @param {MethodView} method */
  #build(method) {
    const before = this.#method === '' ? this.#waiting : {};
    this.#method = method.name;
    this.#preset = '';
    this.#waiting = {};
    this.#fields = method.parameters
      .filter(({ place }) => place === 'advanced')
      .map((parameter) => new Field(parameter, () => this.#tell()));
    /** @type {Map<string, HTMLFieldSetElement>} */
    const groups = new Map();
    for (const field of this.#fields) {
      let group = groups.get(field.group);
      if (!group) {
        group = fitted(make('fieldset'), { className: 'group' }, fitted(make('legend'), { textContent: field.group }));
        groups.set(field.group, group);
      }
      group.append(field.element);
    }
    this.#container.replaceChildren(...groups.values());
    this.show(before);
  }

  #tell() {
    this.#count();
    this.#changed(this.overrides);
  }

  /** Says at the fold how many are changed. */
  #count() {
    const count = this.#container.closest('details')?.querySelector('summary .count');
    const number = this.#fields.filter(({ set }) => set !== undefined).length;
    if (count) count.textContent = number === 0 ? '' : `${number} changed`;
  }

  /**
   * Shows what a link, a project or a session says; everything else is the preset's.
   *
   * @param {Parameters} overrides names without a control here are left to others
   */
  show(overrides) {
    if (this.#method === '') this.#waiting = { ...overrides };
    for (const field of this.#fields) field.show(overrides[field.name]);
    this.#count();
  }

  /** What replaces the preset's values. @returns {Parameters} */
  get overrides() {
    if (this.#method === '') return { ...this.#waiting };
    /** @type {Parameters} */
    const overrides = {};
    for (const { name, set } of this.#fields) if (set !== undefined) overrides[name] = set;
    return overrides;
  }

  /** Back to the preset's values. */
  reset() {
    this.show({});
  }
}
