// @ts-check
/** What can be taken away, and brought back. */
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { after, before, describe, test } from 'node:test';

import { csvRows, drop, farthest, iterations, launch, parameter, pause, peek, settled, status, useIt, withPage } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */

/** @type {import('./browser.mjs').Browser} */
let browser;
before(async () => {
  browser = await launch();
  await browser.context.grantPermissions(['clipboard-read', 'clipboard-write'], { origin: new URL(browser.url).origin });
});
after(() => browser?.close());

/** @param {string} name @param {(page: Page) => Promise<void>} body */
const pageTest = (name, body) => test(name, { timeout: 120_000 }, () => withPage(browser, {}, body));

/** Clicks a button and gives the file. @param {Page} page @param {string} button */
async function file(page, button) {
  const [download] = await Promise.all([
    page.waitForEvent('download'),
    page.getByRole('button', { name: button, exact: true }).click(),
  ]);
  return { name: download.suggestedFilename(), bytes: await readFile(await download.path()) };
}

/** A paused run after a few iterations. @param {Page} page */
async function paused(page) {
  await status(page, 'playing');
  await iterations(page, 3);
  await pause(page);
  await page.getByText('More ways').click();
}

/** Width and height in a PNG's header. @param {Buffer} bytes */
function pngSize(bytes) {
  assert.equal(bytes.subarray(1, 4).toString('latin1'), 'PNG');
  return [bytes.readUInt32BE(16), bytes.readUInt32BE(20)];
}

/**
 * Rows with ink in the first and the last column, and all ink, of a PNG.
 *
 * @param {Page} page
 * @param {Buffer} bytes
 */
const ink = (page, bytes) =>
  page.evaluate(async (numbers) => {
    const picture = await createImageBitmap(new Blob([new Uint8Array(numbers)], { type: 'image/png' }));
    const context = /** @type {OffscreenCanvasRenderingContext2D} */ (new OffscreenCanvas(picture.width, picture.height).getContext('2d'));
    context.drawImage(picture, 0, 0);
    const { data, width, height } = context.getImageData(0, 0, picture.width, picture.height);
    const dark = (/** @type {number} */ x, /** @type {number} */ y) => data[4 * (y * width + x)] < 128;
    const rows = Array.from({ length: height }, (_, y) => y);
    return {
      first: rows.filter((y) => dark(0, y)),
      last: rows.filter((y) => dark(width - 1, y)),
      share: data.filter((value, index) => index % 4 === 0 && value < 128).length / (width * height),
    };
  }, [...bytes]);

