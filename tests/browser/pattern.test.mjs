// @ts-check
/** What the editor computes, without a page: patterns that are never changed in place, and the history of them. */
import assert from 'node:assert/strict';
import { describe, test } from 'node:test';

import { History } from '../../www/common/history.js';
import {
  add, adjust, along, assign, blank, clear, compact, contains, count, MAX_CLASSES, MAX_POINTS, mirror, move, nearest, remove,
  renamed, withAttribute, withBoundary, withClass, within,
} from '../../www/common/pattern.js';
import { sourceOf, viewOf } from '../../www/common/pattern-source.js';

/** @typedef {import('../../www/common/pattern.js').Pattern} Pattern */

/** @param {[number, number][]} places @param {Partial<Pattern>} [more] */
const of = (places, more = {}) => places.reduce((pattern, at) => add(pattern, at, 0), { ...blank(), ...more });
/** @param {Pattern} pattern */
const places = ({ positions }) => [...positions];
/** Freezing typed arrays is not possible, so a copy is compared. @param {Pattern} pattern @param {(pattern: Pattern) => unknown} act */
function leavesAlone(pattern, act) {
  const copy = structuredClone(pattern);
  act(pattern);
  assert.deepEqual(pattern, copy);
}

describe('a pattern', () => {
  test('takes points with the attributes of their like, and keeps them inside', () => {
    let pattern = withAttribute(of([[0.25, 0.5]]), 'radius', 0.1);
    leavesAlone(pattern, (old) => add(old, [0.5, 0.5], 0));
    pattern = add(pattern, [1.5, -2], 0);
    assert.deepEqual(places(pattern), [0.25, 0.5, 1, 0]);
    assert.deepEqual([...pattern.attributes[0].values], [0.1, 0.1]);
    assert.deepEqual([...add(pattern, [0, 0], 0, [0.3]).attributes[0].values], [0.1, 0.1, 0.3]);
    assert.deepEqual(places(add({ ...pattern, boundary: 'periodic' }, [1.25, -0.25], 0)).slice(4), [0.25, 0.75]);
  });

  test('loses points with everything that is theirs', () => {
    const pattern = assign(withAttribute(of([[0, 0], [0.5, 0.5], [1, 1]]), 'radius', 2), [2], 0);
    const sized = adjust(pattern, 0, [2], () => 7);
    leavesAlone(sized, (old) => remove(old, [0, 1]));
    const left = remove(sized, [0, 1]);
    assert.deepEqual([places(left), count(left), [...left.attributes[0].values]], [[1, 1], 1, [7]]);
    assert.equal(count(clear(sized)), 0);
    assert.equal(clear(sized).attributes[0].values.length, 0);
  });

  test('moves points together: they stop together at a border and wrap where there is none', () => {
    const pattern = of([[0.5, 0.5], [0.75, 0.5]]);
    leavesAlone(pattern, (old) => move(old, [0, 1], 0.1, 0.1));
    assert.deepEqual(places(move(pattern, [0, 1], 0.5, 0.25)), [0.75, 0.75, 1, 0.75]);
    assert.deepEqual(places(move(pattern, [1], 0.5, 0)), [0.5, 0.5, 1, 0.5]);
    assert.deepEqual(places(move(withBoundary(pattern, 'periodic'), [0, 1], 0.5, -0.75)), [0, 0.75, 0.25, 0.75]);
  });

  test('is mirrored as a whole in its domain, and in part in its own box', () => {
    const pattern = of([[0.1, 0.25], [0.5, 0.75]]);
    leavesAlone(pattern, (old) => mirror(old, 0));
    assert.deepEqual(places(mirror(pattern, 0)), [0.9, 0.25, 0.5, 0.75]);
    assert.deepEqual(places(mirror(pattern, 1, [0, 1])), [0.1, 0.75, 0.5, 0.25]);
    assert.deepEqual(places(mirror(mirror(pattern, 1), 1)), places(pattern));
  });

  test('finds points by place, by stroke and by frame, also across the border of a tile', () => {
    const pattern = of([[0.02, 0.5], [0.5, 0.5], [0.98, 0.52]]);
    assert.equal(nearest(pattern, 0.49, 0.5, 0.05), 1);
    assert.equal(nearest(pattern, 0.3, 0.3, 0.05), -1);
    assert.equal(nearest(pattern, 1, 0.5, 0.025), -1);
    assert.equal(nearest(withBoundary(pattern, 'periodic'), 1, 0.49, 0.025), 0);
    assert.deepEqual(along(pattern, [0.4, 0.51], [1, 0.51], 0.03), [1, 2]);
    assert.deepEqual(along(pattern, [0.5, 0.6], [0.5, 0.6], 0.03), []);
    assert.deepEqual(within(pattern, [0.6, 0.6], [0, 0.4]), [0, 1]);
    assert.ok(contains(pattern, 1, 1) && !contains(pattern, 1.01, 1));
  });

  test('has names for its classes that are never taken, empty or too long', () => {
    const pattern = withClass(withClass(blank()));
    assert.deepEqual(pattern.classNames, ['points', 'class 2', 'class 3']);
    assert.deepEqual(renamed(pattern, 1, ' class 3 ').classNames, ['points', 'class 3 2', 'class 3']);
    assert.equal(renamed(pattern, 0, '  ').classNames[0], 'class');
    assert.equal([...renamed(pattern, 0, 'ä'.repeat(200)).classNames[0]].length, 60);
    let many = pattern;
    for (let i = 0; i < 30; i++) many = withClass(many);
    assert.equal(many.classNames.length, MAX_CLASSES);
    assert.equal(new Set(many.classNames).size, MAX_CLASSES);
  });

  test('has at most as many points as the engine takes', () => {
    const full = { ...blank(), positions: new Float64Array(2 * MAX_POINTS), classes: new Uint16Array(MAX_POINTS) };
    assert.equal(add(full, [0.5, 0.5], 0), full);
  });

  test('goes to the engine without classes of no point, digit by digit', () => {
    const three = withClass(withClass(of([[1 / 3, 0.1 + 0.2]])));
    const pattern = assign(add(three, [0.5, 0.5], 0), [0], 2);
    const small = compact(pattern);
    assert.deepEqual([small.classNames, [...small.classes]], [['points', 'class 3'], [1, 0]]);
    assert.deepEqual(sourceOf(pattern, 'mine'), { source: 'pattern', name: 'mine', pattern: small });
    assert.deepEqual(places(small), [1 / 3, 0.1 + 0.2, 0.5, 0.5]);
    assert.equal(compact(small), small, 'nothing is copied where nothing is left out');
  });

  test('is drawn in units of its longer side', () => {
    const pattern = of([[10, 20], [20, 60], [12.5, 35]], { domain: [10, 20, 20, 40] });
    const { points, size, min, unit, boundary } = viewOf(pattern);
    assert.deepEqual([...points.positions], [0, 0, 0.25, 1, 0.0625, 0.375]);
    assert.deepEqual([size, min, unit, boundary], [[0.5, 1], [10, 20], 40, 'open']);
  });
});

