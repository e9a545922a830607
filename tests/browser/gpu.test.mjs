// @ts-check
/**
 * The GPU engine inside the real worker, and everything the page says about engines.
 *
 * Chromium's adapter here is SwiftShader, a processor that plays a GPU: real WebGPU, real shaders, but a billion
 * operations take seconds. So the runs are tiny. The check that precedes every run on a GPU compares each stage,
 * forward and backward, with its twin on the processor; that it passes here is the test of the stages in a browser.
 */
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { csvRows, downloadText, drop, farthest, iterations, launch, pause, peek, settled, status, useIt, withPage } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */

/** Sixteen points on a lattice: the smallest thing with a structure. */
const LATTICE = ['x,y', ...Array.from({ length: 16 }, (_, i) => `${((i % 4) + 0.5) / 4},${(Math.floor(i / 4) + 0.5) / 4}`)].join('\n');
/** About two million operations an iteration. */
const TINY = 'test=1&with=channels:8,grid-min:16,grid-max:16';
/** The same without an end in sight, for runs that are to be paused. */
const ENDLESS = `${TINY},iterations-coarse:5000,convergence-window:5000`;
/** The check takes 5 s alone, 8 s beside a run, on an idle machine. */
const CHECKED = 120_000;

/** @type {import('./browser.mjs').Browser} */
let browser;

/**
 * @param {string} name
 * @param {Parameters<typeof withPage>[1]} options
 * @param {(page: Page) => Promise<void>} body
 */
const pageTest = (name, options, body) =>
  test(name, { timeout: 300_000 }, () =>
    withPage(browser, options, async (page) => {
      try {
        await body(page);
      } finally {
        // The tests share one browser, and choices are remembered.
        await page.evaluate(() => localStorage.clear());
      }
    }),
  );

/** @param {Page} page @param {'Auto' | 'GPU' | 'CPU'} name */
const engineSwitch = (page, name) => page.getByRole('group', { name: 'Engine' }).getByRole('radio', { name, exact: true });

/** @param {Page} page @param {boolean} gpu */
const computesOn = (page, gpu) =>
  page.waitForFunction((wanted) => /** @type {any} */ (window).pointweave?.engine?.gpu === wanted, gpu, { polling: 50, timeout: CHECKED });

/** @param {Page} page */
const note = (page) => page.locator('#engine-note-text');

/** Waits for a note. @param {Page} page @param {RegExp} words */
async function noted(page, words) {
  await page.waitForFunction(
    ([source, flags]) => new RegExp(source, flags).test(document.getElementById('engine-note-text')?.textContent ?? ''),
    [words.source, words.flags],
    { polling: 50, timeout: CHECKED },
  );
  return note(page).innerText();
}

/** Takes the lattice, from its first iteration, paused. @param {Page} page @param {boolean} gpu */
async function latticeAtStart(page, gpu) {
  await iterations(page, 1);
  await drop(page, 'lattice.csv', LATTICE);
  await useIt(page);
  await page.waitForFunction(() => document.getElementById('exemplar-title')?.textContent === 'lattice.csv');
  await computesOn(page, gpu);
  await reset(page);
}

/** @param {Page} page */
async function reset(page) {
  await page.getByRole('button', { name: 'Reset' }).click();
  await page.waitForFunction(() => /** @type {any} */ (window).pointweave.progress.totalIterations === 0);
  await status(page, 'paused');
}

/** @param {Page} page */
const play = (page) => page.getByRole('button', { name: /^(Run|Continue)/ }).click();

/** @param {number[]} list */
const mean = (list) => list.reduce((sum, value) => sum + value, 0) / list.length;

/** @param {Page} page */
const destroyDevice = (page) => page.evaluate(() => /** @type {any} */ (window).pointweave.crash('device'));

/** Makes every adapter look like a card, so that `auto` takes it. */
const LOOKS_REAL = `
  Object.defineProperty(GPUAdapter.prototype, 'info', {
    get: () => ({ vendor: 'nvidia', architecture: 'ampere', device: '', description: '', isFallbackAdapter: false }),
  });`;

