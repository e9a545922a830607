// @ts-check
/** Patterns of things: glyphs, sizes, directions and palettes on the real page. */
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { downloadText, iterations, launch, pause, peek, settled, withPage } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */

/** @type {import('./browser.mjs').Browser} */
let browser;
before(async () => void (browser = await launch()));
after(() => browser?.close());

/**
 * A page with that exemplar, paused, and with nothing chosen about looks.
 *
 * @param {string} name
 * @param {string} title of the exemplar
 * @param {Parameters<typeof withPage>[1]} options
 * @param {(page: Page) => Promise<void>} body
 */
const thingsTest = (name, title, options, body) =>
  test(name, { timeout: 240_000 }, () =>
    withPage(browser, options, async (page) => {
      // Once everything has come, so that the reload cuts nothing off.
      await iterations(page, 1);
      await page.evaluate(() => localStorage.removeItem('pointweave.look'));
      await page.reload();
      await choose(page, title);
      await body(page);
    }),
  );

/** @param {Page} page @param {string} title */
async function choose(page, title) {
  await page.locator('.exemplar-card', { hasText: title }).click();
  await page.waitForFunction((wanted) => document.getElementById('exemplar-title')?.textContent === wanted, title);
  await iterations(page, 1);
  await pause(page);
}

/**
 * How many pixels of a canvas have the colour of a class, and where they begin and end.
 *
 * @param {Page} page
 * @param {string} selector
 * @param {number} colour number of the class colour
 */
const painted = (page, selector, colour) =>
  page.evaluate(
    ([canvasSelector, number]) => {
      const canvas = /** @type {HTMLCanvasElement} */ (document.querySelector(String(canvasSelector)));
      const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
      const probe = document.createElement('i');
      probe.style.color = `var(--class-${number})`;
      document.body.append(probe);
      const wanted = (getComputedStyle(probe).color.match(/\d+/g) ?? []).map(Number);
      probe.remove();
      const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
      let count = 0;
      let sum = 0;
      for (let i = 0; i < data.length; i += 4) {
        if (data[i + 3] > 250 && wanted.every((value, channel) => Math.abs(value - data[i + channel]) <= 2)) {
          count++;
          sum += (i % 9973) + 1;
        }
      }
      return { count, sum };
    },
    /** @type {const} */ ([selector, colour]),
  );

const [HOUSES, TREES] = [1, 2];

