// @ts-check
/** Hands on the result, as a person lays them on: mouse, finger, keyboard. */
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { iterations, launch, parameter, pause, peek, settled, status, withPage } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */
/** @typedef {[number, number]} Pair */

/** @type {import('./browser.mjs').Browser} */
let browser;
before(async () => void (browser = await launch()));
after(() => browser?.close());

/** @param {string} name @param {Parameters<typeof withPage>[1]} options @param {(page: Page) => Promise<void>} body */
const pageTest = (name, options, body) => test(name, { timeout: 180_000 }, () => withPage(browser, options, body));

const SMALL = 'channels:4,grid-min:16,grid-max:16';
/** A second, and done. */
const QUICK = { query: `?test=1&with=${SMALL},iterations-coarse:4,iterations-fine:3,iterations-polish:1` };
const ENDLESS = { query: `?test=1&with=${SMALL},iterations-coarse:5000,convergence-window:5000` };

/** Room around the pattern in its canvas. */
const MARGIN = 8;
/** Twice the exemplar's, whose is 1. */
const SIDE = 2;

/** @param {Page} page @returns {Promise<number[]>} */
const pinned = (page) => page.evaluate(() => /** @type {any} */ (window).pointweave.pinned);

/** Waits until so many points are pinned, and says which. @param {Page} page @param {number} count */
async function pins(page, count) {
  await page.waitForFunction((wanted) => /** @type {any} */ (window).pointweave.pinned.length === wanted, count, { polling: 50 });
  return pinned(page);
}

/** @param {Page} page @returns {Promise<string>} */
const hint = async (page) => (await page.locator('#touch-hint').textContent()) ?? '';

/** @param {Page} page @param {string} name */
const press = (page, name) => page.getByRole('button', { name, exact: true }).click();

/** @param {Page} page @returns {Promise<{ scale: number, at: (place: Pair) => Pair }>} from places in the result to the screen */
async function screen(page) {
  await page.locator('#output-canvas').scrollIntoViewIfNeeded();
  const box = await page.locator('#output-canvas').boundingBox();
  assert.ok(box);
  const scale = (box.width - 2 * MARGIN) / SIDE;
  return { scale, at: ([x, y]) => [box.x + MARGIN + scale * x, box.y + MARGIN + scale * y] };
}

/** @param {number[]} positions @param {number} index @returns {Pair} */
const place = (positions, index) => [positions[2 * index], positions[2 * index + 1]];

/** The point nearest to a place. @param {number[]} positions @param {Pair} where */
function nearest(positions, [x, y]) {
  const distance = (/** @type {number} */ i) => Math.hypot(positions[2 * i] - x, positions[2 * i + 1] - y);
  return [...Array(positions.length / 2).keys()].reduce((best, i) => (distance(i) < distance(best) ? i : best), 0);
}

/** Which points are elsewhere, by as little as a bit. @param {number[]} before @param {number[]} after */
const moved = (before, after) =>
  [...Array(before.length / 2).keys()].filter((i) => before[2 * i] !== after[2 * i] || before[2 * i + 1] !== after[2 * i + 1]);

/** Waits until the points are where they were, to the bit. @param {Page} page @param {number[]} before */
const back = (page, before) =>
  page.waitForFunction(
    (was) => /** @type {any} */ (window).pointweave.positions.every((/** @type {number} */ value, /** @type {number} */ i) => value === was[i]),
    before,
    { polling: 50 },
  );

/** @param {Page} page @param {Pair} from @param {Pair} to */
async function drag(page, from, to) {
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to, { steps: 6 });
  await page.mouse.up();
}

/** Draws a line with the mouse. @param {Page} page @param {Pair[]} line */
async function draw(page, line) {
  await page.mouse.move(...line[0]);
  await page.mouse.down();
  for (const corner of line.slice(1)) await page.mouse.move(...corner, { steps: 5 });
  await page.mouse.up();
}

/** @param {number} low @param {number} high @returns {Pair[]} */
const square = (low, high) => [[low, low], [high, low], [high, high], [low, high]];

