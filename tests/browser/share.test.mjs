// @ts-check
/** Links: made by one person, opened by another, and by whoever means harm. */
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { drop, farthest, iterations, launch, parameter, pause, peek, settled, status, useIt, withPage } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */

/** Two people: two browsers with nothing in common but the link. @type {import('./browser.mjs').Browser} */
let sender;
/** @type {import('./browser.mjs').Browser} */
let receiver;
before(async () => {
  sender = await launch();
  receiver = await launch();
  await sender.context.grantPermissions(['clipboard-read', 'clipboard-write'], { origin: new URL(sender.url).origin });
});
after(async () => {
  await sender?.close();
  await receiver?.close();
});

/** @param {string} name @param {() => Promise<void>} body */
const shareTest = (name, body) => test(name, { timeout: 120_000 }, body);

/** Presses the button and gives what came of it. @param {Page} page */
async function copyLink(page) {
  await page.getByRole('button', { name: 'Copy a link' }).click();
  const note = page.locator('#link-note');
  await page.waitForFunction(() => document.getElementById('link-note')?.textContent !== '');
  return { link: await page.locator('#link').inputValue(), note: await note.innerText() };
}

/** @param {string} link */
const fragmentOf = (link) => link.slice(link.indexOf('#'));

/** The run's first points, and those after some steps. @param {Page} page @param {number} count */
async function course(page, count) {
  if ((await peek(page, 'status')) === 'playing') await pause(page);
  await page.getByRole('button', { name: 'Reset' }).click();
  await page.waitForFunction(() => /** @type {any} */ (window).pointweave.progress.totalIterations === 0);
  await settled(page);
  const start = await peek(page, 'positions');
  for (let done = 1; done <= count; done++) {
    await page.getByRole('button', { name: 'Step' }).click();
    await iterations(page, done);
    await settled(page);
  }
  return { start, end: await peek(page, 'positions') };
}

/** A few clusters, from numbers that are the same every time. @param {number} count */
function ownPoints(count) {
  let state = 1;
  const random = () => (state = (state * 48271) % 2147483647) / 2147483647;
  return ['x,y', ...Array.from({ length: count }, () => `${(100 * random()).toFixed(6)},${(100 * random()).toFixed(6)}`)].join('\n');
}

