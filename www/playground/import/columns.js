// @ts-check
/** Which columns of a table hold what: as the reader has guessed, or as the person chooses. */
import { element } from '../../common/elements.js';

/** @typedef {import('../../common/files-messages.js').Column} Column */
/** @typedef {import('../../common/files-messages.js').ColumnChoice} ColumnChoice */
/** @typedef {Column['role']} Role */
/** @typedef {'x' | 'y' | 'class' | 'radius'} Part what a drop-down chooses the column of */

/**
 * @typedef {object} Hooks
 * @property {(choice: ColumnChoice | null) => void} choose reads with these columns; null: with those that the reader guesses
 * @property {(message: string) => void} object says why nothing can be read yet
 */

const PARTS = /** @type {const} */ (['x', 'y', 'class', 'radius']);
/** What a point's size is called among its attributes. */
const RADIUS = 'radius';
/** @type {Role} */
const LEFT_OUT = { kind: 'left-out' };
/** Characters of the examples behind a column's name: what a phone's drop-down shows. */
const LONGEST_EXAMPLES = 30;

/** @param {Column} column */
function examples({ examples: values }) {
  const text = values.map((value) => value.trim() || '(empty)').join(', ');
  return text.length > LONGEST_EXAMPLES ? `${text.slice(0, LONGEST_EXAMPLES - 1).trimEnd()}…` : text;
}

/** Whether a column's cells are places by themselves, as in `POINT (1 2)`. @param {Column | undefined} column */
const isPlace = (column) => column !== undefined && !column.isNumeric && column.examples.some((cell) => /^\s*(SRID=\d+;)?\s*POINT\b/i.test(cell));

/** @param {Part} part @returns {Role} */
const roleOf = (part) => (part === 'radius' ? { kind: 'attribute', name: RADIUS } : { kind: part });

/** @param {Role | undefined} role @param {Part | 'place'} part */
const isFor = (role, part) => (role?.kind === 'attribute' ? part === 'radius' && role.name === RADIUS : role?.kind === part);

