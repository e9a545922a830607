// @ts-check
/**
 * Opens a built page as somebody does who sees it for the first time, and measures what that person waits for:
 * `node benches/load/load.mjs FOLDER OPTIONS` with the options as JSON. Prints one JSON object in one line.
 *
 * The profile is new, so no cache knows the page. The line is `line.mjs`, the slow processor `slow.mjs`. Times are in
 * milliseconds since the navigation began:
 * - `paint`, `contentfulPaint`: the browser's own entries
 * - `points`: the first frame with points of a result; `move`: the first frame in which one of them had moved
 * - `csv`, when it is asked for: from choosing a table, at once after that, to its preview
 *
 * Bytes are those on the wire: headers as text and compressed bodies, everything until the line has been quiet for a
 * while after the first move, so what the service worker keeps is in it.
 */
import { openChromium } from '../../tests/browser/chromium.mjs';
import { serveSlowly } from './line.mjs';
import { measureSlowdown, slowDown } from './slow.mjs';

const PATIENCE_MS = 120_000;
/** A line that is quiet for so long stays quiet. */
const QUIET_MS = 1500;

/** A table of 60 points. */
const TABLE = `x,y,species\n${Array.from({ length: 60 }, (_, i) => `${(i * 37) % 100},${(i * 61) % 97},${i % 3 ? 'oak' : 'elm'}\n`).join('')}`;

/** Chooses a table, and waits for its preview. @param {import('playwright-core').Page} page */
async function openTable(page) {
  const shown = page.evaluate(() => {
    const started = performance.now();
    return new Promise((resolve) => {
      const look = () => {
        const isShown = document.getElementById('import')?.dataset.stage === 'preview' && document.getElementById('import-points')?.textContent;
        if (isShown) resolve(performance.now() - started);
        else requestAnimationFrame(look);
      };
      look();
    });
  });
  await page.setInputFiles('#file', { name: 'trees.csv', mimeType: 'text/csv', buffer: Buffer.from(TABLE) });
  return /** @type {Promise<number>} */ (shown);
}

/** Runs in the page, before its own scripts. */
function watch() {
  /** @type {{ points: number | null, move: number | null }} */
  const seen = { points: null, move: null };
  Object.assign(window, { pointweaveLoad: seen });
  /** @type {number[]} */
  let first = [];
  const look = () => {
    /** @type {number[]} */
    const positions = /** @type {any} */ (window).pointweave?.positions ?? [];
    if (seen.points === null && positions.length > 0) {
      [seen.points, first] = [performance.now(), positions];
    } else if (seen.points !== null && positions.some((value, place) => value !== first[place])) {
      seen.move = performance.now();
      return;
    }
    requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
}

/**
 * @param {string} folder
 * @param {{ megabits: number, roundTripMs: number, slowdown: number, encoding: import('./line.mjs').Encoding, calibrate: boolean,
 *   csv: boolean }} options
 */
async function load(folder, { megabits, roundTripMs, slowdown, encoding, calibrate, csv }) {
  const server = await serveSlowly(folder, { bitsPerSecond: megabits * 1e6, roundTripMs, encoding });
  const { context, close } = await openChromium({
    serviceWorkers: 'allow',
    args: [`--ignore-certificate-errors-spki-list=${server.pin}`],
  });
  try {
    const page = context.pages()[0] ?? (await context.newPage());
    page.on('pageerror', (error) => console.error(`exception: ${error.message}`));
    const slowed = calibrate ? await measureSlowdown(page, () => slowDown(context, slowdown)) : null;
    await page.addInitScript(watch);
    const slow = await slowDown(context, slowdown);
    /** @type {number | null} */
    let opened = null;
    try {
      await page.goto(server.url, { waitUntil: 'commit', timeout: PATIENCE_MS });
      await page.waitForFunction(() => /** @type {any} */ (window).pointweaveLoad.move !== null, null, {
        polling: 200,
        timeout: PATIENCE_MS,
      });
      if (csv) opened = await openTable(page);
    } finally {
      await slow.stop();
    }
    for (let quiet = 0; quiet < QUIET_MS; quiet = server.isIdle ? quiet + 100 : 0) await page.waitForTimeout(100);
    const times = await page.evaluate(() => {
      const paints = Object.fromEntries(performance.getEntriesByType('paint').map(({ name, startTime }) => [name, startTime]));
      const { points, move } = /** @type {any} */ (window).pointweaveLoad;
      const { timeOrigin } = performance;
      return { timeOrigin, paint: paints['first-paint'], contentfulPaint: paints['first-contentful-paint'], points, move };
    });
    const moment = times.timeOrigin + times.move;
    const sum = (/** @type {import('./line.mjs').Transfer[]} */ some) => some.reduce((total, { bytes }) => total + bytes, 0);
    const early = server.transfers.filter(({ arrived }) => arrived !== null && arrived <= moment);
    return {
      ...times,
      csv: opened,
      slowed,
      bytes: sum(server.transfers),
      bytesUntilMove: sum(early),
      requests: server.transfers.length,
      files: server.transfers.map(({ path, status, bytes, asked, arrived }) => ({
        path,
        status,
        bytes,
        asked: asked - times.timeOrigin,
        arrived: arrived === null ? null : arrived - times.timeOrigin,
      })),
    };
  } finally {
    await close();
    await server.close();
  }
}

const [folder, options] = process.argv.slice(2);
if (!folder || !options) {
  console.error('usage: node benches/load/load.mjs FOLDER OPTIONS');
  process.exit(2);
}
console.log(JSON.stringify(await load(folder, JSON.parse(options))));
