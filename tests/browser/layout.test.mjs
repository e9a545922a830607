// @ts-check
/** What has how much room: the result first, on a laptop and on a phone. */
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { iterations, launch, parameter, peek, status, withPage } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */

/** @type {import('./browser.mjs').Browser} */
let browser;
before(async () => void (browser = await launch()));
after(() => browser?.close());

const LAPTOPS = [{ width: 1280, height: 720 }, { width: 1440, height: 900 }];
const PHONES = [{ width: 360, height: 740 }, { width: 390, height: 844 }];
const SCREENS = [...PHONES, { width: 768, height: 1024 }, { width: 1024, height: 768 }, ...LAPTOPS, { width: 1920, height: 1080 }];
/** The result has at least this share of a laptop's height. */
const SHARE = 0.6;
/** Room that a phone may leave beside the result, in CSS pixels. */
const MOST_PADDING = 24;
/** Twice the room around the domain inside a canvas. */
const MARGINS = 16;

/** @param {{ width: number, height: number }} size */
const named = ({ width, height }) => `${width} × ${height}`;

/**
 * @param {string} name
 * @param {Parameters<typeof withPage>[1]} options
 * @param {(page: Page) => Promise<void>} body
 */
const pageTest = (name, options, body) =>
  test(name, { timeout: 120_000 }, () =>
    withPage(browser, options, async (page) => {
      await iterations(page, 1);
      await page.locator('.exemplar-card').nth(5).waitFor();
      await body(page);
    }),
  );

/** @param {Page} page @param {string} what @returns {Promise<{ left: number, top: number, right: number, bottom: number, width: number, height: number }>} */
const box = (page, what) => page.locator(what).evaluate((element) => element.getBoundingClientRect().toJSON());

/** Width that the page has, without a scroll bar. @param {Page} page */
const pageWidth = (page) => page.evaluate(() => document.documentElement.clientWidth);

/** How much wider than the window the page is. @param {Page} page */
const overflow = (page) => page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);

/** Waits until the result has the size it will have. @param {Page} page */
async function laidOut(page) {
  for (let before = ''; ; ) {
    const now = JSON.stringify(await box(page, '#output-canvas'));
    if (now === before) return;
    before = now;
    await page.waitForTimeout(100);
  }
}

/** Whether the whole of it is in the window. @param {Page} page @param {string} what */
async function inSight(page, what) {
  const { left, top, right, bottom } = await box(page, what);
  const [width, height] = await page.evaluate(() => [window.innerWidth, window.innerHeight]);
  return left >= 0 && top >= 0 && right <= width && bottom <= height && right > left;
}

/** @param {Page} page @param {number} x @param {number} y */
async function size(page, x, y) {
  await page.getByLabel('Keep both the same').uncheck();
  await page.getByLabel('Width').fill(String(x));
  await page.getByLabel('Height').fill(String(y));
  await parameter(page, 'expansion-x', x);
  await parameter(page, 'expansion-y', y);
  await laidOut(page);
}

describe('the result comes first', () => {
  for (const viewport of LAPTOPS) {
    pageTest(`on a laptop, ${named(viewport)}`, { viewport }, async (page) => {
      await laidOut(page);
      const result = await box(page, '#output-canvas');
      const share = result.height / viewport.height;
      assert.ok(share >= SHARE, `the result has ${share.toFixed(2)} of the height`);
      assert.ok(Math.abs(result.width - result.height) < 1, 'it is square');
      const exemplar = await box(page, '#exemplar-canvas');
      assert.ok(exemplar.width < 0.5 * result.width, `the exemplar is small: ${exemplar.width} beside ${result.width}`);
      const wanted = ['#output-canvas', '#exemplar-canvas', '#edit', '#play', '#step', '#reset', '#progress', '#fact-left', '#engine', '#touch-region'];
      await page.waitForFunction(() => document.getElementById('fact-left')?.textContent !== '');
      for (const part of wanted) assert.ok(await inSight(page, part), `${part} is in sight without scrolling`);
    });
  }

  for (const viewport of PHONES) {
    pageTest(`on a phone, ${named(viewport)}`, { viewport }, async (page) => {
      await laidOut(page);
      const [result, width] = [await box(page, '#output-canvas'), await pageWidth(page)];
      assert.ok(result.width >= width - MOST_PADDING - 1, `${result.width} of ${width} px`);
      for (const part of ['#play', '#step', '#reset']) assert.ok(await inSight(page, part), `${part} is in sight without scrolling`);
      const deck = await box(page, '.deck');
      assert.ok(result.bottom <= deck.top, `the buttons hide nothing of the result: ${result.bottom}, ${deck.top}`);
    });
  }

  pageTest('and nothing scrolls sideways', {}, async (page) => {
    for (const viewport of SCREENS) {
      await page.setViewportSize(viewport);
      await laidOut(page);
      assert.ok((await overflow(page)) <= 0, `${await overflow(page)} px too wide at ${named(viewport)}`);
    }
  });

  pageTest('in any shape: the exemplar goes where the result leaves room', {}, async (page) => {
    await size(page, 4, 1);
    let [result, exemplar, stage] = [await box(page, '#output-canvas'), await box(page, '#exemplar-canvas'), await box(page, '#figures')];
    assert.ok(result.width >= 0.95 * stage.width, `a wide result has the width: ${result.width} of ${stage.width}`);
    assert.ok(Math.abs((result.width - MARGINS) / (result.height - MARGINS) - 4) < 0.05, `${result.width} × ${result.height}`);
    assert.ok(exemplar.top >= result.bottom, 'and the exemplar below it');
    await size(page, 1, 3);
    [result, exemplar, stage] = [await box(page, '#output-canvas'), await box(page, '#exemplar-canvas'), await box(page, '#figures')];
    assert.ok(result.height >= 0.6 * 900, `a high result has the height: ${result.height}`);
    assert.ok(exemplar.right <= result.left, 'and the exemplar beside it');
    assert.ok(result.bottom <= stage.bottom, 'nothing is cut off');
  });
});