describe('the result can be taken as', () => {
  pageTest('CSV, NPY and a table for the clipboard, with the same points', async (page) => {
    await paused(page);
    const positions = await peek(page, 'positions');
    const csv = await file(page, 'Download CSV');
    assert.equal(csv.name, 'pointweave-rings.csv');
    const rows = csvRows(csv.bytes.toString('utf8')).map((row) => row.split(',').map(Number));
    assert.equal(rows.length, positions.length / 2);
    const npy = await file(page, 'Download NPY');
    assert.equal(npy.name, 'pointweave-rings.npy');
    assert.equal(npy.bytes.subarray(1, 6).toString('latin1'), 'NUMPY');
    const header = npy.bytes.subarray(10, 10 + npy.bytes.readUInt16LE(8)).toString('latin1');
    assert.match(header, /'descr': '<f8'.*'shape': \(240, 2\)/);
    const values = npy.bytes.subarray(10 + npy.bytes.readUInt16LE(8));
    for (const [index, [x, y]] of rows.entries()) {
      assert.equal(values.readDoubleLE(16 * index), x);
      assert.equal(values.readDoubleLE(16 * index + 8), y);
    }
    assert.ok(farthest(positions, rows.flatMap(([x, y]) => [x, y])) < 1e-6, 'the points that are shown');
    await page.getByRole('button', { name: 'Copy table' }).click();
    await page.getByRole('button', { name: 'Copied' }).waitFor();
    const table = await page.evaluate(() => navigator.clipboard.readText());
    const cells = table.split(/\r?\n/).filter((line) => /^-?[\d.]/.test(line)).map((line) => line.split('\t').map(Number));
    assert.deepEqual(cells.map(([x, y]) => [x, y]), rows.map(([x, y]) => [x, y]));
    await page.getByRole('button', { name: 'Copy table' }).waitFor();
  });

  pageTest('PNG at the size that was asked for, and on the clipboard', async (page) => {
    await paused(page);
    await page.getByLabel('Picture size').fill('500');
    const png = await file(page, 'Download PNG');
    assert.equal(png.name, 'pointweave-rings.png');
    assert.deepEqual(pngSize(png.bytes), [500, 500]);
    const { first, last, share } = await ink(page, png.bytes);
    assert.ok(share > 0.01 && share < 0.3, `${share} of it is ink`);
    assert.deepEqual([first, last], [[], []], 'the margin is free');
    await page.getByRole('button', { name: 'Copy picture' }).click();
    await page.getByRole('button', { name: 'Copied' }).waitFor();
    const types = await page.evaluate(async () => (await navigator.clipboard.read()).flatMap(({ types }) => types));
    assert.deepEqual(types, ['image/png']);
    for (const width of ['63', '9000', '1.5', '']) {
      await page.getByLabel('Picture size').fill(width);
      assert.equal(await page.getByLabel('Picture size').getAttribute('aria-invalid'), 'true');
      await page.getByRole('button', { name: 'Download PNG' }).click();
      await page.getByText('A picture is 64 to 8192 pixels wide').waitFor();
      await page.getByRole('button', { name: 'Dismiss' }).click();
    }
  });

  pageTest('one seamless tile, where the result is periodic', async (page) => {
    await paused(page);
    await page.getByLabel('Picture size').fill('600');
    const png = await file(page, 'Tile as PNG');
    assert.equal(png.name, 'pointweave-rings-tile.png');
    assert.deepEqual(pngSize(png.bytes), [600, 600]);
    const { first, last } = await ink(page, png.bytes);
    assert.ok(first.length > 0, 'marks lie on the border');
    const both = first.filter((y) => last.includes(y));
    assert.ok(both.length >= 0.6 * Math.max(first.length, last.length), `rows ${first} go on in rows ${last}`);
    const svg = (await file(page, 'Tile as SVG')).bytes.toString('utf8');
    const circles = await page.evaluate((text) => {
      const parsed = new DOMParser().parseFromString(text, 'image/svg+xml');
      return parsed.querySelector('parsererror') ? -1 : parsed.querySelectorAll('circle').length;
    }, svg);
    assert.ok(circles > 240, `${circles} circles: those on the border on both sides`);
    await page.getByRole('radio', { name: 'Open', exact: true }).check();
    await parameter(page, 'boundary', 'open');
    await page.getByRole('button', { name: 'Tile as PNG' }).waitFor({ state: 'hidden' });
  });
});

describe('a project', () => {
  pageTest('brought back in another browser goes on as if nothing had happened', async (page) => {
    await page.getByLabel('Seed', { exact: true }).fill('12');
    await page.getByLabel('Width').fill('1.5');
    await parameter(page, 'seed', 12);
    await iterations(page, 4);
    await pause(page);
    const before = { positions: await peek(page, 'positions'), count: (await peek(page, 'progress')).totalIterations };
    const project = await file(page, 'Save project');
    assert.match(project.name, /^pointweave-rings-project\.json$/);
    const steps = async (/** @type {Page} */ where) => {
      for (let done = 1; done <= 2; done++) {
        await where.getByRole('button', { name: 'Step' }).click();
        await iterations(where, before.count + done);
        await settled(where);
      }
      return peek(where, 'positions');
    };
    const expected = await steps(page);
    assert.ok(farthest(expected, before.positions) > 0);
    const other = await launch();
    try {
      await withPage(other, {}, async (fresh) => {
        await iterations(fresh, 1);
        await drop(fresh, project.name, project.bytes.toString('utf8'));
        await useIt(fresh);
        await fresh.getByText('From a project, 60 points.').first().waitFor({ state: 'attached' });
        await status(fresh, 'paused');
        await fresh.waitForFunction((count) => /** @type {any} */ (window).pointweave.progress.totalIterations === count, before.count);
        assert.deepEqual(await peek(fresh, 'positions'), before.positions);
        assert.equal(await fresh.getByLabel('Seed', { exact: true }).inputValue(), '12');
        assert.equal(await fresh.locator('#expansion-x-value').innerText(), '×1.5');
        assert.ok(await fresh.locator('#beyond').isHidden(), 'the controls show all there is');
        assert.deepEqual(await steps(fresh), expected, 'the same continuation');
        // And again from its start.
        await fresh.getByRole('button', { name: 'Reset' }).click();
        await fresh.waitForFunction(() => /** @type {any} */ (window).pointweave.progress.totalIterations === 0);
        const again = await peek(fresh, 'positions');
        await page.getByRole('button', { name: 'Reset' }).click();
        await page.waitForFunction(() => /** @type {any} */ (window).pointweave.progress.totalIterations === 0);
        assert.deepEqual(again, await peek(page, 'positions'));
      });
    } finally {
      await other.close();
    }
  });
});
