// @ts-check
/** Draws exemplars the way a person does: with mouse, finger, pen and keyboard. */
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { csvRows, downloadText, iterations, launch, parameter, pause, peek, status, withPage } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */
/** @typedef {import('../../www/common/pattern.js').Pattern} Pattern */
/** @typedef {[number, number]} Pair */
/**
 * @typedef {Omit<Pattern, 'positions' | 'classes' | 'attributes'> & { positions: number[], classes: number[],
 *   attributes: { name: string, values: number[] }[] }} Drawing
 */

/** @type {import('./browser.mjs').Browser} */
let browser;
before(async () => void (browser = await launch()));
after(() => browser?.close());

/**
 * @param {string} name
 * @param {Parameters<typeof withPage>[1]} options
 * @param {(page: Page) => Promise<void>} body
 */
const pageTest = (name, options, body) => test(name, { timeout: 240_000 }, () => withPage(browser, options, body));

/** The drawing as it stands. @param {Page} page @returns {Promise<Drawing>} */
async function drawing(page) {
  const found = await page.evaluate(() => {
    const pattern = /** @type {any} */ (window).pointweave.drawing;
    return pattern && {
      ...pattern,
      positions: [...pattern.positions],
      classes: [...pattern.classes],
      attributes: pattern.attributes.map((/** @type {any} */ { name, values }) => ({ name, values: [...values] })),
    };
  });
  assert.ok(found, 'the editor is open');
  return found;
}

/** @param {Page} page */
const count = async (page) => (await drawing(page)).classes.length;
/** @param {Page} page */
const canvas = (page) => page.getByRole('application', { name: /^The exemplar/ });
/** @param {Page} page */
const says = (page) => page.locator('#editor-status').innerText();

/** Where a place of the unit square is on the screen: 22 pixels around it belong to the margin. @param {Page} page */
async function screen(page) {
  await canvas(page).scrollIntoViewIfNeeded();
  const box = await canvas(page).boundingBox();
  assert.ok(box);
  return (/** @type {Pair} */ [u, v]) => /** @type {Pair} */ ([box.x + 22 + u * (box.width - 44), box.y + 22 + v * (box.height - 44)]);
}

/** @param {Page} page */
async function openBlank(page) {
  await iterations(page, 1);
  await page.getByRole('button', { name: 'Draw your own' }).click();
  await canvas(page).waitFor();
}

/** @param {Page} page @param {Pair} at */
async function click(page, at) {
  const to = await screen(page);
  await page.mouse.click(...to(at));
}

/** @param {Page} page @param {Pair[]} way @param {'left' | 'right'} [button] */
async function drag(page, way, button = 'left') {
  const to = await screen(page);
  await page.mouse.move(...to(way[0]));
  await page.mouse.down({ button });
  for (const at of way.slice(1)) await page.mouse.move(...to(at), { steps: 12 });
  await page.mouse.up({ button });
}

/** @param {Page} page @param {'Draw' | 'Select' | 'Erase' | 'Class'} name */
const tool = (page, name) => page.getByRole('radiogroup', { name: 'Tool' }).getByRole('radio', { name }).check();

/** @param {number[]} found @param {number[]} wanted @param {number} slack */
function near(found, wanted, slack) {
  assert.equal(found.length, wanted.length, `${found} for ${wanted}`);
  for (const [i, value] of found.entries()) assert.ok(Math.abs(value - wanted[i]) <= slack, `${found} for ${wanted}`);
}

/** A pixel on the screen, and a little rounding. */
const PIXEL = 0.004;

