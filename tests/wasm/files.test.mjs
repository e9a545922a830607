// @ts-check
/** The module for files: patterns go in and out as typed arrays, and links are the same as natively. */
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';

import { answer } from './module.mjs';

/** @typedef {import('../../www/common/files-messages.js').FilesRequest} FilesRequest */

/** @param {string | Uint8Array} content @param {string} [name] */
const read = (content, name = '') => {
  const bytes = typeof content === 'string' ? new TextEncoder().encode(content) : content;
  return answer({ type: 'read', name, bytes, options: {} });
};

test('a file becomes typed arrays, and every format brings them back', () => {
  const { pattern, preview, project } = read('# domain 0 0 4 2 periodic\nx,y,class,radius\n1,0.1,oak,3\n2,1.5,elm,0.2\n');
  assert.deepEqual(pattern.positions, Float64Array.of(1, 0.1, 2, 1.5));
  assert.deepEqual(pattern.classes, Uint16Array.of(0, 1));
  assert.deepEqual(pattern.attributes, [{ name: 'radius', values: Float64Array.of(3, 0.2) }]);
  assert.deepEqual([pattern.domain, pattern.boundary, project], [[0, 0, 4, 2], 'periodic', null]);
  assert.deepEqual(preview.classes, [{ name: 'oak', count: 1 }, { name: 'elm', count: 1 }]);
  for (const format of ['csv', 'json']) {
    const written = answer({ type: 'write', format, pattern, title: '', tile: false });
    assert.ok(written.bytes instanceof Uint8Array);
    assert.deepEqual(read(written.bytes).pattern, pattern, format);
  }
  const { bytes } = answer({ type: 'write', format: 'npy', pattern, title: '', tile: false });
  assert.deepEqual(read(bytes).pattern.positions, pattern.positions);
});

test('a project holds a run as it is, and goes on', () => {
  const { pattern } = read('0.1 0.2\n0.5 0.7\n');
  const state = JSON.stringify({ version: 1, exemplar: {}, losses: [0.1, 1e-300], seed: 9007199254740991 });
  const { bytes } = answer({
    type: 'write-project', title: 'Mine', method: 'network', preset: 'fast', overrides: { seed: 3 }, exemplar: pattern, output: pattern, state,
  });
  const { project, pattern: exemplar } = read(bytes, 'mine.json');
  assert.deepEqual([exemplar, project.output, project.overrides], [pattern, pattern, { seed: 3 }]);
  const kept = JSON.parse(project.state);
  assert.deepEqual([kept.losses, kept.seed], [[0.1, 1e-300], 9007199254740991]);
});

test('golden links are read as natively', () => {
  const golden = JSON.parse(readFileSync(new URL('../link/golden.json', import.meta.url), 'utf8'));
  assert.ok(golden.length >= 6);
  for (const { name, fragment, preset, overrides, gallery, exemplar } of golden) {
    const link = answer({ type: 'read-link', fragment: `#${fragment}` });
    assert.deepEqual([link.type, link.preset, link.overrides], ['link-read', preset, overrides], name);
    if (gallery) assert.deepEqual(link.exemplar, { gallery }, name);
    else assert.deepEqual(Array.from(link.exemplar.pattern.positions), exemplar.positions.flat(), name);
    const again = answer({ type: 'write-link', exemplar: link.exemplar, method: 'network', preset, overrides });
    assert.equal(again.exact, true, name);
    // What a preset has taken over since is no longer written, and means the same.
    const back = answer({ type: 'read-link', fragment: again.fragment });
    assert.deepEqual([back.parameters, back.exemplar], [link.parameters, link.exemplar], name);
  }
});

test('pixels become points, and refusals say where', () => {
  const pixels = new Uint8ClampedArray(4 * 12).fill(255);
  pixels.fill(0, 4, 7);
  const found = answer({ type: 'blobs', width: 4, height: 3, pixels: new Uint8Array(pixels.buffer), options: {} });
  assert.deepEqual(found.pattern.positions, Float64Array.of(1.5, 0.5));
  assert.deepEqual(read(Uint8Array.of(0xff, 0xd8, 0xff, 0xe0)).type, 'picture');
  const refused = read('x,y\n0.1,oops\n', 'mine.csv');
  assert.deepEqual(refused.place, { line: 2, column: 2 });
  assert.match(refused.message, /^mine\.csv: line 2, column 2/);
});