describe('the result is touched', () => {
  pageTest('a point is dragged and pinned while it runs, and the others make room', ENDLESS, async (page) => {
    await iterations(page, 3);
    assert.match(await hint(page), /^Drag a point/);
    const { at, scale } = await screen(page);
    const start = nearest(await peek(page, 'positions'), [1, 1]);
    const from = at(place(await peek(page, 'positions'), start));
    const to = /** @type {Pair} */ ([from[0] + 31, from[1] - 17]);
    await page.mouse.move(...from);
    assert.equal(await page.locator('#output-canvas').evaluate((canvas) => getComputedStyle(canvas).cursor), 'grab');
    await page.mouse.down();
    await page.mouse.move(...to, { steps: 6 });
    // What runs learns of it before it is let go of.
    const [held] = await pins(page, 1);
    await page.mouse.up();
    assert.equal(await peek(page, 'status'), 'playing', 'it goes on');
    const [x, y] = at([0, 0]);
    const wanted = /** @type {Pair} */ ([(to[0] - x) / scale, (to[1] - y) / scale]);
    await page.waitForFunction(
      ([index, wantedX, wantedY, tolerance]) => {
        const { positions } = /** @type {any} */ (window).pointweave;
        return Math.hypot(positions[2 * index] - wantedX, positions[2 * index + 1] - wantedY) < tolerance;
      },
      [held, ...wanted, 1 / scale],
      { polling: 50 },
    );
    const put = await peek(page, 'positions');
    await iterations(page, (await peek(page, 'progress')).totalIterations + 8);
    const later = await peek(page, 'positions');
    assert.deepEqual(place(later, held), place(put, held), 'it stays to the bit');
    assert.ok(moved(put, later).length > 0.9 * (put.length / 2), 'the others move');
    assert.match(await hint(page), /^1 point pinned\. The others make room/);
    await pause(page);
    await press(page, 'Unpin it');
    await pins(page, 0);
    await press(page, 'Undo');
    assert.deepEqual(await pins(page, 1), [held]);
    await page.getByRole('button', { name: /^Continue/ }).click();
    await iterations(page, (await peek(page, 'progress')).totalIterations + 4);
    assert.deepEqual(place(await peek(page, 'positions'), held), place(put, held), 'pinned again, it still stays');
  });

  pageTest('what was done by hand is undone, wherever the focus is', QUICK, async (page) => {
    await status(page, 'finished');
    const before = await peek(page, 'positions');
    const { at } = await screen(page);
    const index = nearest(before, [0.6, 1.4]);
    const [x, y] = at(place(before, index));
    await drag(page, [x, y], [x + 20, y + 12]);
    assert.deepEqual(await pins(page, 1), [index]);
    const other = nearest(before, [1.5, 0.5]);
    await page.mouse.click(...at(place(before, other)));
    assert.deepEqual(await pins(page, 2), [index, other].sort((a, b) => a - b));
    assert.deepEqual(moved(before, await peek(page, 'positions')), [index], 'a click moves nothing');
    await page.getByRole('button', { name: 'Keep as A' }).focus();
    await page.keyboard.press('Control+z');
    assert.deepEqual(await pins(page, 1), [index]);
    await page.keyboard.press('Control+z');
    await pins(page, 0);
    await back(page, before.map(Math.fround));
    assert.ok(await page.getByRole('button', { name: 'Undo', exact: true }).isDisabled());
  });

  pageTest('a point dragged over the border comes in again where the result tiles', QUICK, async (page) => {
    await status(page, 'finished');
    const before = await peek(page, 'positions');
    const { at, scale } = await screen(page);
    const index = nearest(before, [1.95, 1]);
    const from = at(place(before, index));
    await drag(page, from, [at([2, 0])[0] + 0.1 * scale, from[1]]);
    assert.deepEqual(await pins(page, 1), [index]);
    const [x, y] = place(await peek(page, 'positions'), index);
    assert.ok(Math.abs(x - 0.1) < 2 / scale && Math.abs(y - before[2 * index + 1]) < 2 / scale, `${x} ${y}`);
  });

  pageTest('a region is drawn around and done again, and nothing else; undo brings it back', QUICK, async (page) => {
    await status(page, 'finished');
    const start = await peek(page, 'positions');
    const { at } = await screen(page);
    const held = nearest(start, [0.9, 0.9]);
    await page.mouse.click(...at(place(start, held)));
    await pins(page, 1);
    await press(page, 'Redo a region');
    assert.match(await hint(page), /^Draw around/);
    await draw(page, square(0.5, 1.3).map(at));
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.progress.redoing);
    assert.match((await page.locator('#fact-scale').textContent()) ?? '', /Redoing a region/);
    await status(page, 'finished');
    const others = moved(start, await peek(page, 'positions'));
    const within = (/** @type {number} */ i, /** @type {number} */ low, /** @type {number} */ high) =>
      place(start, i).every((value) => value > low && value < high);
    assert.ok(others.length > 10, `${others.length} points`);
    assert.deepEqual(others.filter((i) => !within(i, 0.48, 1.32)), [], 'everything else stays to the bit');
    const inside = [...Array(start.length / 2).keys()].filter((i) => within(i, 0.52, 1.28) && i !== held);
    assert.deepEqual(inside.filter((i) => !others.includes(i)), [], 'everything in it is another');
    assert.equal(others.includes(held), false, 'but what is pinned');
    assert.deepEqual(await pinned(page), [held]);
    await page.keyboard.press('Control+z');
    await back(page, start);
    await status(page, 'finished');
  });

  pageTest('a region without anything to do again says so and changes nothing', QUICK, async (page) => {
    await status(page, 'finished');
    const { at } = await screen(page);
    const start = await peek(page, 'positions');
    // The one that stands most alone.
    const all = [...Array(start.length / 2).keys()];
    const room = (/** @type {number} */ i) =>
      Math.min(...all.filter((j) => j !== i).map((j) => Math.hypot(start[2 * j] - start[2 * i], start[2 * j + 1] - start[2 * i + 1])));
    const inner = all.filter((i) => place(start, i).every((value) => value > 0.2 && value < 1.8));
    const index = inner.reduce((best, i) => (room(i) > room(best) ? i : best), inner[0]);
    const [x, y] = place(start, index);
    const half = 0.65 * room(index);
    await page.mouse.click(...at([x, y]));
    await pins(page, 1);
    await press(page, 'Redo a region');
    /** @type {Pair[]} */
    const around = [[x - half, y - half], [x + half, y - half], [x + half, y + half], [x - half, y + half]];
    await draw(page, around.map(at));
    await page.getByRole('alert').getByText('there is no point in this region that may move').waitFor();
    assert.equal(await peek(page, 'status'), 'finished');
    assert.deepEqual(moved(start, await peek(page, 'positions')), []);
    // Escape leaves wherever the focus is, also in the middle of a line.
    await press(page, 'Redo a region');
    await page.mouse.move(...at([0.2, 0.2]));
    await page.mouse.down();
    await page.mouse.move(...at([1.5, 0.4]), { steps: 4 });
    await page.keyboard.press('Escape');
    await page.mouse.up();
    assert.equal(await page.getByRole('button', { name: 'Redo a region' }).getAttribute('aria-pressed'), 'false');
    await settled(page);
    assert.deepEqual(moved(start, await peek(page, 'positions')), []);
  });

  pageTest('the keyboard chooses, pins, moves and does again', QUICK, async (page) => {
    await status(page, 'finished');
    const canvas = page.getByRole('application', { name: /^The result/ });
    await canvas.focus();
    const said = () => page.locator('#live').textContent();
    await page.keyboard.press('ArrowRight');
    const first = (await said()) ?? '';
    assert.match(first, /^Point \d+ of 240\.$/);
    await page.keyboard.press('ArrowRight');
    assert.notEqual(await said(), first, 'the next one');
    await page.keyboard.press('p');
    const [chosen] = await pins(page, 1);
    assert.equal(await said(), `Point ${chosen + 1} is pinned.`);
    const before = await peek(page, 'positions');
    await page.keyboard.press('Shift+ArrowDown');
    await page.waitForFunction(
      ([index, y]) => /** @type {any} */ (window).pointweave.positions[2 * index + 1] !== y,
      [chosen, before[2 * chosen + 1]],
      { polling: 50 },
    );
    const after = await peek(page, 'positions');
    assert.deepEqual(moved(before, after), [chosen]);
    assert.ok(after[2 * chosen + 1] > before[2 * chosen + 1] && after[2 * chosen] === before[2 * chosen], 'down');
    await page.keyboard.press('Delete');
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.progress.redoing);
    await status(page, 'finished');
    const redone = moved(after, await peek(page, 'positions'));
    const far = (/** @type {number} */ i) => Math.hypot(after[2 * i] - after[2 * chosen], after[2 * i + 1] - after[2 * chosen + 1]);
    assert.ok(redone.length > 3 && !redone.includes(chosen), `${redone.length} points`);
    assert.ok(Math.max(...redone.map(far)) < 0.4, 'only around it');
    for (let left = 3; left > 0; left--) {
      await page.keyboard.press('Control+z');
      await page.waitForTimeout(500);
    }
    await pins(page, 0);
    await back(page, before);
  });

  pageTest('a finger that rests on a point picks it up; one that swipes scrolls', { ...QUICK, viewport: { width: 390, height: 844 } }, async (page) => {
    const devtools = await browser.context.newCDPSession(page);
    await devtools.send('Emulation.setTouchEmulationEnabled', { enabled: true, maxTouchPoints: 2 });
    await status(page, 'finished');
    assert.equal(await hint(page), 'Hold a point, then drag it; a tap pins it.');
    /** @param {'touchStart' | 'touchMove' | 'touchEnd'} type @param {Pair[]} touches */
    const touch = (type, ...touches) =>
      devtools.send('Input.dispatchTouchEvent', { type, touchPoints: touches.map(([x, y], id) => ({ x, y, id })) });
    const start = await peek(page, 'positions');
    let { at, scale } = await screen(page);
    const index = nearest(start, [1, 0.5]);
    let [x, y] = at(place(start, index));
    const scrolled = () => page.evaluate(() => window.scrollY);
    const top = await scrolled();
    await touch('touchStart', [x, y]);
    await page.waitForTimeout(450);
    for (let i = 1; i <= 10; i++) await touch('touchMove', [x + 3 * i, y + 4 * i]);
    await touch('touchEnd');
    assert.deepEqual(await pins(page, 1), [index]);
    assert.equal(await scrolled(), top, 'dragging does not scroll the page');
    const put = place(await peek(page, 'positions'), index);
    assert.ok(Math.hypot(put[0] - start[2 * index] - 30 / scale, put[1] - start[2 * index + 1] - 40 / scale) < 2 / scale, `${put}`);

    const swiped = nearest(start, [0.4, 1.2]);
    [x, y] = at(place(start, swiped));
    await touch('touchStart', [x, y]);
    for (let i = 1; i <= 10; i++) await touch('touchMove', [x, y - 12 * i]);
    await touch('touchEnd');
    await page.waitForFunction((before) => window.scrollY > before + 50, top);
    assert.deepEqual(await pinned(page), [index], 'a swipe takes nothing');

    ({ at, scale } = await screen(page));
    const tapped = nearest(start, [1.5, 1]);
    await touch('touchStart', at(place(start, tapped)));
    await touch('touchEnd');
    await pins(page, 2);
    assert.ok((await pinned(page)).includes(tapped));

    await press(page, 'Redo a region');
    ({ at } = await screen(page));
    const here = await scrolled();
    const before = await peek(page, 'positions');
    const corners = square(0.3, 0.8).map(at);
    await touch('touchStart', corners[0]);
    for (const corner of corners.slice(1)) await touch('touchMove', corner);
    await touch('touchEnd');
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.progress.redoing);
    await status(page, 'finished');
    assert.ok(moved(before, await peek(page, 'positions')).length > 3);
    assert.equal(await scrolled(), here, 'drawing around does not scroll');
    const wide = await page.evaluate(() => document.documentElement.scrollWidth > document.documentElement.clientWidth);
    assert.equal(wide, false, 'nothing is wider than the phone');
  });
});

