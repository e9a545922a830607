// @ts-check
/** The rows of controls around the drawing: history, classes, sizes, border, and what acts on everything. */
import { readColours, tracePreview } from '../../common/draw.js';
import { adjust, clear, count, MAX_CLASSES, renamed, withBoundary, withoutAttribute } from '../../common/pattern.js';
import { points } from '../../common/words.js';
import { attributeRange, radii } from './drawing-board.js';
import { many, NOTHING } from './drawing.js';

/** @typedef {import('../../common/pattern.js').Pattern} Pattern */

/**
 * @template {HTMLElement} [E=HTMLElement]
 * @param {string} id
 */
const element = (id) => /** @type {E} */ (document.getElementById(id));
const input = (/** @type {string} */ id) => /** @type {HTMLInputElement} */ (element(id));

export class Bar {
  #canvas;
  #drawing;

  /**
   * @param {HTMLCanvasElement} canvas
   * @param {import('./drawing.js').Drawing} drawing
   */
  constructor(canvas, drawing) {
    this.#canvas = canvas;
    this.#drawing = drawing;
    this.#listen();
  }

  /** Shows the drawing as it stands. */
  refresh() {
    const { pattern, selection } = this.#drawing.state;
    const { classNames, attributes, boundary } = pattern;
    this.#drawing.klass = Math.min(this.#drawing.klass, classNames.length - 1);
    if (this.#drawing.attribute >= attributes.length) this.#drawing.attribute = -1;
    if (this.#drawing.attribute < 0) this.#drawing.attribute = attributes.length > 0 ? Math.max(0, attributes.findIndex(({ name }) => radii(name))) : -1;
    if (this.#drawing.hovered >= count(pattern)) this.#drawing.hovered = -1;
    const chosen = selection.size > 0 ? ` · ${selection.size} selected` : '';
    element('editor-count').textContent = points(count(pattern)) + chosen;
    input('editor-undo').disabled = !this.#drawing.canUndo;
    input('editor-redo').disabled = !this.#drawing.canRedo;
    input('editor-delete').disabled = selection.size === 0;
    input('editor-clear').disabled = count(pattern) === 0;
    input('editor-mirror-x').disabled = input('editor-mirror-y').disabled = count(pattern) === 0;
    for (const radio of document.querySelectorAll('input[name="editor-boundary"]')) {
      /** @type {HTMLInputElement} */ (radio).checked = /** @type {HTMLInputElement} */ (radio).value === boundary;
    }
    this.#canvas.setAttribute('aria-label', `The exemplar, ${points(count(pattern))}${chosen}`);
    this.#showClasses();
    this.#showSizes();
    this.#drawing.board.draw();
  }

  #showClasses() {
    const { classNames } = this.#drawing.pattern;
    const row = element('editor-classes');
    const colours = readColours();
    while (row.children.length > classNames.length + 1) row.children[0].remove();
    if (row.children.length === 0) {
      const more = document.createElement('button');
      more.type = 'button';
      more.className = 'chip more';
      more.id = 'editor-add-class';
      more.textContent = '+ Class';
      more.addEventListener('click', () => this.#drawing.addClass());
      row.append(more);
    }
    while (row.children.length < classNames.length + 1) {
      const chip = document.createElement('button');
      chip.type = 'button';
      chip.className = 'chip';
      const sign = document.createElement('canvas');
      sign.setAttribute('aria-hidden', 'true');
      chip.append(sign, document.createElement('span'));
      chip.addEventListener('click', () => this.#drawing.chooseClass([...row.children].indexOf(chip)));
      row.insertBefore(chip, row.lastElementChild);
    }
    for (const [klass, name] of classNames.entries()) {
      const chip = row.children[klass];
      chip.setAttribute('aria-pressed', String(klass === this.#drawing.klass));
      /** @type {HTMLElement} */ (chip.lastElementChild).textContent = name;
      tracePreview(/** @type {HTMLCanvasElement} */ (chip.firstElementChild), colours, klass, classNames.length > 1);
    }
    input('editor-add-class').disabled = classNames.length >= MAX_CLASSES;
    const name = input('editor-name');
    if (document.activeElement !== name) name.value = classNames[this.#drawing.klass];
    /** @type {HTMLElement} */ (name.parentElement).hidden = classNames.length < 2;
  }

  #showSizes() {
    const { pattern, selection } = this.#drawing.state;
    const has = pattern.attributes.length > 0;
    // Attributes of the person's own data can't be lost with a tick.
    const own = has && pattern.attributes.some(({ name }) => !radii(name));
    input('editor-sized').checked = has;
    input('editor-sized').disabled = own;
    element('editor-size-row').hidden = !has;
    if (!has) return;
    const choice = /** @type {HTMLSelectElement} */ (element('editor-attribute'));
    const names = pattern.attributes.map(({ name }) => name);
    if ([...choice.options].map(({ text }) => text).join('\n') !== names.join('\n')) {
      choice.replaceChildren(...names.map((name, index) => new Option(name, String(index))));
    }
    choice.value = String(this.#drawing.attribute);
    choice.hidden = names.length < 2;
    const { values } = pattern.attributes[this.#drawing.attribute];
    const [low, high] = attributeRange(pattern, this.#drawing.attribute);
    const slider = input('editor-size');
    slider.min = String(low);
    slider.max = String(high);
    const [first] = selection;
    const shown = first === undefined ? (this.#drawing.size ?? values[values.length >> 1] ?? low) : values[first];
    if (document.activeElement !== slider) slider.value = String(shown);
    slider.setAttribute('aria-valuetext', this.#drawing.number(shown));
  }

  #listen() {
    for (const radio of document.querySelectorAll('input[name="editor-boundary"]')) {
      radio.addEventListener('change', () => {
        const boundary = /** @type {Pattern['boundary']} */ (/** @type {HTMLInputElement} */ (radio).value);
        const { pattern, selection } = this.#drawing.present;
        const words = boundary === 'open' ? 'Made it a window' : 'Made it a tile: left meets right and top meets bottom';
        this.#drawing.commit({ pattern: withBoundary(pattern, boundary), selection }, words);
      });
    }
    /** @type {[string, () => void][]} */
    const buttons = [
      ['editor-undo', () => this.#drawing.undo()],
      ['editor-redo', () => this.#drawing.redo()],
      ['editor-mirror-x', () => this.#drawing.mirror(0)],
      ['editor-mirror-y', () => this.#drawing.mirror(1)],
      ['editor-delete', () => this.#drawing.deleteSelection()],
      ['editor-clear', () => this.#drawing.commit({ pattern: clear(this.#drawing.pattern), selection: NOTHING }, `Cleared ${points(count(this.#drawing.pattern))}`)],
    ];
    for (const [id, act] of buttons) {
      element(id).addEventListener('click', () => {
        act();
        // A button that has just been disabled loses the focus to nowhere.
        if (input(id).disabled) this.#canvas.focus({ preventScroll: true });
      });
    }
    const name = input('editor-name');
    name.addEventListener('change', () => {
      const { pattern, selection } = this.#drawing.present;
      if (name.value.trim() === pattern.classNames[this.#drawing.klass]) return;
      const changed = renamed(pattern, this.#drawing.klass, name.value);
      name.value = changed.classNames[this.#drawing.klass];
      this.#drawing.commit({ pattern: changed, selection }, `Named the class ‘${name.value}’`);
    });
    input('editor-sized').addEventListener('change', () => {
      if (input('editor-sized').checked) this.#drawing.ensureSizes();
      else {
        const { pattern, selection } = this.#drawing.present;
        this.#drawing.commit({ pattern: withoutAttribute(pattern, this.#drawing.attribute), selection }, 'Took the sizes away');
      }
    });
    element('editor-attribute').addEventListener('change', (event) => {
      this.#drawing.attribute = Number(/** @type {HTMLSelectElement} */ (event.target).value);
      this.#drawing.size = undefined;
      this.#drawing.refresh();
    });
    const slider = input('editor-size');
    slider.addEventListener('input', () => {
      const value = Number(slider.value);
      const { pattern, selection } = this.#drawing.present;
      this.#drawing.size = value;
      if (selection.size === 0) {
        this.#drawing.say(`New points will have ${pattern.attributes[this.#drawing.attribute].name} ${this.#drawing.number(value)}.`);
        return;
      }
      const { name } = pattern.attributes[this.#drawing.attribute];
      const changed = adjust(pattern, this.#drawing.attribute, selection, () => value);
      this.#drawing.commit({ pattern: changed, selection }, `Set the ${name} of ${many(selection.size)} to ${this.#drawing.number(value)}`, `slide ${[...selection].join()}`);
    });
    slider.addEventListener('change', () => this.#drawing.settle());
    window.addEventListener('themechange', () => {
      if (!element('editor').hidden) this.#showClasses();
    });
  }
}
