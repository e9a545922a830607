// @ts-check
/** Drives the real page the way a person does. */
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { csvRows, downloadText, drop, farthest, iterations, launch, parameter, pause, peek, settled, status, useIt, withPage } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */

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

/** @param {Page} page @param {string} seed */
async function seedAndPause(page, seed) {
  await page.getByLabel('Seed', { exact: true }).fill(seed);
  await parameter(page, 'seed', Number(seed));
  await status(page, 'playing');
  await pause(page);
  await page.getByRole('button', { name: 'Reset' }).click();
  await page.waitForFunction(() => /** @type {any} */ (window).pointweave.progress.totalIterations === 0);
  await settled(page);
}

/** @param {Page} page @param {number} count */
async function steps(page, count) {
  for (let done = 1; done <= count; done++) {
    await page.getByRole('button', { name: 'Step' }).click();
    await iterations(page, done);
    await settled(page);
  }
}

/** @param {Page} page @param {'Open' | 'Periodic'} name */
const boundary = (page, name) => page.getByRole('radio', { name, exact: true });

const square = ['x,y', ...Array.from({ length: 49 }, (_, i) => `${((i % 7) + 0.5) / 7},${(Math.floor(i / 7) + 0.5) / 7}`)];

describe('the playground', () => {
  pageTest('starts by itself, with a gallery and an honest word on the engine', {}, async (page) => {
    await status(page, 'playing');
    const cards = page.getByRole('radiogroup', { name: 'Choose an exemplar' }).getByRole('radio');
    await cards.first().waitFor({ state: 'attached' });
    assert.ok((await cards.count()) >= 12, `${await cards.count()} exemplars`);
    assert.equal(await page.locator('.gallery strong').filter({ hasText: /./ }).count(), await cards.count());
    assert.equal(await page.locator('.gallery span').filter({ hasText: /./ }).count(), await cards.count());
    assert.match(await page.locator('#engine').innerText(), /^CPU · SIMD, 1 thread$/);
    assert.ok(await page.evaluate(() => crossOriginIsolated), 'the page is cross-origin isolated');
    await iterations(page, 2);
  });

  pageTest('moves the points of a chosen exemplar, holds a pause, and steps once', {}, async (page) => {
    await status(page, 'playing');
    await iterations(page, 1);
    await page.locator('.exemplar-card').nth(3).click();
    const title = await page.locator('.exemplar-card strong').nth(3).innerText();
    await page.waitForFunction((words) => document.getElementById('exemplar-title')?.textContent === words, title);
    const start = await peek(page, 'positions');
    await iterations(page, 5);
    assert.ok(farthest(start, await peek(page, 'positions')) > 1e-4, 'points have moved');

    await pause(page);
    const held = await peek(page, 'positions');
    const { totalIterations } = await peek(page, 'progress');
    await page.waitForTimeout(1000);
    assert.deepEqual(await peek(page, 'positions'), held, 'nothing moves in a pause');
    assert.equal((await peek(page, 'progress')).totalIterations, totalIterations);

    await page.getByRole('button', { name: 'Step' }).click();
    await iterations(page, totalIterations + 1);
    await settled(page);
    assert.equal((await peek(page, 'progress')).totalIterations, totalIterations + 1, 'exactly one iteration');
    assert.equal(await peek(page, 'status'), 'paused');
    assert.ok(farthest(held, await peek(page, 'positions')) > 0, 'and it moved something');

    await page.getByRole('button', { name: 'Continue' }).click();
    await iterations(page, totalIterations + 3);
  });

  pageTest('lowers the loss', {}, async (page) => {
    await page.locator('#loss > summary').click();
    await iterations(page, 50);
    const losses = await peek(page, 'losses');
    const mean = (/** @type {number[]} */ list) => list.reduce((sum, value) => sum + value, 0) / list.length;
    const [first, last] = [mean(losses.slice(0, 5)), mean(losses.slice(45, 50))];
    assert.ok(losses.every(Number.isFinite));
    assert.ok(last < 0.8 * first, `the loss went from ${first} to ${last}`);
    assert.match((await page.locator('#loss-canvas').getAttribute('aria-label')) ?? '', /Gram [\d.e+-]+, Correlation/);
  });

  pageTest('gives four times the points at 2 × 2, as CSV and as SVG', {}, async (page) => {
    await iterations(page, 1);
    // A periodic picture may repeat points at its border; an open one may not.
    await boundary(page, 'Open').check();
    await parameter(page, 'boundary', 'open');
    await status(page, 'playing');
    await iterations(page, 2);
    await pause(page);
    const exemplar = Number((await page.locator('#exemplar-count').innerText()).match(/\d+/)?.[0]);
    assert.ok(exemplar >= 40);
    const csv = await downloadText(page, 'Download CSV');
    assert.equal(csv.name, 'pointweave-rings.csv');
    assert.equal(csvRows(csv.text).length, 4 * exemplar);
    const svg = await downloadText(page, 'Download SVG');
    assert.equal(svg.name, 'pointweave-rings.svg');
    const circles = await page.evaluate((text) => {
      const parsed = new DOMParser().parseFromString(text, 'image/svg+xml');
      return parsed.querySelector('parsererror') ? -1 : parsed.querySelectorAll('circle').length;
    }, svg.text);
    assert.equal(circles, 4 * exemplar);
  });

  pageTest('gives the same points for the same seed and others for another', {}, async (page) => {
    await status(page, 'playing');
    const results = [];
    for (const seed of ['7', '8', '7']) {
      await seedAndPause(page, seed);
      await steps(page, 3);
      results.push((await downloadText(page, 'Download CSV')).text);
    }
    assert.ok(csvRows(results[0]).length >= 160);
    assert.equal(results[0], results[2]);
    assert.notEqual(results[0], results[1]);
  });

  pageTest('restarts with other settings and says what they mean', {}, async (page) => {
    await iterations(page, 1);
    const count = async () => (await peek(page, 'positions')).length / 2;
    const four = await count();
    await page.getByLabel('Keep both the same').uncheck();
    await page.getByLabel('Width').fill('3');
    await page.waitForFunction((points) => /** @type {any} */ (window).pointweave.positions.length === points, 3 * four);
    assert.equal(await count(), (four / 4) * 6);
    await page.locator('.slider').first().hover();
    await page.getByText('Width of the result').waitFor();
    await boundary(page, 'Open').check();
    assert.ok(await page.locator('#tiles-row').isHidden());
    await parameter(page, 'boundary', 'open');
    await boundary(page, 'Periodic').check();
    assert.ok(await page.getByLabel('Show 3 × 3 tiles').isVisible());
    await parameter(page, 'boundary', 'periodic');
    const picture = () => page.locator('#output-canvas').evaluate((canvas) => /** @type {HTMLCanvasElement} */ (canvas).toDataURL());
    await status(page, 'playing');
    await iterations(page, 2);
    await pause(page);
    const once = await picture();
    await page.getByLabel('Show 3 × 3 tiles').check();
    assert.notEqual(await picture(), once, 'the tiles are drawn, also in a pause');
    const before = await page.getByLabel('Seed', { exact: true }).inputValue();
    await page.getByRole('button', { name: 'Roll another seed' }).click();
    const rolled = await page.getByLabel('Seed', { exact: true }).inputValue();
    assert.notEqual(rolled, before);
    await parameter(page, 'seed', Number(rolled));
  });

  pageTest('takes the boundary of each exemplar, and lets the person change it', {}, async (page) => {
    await parameter(page, 'boundary', 'periodic');
    await boundary(page, 'Periodic').and(page.locator(':checked')).waitFor({ state: 'attached' });
    await page.locator('.exemplar-card:has([value="phyllotaxis"])').click();
    await parameter(page, 'boundary', 'open');
    assert.ok(await boundary(page, 'Open').isChecked());
    assert.ok(await page.locator('#tiles-row').isHidden());
    await boundary(page, 'Periodic').check();
    await parameter(page, 'boundary', 'periodic');
    // The choice is the person's for as long as the exemplar stays.
    await page.getByLabel('Seed', { exact: true }).fill('4');
    await parameter(page, 'seed', 4);
    assert.equal((await peek(page, 'parameters')).boundary, 'periodic');
    await drop(page, 'window.csv', square.join('\n'));
    await useIt(page);
    await parameter(page, 'boundary', 'open');
    assert.ok(await boundary(page, 'Open').isChecked());
    await drop(page, 'tile.csv', ['# domain 0 0 1 1 periodic', ...square].join('\n'));
    await useIt(page);
    await parameter(page, 'boundary', 'periodic');
    assert.ok(await boundary(page, 'Periodic').isChecked());
    assert.ok(await page.getByLabel('Show 3 × 3 tiles').isVisible());
  });

  pageTest('reads a dropped file and uses it', {}, async (page) => {
    await iterations(page, 1);
    await drop(page, 'lattice.csv', square.join('\n'));
    await useIt(page);
    await page.waitForFunction(() => document.getElementById('exemplar-title')?.textContent === 'lattice.csv');
    assert.equal(await page.locator('#exemplar-count').innerText(), '49 points');
    await status(page, 'playing');
    await iterations(page, 2);
    assert.equal((await peek(page, 'positions')).length, 2 * 4 * 49);
    await pause(page);
    assert.equal((await downloadText(page, 'Download CSV')).name, 'pointweave-lattice.csv');
  });

  pageTest('says where a broken file is broken, and goes on with what it had', {}, async (page) => {
    await iterations(page, 1);
    const broken = [...square];
    broken[3] = '0.5,oops';
    await page.locator('#file').setInputFiles({ name: 'broken.csv', mimeType: 'text/csv', buffer: Buffer.from(broken.join('\n')) });
    const dialog = page.getByRole('dialog', { name: 'broken.csv' });
    await dialog.getByRole('alert').waitFor();
    const words = await dialog.getByRole('alert').innerText();
    assert.match(words, /line 4/i);
    assert.match(words, /column 2/i);
    assert.match(words, /oops/);
    assert.notEqual(await page.locator('#exemplar-title').innerText(), 'broken.csv');
    const { totalIterations } = await peek(page, 'progress');
    await iterations(page, totalIterations + 2);
    await dialog.getByRole('button', { name: 'Close' }).last().click();
    assert.ok(await dialog.isHidden());
  });

  pageTest('refuses a seed that is none', {}, async (page) => {
    await iterations(page, 1);
    const seed = page.getByLabel('Seed', { exact: true });
    await seed.fill('-3');
    assert.equal(await seed.getAttribute('aria-invalid'), 'true');
    await seed.press('Enter');
    await page.getByText('The seed must be a whole number').waitFor();
    await seed.fill('9007199254740991');
    await parameter(page, 'seed', Number.MAX_SAFE_INTEGER);
    assert.equal(await seed.getAttribute('aria-invalid'), 'false');
    await page.getByText('The seed must be a whole number').waitFor({ state: 'detached' });
    await iterations(page, 1);
  });

  pageTest('passes on why a run is refused, keeps the one it has, and takes the next', {}, async (page) => {
    await iterations(page, 1);
    await page.getByLabel('Paper').check();
    await page.getByLabel('Width').fill('6');
    const notice = page.locator('.notice');
    await notice.waitFor();
    assert.match(await notice.innerText(), /needs about \d+ MB of memory, \d+ MB are available; lower '/);
    await status(page, 'paused');
    const { totalIterations } = await peek(page, 'progress');
    await page.getByRole('button', { name: 'Step' }).click();
    await iterations(page, totalIterations + 1);
    await page.getByLabel('Width').fill('1');
    await page.getByLabel('Fast').check();
    await parameter(page, 'expansion-x', 1);
    await status(page, 'playing');
    assert.equal(await notice.count(), 0);
  });

  pageTest('can be driven by keyboard', {}, async (page) => {
    await iterations(page, 2);
    await page.keyboard.press('Space');
    await status(page, 'paused');
    await settled(page);
    const { totalIterations } = await peek(page, 'progress');
    await page.keyboard.press('ArrowRight');
    await iterations(page, totalIterations + 1);
    await settled(page);
    assert.equal((await peek(page, 'progress')).totalIterations, totalIterations + 1);
    await page.keyboard.press('r');
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.progress.totalIterations === 0);
    assert.equal(await peek(page, 'status'), 'paused');
    await page.keyboard.press('Space');
    await iterations(page, 2);
    // The gallery is a radio group: one stop, arrows inside it, and Space is still the run's.
    await page.locator('.exemplar-card input').first().focus();
    const chosen = () => page.locator('.exemplar-card input:checked').getAttribute('value');
    const before = await chosen();
    await page.keyboard.press('ArrowDown');
    assert.notEqual(await chosen(), before);
    const title = await page.locator('.exemplar-card:has(:checked) strong').innerText();
    await page.waitForFunction((words) => document.getElementById('exemplar-title')?.textContent === words, title);
    await status(page, 'playing');
    await page.keyboard.press('Space');
    await status(page, 'paused');
  });

  pageTest('finishes, fills its progress and can be run again', {}, async (page) => {
    await iterations(page, 1);
    await page.getByLabel('Width').fill('1');
    await parameter(page, 'expansion-y', 1);
    assert.match(await page.locator('#output-count').innerText(), /×1 ×1$/);
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.status === 'finished', null, { timeout: 200_000 });
    assert.equal(await page.getByRole('progressbar').getAttribute('aria-valuenow'), '100');
    assert.equal(await page.locator('#fact-scale').innerText(), 'Finished');
    assert.equal(await page.locator('#live').innerText(), 'Finished.');
    await page.getByRole('button', { name: 'Run again' }).click();
    await status(page, 'playing');
  });

  pageTest('scrolls in one direction only, down to 360 pixels', { viewport: { width: 360, height: 740 } }, async (page) => {
    await iterations(page, 1);
    for (const width of [360, 700, 900, 1200]) {
      await page.setViewportSize({ width, height: 740 });
      await page.waitForTimeout(200);
      const { scrollWidth, clientWidth } = await page.evaluate(() => {
        const { scrollWidth, clientWidth } = document.documentElement;
        return { scrollWidth, clientWidth };
      });
      assert.ok(scrollWidth <= clientWidth, `${scrollWidth} px of page in ${width} px`);
      const { right } = await page.locator('#output-canvas').evaluate((canvas) => canvas.getBoundingClientRect().toJSON());
      assert.ok(right <= width, `the result ends at ${right} of ${width}`);
    }
  });

  pageTest('is sharp: as many pixels as the screen has', {}, async (page) => {
    await iterations(page, 1);
    const { shown, held, density } = await page.locator('#output-canvas').evaluate((canvas) => ({
      shown: canvas.clientWidth,
      held: /** @type {HTMLCanvasElement} */ (canvas).width,
      density: window.devicePixelRatio,
    }));
    assert.ok(Math.abs(held - shown * density) <= 1, `${held} pixels for ${shown} × ${density}`);
    assert.ok(shown > 300, 'the result is large');
  });

  pageTest('respects the wish for less motion, and still runs', { media: { reducedMotion: 'reduce' } }, async (page) => {
    await iterations(page, 2);
  });
});

