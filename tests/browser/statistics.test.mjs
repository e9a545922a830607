// @ts-check
/** The statistics panel, in the real page. */
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { iterations, launch, parameter, pause, peek, settled, status, withPage } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */

/** @type {import('./browser.mjs').Browser} */
let browser;
before(async () => void (browser = await launch()));
after(() => browser?.close());

/**
 * A page whose panel is closed: the browser remembers what the test before left.
 *
 * @param {string} name
 * @param {Parameters<typeof withPage>[1]} options
 * @param {(page: Page) => Promise<void>} body
 */
const pageTest = (name, options, body) =>
  test(name, { timeout: 240_000 }, () =>
    withPage(browser, options, async (page) => {
      if (await isOpen(page)) await summary(page).click();
      await iterations(page, 1);
      await body(page);
    }),
  );

/** @param {Page} page */
const summary = (page) => page.locator('#statistics summary');
/** @param {Page} page */
const isOpen = (page) => page.locator('#statistics').evaluate((panel) => /** @type {HTMLDetailsElement} */ (panel).open);
/** @param {Page} page @returns {Promise<number>} */
const answers = async (page) => (await peek(page, 'statistics')).answers;

/** Waits until there were so many answers. @param {Page} page @param {number} count */
const answered = (page, count) =>
  page.waitForFunction((least) => /** @type {any} */ (window).pointweave.statistics.answers >= least, count, { polling: 50 });

/** Waits until the latest answer is about the output as it stands. @param {Page} page */
const upToDate = (page) =>
  page.waitForFunction(
    () => {
      const { statistics, progress } = /** @type {any} */ (window).pointweave;
      return statistics.latest?.iterations === progress.totalIterations;
    },
    null,
    { polling: 50 },
  );

/** Opens the panel and waits for its first answer. @param {Page} page */
async function open(page) {
  const before = await answers(page);
  await summary(page).click();
  await answered(page, before + 1);
}

/** What is drawn of a curve. @param {Page} page @param {'pairs' | 'nearest' | 'spectrum'} chart @param {'edge' | 'result'} curve */
const drawn = async (page, chart, curve) => (await page.locator(`#${chart}-chart .${curve}`).getAttribute('d')) ?? '';

const CHARTS = /** @type {const} */ (['pairs', 'nearest', 'spectrum']);

