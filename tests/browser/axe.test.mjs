// @ts-check
/** axe-core's rules on the page as it is seen: large, small, dark, with everything open, in a frame. */
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { after, before, describe, test } from 'node:test';

import { iterations, launch, pause, peek, withPage } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */

const AXE = await readFile(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/** @type {import('./browser.mjs').Browser} */
let browser;
before(async () => void (browser = await launch()));
after(() => browser?.close());

/** What axe finds, as one line each. @param {Page} page @returns {Promise<string[]>} */
async function violations(page) {
  if (!(await page.evaluate(() => 'axe' in window))) await page.evaluate(AXE);
  const found = await page.evaluate(() => /** @type {any} */ (window).axe.run(document, { resultTypes: ['violations'] }));
  return found.violations
    .filter((/** @type {any} */ { impact }) => impact === 'serious' || impact === 'critical')
    .map((/** @type {any} */ { id, impact, nodes }) => `${impact} ${id}: ${nodes.map((/** @type {any} */ node) => node.target.join(' ')).join(', ')}`);
}

/** Every panel that can be opened. @param {Page} page */
async function openAll(page) {
  for (const summary of await page.locator('summary').all()) {
    const open = await summary.evaluate((element) => /** @type {HTMLDetailsElement} */ (element.parentElement).open);
    if (!open && (await summary.isVisible())) await summary.click();
  }
}

const SIZES = { desktop: { width: 1440, height: 900 }, phone: { width: 360, height: 740 }, projector: { width: 1920, height: 1080 } };

describe('axe finds nothing serious', () => {
  for (const [size, viewport] of Object.entries(SIZES)) {
    for (const colorScheme of /** @type {const} */ (['light', 'dark'])) {
      test(`${size}, ${colorScheme}`, { timeout: 120_000 }, () =>
        withPage(browser, { viewport, media: { colorScheme, reducedMotion: 'reduce' } }, async (page) => {
          await iterations(page, 2);
          await page.getByText('Rings', { exact: true }).first().waitFor();
          assert.deepEqual(await violations(page), [], 'while it runs');
          await pause(page);
          await openAll(page);
          while ((await peek(page, 'statistics')).answers === 0) await page.waitForTimeout(100);
          await page.waitForFunction(() => !document.querySelector('[data-outdated]'));
          await page.waitForTimeout(300);
          assert.deepEqual(await violations(page), [], 'with every panel open');
          await page.getByLabel('Seed', { exact: true }).fill('none');
          await page.getByLabel('Seed', { exact: true }).press('Enter');
          await page.locator('.notice').waitFor();
          assert.deepEqual(await violations(page), [], 'with a notice');
        }),
      );
    }
  }

  for (const size of /** @type {const} */ (['desktop', 'phone'])) {
    for (const colorScheme of /** @type {const} */ (['light', 'dark'])) {
      test(`${size}, ${colorScheme}: comparing, drawing, opening`, { timeout: 120_000 }, () =>
        withPage(browser, { viewport: SIZES[size], media: { colorScheme, reducedMotion: 'reduce' } }, async (page) => {
          await iterations(page, 2);
          await page.getByRole('button', { name: 'Keep as A' }).click();
          await page.getByText(/^Quality of A/).waitFor();
          assert.deepEqual(await violations(page), [], 'with a result kept');
          await page.getByRole('button', { name: 'Edit', exact: true }).click();
          await page.locator('#editor').waitFor();
          assert.deepEqual(await violations(page), [], 'with the editor');
          await page.getByRole('button', { name: 'Discard' }).click();
          await page.getByRole('button', { name: 'Paste…' }).click();
          await page.getByRole('dialog').waitFor();
          assert.deepEqual(await violations(page), [], 'with a dialog');
        }),
      );
    }
  }

  test('in a frame, and where colours are forced', { timeout: 120_000 }, () =>
    withPage(
      browser,
      { query: '?embed=1&hide=gallery,settings,share,take', viewport: { width: 640, height: 480 }, media: { forcedColors: 'active' } },
      async (page) => {
        await iterations(page, 2);
        assert.deepEqual(await violations(page), []);
      },
    ),
  );

  test('and would find it', { timeout: 120_000 }, () =>
    withPage(browser, {}, async (page) => {
      await iterations(page, 1);
      await page.evaluate(() => {
        document.querySelector('#step')?.replaceChildren();
        document.querySelector('#step')?.removeAttribute('title');
        /** @type {HTMLElement} */ (document.querySelector('.tagline')).style.color = 'rgb(225, 225, 225)';
      });
      const found = (await violations(page)).join('\n');
      assert.match(found, /critical button-name: #step/);
      assert.match(found, /serious color-contrast: .*tagline/);
    }),
  );
});