describe('the editor', () => {
  pageTest('draws with the mouse, weaves from the drawing, and gives it away', {}, async (page) => {
    await openBlank(page);
    assert.equal(await count(page), 0);
    assert.match(await says(page), /blank/);
    await click(page, [0.25, 0.5]);
    near((await drawing(page)).positions, [0.25, 0.5], PIXEL);
    assert.match(await says(page), /Added a point at 0\.2\d+, 0\.\d+/);
    // A stroke is a row of points at a distance from one another, and one step.
    await drag(page, [[0.1, 0.1], [0.9, 0.1]]);
    const row = (await drawing(page)).positions.slice(2);
    assert.ok(row.length / 2 >= 10, `${row.length / 2} points`);
    for (let i = 2; i < row.length; i += 2) assert.ok(row[i] - row[i - 2] > 0.02, 'they keep their distance');
    const drawn = await count(page);
    // The drawing is woven by itself, and the gallery has it.
    await page.waitForFunction((points) => /** @type {any} */ (window).pointweave.positions.length === 8 * points, drawn);
    assert.equal(await page.locator('.exemplar-card:has(:checked) strong').innerText(), 'Your drawing');
    assert.ok(await page.locator('#output-canvas').isVisible(), 'the result is to be seen meanwhile');
    assert.ok(await page.locator('#exemplar-canvas').isHidden());
    await page.getByRole('button', { name: 'Use it' }).click();
    assert.equal(await peek(page, 'drawing'), null);
    assert.equal(await page.locator('#exemplar-title').innerText(), 'Your drawing');
    assert.equal(await page.locator('#exemplar-count').innerText(), `${drawn} points`);
    await iterations(page, 2);
    await pause(page);
    assert.equal(csvRows((await downloadText(page, 'Download CSV')).text).length, 4 * drawn);
    // Editing goes on where it was left.
    await page.getByRole('button', { name: 'Edit', exact: true }).click();
    assert.equal(await count(page), drawn);
  });

  pageTest('moves what is there instead of drawing on top of it', {}, async (page) => {
    await openBlank(page);
    await click(page, [0.25, 0.5]);
    await click(page, [0.75, 0.5]);
    await drag(page, [[0.25, 0.5], [0.4, 0.3]]);
    near((await drawing(page)).positions, [0.4, 0.3, 0.75, 0.5], PIXEL);
    await drag(page, [[0.75, 0.5], [1.5, 0.6]]);
    near((await drawing(page)).positions, [0.4, 0.3, 1, 0.6], PIXEL);
    // A click far outside the border is none.
    const to = await screen(page);
    await page.mouse.click(...to([-0.03, 0.5]));
    assert.equal(await count(page), 2);
  });

  pageTest('undoes and does again, by button and by key', {}, async (page) => {
    await openBlank(page);
    const undo = page.getByRole('button', { name: 'Undo' });
    const redo = page.getByRole('button', { name: 'Redo' });
    assert.ok(await undo.isDisabled());
    for (const x of [0.2, 0.4, 0.6]) await click(page, [x, 0.5]);
    await drag(page, [[0.6, 0.5], [0.6, 0.8]]);
    const moved = await drawing(page);
    await undo.click();
    assert.match(await says(page), /^Undone: moved the point/);
    near((await drawing(page)).positions, [0.2, 0.5, 0.4, 0.5, 0.6, 0.5], PIXEL);
    await canvas(page).focus();
    await page.keyboard.press('Control+z');
    assert.equal(await count(page), 2);
    await page.keyboard.press('Control+Shift+Z');
    await page.keyboard.press('Control+y');
    assert.deepEqual(await drawing(page), moved);
    assert.ok(await redo.isDisabled());
    await page.getByRole('button', { name: 'Clear' }).click();
    assert.equal(await count(page), 0);
    await page.keyboard.press('Control+z');
    assert.deepEqual(await drawing(page), moved);
    await click(page, [0.1, 0.1]);
    assert.ok(await redo.isDisabled(), 'what was undone is forgotten');
  });

  pageTest('selects with a frame: moves, deletes, mirrors and classifies what is in it', {}, async (page) => {
    await openBlank(page);
    for (const at of /** @type {Pair[]} */ ([[0.2, 0.2], [0.3, 0.4], [0.8, 0.8]])) await click(page, at);
    await tool(page, 'Select');
    await drag(page, [[0.1, 0.1], [0.5, 0.5]]);
    assert.match(await page.locator('#editor-count').innerText(), /2 selected/);
    await drag(page, [[0.2, 0.2], [0.3, 0.3]]);
    near((await drawing(page)).positions, [0.3, 0.3, 0.4, 0.5, 0.8, 0.8], 2 * PIXEL);
    await page.getByRole('button', { name: 'Mirror left and right' }).click();
    near((await drawing(page)).positions, [0.4, 0.3, 0.3, 0.5, 0.8, 0.8], 2 * PIXEL);
    await page.getByRole('button', { name: '+ Class' }).click();
    assert.deepEqual((await drawing(page)).classes, [1, 1, 0], 'a new class is the selection’s');
    await page.getByRole('button', { name: 'points', exact: true }).click();
    assert.deepEqual((await drawing(page)).classes, [0, 0, 0]);
    // Shift adds to the selection, by frame and by click.
    await page.keyboard.down('Shift');
    await drag(page, [[0.7, 0.7], [0.9, 0.9]]);
    assert.match(await page.locator('#editor-count').innerText(), /3 selected/);
    await click(page, [0.3, 0.5]);
    await page.keyboard.up('Shift');
    assert.match(await page.locator('#editor-count').innerText(), /2 selected/);
    await page.getByRole('button', { name: 'Delete the selection' }).click();
    near((await drawing(page)).positions, [0.3, 0.5], 2 * PIXEL);
    await page.getByRole('button', { name: 'Mirror top and bottom' }).click();
    await page.getByRole('button', { name: 'Mirror left and right' }).click();
    near((await drawing(page)).positions, [0.7, 0.5], 2 * PIXEL);
  });

  pageTest('has a brush for classes and one that erases, up to sixteen classes', {}, async (page) => {
    await openBlank(page);
    await drag(page, [[0.1, 0.3], [0.9, 0.3]]);
    await drag(page, [[0.1, 0.7], [0.9, 0.7]]);
    const { classes, positions } = await drawing(page);
    await page.keyboard.press('Escape');
    await page.getByRole('button', { name: '+ Class' }).click();
    await page.getByLabel('Name of the class').fill('oak');
    await page.keyboard.press('Enter');
    await tool(page, 'Class');
    await drag(page, [[0.05, 0.7], [0.95, 0.7]]);
    const painted = await drawing(page);
    assert.deepEqual(painted.classNames, ['points', 'oak']);
    assert.deepEqual(painted.classes, classes.map((_, i) => (positions[2 * i + 1] > 0.5 ? 1 : 0)));
    await tool(page, 'Erase');
    await drag(page, [[0.05, 0.3], [0.95, 0.3]]);
    assert.deepEqual(new Set((await drawing(page)).classes), new Set([1]));
    // The right button erases with any tool.
    await tool(page, 'Draw');
    await click(page, [0.5, 0.2]);
    assert.equal((await drawing(page)).classes.at(-1), 1, 'the brush keeps its class');
    const total = await count(page);
    await drag(page, [[0.5, 0.19], [0.5, 0.21]], 'right');
    assert.equal(await count(page), total - 1);
    for (let i = 0; i < 14; i++) await page.getByRole('button', { name: '+ Class' }).click();
    assert.equal((await drawing(page)).classNames.length, 16);
    assert.ok(await page.getByRole('button', { name: '+ Class' }).isDisabled());
    // Two classes are left of all that when it is woven.
    await tool(page, 'Draw');
    await click(page, [0.5, 0.5]);
    await page.waitForFunction(
      (points) => /** @type {any} */ (window).pointweave.positions.length > 0 && document.getElementById('exemplar-count')?.textContent === `${points} points`,
      total,
    );
    assert.equal(await page.locator('.notice').count(), 0);
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.progress?.classes === 2);
  });

  pageTest('gives points a size by wheel, handle and slider', {}, async (page) => {
    await openBlank(page);
    await click(page, [0.3, 0.5]);
    await click(page, [0.7, 0.5]);
    const radii = async () => (await drawing(page)).attributes[0].values;
    assert.equal((await drawing(page)).attributes.length, 0);
    await page.getByLabel('Sizes', { exact: true }).check();
    const [start] = await radii();
    assert.ok(start > 0.002 && start < 0.05, `${start}`);
    const to = await screen(page);
    await page.mouse.move(...to([0.3, 0.5]));
    for (let i = 0; i < 6; i++) await page.mouse.wheel(0, -120);
    await page.waitForFunction((before) => /** @type {any} */ (window).pointweave.drawing.attributes[0].values[0] > 1.8 * before, start);
    assert.equal((await radii())[1], start, 'the other is as it was');
    // All turns are one step.
    await page.keyboard.press('Control+z');
    assert.deepEqual(await radii(), [start, start]);
    // A click selects and shows the handle, 18 pixels outside the mark.
    await page.mouse.click(...to([0.3, 0.5]));
    const [x, y] = to([0.3, 0.5]);
    const scale = (to([1, 0])[0] - to([0, 0])[0]);
    const from = x + start * scale + 18;
    await page.mouse.move(from, y);
    await page.mouse.down();
    await page.mouse.move(from + 20, y, { steps: 5 });
    await page.mouse.up();
    near(await radii(), [start + 20 / scale, start], 2 / scale);
    await page.getByLabel('Size of new points, or of the selection').fill('0.1');
    near(await radii(), [0.1, start], 1e-3);
    // The wheel beside the points scrolls; nothing changes.
    await page.mouse.move(...to([0.5, 0.2]));
    await page.mouse.wheel(0, -120);
    near(await radii(), [0.1, start], 1e-3);
    await page.getByLabel('Sizes', { exact: true }).uncheck();
    assert.equal((await drawing(page)).attributes.length, 0);
  });

  pageTest('can be drawn with a finger, and with a pen that erases', { viewport: { width: 360, height: 740 } }, async (page) => {
    await openBlank(page);
    const devtools = await browser.context.newCDPSession(page);
    await devtools.send('Emulation.setTouchEmulationEnabled', { enabled: true, maxTouchPoints: 2 });
    const to = await screen(page);
    /** @param {'touchStart' | 'touchMove' | 'touchEnd' | 'touchCancel'} type @param {Pair[]} touches */
    const touch = (type, ...touches) =>
      devtools.send('Input.dispatchTouchEvent', { type, touchPoints: touches.map(([x, y], id) => ({ x, y, id })) });
    await touch('touchStart', to([0.5, 0.5]));
    await touch('touchEnd');
    near((await drawing(page)).positions, [0.5, 0.5], 2 * PIXEL);
    const scrolled = await page.evaluate(() => window.scrollY);
    await touch('touchStart', to([0.1, 0.2]));
    for (let i = 1; i <= 20; i++) await touch('touchMove', to([0.1 + 0.04 * i, 0.2 + 0.03 * i]));
    await touch('touchEnd');
    assert.ok((await count(page)) > 6, `${await count(page)} points`);
    assert.equal(await page.evaluate(() => window.scrollY), scrolled, 'drawing does not scroll the page');
    assert.match(await says(page), /^Added \d+ points/);
    // What is taken away from the finger was never drawn.
    const before = await count(page);
    await touch('touchStart', to([0.9, 0.1]));
    await touch('touchCancel');
    assert.equal(await count(page), before);
    await tool(page, 'Erase');
    await touch('touchStart', to([0.5, 0.5]));
    await touch('touchEnd');
    assert.ok((await count(page)) < before);
    await page.getByRole('button', { name: 'Undo' }).click();
    assert.equal(await count(page), before);
    // A pen draws; its other end erases.
    await tool(page, 'Draw');
    const again = await screen(page);
    const pen = (/** @type {'mousePressed' | 'mouseMoved' | 'mouseReleased'} */ type, /** @type {Pair} */ [x, y], /** @type {number} */ buttons) =>
      devtools.send('Input.dispatchMouseEvent', { type, x, y, button: 'left', buttons, clickCount: 1, pointerType: 'pen' });
    await pen('mousePressed', again([0.9, 0.1]), 1);
    await pen('mouseReleased', again([0.9, 0.1]), 0);
    near((await drawing(page)).positions.slice(-2), [0.9, 0.1], 2 * PIXEL);
    const [x, y] = again([0.9, 0.1]);
    await canvas(page).evaluate(
      (element, [clientX, clientY]) => {
        // No driver of browsers knows the eraser of a pen. It can't be captured either, which is right for a made-up pointer.
        element.setPointerCapture = () => {};
        const init = { clientX, clientY, pointerType: 'pen', pointerId: 77, button: 5, buttons: 32, bubbles: true };
        element.dispatchEvent(new PointerEvent('pointerdown', init));
        element.dispatchEvent(new PointerEvent('pointerup', { ...init, buttons: 0 }));
      },
      [x, y],
    );
    assert.equal(await count(page), before);
  });

  pageTest('can be drawn with the keyboard alone, and says what happens', {}, async (page) => {
    await iterations(page, 1);
    await page.getByRole('button', { name: 'Draw your own' }).focus();
    await page.keyboard.press('Enter');
    await canvas(page).and(page.locator(':focus')).waitFor();
    assert.match((await canvas(page).getAttribute('aria-describedby')) ?? '', /editor-hint/);
    assert.equal(await page.locator('#editor-status').getAttribute('role'), 'status');
    await page.keyboard.press('ArrowRight');
    assert.match(await says(page), /^Cursor at 0\.517, 0\.500/);
    await page.keyboard.press('Enter');
    assert.match(await says(page), /^Added a point at 0\.517, 0\.500\. 1 point\./);
    await page.keyboard.press('Enter');
    assert.match(await says(page), /already/);
    await page.keyboard.press('Shift+ArrowUp');
    await page.keyboard.press('Enter');
    await page.keyboard.press('Shift+ArrowLeft');
    await page.keyboard.press('Enter');
    near((await drawing(page)).positions, [31 / 60, 0.5, 31 / 60, 25 / 60, 26 / 60, 25 / 60], 1e-9);
    // From point to point, and on with the page after the last one.
    await page.keyboard.press('Tab');
    assert.match(await says(page), /^Point 1 of 3 at 0\.517, 0\.500/);
    await page.keyboard.press('m');
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('ArrowDown');
    near((await drawing(page)).positions.slice(0, 2), [31 / 60, 32 / 60], 1e-9);
    await page.keyboard.press('Escape');
    near((await drawing(page)).positions.slice(0, 2), [31 / 60, 0.5], 1e-9);
    await page.keyboard.press('m');
    await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('m');
    near((await drawing(page)).positions.slice(0, 2), [30 / 60, 0.5], 1e-9);
    await page.keyboard.press('Control+z');
    near((await drawing(page)).positions.slice(0, 2), [31 / 60, 0.5], 1e-9);
    await page.keyboard.press('+');
    const { attributes } = await drawing(page);
    assert.ok(Number(attributes[0].values[0]) > attributes[0].values[1]);
    await page.getByRole('button', { name: '+ Class' }).focus();
    await page.keyboard.press('Enter');
    await canvas(page).focus();
    assert.deepEqual((await drawing(page)).classes, [1, 0, 0]);
    await page.keyboard.press('1');
    assert.deepEqual((await drawing(page)).classes, [0, 0, 0]);
    await page.keyboard.press('Control+a');
    assert.match(await says(page), /^3 points selected/);
    await page.keyboard.press('2');
    assert.deepEqual((await drawing(page)).classes, [1, 1, 1]);
    await page.keyboard.press('Escape');
    await page.keyboard.press('Shift+ArrowRight');
    await page.keyboard.press('Delete');
    assert.match(await says(page), /no point/);
    // Nobody is caught in the drawing.
    await page.keyboard.press('Escape');
    await page.keyboard.press('Tab');
    assert.equal(await canvas(page).and(page.locator(':focus')).count(), 0);
    await canvas(page).focus();
    for (let i = 0; i < 4; i++) await page.keyboard.press('Tab');
    assert.equal(await canvas(page).and(page.locator(':focus')).count(), 0, 'after the last point the focus moves on');
    await page.keyboard.press('Shift+Tab');
    await page.keyboard.press('Shift+Tab');
    await page.keyboard.press('Delete');
    assert.equal(await count(page), 2);
    // The arrows were the drawing's and made no iteration; Space is still the run's.
    await status(page, 'playing');
    await canvas(page).focus();
    await page.keyboard.press('Space');
    await status(page, 'paused');
  });

  pageTest('edits a copy of the gallery’s, keeps its border, and leaves no trace when it is discarded', {}, async (page) => {
    await iterations(page, 1);
    await parameter(page, 'boundary', 'periodic');
    const total = Number((await page.locator('#exemplar-count').innerText()).match(/\d+/)?.[0]);
    await page.getByRole('button', { name: 'Edit', exact: true }).click();
    await page.locator('#editor-status', { hasText: 'copy of Rings' }).waitFor();
    const copy = await drawing(page);
    assert.deepEqual([copy.classes.length, copy.boundary], [total, 'periodic']);
    await page.getByRole('radio', { name: 'Window' }).check();
    await click(page, [0.5, 0.5]);
    const changed = await count(page);
    await parameter(page, 'boundary', 'open');
    await page.waitForFunction((points) => document.getElementById('exemplar-count')?.textContent === `${points} points`, changed);
    await page.getByRole('button', { name: 'Discard' }).click();
    await parameter(page, 'boundary', 'periodic');
    await page.waitForFunction((points) => document.getElementById('exemplar-count')?.textContent === `${points} points`, total);
    assert.equal(await page.locator('#exemplar-title').innerText(), 'Rings');
    assert.equal(await page.locator('.exemplar-card:has(:checked) strong').innerText(), 'Rings');
    assert.equal(await page.getByText('Your drawing').count(), 0);
    // Second thoughts are welcome.
    await page.getByRole('button', { name: 'Bring it back' }).click();
    assert.equal(await count(page), changed);
    await page.getByRole('button', { name: 'Use it' }).click();
    await page.waitForFunction((points) => document.getElementById('exemplar-count')?.textContent === `${points} points`, changed);
    assert.equal(await page.locator('#exemplar-title').innerText(), 'Your drawing');
  });

  pageTest('keeps a drawing when another exemplar is chosen, and does not weave from nothing', {}, async (page) => {
    await openBlank(page);
    await page.getByLabel('Weave as I draw').uncheck();
    await page.getByRole('button', { name: 'Use it' }).click();
    assert.match(await says(page), /at least 2 points/);
    for (const at of /** @type {Pair[]} */ ([[0.2, 0.2], [0.7, 0.3], [0.4, 0.8]])) await click(page, at);
    await page.waitForTimeout(1000);
    assert.equal(await page.locator('#exemplar-title').textContent(), 'Rings', 'nothing is woven unasked');
    await page.locator('.exemplar-card:has([value="maze"])').click();
    await page.waitForFunction(() => document.getElementById('exemplar-title')?.textContent === 'Maze');
    assert.equal(await peek(page, 'drawing'), null);
    await page.locator('.exemplar-card', { hasText: 'Your drawing' }).click();
    await page.waitForFunction(() => document.getElementById('exemplar-count')?.textContent === '3 points');
    await iterations(page, 2);
    await page.getByRole('button', { name: 'Draw your own' }).click();
    assert.equal(await count(page), 0);
    await click(page, [0.5, 0.5]);
    await page.locator('.exemplar-card:has([value="maze"])').click();
    assert.equal(await page.locator('.exemplar-card strong', { hasText: 'Your drawing' }).count(), 2, 'one drawing does not replace another');
  });

  pageTest('fits on a small screen', { viewport: { width: 360, height: 740 } }, async (page) => {
    await openBlank(page);
    await page.getByRole('button', { name: '+ Class' }).click();
    await page.getByLabel('Sizes', { exact: true }).check();
    await page.getByText('Keys and gestures', { exact: true }).click();
    for (const width of [360, 700, 900, 1200]) {
      await page.setViewportSize({ width, height: 740 });
      await page.waitForTimeout(200);
      const widest = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
      assert.ok(widest <= 0, `${widest} px too wide at ${width}`);
      const { right, height } = await canvas(page).evaluate((element) => element.getBoundingClientRect().toJSON());
      assert.ok(right <= width && height >= 260, `the drawing ends at ${right} of ${width}, ${height} high`);
    }
  });
});
