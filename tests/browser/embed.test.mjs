// @ts-check
/** The page inside another page, of another origin. */
import assert from 'node:assert/strict';
import { createServer } from 'node:http';
import { after, before, describe, test } from 'node:test';

import { PATIENCE, farthest, launch, withPage, iterations } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */

/** @type {import('./browser.mjs').Browser} */
let browser;
before(async () => void (browser = await launch()));
after(() => browser?.close());

/** A page that holds others and writes down what they say. */
const HOST = (/** @type {string} */ frames) => `<!doctype html><meta charset="utf-8"><title>Host</title>${frames}<script>
  window.heard = [];
  addEventListener('message', ({ data, origin }) => heard.push({ data, origin }));
</script>`;

/**
 * @param {string} frames as HTML
 * @param {(page: Page) => Promise<void>} body
 * @param {Record<string, string>} [headers] of the page around
 */
async function withHost(frames, body, headers = {}) {
  const server = createServer((request, response) => {
    if (request.url === '/intruder') {
      // Another frame beside ours that would like to talk to it.
      response.writeHead(200, { 'Content-Type': 'text/html' });
      response.end(`<script>
        addEventListener('message', ({ data }) => parent.postMessage({ intruder: data }, '*'));
        setInterval(() => parent.frames[0].postMessage({ pointweave: 1, type: 'state', id: 'intruder' }, '*'), 100);
      </script>`);
      return;
    }
    response.writeHead(200, { 'Content-Type': 'text/html', ...headers });
    response.end(HOST(frames));
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', () => resolve(undefined)));
  const { port } = /** @type {import('node:net').AddressInfo} */ (server.address());
  const page = await browser.context.newPage();
  /** @type {string[]} */
  const errors = [];
  page.on('pageerror', (error) => errors.push(error.message));
  page.on('console', (message) => void (message.type() === 'error' && !/favicon/.test(message.location().url) && errors.push(message.text())));
  try {
    await page.setViewportSize({ width: 1000, height: 800 });
    await page.goto(`http://localhost:${port}/`);
    await body(page);
    assert.deepEqual(errors, []);
  } finally {
    await page.close();
    server.close();
    server.closeAllConnections();
  }
}

/** @param {string} address */
const frame = (address) => `<iframe src="${address.replaceAll('&', '&amp;')}" width="720" height="520"></iframe>`;

/** The first message that fits, from now or before. @param {Page} page @param {Record<string, unknown>} wanted */
async function heard(page, wanted) {
  const handle = await page.waitForFunction(
    (parts) => /** @type {any} */ (window).heard.find((/** @type {any} */ { data }) => Object.entries(parts).every(([name, value]) => data?.[name] === value)),
    wanted,
    { timeout: PATIENCE },
  );
  return handle.evaluate(({ data, origin }) => ({
    origin,
    data: { ...data, pattern: data.pattern && { ...data.pattern, positions: [...data.pattern.positions], classes: [...data.pattern.classes] } },
  }));
}

let ids = 0;
/** Sends a message and waits for the answer to it. @param {Page} page @param {Record<string, unknown>} message */
async function ask(page, message) {
  const id = ++ids;
  await page.evaluate((sent) => window.frames[0].postMessage(sent, '*'), { pointweave: 1, ...message, id });
  return (await heard(page, { id })).data;
}

const square = ['x,y', ...Array.from({ length: 49 }, (_, i) => `${((i % 7) + 0.5) / 7},${(Math.floor(i / 7) + 0.5) / 7}`)].join('\n');
/** @param {string} name @param {() => Promise<void>} body */
const embedTest = (name, body) => test(name, { timeout: 120_000 }, body);

describe('in a frame, the page', () => {
  embedTest('hides what it is told to, fits, and leads to the whole page', async () => {
    await withHost(frame(`${browser.url}#v=1&exemplar=maze&embed=1&hide=gallery,settings,share,take,loss,statistics,nonsense,constructor`), async (page) => {
      await heard(page, { type: 'ready' });
      const inside = page.frameLocator('iframe');
      await inside.locator('#exemplar-title').getByText('Maze').waitFor();
      for (const part of ['.top', '.rail', '#settings', '#share', '#take', '.loss', '#statistics', '.panel']) {
        assert.ok(await inside.locator(part).isHidden(), `${part} is hidden`);
      }
      for (const part of ['#output-canvas', '#exemplar-canvas', '#play', '#engine-line']) {
        assert.ok(await inside.locator(part).isVisible(), `${part} is there`);
      }
      const { scroll, client } = await inside.locator('html').evaluate((root) => ({ scroll: root.scrollHeight, client: root.clientHeight }));
      assert.ok(scroll <= client, `${scroll} px of page in ${client} px`);
      await inside.getByRole('button', { name: 'Pause' }).click();
      const [whole] = await Promise.all([page.context().waitForEvent('page'), inside.getByRole('link', { name: 'Open in Pointweave' }).click()]);
      await whole.waitForURL(/#v=1&.*exemplar=maze/);
      await whole.locator('.rail').waitFor();
      assert.ok(await whole.locator('#settings').isVisible());
      await whole.close();
    });
  });

  embedTest('loads, runs, tells and gives its points as it is told by the page around it', async () => {
    await withHost(frame(`${browser.url}#embed=1&hide=gallery,settings`), async (page) => {
      const ready = await heard(page, { type: 'ready' });
      assert.deepEqual(ready, { origin: new URL(browser.url).origin, data: { pointweave: 1, type: 'ready', pattern: undefined } });
      const loaded = await ask(page, { type: 'load', data: square, name: 'square.csv', run: false });
      assert.equal(loaded.type, 'done');
      assert.deepEqual([loaded.of, loaded.status, loaded.title, loaded.points], ['load', 'paused', 'square.csv', 196]);
      const start = (await ask(page, { type: 'points' })).pattern;
      assert.equal(start.positions.length, 2 * 196);
      assert.deepEqual([...start.domain], [0, 0, 2, 2]);
      await page.waitForTimeout(700);
      assert.equal((await ask(page, { type: 'state' })).progress.totalIterations, 0, 'nothing runs unasked');
      await ask(page, { type: 'follow' });
      await ask(page, { type: 'play' });
      await heard(page, { type: 'status', status: 'playing' });
      await page.waitForFunction(() => /** @type {any} */ (window).heard.filter((/** @type {any} */ { data }) => data.type === 'progress').length >= 3);
      assert.equal((await ask(page, { type: 'pause' })).status, 'paused');
      const later = (await ask(page, { type: 'points' })).pattern;
      assert.ok(farthest(start.positions, later.positions) > 1e-4, 'points have moved');
      assert.equal((await ask(page, { type: 'reset' })).progress.totalIterations, 0);
      const again = (await ask(page, { type: 'points' })).pattern;
      assert.deepEqual(again.positions, start.positions);
      const stepped = await ask(page, { type: 'step' });
      assert.equal(stepped.progress.totalIterations, 1);
      const link = await ask(page, { type: 'load', link: `${browser.url}#v=1&exemplar=stripes&seed=5` });
      assert.deepEqual([link.type, link.parameters.seed, link.status], ['done', 5, 'playing']);
      const heavy = await ask(page, { type: 'load', link: 'v=1&exemplar=rings&preset=paper&expansion-x=3&expansion-y=3' });
      assert.deepEqual([heavy.type, heavy.status], ['done', 'empty']);
    });
  });

  embedTest('refuses in words, and says nothing to others', async () => {
    await withHost(`${frame(`${browser.url}#embed=1`)}<iframe src="/intruder"></iframe>`, async (page) => {
      await heard(page, { type: 'ready' });
      const refused = async (/** @type {Record<string, unknown>} */ message) => {
        const answer = await ask(page, message);
        assert.equal(answer.type, 'refused');
        return answer.message;
      };
      assert.match(await refused({ type: 'explode' }), /no message of type 'explode'/);
      assert.match(await refused({ pointweave: 2, type: 'state' }), /version 1/);
      assert.match(await refused({ type: 'load' }), /'link' or 'data'/);
      assert.match(await refused({ type: 'load', link: 'v=77' }), /version/);
      assert.match(await refused({ type: 'load', data: 'x,y\n0,oops\n', name: 'a.csv' }), /oops/);
      // The person's own points are not the host's.
      const inside = page.frameLocator('iframe').first();
      await inside.locator('#file').setInputFiles({ name: 'secret.csv', mimeType: 'text/csv', buffer: Buffer.from(square) });
      await inside.getByRole('button', { name: 'Use these points' }).click();
      await inside.locator('#exemplar-title').getByText('secret.csv').waitFor();
      assert.match(await refused({ type: 'points' }), /person’s own/);
      assert.equal((await ask(page, { type: 'state' })).title, '');
      await ask(page, { type: 'load', link: 'v=1&exemplar=rings' });
      assert.equal((await ask(page, { type: 'points' })).type, 'done');
      // It has asked ten times a second all along.
      const told = await page.evaluate(() => /** @type {any} */ (window).heard.filter((/** @type {any} */ { data }) => data.intruder));
      assert.deepEqual(told, []);
      const leaked = await page.evaluate(() => /** @type {any} */ (window).heard.filter((/** @type {any} */ { data }) => data.id === 'intruder'));
      assert.deepEqual(leaked, []);
    });
  });

  embedTest('opens in a page that is cross-origin isolated, too', async () => {
    const isolated = { 'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp' };
    await withHost(
      frame(`${browser.url}#embed=1`),
      async (page) => {
        assert.ok(await page.evaluate(() => crossOriginIsolated));
        await heard(page, { type: 'ready' });
        assert.equal((await ask(page, { type: 'state' })).title, 'Rings');
      },
      isolated,
    );
  });

  embedTest('comes from the HTML that the page offers', async () => {
    let html = '';
    await withPage(browser, {}, async (page) => {
      await iterations(page, 1);
      await page.locator('.exemplar-card:has([value="maze"])').click();
      await page.locator('#exemplar-title').getByText('Maze').waitFor();
      await page.getByText('Put it on a page of yours').click();
      await page.getByRole('checkbox', { name: 'Loss' }).check();
      await page.waitForFunction(() => {
        const { value } = /** @type {HTMLTextAreaElement} */ (document.getElementById('frame-code'));
        return /exemplar=maze/.test(value) && !/hide=[^"]*loss/.test(value);
      });
      html = await page.getByLabel('HTML of the frame').inputValue();
    });
    await withHost(html, async (page) => {
      await heard(page, { type: 'ready' });
      const inside = page.frameLocator('iframe[title="Pointweave: Maze"]');
      await inside.locator('#exemplar-title').getByText('Maze').waitFor();
      assert.ok(await inside.locator('.loss').isVisible());
      assert.ok(await inside.locator('.rail').isHidden());
      assert.ok(await inside.locator('#take').isHidden());
    });
  });
});