/** Replaces a piece of every shader that holds it, as a compiler's bug would. @param {string} piece @param {string} other */
const sabotage = (piece, other) => `
  const create = GPUDevice.prototype.createShaderModule;
  GPUDevice.prototype.createShaderModule = function (descriptor) {
    return create.call(this, { ...descriptor, code: descriptor.code.replaceAll(${JSON.stringify(piece)}, ${JSON.stringify(other)}) });
  };`;

describe('a browser whose WebGPU is emulated', () => {
  before(async () => void (browser = await launch({ webgpu: true })));
  after(() => browser?.close());

  pageTest('stays on the processor by itself, says why, and says it once', {}, async (page) => {
    await iterations(page, 2);
    assert.match(await noted(page, /emulated/), /^WebGPU is only emulated in this browser, so the processor computes: it is faster\.$/);
    assert.match(await page.locator('#engine').innerText(), /^CPU · SIMD, 1 thread$/);
    assert.equal(await page.getByRole('alert').locator('.notice').count(), 0, 'a note is no alert');
    assert.ok(await engineSwitch(page, 'Auto').isChecked());
    assert.ok(await engineSwitch(page, 'GPU').isEnabled());
    await page.getByRole('button', { name: 'Dismiss the note' }).click();
    assert.equal(await note(page).innerText(), '');
    await page.reload();
    await iterations(page, 2);
    await page.waitForTimeout(1500);
    assert.equal(await note(page).innerText(), '', 'what was dismissed is not said again');
  });

  pageTest('passes the check of every stage, and gives the same losses as the processor', { query: `?engine=gpu&${ENDLESS}` }, async (page) => {
    await iterations(page, 1);
    await status(page, 'playing');
    await pause(page);
    await computesOn(page, true);
    // Once more with nothing beside it, to know what it takes.
    await engineSwitch(page, 'CPU').check();
    await computesOn(page, false);
    const begun = Date.now();
    await engineSwitch(page, 'GPU').check();
    await computesOn(page, true);
    console.log(`  the check took ${((Date.now() - begun) / 1000).toFixed(1)} s on SwiftShader, beside nothing else`);
    assert.equal(await page.locator('#engine').innerText(), 'Google SwiftShader · WebGPU');
    assert.match((await page.locator('#engine').getAttribute('title')) ?? '', /emulated/);
    assert.equal(await note(page).innerText(), '');

    await latticeAtStart(page, true);
    await play(page);
    await iterations(page, 30);
    assert.match(await page.locator('#fact-rate').innerText(), /^[\d.]+ (it\/s|s\/it)$/);
    await pause(page);
    const losses = await peek(page, 'losses');
    assert.ok(losses.every(Number.isFinite));
    const [first, last] = [mean(losses.slice(0, 5)), mean(losses.slice(25, 30))];
    assert.ok(last < 0.85 * first, `the loss went from ${first} to ${last}`);

    await withPage(browser, { query: `?engine=cpu&${TINY}` }, async (other) => {
      await latticeAtStart(other, false);
      await play(other);
      await iterations(other, 12);
      await pause(other);
      const twin = await peek(other, 'losses');
      const errors = twin.slice(0, 12).map((/** @type {number} */ loss, /** @type {number} */ index) => Math.abs(losses[index] / loss - 1));
      console.log(`  the first 12 losses differ from the processor's by up to ${Math.max(...errors).toExponential(1)}`);
      // Both round to single precision, in different orders: 1e-6 was measured. Adam's first steps can turn the
      // rounding of a gradient near zero into a whole step of one point, a share of 1e-4 of the loss.
      assert.ok(Math.max(...errors) < 1e-4, `${errors}`);
      // Another seed is told apart by more than that.
      await other.getByLabel('Seed', { exact: true }).fill('2');
      await other.waitForFunction(() => /** @type {any} */ (window).pointweave.parameters.seed === 2);
      await iterations(other, 3);
      const stranger = await peek(other, 'losses');
      assert.ok(Math.abs(stranger[0] / twin[0] - 1) > 1e-3, 'the comparison can fail');
    });
  });

  pageTest('switches a run over and back, and loses nothing', { query: `?engine=cpu&${TINY}` }, async (page) => {
    await latticeAtStart(page, false);
    await play(page);
    await iterations(page, 20);
    await pause(page);
    const held = await peek(page, 'positions');
    const { totalIterations: before } = await peek(page, 'progress');
    await engineSwitch(page, 'GPU').check();
    await computesOn(page, true);
    assert.deepEqual(await peek(page, 'positions'), held, 'points stay where they are');
    assert.match(await page.locator('#live').innerText(), /^Now computing on the GPU: Google SwiftShader\.$/);
    await page.getByRole('button', { name: 'Step' }).click();
    await iterations(page, before + 1);
    await settled(page);
    assert.equal((await peek(page, 'progress')).totalIterations, before + 1, 'exactly one iteration');
    const moved = farthest(held, await peek(page, 'positions'));
    assert.ok(moved > 0 && moved < 0.05, `a step, not a jump: ${moved}`);
    await play(page);
    await iterations(page, before + 4);
    await engineSwitch(page, 'CPU').check();
    await computesOn(page, false);
    const { totalIterations: after } = await peek(page, 'progress');
    await iterations(page, after + 20);
    assert.equal(await peek(page, 'status'), 'playing');
    await pause(page);
    const losses = await peek(page, 'losses');
    assert.equal(losses.length, (await peek(page, 'progress')).totalIterations, 'every iteration is there once');
    const around = losses.slice(before - 5, before + 5);
    assert.ok(Math.max(...around) < 2 * Math.min(...around), `the loss goes on: ${around}`);
    assert.equal((await peek(page, 'positions')).length, 2 * 4 * 16);
  });

  pageTest('goes on with a fresh device after a loss, then on the processor, to the end', { query: `?engine=gpu&${TINY}` }, async (page) => {
    await latticeAtStart(page, true);
    await play(page);
    await iterations(page, 3);
    await destroyDevice(page);
    const first = await noted(page, /fresh device/);
    assert.match(first, /^The GPU stopped working: .+\. Going on with a fresh device from the last iteration\.$/);
    assert.equal((await peek(page, 'engine')).gpu, true);
    const { totalIterations: resumed } = await peek(page, 'progress');
    assert.ok(resumed >= 3, 'no iteration that was seen is lost');
    await iterations(page, resumed + 3);
    await destroyDevice(page);
    const second = await noted(page, /processor/);
    assert.match(second, /^The GPU stopped working: .+\. The processor computes instead\.$/);
    assert.match(await page.locator('#engine').innerText(), /^CPU/);
    assert.ok(await engineSwitch(page, 'GPU').isChecked(), 'the choice is still the person’s');
    assert.equal(await page.locator('.notice').count(), 0, 'a note is no alert');
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.status === 'finished', null, { timeout: 120_000 });
    const losses = await peek(page, 'losses');
    assert.equal(losses.length, (await peek(page, 'progress')).totalIterations);
    assert.ok(losses.every(Number.isFinite));
    assert.equal(csvRows((await downloadText(page, 'Download CSV')).text).length, 4 * 16, 'no point is lost');
  });

  for (const [piece, other, stage] of [
    ['s3 += a.w * b', 's3 += a.z * b', 'Gram matrix 2'],
    ['2.0 / f32(plane.size.x', '2.1 / f32(plane.size.x', 'gradient of layer 4'],
  ]) {
    const query = `?engine=gpu&${TINY}`;
    pageTest(`does not use a GPU that gets the ${stage} wrong`, { query, prelude: sabotage(piece, other) }, async (page) => {
      const words = await noted(page, /wrongly/);
      assert.match(words, new RegExp(`^The GPU computes (exemplar's )?${stage} wrongly: off by [\\d.e-]+, allowed are [\\d.e-]+\\. The processor computes instead\\.$`));
      assert.match(await page.locator('#engine').innerText(), /^CPU/);
      const { totalIterations } = await peek(page, 'progress');
      assert.ok(totalIterations > 0);
    });
  }

  pageTest('hands the run to the GPU by itself where there is a card', { query: `?${TINY}`, prelude: LOOKS_REAL }, async (page) => {
    await iterations(page, 2);
    await computesOn(page, true);
    assert.ok(await engineSwitch(page, 'Auto').isChecked());
    assert.equal(await page.locator('#engine').innerText(), 'NVIDIA Ampere · WebGPU');
    assert.equal(await note(page).innerText(), '');
    if ((await peek(page, 'status')) === 'finished') await page.getByRole('button', { name: 'Run again' }).click();
    await iterations(page, 2);
    await page.waitForFunction(() => /(it\/s|s\/it)$/.test(document.getElementById('fact-rate')?.textContent ?? ''));
  });

  pageTest('obeys the newest of two choices', { query: `?engine=cpu&${TINY}` }, async (page) => {
    await iterations(page, 1);
    await engineSwitch(page, 'GPU').check();
    await page.getByText('checking the GPU').waitFor();
    await engineSwitch(page, 'CPU').check();
    await page.getByText('checking the GPU').waitFor({ state: 'hidden' });
    await page.waitForTimeout(15_000);
    assert.equal((await peek(page, 'engine')).gpu, false, 'the GPU that was ready too late is not used');
    assert.equal(await page.locator('.notice').count(), 0);
  });

  pageTest('remembers the choice over a reload; the address wins; a choice replaces the address', { query: '?test=1' }, async (page) => {
    await iterations(page, 1);
    await engineSwitch(page, 'CPU').check();
    await page.reload();
    await iterations(page, 1);
    assert.ok(await engineSwitch(page, 'CPU').isChecked());
    assert.equal(await note(page).innerText(), '', 'nothing was refused');
    await page.goto(`${browser.url}?engine=auto&test=1`);
    await noted(page, /emulated/);
    assert.ok(await engineSwitch(page, 'Auto').isChecked());
    await engineSwitch(page, 'Auto').focus();
    await page.keyboard.press('ArrowLeft');
    assert.ok(await engineSwitch(page, 'CPU').isChecked(), 'arrows move the switch');
    assert.equal(new URL(page.url()).search, '?test=1');
    await page.evaluate(() => localStorage.clear());
    await page.goto(`${browser.url}?engine=nonsense`);
    await iterations(page, 1);
    assert.ok(await engineSwitch(page, 'Auto').isChecked());
  });

  // Long enough not to be over on the processor while the device is checked.
  const long = `?engine=gpu&${TINY},iterations-coarse:5000,convergence-window:5000`;
  pageTest('tells a new worker the choice', { query: long, expectErrors: true }, async (page) => {
    await latticeAtStart(page, true);
    await play(page);
    await iterations(page, 2);
    await page.evaluate(() => void (/** @type {any} */ (window).pointweave.crash('trap')));
    await page.locator('.notice').waitFor();
    assert.match(await page.locator('#engine').innerText(), /^CPU/);
    await page.getByRole('button', { name: /^(Continue|Start)/ }).click();
    await computesOn(page, true);
    await status(page, 'playing');
    // What stops twice on a GPU is not put there a third time unasked.
    await page.evaluate(() => void (/** @type {any} */ (window).pointweave.crash('trap')));
    await noted(page, /stopped on the GPU/);
    await page.getByRole('button', { name: /^(Continue|Start)/ }).click();
    await status(page, 'playing');
    await page.waitForTimeout(1000);
    assert.equal(await page.locator('#engine-line[data-checks]').count(), 0);
    assert.equal((await peek(page, 'engine')).gpu, false);
  });
});

describe('a browser without WebGPU', () => {
  before(async () => void (browser = await launch()));
  after(() => browser?.close());

  pageTest('computes on the processor and says why there is no GPU to choose', { query: '?test=1' }, async (page) => {
    await iterations(page, 2);
    await page.getByText('This browser offers no WebGPU here, so there is no GPU to choose.').waitFor();
    assert.ok(await engineSwitch(page, 'GPU').isDisabled());
    assert.ok(await engineSwitch(page, 'Auto').isChecked());
    assert.match(await page.locator('#engine').innerText(), /^CPU · SIMD, 1 thread$/);
    assert.equal(await note(page).innerText(), '', 'nobody asked for a GPU');
  });

  pageTest('says so to who asks for one', { query: '?engine=gpu' }, async (page) => {
    await iterations(page, 2);
    assert.equal(await noted(page, /./), 'No WebGPU adapter: this browser offers none. The processor computes instead.');
    assert.ok(await engineSwitch(page, 'Auto').isChecked());
    await iterations(page, 4);
  });
});
