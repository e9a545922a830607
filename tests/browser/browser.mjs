// @ts-check
/** A headless Chromium that opens the built page and watches it for what no test should have to look for. */
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { openChromium } from './chromium.mjs';
import { serve } from './server.mjs';

/** @typedef {import('playwright-core').Page} Page */

export const DIST = process.env.POINTWEAVE_DIST ?? fileURLToPath(new URL('../../dist', import.meta.url));
/** How long a test waits for one thing; machines are slow and busy. */
export const PATIENCE = 60_000;

/** @param {Parameters<typeof openChromium>[0] & { folder?: string }} [options] `folder`: another page than the built one */
export async function launch({ folder = DIST, ...options } = {}) {
  assert.ok(existsSync(join(DIST, 'index.html')), `there is no built page in ${DIST}: run \`cargo xtask build\` first`);
  const server = await serve(folder);
  const { context, close } = await openChromium(options);
  context.setDefaultTimeout(PATIENCE);
  return {
    context,
    url: server.url,
    stopServer: server.close,
    async close() {
      await close();
      await server.close();
    },
  };
}

/** @typedef {Awaited<ReturnType<typeof launch>>} Browser */

/**
 * Opens the page, hands it to `body`, and fails when the console held an error, the policy was violated, a script
 * threw or anything but the page's own server was asked.
 *
 * @param {Browser} browser
 * @param {{ query?: string, viewport?: { width: number, height: number }, expectErrors?: boolean,
 *   allows?: string, reads?: string, media?: Parameters<Page['emulateMedia']>[0], prelude?: string }} options `allows` is another
 *   origin that may be asked, `reads` a file that the page reads piece by piece, `prelude` is put before the worker's script
 * @param {(page: Page) => Promise<void>} body
 */
export async function withPage(browser, options, body) {
  const { query = '', viewport = { width: 1440, height: 900 }, expectErrors, allows, reads, media, prelude } = options;
  const page = await browser.context.newPage();
  /** @type {string[]} */
  const complaints = [];
  page.on('console', (message) => {
    if (message.type() === 'error' && !expectErrors) complaints.push(`console: ${message.text()}`);
    if (/content security policy/i.test(message.text())) complaints.push(`policy: ${message.text()}`);
  });
  page.on('pageerror', (error) => complaints.push(`exception: ${error.message}`));
  page.on('requestfailed', (request) => {
    const { origin, pathname } = new URL(request.url());
    const reason = request.failure()?.errorText;
    // Chromium calls a third of the requests aborted whose body was read by a reader, to the end and in order.
    const isRead = reads !== undefined && pathname === `/${reads}` && reason === 'net::ERR_ABORTED';
    if (origin !== allows && !isRead) complaints.push(`failed: ${request.url()} ${reason}`);
  });
  page.on('response', (response) => {
    if (response.status() >= 400) complaints.push(`status ${response.status()}: ${response.url()}`);
  });
  page.on('request', (request) => {
    const { origin, protocol } = new URL(request.url());
    const own = origin === new URL(browser.url).origin;
    if (!own && origin !== allows && protocol !== 'blob:' && protocol !== 'data:') complaints.push(`third party: ${request.url()}`);
  });
  try {
    if (media) await page.emulateMedia(media);
    if (prelude) {
      await page.route('**/worker.js*', async (route) => {
        const response = await route.fetch();
        await route.fulfill({ response, body: `${prelude}\n${await response.text()}` });
      });
    }
    await page.setViewportSize(viewport);
    await page.goto(browser.url + query);
    await body(page);
    assert.deepEqual(complaints, [], 'the page complained');
  } finally {
    await page.close();
  }
}

/**
 * One member of the page's debug object.
 *
 * @param {Page} page
 * @param {'status' | 'progress' | 'parameters' | 'positions' | 'drawing' | 'losses' | 'savedIterations' | 'engine' | 'statistics' | 'look'} member
 * @returns {Promise<any>}
 */
export const peek = (page, member) =>
  page.evaluate((name) => /** @type {any} */ (window).pointweave?.[name], member);

/**
 * Waits until the run has done so many iterations.
 *
 * @param {Page} page
 * @param {number} count
 */
export const iterations = (page, count) =>
  page.waitForFunction(
    (least) => /** @type {any} */ (window).pointweave?.progress?.totalIterations >= least,
    count,
    { polling: 50 },
  );

/**
 * Waits until a run with that parameter has begun; settings take effect a moment after they were changed.
 *
 * @param {Page} page
 * @param {string} name
 * @param {number | string} value
 */
export const parameter = (page, name, value) =>
  page.waitForFunction(
    ([key, wanted]) => /** @type {any} */ (window).pointweave?.parameters?.[key] === wanted,
    /** @type {const} */ ([name, value]),
    { polling: 50 },
  );

/**
 * Waits until the run is in that state.
 *
 * @param {Page} page
 * @param {string} status
 */
export const status = (page, status) =>
  page.waitForFunction((wanted) => /** @type {any} */ (window).pointweave?.status === wanted, status, { polling: 50 });

/**
 * Pauses a run that plays and waits for the batch under way, so that nothing moves any more.
 *
 * @param {Page} page
 */
export async function pause(page) {
  await page.getByRole('button', { name: 'Pause' }).click();
  await status(page, 'paused');
  await settled(page);
}

/**
 * Waits until the positions have been the same for a while.
 *
 * @param {Page} page
 */
export async function settled(page) {
  for (let before = ''; ; ) {
    const now = JSON.stringify(await peek(page, 'positions'));
    if (now === before) return;
    before = now;
    await page.waitForTimeout(400);
  }
}

/**
 * Clicks something that starts a download and reads the file.
 *
 * @param {Page} page
 * @param {string} button
 */
export async function downloadText(page, button) {
  const [download] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: button }).click()]);
  const chunks = [];
  for await (const chunk of await download.createReadStream()) chunks.push(chunk);
  return { name: download.suggestedFilename(), text: Buffer.concat(chunks).toString('utf8') };
}

/**
 * The data rows of a CSV: lines that begin with a number.
 *
 * @param {string} text
 */
export const csvRows = (text) => text.split('\n').filter((line) => /^-?[\d.]/.test(line));

/**
 * Drops a file on the page.
 *
 * @param {Page} page
 * @param {string} name
 * @param {string} text
 */
export async function drop(page, name, text) {
  const transfer = await page.evaluateHandle(
    ([fileName, content]) => {
      const data = new DataTransfer();
      data.items.add(new File([content], fileName));
      return data;
    },
    [name, text],
  );
  await page.dispatchEvent('body', 'dragover', { dataTransfer: transfer });
  assert.ok(await page.getByText('Drop to use these points').isVisible(), 'the page says that it takes the file');
  await page.dispatchEvent('body', 'drop', { dataTransfer: transfer });
}

/** Uses what the import's dialog shows. @param {Page} page */
export async function useIt(page) {
  await page.getByRole('button', { name: 'Use these points' }).click();
  await page.getByRole('dialog').waitFor({ state: 'hidden' });
}

/** How far the points are from where they were, at most. @param {number[]} a @param {number[]} b */
export const farthest = (a, b) => a.reduce((most, value, index) => Math.max(most, Math.abs(value - b[index])), 0);
