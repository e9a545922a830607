// @ts-check
/** What the person should know of a file, as a list with a sign for each kind. */
import { element } from '../../common/elements.js';

/** @typedef {import('../../common/files-messages.js').Note} Note */
/** A sentence of the page itself is only told. @typedef {Note | { kind: 'told', text: string }} Said */

/** For each kind its word, and its sign as path data in a square of 16. */
const SIGNS = {
  'left-out': { word: 'Left out', path: 'M8 1.2a6.800 6.800 0 1 1 0 13.600A6.800 6.800 0 0 1 8 1.200zm0 1.500a5.300 5.300 0 1 0 0 10.600A5.300 5.300 0 0 0 8 2.700zM4.700 7.200h6.600v1.600H4.700z' },
  changed: { word: 'Changed', path: 'M10.700 1.500 14.500 5l-3.800 3.500V5.800H2V4.200h8.700zM5.300 7.500v2.700H14v1.600H5.300v2.700L1.500 11z' },
  odd: { word: 'Odd', path: 'M8 1.200 15.300 14.500H.7zm0 3.100L3.200 13h9.600zM7.200 6.800h1.600v3.400H7.200zm0 4.200h1.600v1.400H7.200z' },
  told: { word: 'Note', path: 'M8 1.200a6.800 6.800 0 1 1 0 13.600A6.800 6.800 0 0 1 8 1.200zm0 1.500a5.300 5.300 0 1 0 0 10.600A5.300 5.300 0 0 0 8 2.700zM7.200 7h1.600v4.300H7.200zm0-2.500h1.600v1.600H7.200z' },
};

const SVG = 'http://www.w3.org/2000/svg';

/** @param {Said} note */
function item({ kind, text }) {
  const { word, path } = SIGNS[kind];
  const line = document.createElement('li');
  line.dataset.kind = kind;
  const sign = document.createElementNS(SVG, 'svg');
  sign.setAttribute('class', 'icon');
  sign.setAttribute('viewBox', '0 0 16 16');
  sign.setAttribute('aria-hidden', 'true');
  const shape = document.createElementNS(SVG, 'path');
  shape.setAttribute('fill-rule', 'evenodd');
  shape.setAttribute('d', path);
  sign.append(shape);
  const words = document.createElement('span');
  words.append(Object.assign(document.createElement('b'), { textContent: `${word}: ` }), text);
  line.append(sign, words);
  return line;
}

/** @param {Said[]} notes */
export function showNotes(notes) {
  const list = element('import-notes');
  list.hidden = notes.length === 0;
  list.replaceChildren(...notes.map(item));
  // A list that scrolls has to be reached by keyboard; one that does not is no stop on the way.
  if (list.scrollHeight > list.clientHeight) list.tabIndex = 0;
  else list.removeAttribute('tabindex');
}