describe('a result is gone on from', () => {
  pageTest('with changed settings, its points and its pins', QUICK, async (page) => {
    await status(page, 'finished');
    const start = await peek(page, 'positions');
    const { at } = await screen(page);
    const index = nearest(start, [1, 1]);
    const [x, y] = at(place(start, index));
    await drag(page, [x, y], [x + 15, y + 15]);
    await pins(page, 1);
    const put = await peek(page, 'positions');
    const before = (await peek(page, 'progress')).totalIterations;
    await press(page, 'Go on');
    await page.waitForFunction((count) => /** @type {any} */ (window).pointweave.progress.totalIterations > count, before);
    await status(page, 'finished');
    const on = await peek(page, 'positions');
    assert.deepEqual(place(on, index), place(put, index), 'what is pinned stays');
    assert.ok(moved(put, on).length > 100, 'the others move');

    await page.getByLabel('Settings keep the points').check();
    const count = (await peek(page, 'progress')).totalIterations;
    await page.getByLabel('Open', { exact: true }).check({ force: true });
    await parameter(page, 'boundary', 'open');
    await status(page, 'finished');
    assert.ok((await peek(page, 'progress')).totalIterations > count, 'it went on, and did not begin again');
    assert.deepEqual(place(await peek(page, 'positions'), index), place(put, index));

    // Another size can't keep them: that is said, and the run stays until the person decides.
    const kept = await peek(page, 'positions');
    await page.getByLabel('Width').fill('3');
    await page.getByRole('alert').getByText('another size needs another start').waitFor();
    assert.deepEqual(await peek(page, 'positions'), kept);
    await press(page, 'Start anew');
    await parameter(page, 'expansion-x', 3);
    await pins(page, 0);

    // Without the choice a setting begins again.
    await status(page, 'finished');
    await page.getByLabel('Settings keep the points').uncheck();
    const long = (await peek(page, 'progress')).totalIterations;
    await page.getByLabel('Seed', { exact: true }).fill('7');
    await parameter(page, 'seed', 7);
    await status(page, 'finished');
    assert.ok((await peek(page, 'progress')).totalIterations <= long);
  });

  pageTest('after the page was loaded again', QUICK, async (page) => {
    await status(page, 'finished');
    const start = await peek(page, 'positions');
    const { at } = await screen(page);
    const index = nearest(start, [1, 1]);
    await page.mouse.click(...at(place(start, index)));
    await pins(page, 1);
    await page.waitForTimeout(1000);
    await page.reload();
    assert.deepEqual(await pins(page, 1), [index]);
    assert.deepEqual(moved(start, await peek(page, 'positions')), []);
  });
});

