// @ts-check
/** Where in a text a refusal points: the line itself, with the lines around it, and the part of it that is wrong. */

/** @typedef {{ number: number, text: string, mark: [number, number] | null }} Line `mark` is from and to, in characters of `text` */

/** Lines shown before and after. */
const AROUND = 1;
/** Of a longer line only what is around the place is shown. */
const LONGEST = 96;

/** Separators of a table, by the rule of `src/formats`: of the first line of data, within quotes none counts. @param {string} text */
function separator(text) {
  const first = text.split(/\r\n|\n|\r/).find((line) => line.trim() !== '' && !line.startsWith('#')) ?? '';
  const bare = first.split('"').filter((_, i) => i % 2 === 0).join('').trim();
  return ['\t', ';', ','].find((sign) => bare.includes(sign)) ?? null;
}

/**
 * From and to of a field of a table.
 *
 * @param {string} line
 * @param {number} column from 1
 * @param {string | null} sign between the fields; blanks where it is null
 * @returns {[number, number] | null} null when the line has no such field
 */
function field(line, column, sign) {
  if (sign === null) {
    const found = [...line.matchAll(/\S+/g)][column - 1];
    return found ? [found.index, found.index + found[0].length] : null;
  }
  let [start, quoted, number] = [0, false, 1];
  for (let i = 0; i <= line.length; i++) {
    if (line[i] === '"') quoted = !quoted;
    if (i < line.length && (line[i] !== sign || quoted)) continue;
    if (number === column) return [start, i];
    number++;
    start = i + 1;
  }
  return null;
}

/**
 * @param {string} text
 * @param {{ line: number, column: number | null }} place counted from 1; the column is a field of a table and a character of
 *   JSON and SVG
 * @returns {Line[]}
 */
export function offending(text, { line: wanted, column }) {
  const lines = text.split(/\r\n|\n|\r/);
  if (wanted < 1 || wanted > lines.length) return [];
  const isTable = !/^\s*[[{<]/.test(text.replace(/^\ufeff/, ''));
  const shown = [];
  for (let number = Math.max(1, wanted - AROUND); number <= Math.min(lines.length, wanted + AROUND); number++) {
    let line = lines[number - 1];
    /** @type {[number, number] | null} */
    let mark = null;
    if (number === wanted && column !== null && column > 0) {
      mark = isTable ? field(line, column, separator(text)) : [Math.min(column - 1, line.length), Math.min(column, line.length)];
    }
    const start = Math.max(0, Math.min((mark?.[0] ?? 0) - LONGEST / 2, line.length - LONGEST));
    const cut = line.length > LONGEST;
    if (cut) {
      const lead = start > 0 ? '…' : '';
      line = lead + line.slice(start, start + LONGEST) + (start + LONGEST < line.length ? '…' : '');
      if (mark) {
        const shift = lead.length - start;
        mark = [mark[0] + shift, Math.min(mark[1] + shift, line.length)];
      }
    }
    // A field that is missing or empty is pointed at all the same.
    if (mark && mark[1] <= mark[0]) mark = [mark[0], mark[0] + 1];
    shown.push({ number, text: mark && mark[1] > line.length ? `${line} ` : line, mark });
  }
  return shown;
}
