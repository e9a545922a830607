// @ts-check
/**
 * Takes pictures for the README, see `cargo xtask pictures`:
 *
 * - `node tests/browser/pictures.mjs page DIST FOLDER`: the built page when its first run is done, on a desktop, light
 *   and dark, and on a phone
 * - `node tests/browser/pictures.mjs sheet FILE.html FILE.png`: a page of pictures as a whole
 */
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

import { openChromium } from './chromium.mjs';
import { serve } from './server.mjs';

/** A run takes half a minute, on a busy machine some. */
const PATIENCE_MS = 600_000;
const DESKTOP = { width: 1440, height: 900 };
const PHONE = { width: 390, height: 844 };

/** @typedef {import('playwright-core').Page} Page */

/** Two frames, so that what was asked for is drawn. @param {Page} page */
const drawn = (page) =>
  page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));

/** @param {Page} page @param {string} dist @param {string} folder */
async function shootPage(page, dist, folder) {
  const server = await serve(dist);
  try {
    /** @param {string} name */
    const shoot = async (name) => {
      await page.evaluate(() => window.scrollTo(0, 0));
      // Transitions of colours and places come to their end.
      await page.waitForTimeout(600);
      await drawn(page);
      await page.screenshot({ path: join(folder, name), animations: 'disabled', caret: 'hide' });
    };
    await page.setViewportSize(DESKTOP);
    await page.emulateMedia({ colorScheme: 'light' });
    await page.goto(server.url);
    await page.waitForFunction(
      () => ['finished', 'stopped'].includes(/** @type {any} */ (window).pointweave?.status),
      null,
      { polling: 250, timeout: PATIENCE_MS },
    );
    const status = await page.evaluate(() => /** @type {any} */ (window).pointweave.status);
    if (status !== 'finished') throw new Error(`the page's run has ${status}`);
    await shoot('page-light.png');
    await page.emulateMedia({ colorScheme: 'dark' });
    await shoot('page-dark.png');
    await page.emulateMedia({ colorScheme: 'light' });
    await page.setViewportSize(PHONE);
    await shoot('page-phone.png');
  } finally {
    await server.close();
  }
}

/** @param {Page} page @param {string} html @param {string} picture */
async function shootSheet(page, html, picture) {
  await page.setViewportSize(DESKTOP);
  await page.goto(pathToFileURL(html).href);
  await page.evaluate(() => Promise.all(Array.from(document.images, (image) => image.decode())));
  await drawn(page);
  await page.locator('body').screenshot({ path: picture });
}

const [kind, from, to] = process.argv.slice(2);
if (!to || (kind !== 'page' && kind !== 'sheet')) {
  console.error('usage: node tests/browser/pictures.mjs page DIST FOLDER | sheet FILE.html FILE.png');
  process.exit(2);
}
const { context, close } = await openChromium();
try {
  const page = context.pages()[0] ?? (await context.newPage());
  page.on('pageerror', (error) => console.error(`exception: ${error.message}`));
  await (kind === 'page' ? shootPage(page, from, to) : shootSheet(page, from, to));
} finally {
  await close();
}
