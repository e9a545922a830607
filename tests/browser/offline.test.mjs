// @ts-check
/** The page without a network, and after a new build. */
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { cp, mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { describe, test } from 'node:test';

import { DIST, iterations, launch, parameter, status } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */

/** @param {string | Buffer} bytes */
const integrity = (bytes) => `sha256-${createHash('sha256').update(bytes).digest('base64')}`;

/**
 * Changes a file as a build of other sources would: its hash, the version and every page's stamp follow.
 *
 * @param {string} folder
 * @param {string} path
 * @param {(text: string) => string} change
 * @param {string} version
 */
async function build(folder, path, change, version) {
  const text = (/** @type {string} */ name) => readFile(join(folder, name), 'utf8');
  const before = JSON.parse(await text('version.json')).version;
  let worker = await text('sw.js');
  const replace = async (/** @type {string} */ name, /** @type {(text: string) => string} */ by) => {
    const old = await text(name);
    const now = by(old);
    assert.notEqual(now, old, `${name} changes`);
    assert.ok(worker.includes(integrity(old)), `${name} is listed with its hash`);
    worker = worker.replace(integrity(old), integrity(now));
    await writeFile(join(folder, name), now);
  };
  await replace(path, change);
  await replace('index.html', (page) => page.replace(`data-build="${before}"`, `data-build="${version}"`));
  await writeFile(join(folder, 'sw.js'), worker.replace(`const VERSION = '${before}'`, `const VERSION = '${version}'`));
  await writeFile(join(folder, 'version.json'), JSON.stringify({ version }));
}

/** @param {(site: { folder: string, browser: import('./browser.mjs').Browser }) => Promise<void>} body */
async function withSite(body) {
  const folder = await mkdtemp(join(tmpdir(), 'pointweave-site-'));
  await cp(DIST, folder, { recursive: true });
  const browser = await launch({ folder, serviceWorkers: 'allow' });
  try {
    await body({ folder, browser });
  } finally {
    await browser.close();
    await rm(folder, { recursive: true, force: true });
  }
}

/** @param {import('./browser.mjs').Browser} browser @param {string} [query] */
async function visit(browser, query = '') {
  const page = await browser.context.newPage();
  await page.goto(browser.url + query);
  return page;
}

/** @param {Page} page */
const kept = (page) => page.getByText('Kept in this browser').waitFor();
const versionOf = (/** @type {Page} */ page) => page.evaluate(() => document.documentElement.dataset.build);
/** What a tab gets when it asks for a file later on. @param {Page} page @param {string} path */
const later = (page, path) => page.evaluate((name) => fetch(name).then((response) => response.text()), path);
const marked = (/** @type {string} */ text) => `${text}\n/* the next build */\n`;

describe('the page, once seen,', () => {
  test('opens and computes while the server is gone', { timeout: 120_000 }, () =>
    withSite(async ({ browser }) => {
      const page = await visit(browser);
      await iterations(page, 1);
      await kept(page);
      await browser.stopServer();
      await assert.rejects(fetch(browser.url), 'the server is gone');
      await page.reload();
      await status(page, 'playing');
      assert.ok(await page.evaluate(() => crossOriginIsolated), 'the headers were kept, too');
      await page.locator('.exemplar-card').nth(2).click();
      await page.getByLabel('Seed', { exact: true }).fill('5');
      await parameter(page, 'seed', 5);
      await iterations(page, 2);
      // Another address of the same page, in another tab.
      const other = await visit(browser, '?engine=cpu');
      await iterations(other, 1);
    }),
  );

  test('is the new build at the first load after one, then also without a network', { timeout: 120_000 }, () =>
    withSite(async ({ folder, browser }) => {
      const page = await visit(browser);
      await kept(page);
      const first = await versionOf(page);
      assert.match(first ?? '', /^[0-9a-f]{16}$/);
      await page.reload();
      assert.equal(await versionOf(page), first);
      await build(folder, 'common/base.css', marked, 'second');
      await page.reload();
      assert.equal(await versionOf(page), 'second', 'the next load shows it');
      assert.match(await later(page, 'common/base.css'), /the next build/);
      await iterations(page, 1);
      // The service worker of the new build takes over once it has every file.
      while (!(await page.evaluate(() => caches.keys())).every((name) => name.endsWith(':second'))) await page.waitForTimeout(100);
      await browser.stopServer();
      await page.reload();
      assert.equal(await versionOf(page), 'second');
      assert.match(await later(page, 'common/base.css'), /the next build/);
      await iterations(page, 1);
    }),
  );

  test('never mixes two builds: a tab that is open keeps its own', { timeout: 120_000 }, () =>
    withSite(async ({ folder, browser }) => {
      const page = await visit(browser);
      await kept(page);
      await page.reload();
      await iterations(page, 1);
      const first = await versionOf(page);
      await build(folder, 'common/words.js', marked, 'second');
      const other = await visit(browser);
      assert.equal(await versionOf(other), 'second');
      await iterations(other, 1);
      assert.match(await later(other, 'common/words.js'), /the next build/);
      assert.doesNotMatch(await later(page, 'common/words.js'), /the next build/);
      await other.waitForTimeout(1500);
      assert.doesNotMatch(await later(page, 'common/words.js'), /the next build/);
      assert.equal(await versionOf(page), first);
      assert.match(await later(other, 'common/words.js'), /the next build/);
    }),
  );

  test('keeps the whole old build while the server has half of the next', { timeout: 120_000 }, () =>
    withSite(async ({ folder, browser }) => {
      const page = await visit(browser);
      await kept(page);
      const first = await versionOf(page);
      await build(folder, 'common/base.css', marked, 'second');
      // Not what the list says: it was not copied yet.
      await writeFile(join(folder, 'common/words.js'), marked(await readFile(join(folder, 'common/words.js'), 'utf8')));
      await page.reload();
      assert.equal(await versionOf(page), 'second');
      await page.waitForTimeout(1500);
      await browser.stopServer();
      await page.reload();
      assert.equal(await versionOf(page), first);
      assert.doesNotMatch(await later(page, 'common/base.css'), /the next build/);
      await iterations(page, 1);
    }),
  );
});
