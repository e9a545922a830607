// @ts-check
/**
 * A second method on the page: one that is built for this test alone, with the crate's feature `pretend-method`. The page
 * must offer it without knowing of it.
 */
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { iterations, launch, parameter, peek, status, withPage } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */

const PRETEND = process.env.POINTWEAVE_PRETEND_DIST ?? fileURLToPath(new URL('../../target/pretend-dist', import.meta.url));

/** @type {import('./browser.mjs').Browser} */
let browser;
before(async () => {
  assert.ok(existsSync(join(PRETEND, 'index.html')), `there is no page in ${PRETEND}: run \`cargo xtask build --pretend\` first`);
  browser = await launch({ folder: PRETEND });
});
after(() => browser?.close());

/** @param {string} name @param {(page: Page) => Promise<void>} body @param {Parameters<typeof withPage>[1]} [options] */
const pageTest = (name, body, options = {}) =>
  test(name, { timeout: 120_000 }, () =>
    withPage(browser, options, async (page) => {
      await iterations(page, 1);
      await body(page);
    }),
  );

/** @param {Page} page @param {string} group */
const titles = (page, group) => page.locator(`#${group} label`).allInnerTexts();

/** Chooses the pretend method and waits for its run. @param {Page} page */
async function chooseJitter(page) {
  await page.getByRole('radio', { name: 'Jitter', exact: true }).check();
  await page.waitForFunction(() => /** @type {any} */ (window).pointweave.parameters?.walks !== undefined);
}

/** @param {Page} page */
async function linkOf(page) {
  await page.getByRole('button', { name: 'Copy a link' }).click();
  await page.waitForFunction(() => document.getElementById('link-note')?.textContent !== '');
  return page.locator('#link').inputValue();
}

describe('a page with two methods', () => {
  pageTest('offers both, with presets, parameters and losses of their own', async (page) => {
    assert.ok(await page.locator('[data-field="method"]').isVisible());
    assert.equal((await titles(page, 'methods')).length, 2);
    const presets = await titles(page, 'presets');
    await chooseJitter(page);
    assert.deepEqual(await titles(page, 'presets'), ['Quick']);
    assert.equal(await page.evaluate(() => /** @type {HTMLDetailsElement} */ (document.getElementById('advanced-fold')).open), false);
    await page.locator('#advanced-fold summary').click();
    assert.deepEqual(await page.locator('#advanced label').allInnerTexts(), ['Stride', 'Walks']);
    await status(page, 'finished');
    assert.match(await page.locator('#fact-iteration').innerText(), /5/);
    // Its loss is drawn under its name, and the other method's are gone.
    assert.equal((await peek(page, 'losses')).length, 5);
    await page.locator('#loss summary').click();
    await page.locator('#loss-canvas[aria-label^="Loss after 5 iterations: Unrest 0.2"]').waitFor();
    assert.ok(await page.getByText('Unrest').first().isVisible());
    // A parameter of its own starts a run.
    await page.getByRole('spinbutton', { name: 'Walks' }).fill('9');
    await parameter(page, 'walks', 9);
    await status(page, 'finished');
    assert.match(await page.locator('#fact-iteration').innerText(), /9/);
    // And back.
    await page.locator('#methods input').first().check();
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.parameters?.channels > 0);
    assert.deepEqual(await titles(page, 'presets'), presets);
    assert.equal(await page.getByText('Unrest').count(), 0);
  });

  pageTest('disables what a method lacks, and says why', async (page) => {
    const lacking = ['#touch-region', '#go-on', '#keep-points', 'input[name="engine"][value="gpu"]'];
    assert.equal(await page.locator('#touch-region').isDisabled(), false);
    await chooseJitter(page);
    await status(page, 'finished');
    for (const selector of lacking) {
      assert.ok(await page.locator(selector).isDisabled(), selector);
      const title = await page.locator(selector).evaluate((control) => /** @type {HTMLElement} */ (control.closest('[title]'))?.title);
      assert.match(title, /^Jitter can’t /, selector);
    }
    // Points can be pinned with it.
    await page.locator('#output-canvas').focus();
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('p');
    await page.locator('#touch-unpin:visible').waitFor();
    await page.keyboard.press('Delete');
    await page.waitForFunction(() => document.getElementById('live')?.textContent?.includes('can’t do a region again'));
    await page.locator('#methods input').first().check();
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.parameters?.channels > 0);
    for (const selector of ['#touch-region', '#keep-points']) assert.equal(await page.locator(selector).isDisabled(), false, selector);
    assert.doesNotMatch((await page.locator('#touch-region').getAttribute('title')) ?? '', /can’t/);
  });

  pageTest('keeps the choice in links and over a reload', async (page) => {
    await chooseJitter(page);
    await page.getByLabel('Seed', { exact: true }).fill('7');
    await parameter(page, 'seed', 7);
    await status(page, 'finished');
    const link = await linkOf(page);
    assert.match(link, /[#&]method=jitter(&|$)/);
    const positions = await peek(page, 'positions');
    await withPage(browser, { query: link.slice(link.indexOf('#')) }, async (other) => {
      await status(other, 'finished');
      assert.ok(await other.getByRole('radio', { name: 'Jitter', exact: true }).isChecked());
      assert.deepEqual(await titles(other, 'presets'), ['Quick']);
      assert.deepEqual(await peek(other, 'positions'), positions);
    });
    await page.reload();
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave?.parameters?.walks !== undefined);
    assert.ok(await page.getByRole('radio', { name: 'Jitter', exact: true }).isChecked());
    assert.deepEqual(await titles(page, 'presets'), ['Quick']);
    assert.equal((await peek(page, 'parameters')).seed, 7);
  });

  pageTest('finds its way between the methods by keyboard', async (page) => {
    await page.locator('#methods input').first().focus();
    await page.keyboard.press('ArrowRight');
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.parameters?.walks !== undefined);
    assert.ok(await page.getByRole('radio', { name: 'Jitter', exact: true }).and(page.locator(':focus')).isVisible(), 'the focus stays');
    await page.keyboard.press('ArrowLeft');
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.parameters?.channels > 0);
  });
});