describe('a link', () => {
  shareTest('to a gallery exemplar with settings gives another person the very same run', async () => {
    let link = '';
    /** @type {Awaited<ReturnType<typeof course>>} */
    let sent;
    await withPage(sender, {}, async (page) => {
      await iterations(page, 1);
      await page.locator('.exemplar-card:has([value="stripes"])').click();
      await page.getByLabel('Width').fill('1.5');
      await page.getByLabel('Seed', { exact: true }).fill('77');
      await parameter(page, 'seed', 77);
      await page.getByRole('radio', { name: 'Open', exact: true }).check();
      await parameter(page, 'boundary', 'open');
      await status(page, 'playing');
      sent = await course(page, 3);
      const made = await copyLink(page);
      link = made.link;
      assert.equal(await page.evaluate(() => navigator.clipboard.readText()), link);
      assert.match(made.note, new RegExp(`^Copied: ${link.length} characters`));
      assert.match(fragmentOf(link), /^#v=1&/);
      assert.match(link, /stripes/);
      assert.match(link, /seed=77/);
      assert.ok(link.length < 200, link);
      assert.equal(await page.getByRole('button', { name: 'Save as a project file' }).isVisible(), false);
    });
    await withPage(receiver, { query: fragmentOf(link) }, async (page) => {
      await status(page, 'playing');
      assert.equal((await peek(page, 'parameters')).seed, 77);
      assert.equal(await page.getByLabel('Seed', { exact: true }).inputValue(), '77');
      assert.equal(await page.locator('#expansion-x-value').innerText(), '×1.5');
      assert.ok(await page.getByRole('radio', { name: 'Open', exact: true }).isChecked());
      assert.ok(await page.locator('.exemplar-card input[value="stripes"]').isChecked());
      assert.match(await page.locator('#exemplar-title').innerText(), /stripes/i);
      assert.deepEqual(await course(page, 3), sent);
      // The link stays in the address until something else is wanted.
      assert.equal(await page.evaluate(() => location.hash), fragmentOf(link));
      await page.getByLabel('Seed', { exact: true }).fill('78');
      await parameter(page, 'seed', 78);
      assert.equal(await page.evaluate(() => location.hash), '');
    });
  });

  shareTest('to own points holds them all, in less than 2 kB for 300, and says what is rounded', async () => {
    let link = '';
    /** @type {Awaited<ReturnType<typeof course>>} */
    let sent;
    await withPage(sender, {}, async (page) => {
      await iterations(page, 1);
      await drop(page, 'mine.csv', `# domain 0 0 100 100\n${ownPoints(300)}`);
      await useIt(page);
      await page.waitForFunction(() => document.getElementById('exemplar-title')?.textContent === 'mine.csv');
      await status(page, 'playing');
      await pause(page);
      const first = await copyLink(page);
      assert.ok(fragmentOf(first.link).length <= 2000, `${fragmentOf(first.link).length} characters`);
      assert.match(first.note, /rounded to 1\/65535/);
      await page.getByRole('button', { name: 'Go on with the rounded points' }).click();
      await status(page, 'playing');
      sent = await course(page, 2);
      const second = await copyLink(page);
      assert.doesNotMatch(second.note, /rounded/);
      link = second.link;
      assert.equal(link, first.link, 'the rounded points are those of the link');
    });
    await withPage(receiver, { query: fragmentOf(link) }, async (page) => {
      await page.waitForFunction(() => document.getElementById('exemplar-title')?.textContent === 'Shared pattern');
      assert.equal(await page.locator('#exemplar-count').innerText(), '300 points');
      assert.deepEqual(await course(page, 2), sent);
      assert.ok(farthest(sent.start, sent.end) > 0, 'and it is a run');
    });
  });

  shareTest('that is long comes with a warning, and one that is too long as a file', async () => {
    await withPage(sender, {}, async (page) => {
      await iterations(page, 1);
      await page.getByLabel('Width').fill('1');
      await parameter(page, 'expansion-x', 1);
      await drop(page, 'long.csv', ownPoints(1000));
      await useIt(page);
      await page.waitForFunction(() => document.getElementById('exemplar-title')?.textContent === 'long.csv');
      await status(page, 'playing');
      await pause(page);
      const { link, note } = await copyLink(page);
      assert.ok(link.length > 2000 && link.length < 32_768, `${link.length} characters`);
      assert.match(note, /Some programs cut links that long; a file holds the same/);
      assert.ok(await page.getByRole('button', { name: 'Save as a project file' }).isVisible());
      await drop(page, 'longer.csv', ownPoints(12_000));
      await useIt(page);
      await page.waitForFunction(() => document.getElementById('exemplar-title')?.textContent === 'longer.csv');
      await status(page, 'playing');
      await pause(page);
      const refused = await copyLink(page);
      assert.match(refused.note, /share a file instead/);
      assert.equal(await page.locator('#link').isVisible(), false);
      const [download] = await Promise.all([
        page.waitForEvent('download'),
        page.getByRole('button', { name: 'Save as a project file' }).click(),
      ]);
      assert.match(download.suggestedFilename(), /^pointweave-longer-project\.json$/);
    });
  });

  shareTest('asking for much work waits for a person, and says how long it takes', async () => {
    await withPage(receiver, { query: '#v=1&exemplar=rings&preset=paper&expansion-x=3&expansion-y=3' }, async (page) => {
      const notice = page.locator('.notice');
      await notice.waitFor();
      assert.match(await notice.innerText(), /This link asks for 540 points; on the processor that takes about \d+ (s|min|h)|about [\d.]+ h/);
      assert.equal(await peek(page, 'status'), 'empty');
      assert.equal(await page.locator('#output-count').innerText(), '540 points · ×3 ×3');
      await page.waitForTimeout(1500);
      assert.equal(await peek(page, 'status'), 'empty', 'it does not start by itself');
      assert.equal(await peek(page, 'progress'), null);
      await notice.getByRole('button', { name: 'Run' }).click();
      await status(page, 'playing');
      assert.equal((await peek(page, 'parameters')).channels, 120);
      assert.equal((await peek(page, 'positions')).length, 2 * 540);
    });
  });

  shareTest('that is followed on an open page takes its place', async () => {
    await withPage(receiver, {}, async (page) => {
      await iterations(page, 1);
      await page.evaluate(() => void (location.hash = '#v=1&exemplar=maze&seed=9'));
      await parameter(page, 'seed', 9);
      assert.match(await page.locator('#exemplar-title').innerText(), /maze/i);
      // A place on the page is no link.
      await page.evaluate(() => void (location.hash = '#stage'));
      await page.waitForTimeout(300);
      assert.equal((await peek(page, 'parameters')).seed, 9);
      assert.equal(await page.locator('.notice').count(), 0);
    });
  });
});

describe('a link that is broken or hostile', () => {
  const long = 'A'.repeat(40_000);
  for (const [what, fragment] of /** @type {const} */ ([
    ['points that are none', '#v=1&points=%00%ff!!!'],
    ['points that end early', '#v=1&points=eJwDAAAAAAE'],
    ['another version', '#v=999&exemplar=rings'],
    ['an exemplar that is not there', '#v=1&exemplar=%3Cscript%3Ealert(1)%3C%2Fscript%3E'],
    ['far too many characters', `#v=1&points=${long}`],
  ])) {
    shareTest(`(${what}) is refused in words, and the page works`, async () => {
      await withPage(receiver, { query: fragment }, async (page) => {
        const notice = page.locator('.notice');
        await notice.waitFor();
        assert.match(await notice.innerText(), /^This link can’t be opened: .{10,}/);
        await status(page, 'playing');
        await iterations(page, 1);
        assert.match(await page.locator('#exemplar-title').innerText(), /rings/i);
        // The same on a page that is at work already leaves it alone.
        await page.getByRole('button', { name: 'Dismiss' }).click();
        const { totalIterations } = await peek(page, 'progress');
        await page.evaluate((hash) => void (location.hash = `${hash}&again=1`), fragment);
        await notice.waitFor();
        await iterations(page, totalIterations + 1);
      });
    });
  }

  shareTest('(numbers beyond every range) is brought within them', async () => {
    await withPage(receiver, { query: '#v=1&exemplar=rings&expansion-x=1e9&expansion-y=1&channels=-5&seed=-1' }, async (page) => {
      await page.locator('.notice').waitFor();
      const { status: now } = await page.evaluate(() => /** @type {any} */ (window).pointweave);
      assert.ok(['empty', 'playing', 'paused'].includes(now), now);
      assert.equal(await page.locator('#expansion-x-value').innerText(), '×8', 'the largest there is');
    });
  });
});
