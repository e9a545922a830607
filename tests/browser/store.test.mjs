// @ts-check
/** The state of a page: who is called, when, and with what. */
import assert from 'node:assert/strict';
import { test } from 'node:test';

import { Store } from '../../www/common/store.js';

test('a view is called at once and then only when what it looks at changes', () => {
  const store = new Store({ seed: 1, title: 'Rings' });
  /** @type {number[]} */
  const seen = [];
  store.subscribe(({ seed }) => seed, (seed) => void seen.push(seed));
  assert.deepEqual(seen, [1]);
  store.update({ title: 'Geese' });
  store.update({ seed: 1 });
  assert.deepEqual(seen, [1], 'nothing new to see');
  store.update({ seed: 2 });
  assert.deepEqual(seen, [1, 2]);
  assert.deepEqual(store.state, { seed: 2, title: 'Geese' });
});

test('a selector picks several members, and a new list of the same items is no change', () => {
  const store = new Store({ x: 1, y: 2, z: 3 });
  let calls = 0;
  store.subscribe(({ x, y }) => [x, y], () => void calls++);
  store.update({ z: 4 });
  assert.equal(calls, 1);
  store.update({ y: 5 });
  assert.equal(calls, 2);
  store.update({ x: 6, y: 7 });
  assert.equal(calls, 3, 'one call for one update');
});

test('what is not a number is the same as itself, and an object only as itself', () => {
  const store = new Store({ number: Number.NaN, object: { a: 1 } });
  let [numbers, objects] = [0, 0];
  store.subscribe(({ number }) => number, () => void numbers++);
  store.subscribe(({ object }) => object, () => void objects++);
  store.update({ number: Number.NaN });
  store.update({ object: { a: 1 } });
  assert.deepEqual([numbers, objects], [1, 2]);
});

test('a state is replaced, not changed', () => {
  const first = { seed: 1 };
  const store = new Store(first);
  store.update({ seed: 2 });
  assert.equal(first.seed, 1);
});

test('a view may update the state, and nobody is shown what is already replaced', () => {
  const store = new Store({ seed: 1, text: 'seed 1' });
  store.subscribe(({ seed }) => seed, (seed) => store.update({ text: `seed ${seed}` }));
  /** @type {string[]} */
  const seen = [];
  store.subscribe(({ seed, text }) => `${seed}: ${text}`, (text) => void seen.push(text));
  store.update({ seed: 2 });
  assert.deepEqual(seen, ['1: seed 1', '2: seed 2']);
});

test('a subscription ends, also while the others are being told', () => {
  const store = new Store({ seed: 1 });
  let calls = 0;
  /** @type {(() => void)[]} */
  const ends = [];
  store.subscribe(({ seed }) => seed, (seed) => seed === 2 && ends[0]());
  ends.push(store.subscribe(({ seed }) => seed, () => void calls++));
  store.update({ seed: 2 });
  store.update({ seed: 3 });
  assert.equal(calls, 1, 'only when it was made');
});