describe('patterns of things', () => {
  thingsTest('houses and trees are drawn as such, on both sides and in the gallery', 'Houses among trees', {}, async (page) => {
    assert.deepEqual((await peek(page, 'look')).glyphs, {}, 'nothing is chosen, names say it');
    assert.equal(await page.getByLabel('house', { exact: true }).inputValue(), 'house');
    assert.equal(await page.getByLabel('tree', { exact: true }).inputValue(), 'tree');
    for (const canvas of ['#exemplar-canvas', '.exemplar-card:has(:checked) canvas']) {
      for (const colour of [HOUSES, TREES]) {
        const { count } = await painted(page, canvas, colour);
        assert.ok(count > 60, `${canvas}: ${count} pixels of colour ${colour}`);
      }
    }
    // Classes come one after the other: the houses have begun.
    assert.ok((await painted(page, '#output-canvas', HOUSES)).count > 200);
    assert.equal((await painted(page, '#exemplar-canvas', 4)).count, 0, 'no third class');
  });

  thingsTest('another glyph and another palette show at once, in files too, and stay', 'Houses among trees', {}, async (page) => {
    const before = await painted(page, '#exemplar-canvas', HOUSES);
    await page.getByLabel('house', { exact: true }).selectOption('star');
    const starred = await painted(page, '#exemplar-canvas', HOUSES);
    assert.notDeepEqual(starred, before);
    assert.deepEqual((await peek(page, 'look')).glyphs, { house: 'star' });
    const svg = (await downloadText(page, 'Download SVG')).text;
    assert.match(svg, /d="M0 -1\.6L0\.44 -0\.61/, 'a star in the file');
    assert.ok(svg.includes('#d55e00'));

    await page.getByLabel('Soft').check();
    assert.ok((await downloadText(page, 'Download SVG')).text.includes('#ee6677'));
    assert.ok((await painted(page, '#exemplar-canvas', HOUSES)).count > 60, 'the canvas has the new colour');
    await page.reload();
    // A reload keeps the exemplar, and a paused run stays paused.
    await page.waitForFunction(() => document.getElementById('exemplar-title')?.textContent === 'Houses among trees');
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave?.look.palette === 'bright');
    assert.deepEqual(await peek(page, 'look'), { glyphs: { house: 'star' }, palette: 'bright' });
    assert.ok(await page.getByLabel('Soft').isChecked());
  });

  thingsTest('an own path is drawn, a bad one is refused in words', 'Houses among trees', {}, async (page) => {
    await page.getByLabel('tree', { exact: true }).selectOption('Own path…');
    const field = page.getByLabel('SVG path data for tree');
    assert.ok(await field.evaluate((element) => element === document.activeElement), 'the field is ready to be written in');
    await field.fill('M0 0H10V10H0Z');
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.look.glyphs.tree === 'path:M0 0H10V10H0Z');
    const square = await painted(page, '#exemplar-canvas', TREES);
    assert.ok(square.count > 200, `${square.count}`);
    const { text } = await downloadText(page, 'Download SVG');
    // The trees may not have begun yet; their shape is in the file all the same.
    assert.match(text, /d="M-1 -1L1 -1L1 1L-1 1Z"/);

    await field.fill('M0 0X5 5"><script>');
    const words = page.locator('.look-error');
    await page.waitForFunction(() => document.querySelector('.look-error')?.textContent !== '');
    assert.match(await words.innerText(), /^Position 5 of the path: 'X' where a command/);
    assert.equal(await field.getAttribute('aria-invalid'), 'true');
    assert.deepEqual(await painted(page, '#exemplar-canvas', TREES), square, 'the last good one stays');
    assert.equal((await peek(page, 'look')).glyphs.tree, 'path:M0 0H10V10H0Z');

    await field.fill('M0 0C9 0 9 9 0 9Z');
    await page.waitForFunction(() => document.querySelector('.look-error')?.textContent === '');
    assert.notDeepEqual(await painted(page, '#exemplar-canvas', TREES), square);
    // Keys belong to the field here.
    const status = await peek(page, 'status');
    await field.press('Space');
    await field.press('r');
    assert.equal(await peek(page, 'status'), status);
    assert.ok((await peek(page, 'progress')).totalIterations > 0, 'no reset');
  });

  thingsTest('crowns are drawn to scale and come in on the other side of a tile', 'Grove', {}, async (page) => {
    // Old and young crowns of the exemplar cover 17 to 21 % of it.
    const { width, height } = await page.locator('#exemplar-canvas').evaluate((canvas) => {
      const { width, height } = /** @type {HTMLCanvasElement} */ (canvas);
      return { width, height };
    });
    const share = (await painted(page, '#exemplar-canvas', TREES)).count / (width * height);
    assert.ok(share > 0.13 && share < 0.24, `crowns cover ${share}`);
    await page.getByLabel('tree', { exact: true }).selectOption('ring');
    const rings = (await painted(page, '#exemplar-canvas', TREES)).count / (width * height);
    assert.ok(rings < 0.8 * share, `rings cover ${rings}`);
  });

  thingsTest('boats turn, and a meadow has four classes in depth', 'Boats', {}, async (page) => {
    await page.getByLabel('boat', { exact: true }).selectOption('arrow');
    await choose(page, 'Meadow');
    for (const colour of [2, 7, 3, 6]) {
      const { count } = await painted(page, '#exemplar-canvas', colour);
      assert.ok(count > 30, `${count} pixels of colour ${colour}`);
    }
    assert.deepEqual(await page.locator('.look-class label').allInnerTexts(), ['tree', 'bush', 'flower', 'stone']);
  });

  thingsTest('a dot is as it always was', 'Blue noise', {}, async (page) => {
    assert.deepEqual(await page.locator('.look-class label').allInnerTexts(), ['points']);
    const before = JSON.stringify(await peek(page, 'positions'));
    await page.getByLabel('points', { exact: true }).selectOption('triangle');
    await settled(page);
    assert.equal(JSON.stringify(await peek(page, 'positions')), before, 'a look moves nothing');
  });

  thingsTest('the look fits on a phone', 'Meadow', { viewport: { width: 360, height: 740 } }, async (page) => {
    await page.getByLabel('stone', { exact: true }).selectOption('Own path…');
    await page.getByLabel('SVG path data for stone').fill('M0 0L1 2 x');
    await page.waitForFunction(() => document.querySelector('.look-error')?.textContent !== '');
    const overflow = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
    assert.ok(overflow <= 0, `the page is ${overflow} px too wide`);
    for (const id of ['#look-class-0', '#look-palette']) {
      const box = await page.locator(id).boundingBox();
      assert.ok(box && box.x >= 0 && box.x + box.width <= 360, `${id}: ${JSON.stringify(box)}`);
    }
  });
});