describe('the gallery', () => {
  for (const viewport of SCREENS) {
    pageTest(`shows more than five exemplars at once, ${named(viewport)}`, { viewport }, async (page) => {
      const seen = await page.locator('.exemplar-card').evaluateAll((cards) => {
        const { left, top, right, bottom } = /** @type {HTMLElement} */ (document.getElementById('gallery')).getBoundingClientRect();
        return cards.filter((card) => {
          const place = card.getBoundingClientRect();
          const inside = place.left >= left && place.right <= right && place.top >= top && place.bottom <= bottom;
          return inside && place.bottom <= innerHeight && place.right <= innerWidth;
        }).length;
      });
      assert.ok(seen > 5, `${seen} exemplars in sight`);
    });
  }

  pageTest('says what an exemplar teaches where the pointer or the keyboard is', {}, async (page) => {
    const captions = () => page.locator('.exemplar-card span').evaluateAll((all) => all.flatMap((span) => {
      const { visibility, opacity } = getComputedStyle(span);
      return visibility === 'visible' && Number(opacity) > 0.9 ? [span.textContent] : [];
    }));
    const caption = (/** @type {number} */ number) => page.locator('.exemplar-card span').nth(number).textContent();
    const shows = async (/** @type {number} */ number) => {
      const words = await caption(number);
      for (let tries = 0; (await captions()).join() !== words; tries++) {
        assert.ok(tries < 40, `shown: ${JSON.stringify(await captions())}; wanted: ${words}`);
        await page.waitForTimeout(100);
      }
    };
    assert.deepEqual(await captions(), []);
    await page.locator('.exemplar-card').nth(4).hover();
    await shows(4);
    await page.mouse.move(700, 30);
    await page.locator('.exemplar-card input').first().focus();
    await page.keyboard.press('ArrowDown');
    await shows(1);
    assert.equal(await page.locator('#exemplar-caption').textContent(), await caption(1), 'it also stands beside the exemplar');
  });
});

describe('the drawer', () => {
  const isOpen = (/** @type {Page} */ page, /** @type {string} */ id) =>
    page.locator(id).evaluate((details) => /** @type {HTMLDetailsElement} */ (details).open);

  for (const viewport of [LAPTOPS[0], PHONES[0]]) {
    pageTest(`opens by keyboard, leaves the buttons where they can be pressed, and remembers itself, ${named(viewport)}`, { viewport }, async (page) => {
      for (const id of ['#loss', '#statistics']) if (await isOpen(page, id)) await page.locator(`${id} > summary`).click();
      await page.locator('#loss > summary').focus();
      await page.keyboard.press('Enter');
      assert.equal(await isOpen(page, '#loss'), true);
      await page.waitForFunction(() => /Gram/.test(document.getElementById('loss-canvas')?.getAttribute('aria-label') ?? ''));
      await page.keyboard.press('Tab');
      await page.keyboard.press('Enter');
      assert.equal(await isOpen(page, '#statistics'), true);
      while ((await peek(page, 'statistics')).answers === 0) await page.waitForTimeout(100);
      assert.ok((await overflow(page)) <= 0);
      if (viewport === LAPTOPS[0]) {
        await laidOut(page);
        for (const part of ['#output-canvas', '#play', '#loss-canvas', '#quality-score']) {
          assert.ok(await inSight(page, part), `${part} is in sight with all open`);
        }
      }
      await page.reload();
      assert.deepEqual([await isOpen(page, '#loss'), await isOpen(page, '#statistics')], [true, true], 'it remembers');
      await status(page, 'playing');
      await page.locator('#loss > summary').click();
      await page.locator('#statistics > summary').click();
      await laidOut(page);
      await page.reload();
      assert.deepEqual([await isOpen(page, '#loss'), await isOpen(page, '#statistics')], [false, false]);
    });
  }
});

describe('the cards', () => {
  for (const viewport of [LAPTOPS[0], PHONES[1]]) {
    pageTest(`are one press away, ${named(viewport)}`, { viewport, media: { reducedMotion: 'reduce' } }, async (page) => {
      for (const [name, part] of /** @type {const} */ ([['Take', '#download-csv'], ['Look', '#look-palette'], ['Share', '#copy-link']])) {
        await page.evaluate(() => window.scrollTo(0, 0));
        await page.locator('.jump').getByRole('button', { name, exact: true }).click();
        assert.ok(await inSight(page, part), `${name} shows ${part}`);
      }
    });
  }
});

pageTest('on a touch screen everything that is pressed is at least 40 pixels high', { viewport: PHONES[0] }, async (page) => {
  const low = await page.locator('button, select, input[type="text"], .segments label, summary, .dropzone').evaluateAll((all) =>
    all.flatMap((element) => {
      const { width, height } = element.getBoundingClientRect();
      // Within a sentence a button is a link.
      if (width === 0 || element.matches('.text') || element.closest('.unseen')) return [];
      return height < 39.5 ? [`${element.id || element.className || element.textContent?.trim()}: ${height}`] : [];
    }),
  );
  assert.deepEqual(low, []);
});
