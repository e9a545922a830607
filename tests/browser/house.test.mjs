// @ts-check
/** The order of the page's scripts: every element has one owner, and no module is too long to be read at a sitting. No browser. */
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

/** Folders whose modules are one owner together. */
const OWNERS = ['playground/editor/', 'playground/import/'];
const MOST_LINES = 600;

const www = fileURLToPath(new URL('../../www/', import.meta.url));
const ids = idsOf(readFileSync(`${www}index.html`, 'utf8'));
const modules = readdirSync(www, { recursive: true, encoding: 'utf8' })
  .map((path) => path.replaceAll('\\', '/'))
  .filter((path) => path.endsWith('.js') && !path.startsWith('pkg/'))
  .map((path) => ({ path, text: readFileSync(www + path, 'utf8') }));

/** @typedef {{ path: string, text: string }} Module */

/** @param {string} html */
function idsOf(html) {
  return new Set([...html.matchAll(/\sid="([^"]+)"/g)].map(([, id]) => id));
}

/**
 * The ids a module asks for: by `getElementById`, by `element` and what a module calls its own short forms of them, and in
 * selectors. Comments ask for nothing.
 *
 * @param {string} text
 */
function asked(text) {
  const code = text.replace(/\/\*[\s\S]*?\*\//g, '').replace(/^\s*\/\/.*$/gm, '');
  const names = ['getElementById', 'element', 'input'];
  for (const [, name, parameter, body] of code.matchAll(/(?:const|function) (\w+)\s*=?\s*\(\s*(\w+)\s*\)(.*)/g)) {
    if (names.some((known) => body.includes(`${known}(${parameter})`))) names.push(name);
  }
  const calls = code.matchAll(new RegExp(`\\b(?:${names.join('|')})\\(\\s*['"\`]([\\w-]+)['"\`]`, 'g'));
  const selectors = [...code.matchAll(/(?:querySelector(?:All)?|closest|matches)\(\s*(['"`])(.*?)\1/g)].map(([, , selector]) => selector);
  const inSelectors = selectors.flatMap((selector) => [...selector.matchAll(/#([\w-]+)/g)].map(([, id]) => id));
  return new Set([...[...calls].map(([, id]) => id), ...inSelectors]);
}

/** @param {string} path */
const ownerOf = (path) => OWNERS.find((folder) => path.startsWith(folder)) ?? path;

/** @param {Module[]} list @param {Set<string>} known ids of the page @returns {string[]} what is wrong, in sentences */
function shared(list, known) {
  /** @type {Map<string, Set<string>>} */
  const owners = new Map();
  for (const { path, text } of list) {
    for (const id of asked(text)) {
      if (!known.has(id)) continue;
      owners.set(id, (owners.get(id) ?? new Set()).add(ownerOf(path)));
    }
  }
  return [...owners].filter(([, of]) => of.size > 1).map(([id, of]) => `'${id}' is asked for by ${[...of].join(' and ')}`);
}

/** Ids of elements that a module makes. @param {string} text */
const made = (text) => new Set([...text.matchAll(/\bid(?::|\s=)\s'([\w-]+)'/g)].map(([, id]) => id));

/** @param {Module[]} list @param {Set<string>} known @returns {string[]} */
const unknown = (list, known) =>
  list.flatMap(({ path, text }) =>
    [...asked(text)].filter((id) => !known.has(id) && !made(text).has(id)).map((id) => `${path} asks for '${id}', which the page has not`),
  );

/** @param {Module[]} list @returns {string[]} */
const long = (list) =>
  list.map(({ path, text }) => ({ path, lines: text.split('\n').length - 1 }))
    .filter(({ lines }) => lines > MOST_LINES)
    .map(({ path, lines }) => `${path} has ${lines} lines; at most ${MOST_LINES} are read at a sitting`);

test('the rules find what breaks them', () => {
  const known = new Set(['play', 'seed', 'editor']);
  const module = (/** @type {string} */ path, /** @type {string} */ text) => ({ path, text });
  const owner = module('playground/a.js', "element('play').hidden = true;");
  for (const text of [
    "document.getElementById('play')",
    'element("play")',
    "const button = (id) => document.getElementById(id);\nbutton('play');",
    "const button = (id) => element(id);\nconst wide = (id) => button(id);\nwide('play');",
    "document.querySelector('#play > span')",
    "event.target.closest('form, #play')",
  ]) {
    assert.deepEqual(shared([owner, module('playground/b.js', text)], known), ["'play' is asked for by playground/a.js and playground/b.js"], text);
  }
  for (const text of ["// element('play')", "/** see element('play') */", "tell('play')", "element('seed')"]) {
    assert.deepEqual(shared([owner, module('playground/b.js', text)], known), [], text);
  }
  const [bar, keys] = ['bar', 'keys'].map((name) => module(`playground/editor/${name}.js`, "element('editor')"));
  assert.deepEqual(shared([bar, keys], known), [], 'one owner in several files');
  assert.equal(shared([bar, module('playground/a.js', "element('editor')")], known).length, 1);
  assert.deepEqual(unknown([module('a.js', "element('plya')")], known), ["a.js asks for 'plya', which the page has not"]);
  assert.deepEqual(unknown([module('a.js', "button.id = 'plya';\nelement('plya')")], known), [], 'it made that itself');
  assert.deepEqual(long([module('a.js', 'x\n'.repeat(MOST_LINES))]), []);
  assert.equal(long([module('a.js', 'x\n'.repeat(MOST_LINES + 1))]).length, 1);
});

test('the rules see the page', () => {
  assert.ok(ids.size > 100, 'ids of the page');
  const all = new Set(modules.flatMap(({ text }) => [...asked(text)]));
  assert.ok(all.size > 100, `ids that modules ask for: ${all.size}`);
});

test('every element has one owner', () => assert.deepEqual(shared(modules, ids), []));

test('what a script asks for is there', () => assert.deepEqual(unknown(modules, ids), []));

test('no module is too long', () => assert.deepEqual(long(modules), []));