export class Columns {
  #hooks;
  #whole = /** @type {HTMLDetailsElement} */ (element('import-columns'));
  #selects = /** @type {Record<Part, HTMLSelectElement>} */ (
    Object.fromEntries(PARTS.map((part) => [part, element(`import-column-${part}`)]))
  );
  #guessed = /** @type {HTMLButtonElement} */ (element('import-as-guessed'));
  /** @type {Column[]} */
  #columns = [];
  /** What each column is taken for, by its name. @type {Map<string, Role>} */
  #roles = new Map();
  /** The same as it was before anybody chose. @type {Map<string, Role>} */
  #guess = new Map();
  #isChosen = false;
  /** Whether x and y are columns; of GeoJSON they are not. */
  #hasPlaces = true;

  /** @param {Hooks} hooks */
  constructor(hooks) {
    this.#hooks = hooks;
    for (const part of PARTS) {
      this.#selects[part].addEventListener('change', () => {
        this.#assign(part, this.#selects[part].value);
        this.#choose();
      });
    }
    element('import-column-attributes').addEventListener('change', ({ target }) => {
      const { value, checked } = /** @type {HTMLInputElement} */ (target);
      this.#roles.set(value, checked ? this.#attribute(value) : LEFT_OUT);
      this.#choose();
    });
    this.#guessed.addEventListener('click', () => {
      this.#isChosen = false;
      this.#roles = new Map(this.#guess);
      this.#show();
      this.#selects[this.#hasPlaces ? 'x' : 'class'].focus();
      this.#hooks.choose(null);
    });
  }

  /** Another file has no columns until it is read. */
  reset() {
    this.#columns = [];
    this.#isChosen = false;
    this.#hasPlaces = true;
    this.#whole.open = false;
    this.#whole.hidden = true;
  }

  /** What was read. @param {Column[]} columns */
  read(columns) {
    if (!this.#isChosen) this.#hasPlaces = columns.some(({ role: { kind } }) => kind === 'x' || kind === 'y' || kind === 'place');
    this.#take(columns, true);
  }

  /** Nothing could be read with these columns as they are: the choice stays, so that it can be put right. @param {Column[]} columns */
  refused(columns) {
    if (columns.length > 0) this.#take(columns, !this.#isChosen);
    if (this.#columns.length > 0) this.#whole.open = true;
  }

  /** Goes to what has to be chosen. */
  focus() {
    const missing = PARTS.find((part) => this.#selects[part].value === '' && (part === 'x' || part === 'y'));
    this.#selects[missing ?? (this.#hasPlaces ? 'x' : 'class')].focus();
  }

  /** @param {Column[]} columns @param {boolean} withRoles whether their roles are what holds */
  #take(columns, withRoles) {
    const before = JSON.stringify(this.#columns.map(({ role: _, ...column }) => column));
    this.#columns = columns;
    if (withRoles) this.#roles = new Map(columns.map(({ name, role }) => [name, role]));
    if (!this.#isChosen) this.#guess = new Map(this.#roles);
    // What has the focus stays where it is.
    if (before !== JSON.stringify(columns.map(({ role: _, ...column }) => column))) this.#fill();
    this.#show();
  }

  // -------------------------------------------------------------------------------------------- choosing

  /** @param {Part | 'place'} part @returns {string} the column that holds it; empty when none does */
  #column(part) {
    return this.#columns.find(({ name }) => isFor(this.#roles.get(name), part))?.name ?? '';
  }

  /** What a column is called as an attribute. @param {string} column @returns {Role} */
  #attribute(column) {
    const guess = this.#guess.get(column);
    return guess?.kind === 'attribute' && guess.name !== RADIUS ? guess : { kind: 'attribute', name: column };
  }

  /** @param {Part} part @param {string} column empty for none */
  #assign(part, column) {
    const isAxis = part === 'x' || part === 'y';
    if (isAxis && isPlace(this.#columns.find(({ name }) => name === column))) {
      for (const axis of /** @type {const} */ (['x', 'y'])) this.#leave(axis);
      this.#roles.set(column, { kind: 'place' });
      return;
    }
    const before = this.#column(part);
    const held = this.#roles.get(column);
    // One column for both is as good as none once another is chosen for one of them.
    const place = isAxis ? this.#column('place') : '';
    if (place) this.#roles.set(place, LEFT_OUT);
    if (column) this.#roles.set(column, roleOf(part));
    if (!before || before === column) return;
    // Axes that were the wrong way round are put right by one choice, and a slip by taking it back.
    this.#roles.set(before, LEFT_OUT);
    if (!column) return;
    const isSwap = isAxis && (held?.kind === 'x' || held?.kind === 'y');
    this.#roles.set(before, isSwap ? held : this.#free(this.#guess.get(before)));
  }

  /** @param {Part} part */
  #leave(part) {
    const column = this.#column(part);
    if (column) this.#roles.set(column, LEFT_OUT);
  }

  /** A role that may have been taken since: nothing then. @param {Role | undefined} role @returns {Role} */
  #free(role = LEFT_OUT) {
    const same = JSON.stringify(role);
    return [...this.#roles.values()].some((other) => JSON.stringify(other) === same) ? LEFT_OUT : role;
  }

  #choose() {
    this.#isChosen = true;
    this.#show();
    const [x, y, place] = [this.#column('x'), this.#column('y'), this.#column('place')];
    if (this.#hasPlaces && !place && !(x && y)) {
      this.#hooks.object(`choose the column of ${x ? 'y' : y ? 'x' : 'x and that of y'}, too`);
      return;
    }
    this.#hooks.choose({
      ...(this.#hasPlaces && { x: place || x, y: place || y }),
      class: this.#column('class'),
      attributes: this.#columns.flatMap(({ name }) => {
        const role = this.#roles.get(name);
        return role?.kind === 'attribute' ? [/** @type {[string, string]} */ ([role.name, name])] : [];
      }),
    });
  }

  // -------------------------------------------------------------------------------------------- showing

  /** Makes what can be chosen. */
  #fill() {
    for (const part of PARTS) {
      const columns = part === 'radius' ? this.#columns.filter(({ isNumeric }) => isNumeric) : this.#columns;
      const none = new Option(part === 'x' || part === 'y' ? 'choose…' : 'none', '');
      this.#selects[part].replaceChildren(
        none,
        ...columns.map((column) => new Option(`${column.name} (${examples(column)})`, column.name)),
      );
    }
    element('import-column-attributes').replaceChildren(
      ...this.#columns.map((column) => {
        const label = document.createElement('label');
        label.className = 'check';
        const box = Object.assign(document.createElement('input'), { type: 'checkbox', value: column.name });
        const name = Object.assign(document.createElement('span'), { textContent: column.name });
        const values = Object.assign(document.createElement('small'), { textContent: examples(column) });
        label.append(box, name, ' ', values);
        return label;
      }),
    );
  }

  #show() {
    this.#whole.hidden = this.#columns.length === 0;
    const place = this.#column('place');
    for (const part of PARTS) {
      const select = this.#selects[part];
      select.value = this.#column(part) || (part === 'x' || part === 'y' ? place : '');
      /** @type {HTMLElement} */ (select.parentElement).hidden = !this.#hasPlaces && (part === 'x' || part === 'y');
    }
    for (const box of element('import-column-attributes').querySelectorAll('input')) {
      const column = this.#columns.find(({ name }) => name === box.value);
      const role = this.#roles.get(box.value);
      const part = [...PARTS, /** @type {const} */ ('place')].find((one) => isFor(role, one));
      box.checked = role?.kind === 'attribute' && part === undefined;
      box.disabled = part !== undefined || !column?.isNumeric;
      const values = /** @type {HTMLElement} */ (box.parentElement?.querySelector('small'));
      const used = part === 'place' ? 'x and y' : part;
      values.textContent = used ? `is ${used}` : column && !column.isNumeric ? 'no numbers' : column ? examples(column) : '';
    }
    this.#guessed.disabled = !this.#isChosen;
    element('import-columns-words').textContent = this.#words();
  }

  /** All of it in one line. */
  #words() {
    const place = this.#column('place');
    const said = PARTS.flatMap((part) => {
      const column = this.#column(part);
      return column ? [`${part} = ${column}`] : [];
    });
    if (place) said.unshift(`x and y = ${place}`);
    else if (this.#hasPlaces && !(this.#column('x') && this.#column('y'))) return 'Which columns hold the points?';
    return `Columns: ${said.join(', ') || 'neither class nor radius'}`;
  }
}
