// @ts-check
/** Hands on the result, as a person lays them on: mouse, touch, keyboard. */
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';

import { launch, parameter, peek, status, withPage } from './browser.mjs';

/** @type {import('./browser.mjs').Browser} */
let browser;
before(async () => {
  browser = await launch();
});
after(() => browser.close());

const QUICK = '?test=1&with=channels:4,grid-min:16,grid-max:16,iterations-coarse:4,iterations-fine:3,iterations-polish:1';

/** @param {import('playwright-core').Page} page @returns {Promise<number[]>} */
const pinned = (page) => page.evaluate(() => /** @type {any} */ (window).pointweave.pinned);

/** Where a point is on the screen. @param {import('playwright-core').Page} page @param {number} index */
async function onScreen(page, index) {
  const positions = await peek(page, 'positions');
  const box = await page.locator('#output-canvas').boundingBox();
  assert.ok(box);
  const scale = (box.width - 16) / 2;
  return { x: box.x + 8 + scale * positions[2 * index], y: box.y + 8 + scale * positions[2 * index + 1], scale };
}

/** @param {number[]} before @param {number[]} after */
const moved = (before, after) =>
  Array.from({ length: before.length / 2 }, (_, i) => i).filter(
    (i) => before[2 * i] !== after[2 * i] || before[2 * i + 1] !== after[2 * i + 1],
  );

test('a point is dragged and pinned, and stays through the run', () =>
  withPage(browser, { query: QUICK }, async (page) => {
    await status(page, 'finished');
    const start = await peek(page, 'positions');
    const { x, y, scale } = await onScreen(page, 7);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 20, y + 12, { steps: 4 });
    await page.mouse.up();
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.pinned.length === 1);
    const [held] = await pinned(page);
    const put = await peek(page, 'positions');
    assert.deepEqual(moved(start, put), [held]);
    assert.ok(Math.abs(put[2 * held] - start[2 * held] - 20 / scale) < 0.02);
    await page.getByRole('button', { name: 'Go on' }).click();
    await status(page, 'playing');
    await status(page, 'finished');
    const end = await peek(page, 'positions');
    assert.equal(moved(put, end).includes(held), false, 'what is pinned stays');
    assert.ok(moved(put, end).length > 100, 'the others move');
    await page.getByRole('button', { name: 'Unpin it' }).click();
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.pinned.length === 0);
    await page.getByRole('button', { name: 'Undo' }).click();
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.pinned.length === 1);
  }));

test('a region is drawn around and done again, and nothing else; undo brings it back', () =>
  withPage(browser, { query: QUICK }, async (page) => {
    await status(page, 'finished');
    const start = await peek(page, 'positions');
    const box = await page.locator('#output-canvas').boundingBox();
    assert.ok(box);
    await page.getByRole('button', { name: 'Redo here' }).click();
    const corner = (/** @type {number} */ u, /** @type {number} */ v) =>
      /** @type {const} */ ([box.x + 8 + u * (box.width - 16), box.y + 8 + v * (box.height - 16)]);
    await page.mouse.move(...corner(0.25, 0.25));
    await page.mouse.down();
    for (const [u, v] of [[0.6, 0.25], [0.6, 0.6], [0.25, 0.6]]) await page.mouse.move(...corner(u, v), { steps: 5 });
    await page.mouse.up();
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.progress.redoing);
    await status(page, 'finished');
    const inside = (/** @type {number} */ i) =>
      [0, 1].every((axis) => start[2 * i + axis] > 0.51 && start[2 * i + axis] < 1.19);
    const outside = (/** @type {number} */ i) =>
      [0, 1].some((axis) => start[2 * i + axis] < 0.49 || start[2 * i + axis] > 1.21);
    const others = moved(start, await peek(page, 'positions'));
    assert.ok(others.length > 5);
    assert.equal(others.some(outside), false, 'everything else stays');
    const all = Array.from({ length: start.length / 2 }, (_, i) => i);
    assert.deepEqual(all.filter(inside).filter((i) => !others.includes(i)), []);
    await page.getByRole('button', { name: 'Undo' }).click();
    await page.waitForFunction((was) => /** @type {any} */ (window).pointweave.positions.every(
      (/** @type {number} */ value, /** @type {number} */ i) => value === was[i]), start);
  }));

test('the keyboard chooses, pins, moves and does again', () =>
  withPage(browser, { query: QUICK }, async (page) => {
    await status(page, 'finished');
    await page.locator('#output-canvas').focus();
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('p');
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.pinned.length === 1);
    const before = await peek(page, 'positions');
    await page.keyboard.press('Shift+ArrowRight');
    await page.waitForFunction((was) => /** @type {any} */ (window).pointweave.positions.some(
      (/** @type {number} */ value, /** @type {number} */ i) => value !== was[i]), before);
    assert.deepEqual(moved(before, await peek(page, 'positions')), await pinned(page));
    await page.keyboard.press('Delete');
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.progress.redoing);
    await status(page, 'finished');
  }));

test('settings keep the points when asked to, and A stands beside B', () =>
  withPage(browser, { query: QUICK }, async (page) => {
    await status(page, 'finished');
    await page.getByRole('button', { name: 'Keep as A' }).click();
    await page.getByLabel('Settings keep the points').check();
    const count = (await peek(page, 'progress')).totalIterations;
    await page.locator('#seed').fill('5');
    await parameter(page, 'seed', 5);
    await status(page, 'finished');
    assert.ok((await peek(page, 'progress')).totalIterations > count, 'it went on');
    assert.match((await page.locator('#differences').textContent()) ?? '', /seed 1 → 5/);
    await page.getByText(/^B: quality/).waitFor();
    await page.screenshot({ path: '/tmp/touch_ab.png' });
    await page.getByRole('button', { name: 'Remove' }).click();
    assert.equal(await page.locator('#kept').isVisible(), false);
  }));
