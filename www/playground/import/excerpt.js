// @ts-check
/** The lines of a file around a place that is wrong, as elements. */
import { offending } from './offending.js';

/**
 * @param {HTMLElement} excerpt
 * @param {Uint8Array | null} bytes of the file
 * @param {{ line: number, column: number | null } | null} place
 */
export function showExcerpt(excerpt, bytes, place) {
  const lines = place && bytes ? offending(new TextDecoder().decode(bytes), place) : [];
  excerpt.hidden = lines.length === 0;
  excerpt.replaceChildren(
    ...lines.map(({ number, text, mark }) => {
      const row = document.createElement('span');
      row.className = 'line';
      row.toggleAttribute('data-wrong', number === place?.line);
      const count = document.createElement('span');
      count.className = 'line-number';
      count.textContent = String(number);
      const words = document.createElement('code');
      if (mark) {
        const wrong = document.createElement('mark');
        wrong.textContent = text.slice(...mark);
        words.append(text.slice(0, mark[0]), wrong, text.slice(mark[1]));
      } else {
        words.textContent = text;
      }
      row.append(count, words);
      return row;
    }),
  );
}