describe('a history', () => {
  test('goes back and forth, and forgets what was undone when something else is done', () => {
    const history = new History('a');
    assert.deepEqual([history.canUndo, history.undo(), history.redo()], [false, null, null]);
    history.push('b', 'made b');
    history.push('c', 'made c');
    assert.equal(history.undo(), 'made c');
    assert.equal(history.present, 'b');
    assert.equal(history.redo(), 'made c');
    assert.equal(history.present, 'c');
    history.undo();
    history.push('d', 'made d');
    assert.deepEqual([history.present, history.canRedo], ['d', false]);
    history.undo();
    history.undo();
    assert.deepEqual([history.present, history.canUndo], ['a', false]);
  });

  test('makes one step of a row of acts with one key, until something comes between', () => {
    const history = new History(0);
    for (const state of [1, 2, 3]) history.push(state, 'turned', 'wheel');
    history.push(4, 'turned', 'other');
    history.settle();
    history.push(5, 'turned', 'other');
    const seen = [history.present];
    while (history.canUndo) {
      history.undo();
      seen.push(history.present);
    }
    assert.deepEqual(seen, [5, 4, 3, 0]);
    history.redo();
    history.push(9, 'turned', 'wheel');
    assert.equal(history.undo(), 'turned');
    assert.equal(history.present, 3, 'what was done again is not added to');
  });

  test('keeps a limited number of steps, and an amended present', () => {
    const history = new History(0, 3);
    for (let i = 1; i <= 10; i++) history.push(i, `${i}`);
    history.amend(100);
    assert.equal(history.present, 100);
    for (let i = 0; i < 3; i++) assert.ok(history.undo());
    assert.deepEqual([history.present, history.canUndo], [7, false]);
    for (let i = 0; i < 3; i++) history.redo();
    assert.equal(history.present, 100);
  });
});