describe('two results are compared', () => {
  /** @param {Page} page */
  const drawn = (page) => page.locator('#output-canvas').evaluate((canvas) => /** @type {HTMLCanvasElement} */ (canvas).toDataURL());

  /**
   * The picture once it stands still: a point that was moved far is still drawn on its way when its place is known.
   *
   * @param {Page} page
   */
  async function picture(page) {
    for (let before = await drawn(page); ; ) {
      await page.waitForTimeout(600);
      const now = await drawn(page);
      if (now === before) return now;
      before = now;
    }
  }

  pageTest('A, as it was kept, in the place of B, with the same seed', { ...QUICK, viewport: { width: 390, height: 844 } }, async (page) => {
    await status(page, 'finished');
    await settled(page);
    assert.equal(await page.getByRole('radiogroup', { name: 'Result shown' }).isVisible(), false, 'there is nothing to compare');
    const plain = await picture(page);
    await press(page, 'Keep as A');
    assert.match((await page.locator('#differences').textContent()) ?? '', /^Same seed, 1\. No parameter differs yet\.$/);
    await page.getByText(/^Quality of A: \d\.\d\d\.$/).waitFor();
    await page.getByLabel('Open', { exact: true }).check({ force: true });
    await parameter(page, 'boundary', 'open');
    await status(page, 'finished');
    await settled(page);
    assert.match((await page.locator('#differences').textContent()) ?? '', /^Same seed, 1\. A → B: boundary periodic → open\.$/);
    await page.getByText(/^Quality of B: \d/).waitFor();
    const letters = page.getByRole('radiogroup', { name: 'Result shown' });
    const canvas = page.locator('#output-canvas');
    const other = await picture(page);
    assert.notEqual(other, plain);
    const positions = await peek(page, 'positions');
    await letters.getByLabel('A', { exact: true }).check();
    assert.ok(await letters.getByLabel('A', { exact: true }).isChecked());
    assert.equal(await picture(page), plain, 'A looks as it did');
    assert.match((await canvas.getAttribute('aria-label')) ?? '', /^A, the result that was kept/);
    assert.match(await hint(page), /^This is A/);
    assert.ok(await page.getByRole('button', { name: 'Redo a region' }).isDisabled(), 'A is only looked at');
    // The keyboard goes back.
    await letters.getByLabel('A', { exact: true }).press('ArrowRight');
    assert.ok(await letters.getByLabel('B', { exact: true }).isChecked());
    assert.equal(await picture(page), other, 'B looks as it did');
    assert.match((await canvas.getAttribute('aria-label')) ?? '', /^The result/);
    assert.deepEqual(await peek(page, 'positions'), positions, 'looking changes nothing');
    await letters.getByLabel('A', { exact: true }).check();
    const wide = await page.evaluate(() => document.documentElement.scrollWidth > document.documentElement.clientWidth);
    assert.equal(wide, false, 'nothing is wider than the phone');
    await press(page, 'Remove A');
    assert.equal(await letters.isVisible(), false);
    assert.equal(await picture(page), other);
  });

  pageTest('side by side where there is room; another exemplar drops A', QUICK, async (page) => {
    await status(page, 'finished');
    await press(page, 'Keep as A');
    const [a, b] = [page.getByRole('img', { name: 'A, the result that was kept' }), page.locator('#output-canvas')];
    const [boxA, boxB] = [await a.boundingBox(), await b.boundingBox()];
    assert.ok(boxA && boxB);
    assert.ok(Math.abs(boxA.width - boxB.width) < 1 && Math.abs(boxA.y - boxB.y) < 1, 'as large, and as high');
    assert.ok(boxA.x + boxA.width < boxB.x, 'beside it');
    await page.getByText('Flying geese', { exact: true }).first().click();
    await a.waitFor({ state: 'hidden' });
  });
});