describe('the statistics panel', () => {
  pageTest('asks nothing while it is closed', {}, async (page) => {
    assert.equal(await answers(page), 0);
    await iterations(page, 8);
    await page.waitForTimeout(1500);
    assert.equal(await answers(page), 0, 'never opened');
    await open(page);
    await summary(page).click();
    assert.equal(await isOpen(page), false);
    await page.waitForTimeout(300);
    const before = await answers(page);
    await iterations(page, (await peek(page, 'progress')).totalIterations + 10);
    await page.waitForTimeout(1500);
    assert.equal(await answers(page), before, 'closed again');
  });

  pageTest('opens by keyboard, draws its charts and says in words what they show', {}, async (page) => {
    await summary(page).focus();
    await page.keyboard.press('Space');
    assert.equal(await isOpen(page), true);
    assert.equal(await peek(page, 'status'), 'playing', 'the key belongs to the panel here');
    await answered(page, 1);
    for (const chart of CHARTS) {
      for (const curve of /** @type {const} */ (['edge', 'result'])) {
        const d = await drawn(page, chart, curve);
        assert.match(d, /^M[\d.]+ -?[\d.]+(L[\d.]+ -?[\d.]+){8,}$/, `${chart} ${curve}`);
        const { width, height } = await page.locator(`#${chart}-chart .${curve}`).evaluate((path) => path.getBoundingClientRect());
        assert.ok(width > 120 && height > 1, `${chart} ${curve}: ${width} × ${height}`);
      }
    }
    const label = (/** @type {string} */ chart) => page.locator(`#${chart}-chart`).getAttribute('aria-label');
    assert.match((await label('pairs')) ?? '', /^Pair correlation: most neighbours at \d\.\d\d mean spacings in the exemplar/);
    assert.match((await label('nearest')) ?? '', /on average at 1\.00 mean spacings in the exemplar and \d\.\d\d in the result/);
    assert.match((await label('spectrum')) ?? '', /strongest at \d\.\d\d cycles/);
    for (const map of ['spectrum-exemplar', 'spectrum-output']) {
      const canvas = page.locator(`#${map}`);
      assert.match((await canvas.getAttribute('aria-label')) ?? '', /^Periodogram of the .+ along x and y: strongest at \d\.\d\d cycles per d in the direction of \d+°, [\d.]+ times chance\.$/);
      const colours = await canvas.evaluate((element) => {
        const { width, height } = /** @type {HTMLCanvasElement} */ (element);
        const context = /** @type {CanvasRenderingContext2D} */ (/** @type {HTMLCanvasElement} */ (element).getContext('2d'));
        return new Set(new Uint32Array(context.getImageData(0, 0, width, height).data.buffer)).size;
      });
      assert.ok(colours > 50, `${map} has ${colours} colours`);
    }
    assert.match(await page.locator('#spectra-scale').innerText(), /Strongest colour: [\d.]+ times chance or more\.$/);
    assert.match(await page.locator('#rho-exemplar').innerText(), /^0\.\d{3}$/);
    assert.match(await page.locator('#rho-output').innerText(), /^0\.\d{3}$/);
    const { latest } = await peek(page, 'statistics');
    assert.equal(await page.locator('#rho-exemplar').innerText(), latest.exemplar.relativeRadius.toFixed(3));
    assert.equal(await page.locator('#verdict').innerText(), latest.verdict);
  });

  pageTest('follows the run, not oftener than it should, and at once when it pauses or steps', {}, async (page) => {
    await open(page);
    const [shape, line] = [await drawn(page, 'pairs', 'edge'), await drawn(page, 'pairs', 'result')];
    const before = await answers(page);
    const start = Date.now();
    await answered(page, before + 2);
    const seconds = (Date.now() - start) / 1000;
    assert.ok(seconds > 0.9, `two answers in ${seconds} s`);
    assert.equal(await peek(page, 'status'), 'playing');
    assert.equal(await drawn(page, 'pairs', 'edge'), shape, 'the exemplar stays');
    assert.notEqual(await drawn(page, 'pairs', 'result'), line, 'the result moves');

    await pause(page);
    await upToDate(page);
    const held = await answers(page);
    await page.waitForTimeout(2500);
    assert.equal(await answers(page), held, 'nothing moves, so nothing is asked');
    await page.getByRole('button', { name: 'Step' }).click();
    await settled(page);
    await upToDate(page);
    await page.getByRole('button', { name: 'Reset' }).click();
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.statistics.latest.iterations === 0);
  });

  pageTest('shows the curves of another exemplar', {}, async (page) => {
    await open(page);
    const before = await Promise.all(CHARTS.map((chart) => drawn(page, chart, 'edge')));
    await page.locator('.exemplar-card', { hasText: 'Blue noise' }).click();
    await page.waitForFunction(() => document.getElementById('exemplar-title')?.textContent === 'Blue noise');
    await answered(page, (await answers(page)) + 2);
    const now = await Promise.all(CHARTS.map((chart) => drawn(page, chart, 'edge')));
    for (const [index, chart] of CHARTS.entries()) assert.notEqual(now[index], before[index], chart);
    assert.equal(await page.locator('#statistics[data-outdated]').count(), 0);
    // Blue noise is random: a copy is not what one can ask for, and the meter marks what is.
    assert.ok(await page.locator('#quality-independent').isVisible());
    assert.match(await page.locator('#quality-meter').getAttribute('aria-valuetext') ?? '', /another sample .+ about 0\.\d\d$/);
  });

  pageTest('ends with a verdict on the finished pattern, which is spoken', {}, async (page) => {
    await page.getByLabel('Width').fill('1');
    await parameter(page, 'expansion-y', 1);
    await open(page);
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.status === 'finished', null, { timeout: 200_000 });
    await upToDate(page);
    const { latest } = await peek(page, 'statistics');
    const verdict = await page.locator('#verdict').innerText();
    assert.match(verdict, /^The output .+ quality \d\.\d\d/);
    assert.equal(verdict, latest.verdict);
    assert.ok(latest.quality.score > 0.3, `a finished run is better than chance: ${latest.quality.score}`);
    const meter = page.getByRole('meter', { name: /^Quality/ });
    assert.equal(Number(await meter.getAttribute('aria-valuenow')), Math.min(latest.quality.score, 1));
    assert.equal(await page.locator('#quality-score').innerText(), latest.quality.score.toFixed(2));
    assert.equal(await page.locator('#live').innerText(), `Finished. ${verdict}`);
  });

  pageTest('is remembered, fits on a phone, and goes on after the worker died', { query: '?test=1', expectErrors: true, viewport: { width: 360, height: 740 } }, async (page) => {
    await open(page);
    for (const width of [360, 700, 900, 1200]) {
      await page.setViewportSize({ width, height: 740 });
      await page.waitForTimeout(200);
      const spare = await page.evaluate(() => document.documentElement.clientWidth - document.documentElement.scrollWidth);
      assert.ok(spare >= 0, `${-spare} px too wide at ${width}`);
      const { right } = await page.locator('#spectrum-chart').evaluate((chart) => chart.getBoundingClientRect().toJSON());
      assert.ok(right <= width, `a chart ends at ${right} of ${width}`);
    }
    await page.reload();
    assert.equal(await isOpen(page), true);
    await answered(page, 1);
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.savedIterations > 0);
    await page.evaluate(() => void (/** @type {any} */ (window).pointweave.crash('trap')));
    await page.locator('.notice').waitFor();
    const before = await answers(page);
    await page.locator('.notice button').first().click();
    await status(page, 'playing');
    await answered(page, before + 1);
  });
});
