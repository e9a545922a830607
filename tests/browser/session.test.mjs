// @ts-check
/** A tab's work over a reload. */
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { drop, iterations, launch, parameter, pause, peek, settled, status, useIt, withPage } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */

/** @type {import('./browser.mjs').Browser} */
let browser;
before(async () => void (browser = await launch()));
after(() => browser?.close());

/** @param {string} name @param {(page: Page) => Promise<void>} body @param {Parameters<typeof withPage>[1]} [options] */
const pageTest = (name, body, options = {}) => test(name, { timeout: 120_000 }, () => withPage(browser, options, body));

/** This tab's record once it says so. @param {Page} page @param {(record: any) => boolean} wanted */
async function kept(page, wanted) {
  for (;;) {
    const records = await page.evaluate(async () => {
      const id = sessionStorage.getItem('pointweave.session');
      const database = await new Promise((resolve) => {
        const request = indexedDB.open('pointweave');
        request.onsuccess = () => resolve(request.result);
      });
      const all = database.transaction('sessions').objectStore('sessions').getAll();
      await new Promise((resolve) => (all.onsuccess = resolve));
      database.close();
      return all.result.filter((/** @type {any} */ record) => record.id === id);
    });
    if (records.length === 1 && wanted(records[0])) return records[0];
    await page.waitForTimeout(100);
  }
}

/** @param {Page} page @param {string} what "state", "exemplar" or "shape" */
const spoil = (page, what) =>
  page.evaluate(
    async ([code]) => {
      const database = await new Promise((resolve) => {
        const request = indexedDB.open('pointweave');
        request.onsuccess = () => resolve(request.result);
      });
      const store = database.transaction('sessions', 'readwrite').objectStore('sessions');
      const request = store.get(sessionStorage.getItem('pointweave.session'));
      await new Promise((resolve) => (request.onsuccess = resolve));
      const record = request.result;
      record.state = code === 'state' ? '{"version":1,"exemplar":' : record.state;
      if (code === 'exemplar') [record.state, record.chosen.source] = [null, { source: 'gallery', name: 'no such one' }];
      if (code === 'shape') record.chosen = 'nonsense';
      const written = store.put(record);
      await new Promise((resolve) => (written.onsuccess = resolve));
      database.close();
    },
    [what],
  );

/** @param {Page} page @param {number} count */
async function steps(page, count) {
  const { totalIterations } = await peek(page, 'progress');
  for (let done = 1; done <= count; done++) {
    await page.getByRole('button', { name: 'Step' }).click();
    await iterations(page, totalIterations + done);
    await settled(page);
  }
}

/** @param {Page} page */
const total = async (page) => (await peek(page, 'progress')).totalIterations;