describe('a worker that dies', () => {
  for (const [how, query] of /** @type {const} */ ([
    ['trap', '?test=1'],
    ['silence', '?test=1&patience=4000'],
  ])) {
    pageTest(`by ${how} is announced, and the run goes on from its saved state`, { query, expectErrors: true }, async (page) => {
      await iterations(page, 3);
      await page.waitForFunction(() => /** @type {any} */ (window).pointweave.savedIterations > 0);
      await page.evaluate((way) => void (/** @type {any} */ (window).pointweave.crash(way)), how);
      const notice = page.locator('.notice');
      await notice.waitFor();
      assert.match(await notice.innerText(), /stopped unexpectedly \(.+\)\. Its state after iteration \d+ is safe\./);
      assert.equal(await peek(page, 'status'), 'stopped');
      const saved = await peek(page, 'savedIterations');
      assert.ok(saved > 0);
      await page.getByRole('button', { name: `Continue from iteration ${saved}` }).click();
      await status(page, 'playing');
      await iterations(page, saved + 2);
      // In one look: the run goes on meanwhile.
      const [losses, total] = await page.evaluate(() => {
        const { losses: list, progress } = /** @type {any} */ (window).pointweave;
        return [list.length, progress.totalIterations];
      });
      assert.equal(losses, total);
      assert.equal(await notice.count(), 0);
    });
  }

  pageTest('can not be killed on an ordinary page', {}, async (page) => {
    await iterations(page, 1);
    await page.evaluate(() => /** @type {any} */ (window).pointweave.crash('trap'));
    const { totalIterations } = await peek(page, 'progress');
    await iterations(page, totalIterations + 1);
    assert.equal(await page.locator('.notice').count(), 0);
  });
});

describe('a browser with WebGPU', () => {
  test('shows the same page, and the same honest engine', { timeout: 120_000 }, async () => {
    const other = await launch({ webgpu: true });
    try {
      await withPage(other, {}, async (page) => {
        assert.ok(await page.evaluate(() => 'gpu' in navigator), 'this browser has WebGPU');
        await iterations(page, 2);
        assert.match(await page.locator('#engine').innerText(), /^CPU/);
      });
    } finally {
      await other.close();
    }
  });
});