describe('a reload', () => {
  pageTest('in a pause shows the same run, and it goes on as if there had been none', async (page) => {
    await page.locator('.exemplar-card:has([value="chevrons"])').click();
    await page.getByLabel('Width').fill('1.5');
    await parameter(page, 'expansion-x', 1.5);
    await page.getByLabel('Seed', { exact: true }).fill('11');
    await parameter(page, 'seed', 11);
    await status(page, 'playing');
    await pause(page);
    await page.getByRole('button', { name: 'Reset' }).click();
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.progress.totalIterations === 0);
    await steps(page, 4);
    const uninterrupted = await peek(page, 'positions');
    await page.getByRole('button', { name: 'Reset' }).click();
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.progress.totalIterations === 0);
    await steps(page, 2);
    const [positions, losses] = [await peek(page, 'positions'), await peek(page, 'losses')];
    assert.equal(losses.length, 2);
    await kept(page, ({ curve }) => curve.losses.length === 2);

    await page.reload();
    await status(page, 'paused');
    assert.equal(await total(page), 2);
    assert.deepEqual(await peek(page, 'positions'), positions);
    assert.deepEqual(await peek(page, 'losses'), losses);
    assert.equal(await page.getByLabel('Seed', { exact: true }).inputValue(), '11');
    assert.equal(await page.locator('#expansion-x-value').innerText(), '×1.5');
    assert.match(await page.locator('#exemplar-title').innerText(), /geese/i);
    await page.locator('.exemplar-card input[value="chevrons"]:checked').waitFor({ state: 'attached' });
    await steps(page, 2);
    assert.deepEqual(await peek(page, 'positions'), uninterrupted, 'the same continuation');
    // Also from the beginning: the settings are those of the run.
    await page.getByRole('button', { name: 'Reset' }).click();
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.progress.totalIterations === 0);
    await steps(page, 4);
    assert.deepEqual(await peek(page, 'positions'), uninterrupted);
  });

  pageTest('while it runs goes on running, with own points and settings', async (page) => {
    await iterations(page, 1);
    const rows = Array.from({ length: 49 }, (_, i) => `${((i % 7) + 0.5) / 7},${(Math.floor(i / 7) + 0.5) / 7}`);
    await drop(page, 'mine.csv', ['# domain 0 0 1 1 periodic', 'x,y', ...rows].join('\n'));
    await useIt(page);
    await page.waitForFunction(() => document.getElementById('exemplar-title')?.textContent === 'mine.csv');
    await page.getByLabel('Show 3 × 3 tiles').check();
    const { curve } = await kept(page, (record) => record.chosen.title === 'mine.csv' && record.curve.losses.length > 2);
    await page.reload();
    await status(page, 'playing');
    assert.ok((await total(page)) >= curve.losses.length);
    await iterations(page, curve.losses.length + 2);
    assert.equal(await page.locator('#exemplar-title').innerText(), 'mine.csv');
    assert.equal(await page.locator('#exemplar-count').innerText(), '49 points');
    assert.ok(await page.getByLabel('Show 3 × 3 tiles').isChecked());
    assert.equal((await peek(page, 'parameters')).boundary, 'periodic');
    assert.ok(await page.locator('.exemplar-card input[value="own-1"]').isChecked());
    assert.equal(await page.locator('.exemplar-card input[value="rings"]').count(), 1, 'the gallery is there, too');
  });

  for (const what of ['state', 'exemplar', 'shape']) {
    pageTest(`finds its record spoilt (${what}) and begins anew`, async (page) => {
      await page.getByLabel('Seed', { exact: true }).fill('23');
      await parameter(page, 'seed', 23);
      await iterations(page, 1);
      await pause(page);
      await kept(page, (record) => record.settings.seed === '23' && record.status === 'paused');
      await spoil(page, what);
      await page.reload();
      await status(page, 'playing');
      await iterations(page, 1);
      assert.equal(await page.locator('.notice').count(), 0);
      // What can be read still counts.
      assert.equal((await peek(page, 'parameters')).seed, what === 'state' ? 23 : 1);
      assert.match(await page.locator('#exemplar-title').innerText(), /rings/i);
    });
  }

  test('of a browser that stores nothing works, too', { timeout: 120_000 }, async () => {
    const page = await browser.context.newPage();
    /** @type {string[]} */
    const errors = [];
    page.on('pageerror', (error) => errors.push(error.message));
    page.on('console', (message) => void (message.type() === 'error' && errors.push(message.text())));
    await page.addInitScript(() => {
      IDBObjectStore.prototype.put = () => {
        throw new DOMException('full', 'QuotaExceededError');
      };
    });
    await page.goto(browser.url);
    await iterations(page, 3);
    await page.reload();
    await iterations(page, 1);
    await page.addInitScript(() => {
      for (const name of ['indexedDB', 'sessionStorage', 'localStorage']) {
        Object.defineProperty(window, name, { get: () => { throw new DOMException('denied', 'SecurityError'); } });
      }
    });
    await page.reload();
    await iterations(page, 1);
    assert.deepEqual(errors, []);
    await page.close();
  });
});

pageTest('another tab begins anew, and leaves the first one alone', async (page) => {
  await page.getByLabel('Seed', { exact: true }).fill('31');
  await parameter(page, 'seed', 31);
  await iterations(page, 1);
  await kept(page, (record) => record.settings.seed === '31');
  await withPage(browser, {}, async (other) => {
    await iterations(other, 1);
    assert.equal((await peek(other, 'parameters')).seed, 1);
    await other.getByLabel('Seed', { exact: true }).fill('32');
    await parameter(other, 'seed', 32);
    await kept(other, (record) => record.settings.seed === '32');
  });
  await page.reload();
  await status(page, 'playing');
  assert.equal((await peek(page, 'parameters')).seed, 31);
});
