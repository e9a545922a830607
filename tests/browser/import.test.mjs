// @ts-check
/** Brings points into the page on every way there is: drop, paste, picker, address, picture; and what can't be read. */
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { drop, iterations, launch, peek, status, useIt, withPage } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */

/** @type {import('./browser.mjs').Browser} */
let browser;
before(async () => void (browser = await launch()));
after(() => browser?.close());

/**
 * @param {string} name
 * @param {Parameters<typeof withPage>[1]} options
 * @param {(page: Page) => Promise<void>} body
 */
const pageTest = (name, options, body) => test(name, { timeout: 240_000 }, () => withPage(browser, options, body));

const DATA = 'https://data.example';
const places = Array.from({ length: 49 }, (_, i) => [((i % 7) + 0.5) / 7, (Math.floor(i / 7) + 0.5) / 7]);
const lattice = ['x,y', ...places.map((place) => place.join(','))].join('\n');
const trees = [
  '# domain 0 0 70 70 periodic',
  'x,y,class,radius',
  ...places.map(([x, y], i) => `${70 * x},${70 * y},${i % 2 ? 'oak' : 'birch'},${1 + (i % 3)}`),
].join('\n');

/** @param {Page} page */
const dialog = (page) => page.getByRole('dialog');
/** What the preview says of one fact. @param {Page} page @param {string} fact */
const fact = (page, fact) => page.locator('.import-facts div', { has: page.getByText(fact, { exact: true }) }).locator('dd').innerText();
/** @param {Page} page @param {string} name @param {string | Buffer} content */
const pick = (page, name, content) =>
  page.locator('#file').setInputFiles({ name, mimeType: '', buffer: Buffer.from(content) });
/** @param {Page} page @param {string} title */
const exemplar = (page, title) => page.waitForFunction((words) => document.getElementById('exemplar-title')?.textContent === words, title);

/**
 * Pastes as the keyboard does: the browser gives the page what is on the clipboard. A headless one has no clipboard to fill.
 *
 * @param {Page} page
 * @param {{ text?: string, file?: { name: string, content: string } }} what
 * @param {string} [into]
 */
async function paste(page, { text, file }, into = 'body') {
  await page.evaluate(
    ([words, name, content, selector]) => {
      const data = new DataTransfer();
      if (words !== undefined) data.setData('text/plain', words);
      if (name !== undefined) data.items.add(new File([content ?? ''], name));
      const event = new ClipboardEvent('paste', { clipboardData: data, bubbles: true, cancelable: true });
      document.querySelector(String(selector))?.dispatchEvent(event);
    },
    [text, file?.name, file?.content, into],
  );
}

/** A picture of disks on a ground that grows darker to the right. @param {Page} page @param {{ ink?: string, paper?: [string, string] }} [colours] */
async function picture(page, { ink = '#222', paper = ['#fff', '#bbb'] } = {}) {
  const encoded = await page.evaluate(
    ([dots, from, to]) => {
      const canvas = document.createElement('canvas');
      [canvas.width, canvas.height] = [400, 200];
      const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
      const ground = context.createLinearGradient(0, 0, 400, 0);
      ground.addColorStop(0, from);
      ground.addColorStop(1, to);
      context.fillStyle = ground;
      context.fillRect(0, 0, 400, 200);
      context.fillStyle = dots;
      for (let i = 0; i < 32; i++) {
        context.beginPath();
        // Four large ones among the others.
        context.arc(25 + 50 * (i % 8), 25 + 50 * Math.floor(i / 8), i % 9 === 0 ? 18 : 8, 0, 7);
        context.fill();
      }
      return canvas.toDataURL('image/png').split(',')[1];
    },
    /** @type {const} */ ([ink, ...paper]),
  );
  return Buffer.from(encoded, 'base64');
}

describe('points of one’s own', () => {
  pageTest('come by picker: looked at first, then used with everything they have', {}, async (page) => {
    await iterations(page, 1);
    await pick(page, 'trees.csv', trees);
    await dialog(page).getByRole('heading', { name: 'trees.csv' }).waitFor();
    await page.getByRole('button', { name: 'Use these points' }).waitFor();
    assert.match(await fact(page, 'Format'), /CSV/);
    assert.equal(await fact(page, 'Points'), '49 points');
    assert.match(await fact(page, 'Classes'), /birch\s*25\s*oak\s*24/);
    assert.match(await fact(page, 'Attributes'), /radius 1 to 3/);
    assert.equal(await fact(page, 'Domain'), '0 to 70 × 0 to 70');
    assert.match(await dialog(page).innerText(), /Your data stays on your machine/);
    assert.ok(await dialog(page).getByRole('radio', { name: 'Tile' }).isChecked());
    assert.match((await page.locator('#import-canvas').getAttribute('aria-label')) ?? '', /49 points/);
    assert.notEqual(await page.locator('#exemplar-title').innerText(), 'trees.csv', 'nothing is used unasked');
    await useIt(page);
    await exemplar(page, 'trees.csv');
    await status(page, 'playing');
    await iterations(page, 1);
    assert.equal((await peek(page, 'parameters')).boundary, 'periodic');
    assert.equal((await peek(page, 'progress')).classes, 2);
    assert.equal(await page.locator('.exemplar-card:has(:checked) strong').innerText(), 'trees.csv');
    // Edited, they are still the file's own numbers.
    await page.getByRole('button', { name: 'Edit', exact: true }).click();
    const drawing = await page.evaluate(() => {
      const { positions, domain, attributes, classNames } = /** @type {any} */ (window).pointweave.drawing;
      return { first: [...positions.slice(0, 4)], domain, values: [...attributes[0].values.slice(0, 3)], classNames };
    });
    assert.deepEqual(drawing, { first: [5, 5, (70 * 1.5) / 7, 5], domain: [0, 0, 70, 70], values: [1, 2, 3], classNames: ['birch', 'oak'] });
  });

  pageTest('come by drop, and go again with Cancel and Escape', {}, async (page) => {
    await iterations(page, 1);
    await drop(page, 'lattice.csv', lattice);
    await page.getByRole('button', { name: 'Use these points' }).waitFor();
    assert.ok(await page.locator('#drop-veil').isHidden());
    await dialog(page).getByRole('button', { name: 'Cancel' }).click();
    assert.ok(await dialog(page).isHidden());
    assert.equal(await page.locator('#exemplar-title').innerText(), 'Rings');
    await drop(page, 'lattice.csv', lattice);
    await page.getByRole('button', { name: 'Use these points' }).waitFor();
    // Space is the dialog's here and pauses nothing.
    await page.keyboard.press('Shift+Tab');
    await page.keyboard.press('Escape');
    assert.ok(await dialog(page).isHidden());
    assert.equal(await peek(page, 'status'), 'playing');
    await drop(page, 'lattice.csv', lattice);
    await useIt(page);
    await exemplar(page, 'lattice.csv');
    await page.waitForFunction((numbers) => /** @type {any} */ (window).pointweave.positions.length === numbers, 8 * 49);
  });

  pageTest('come by paste: table cells, text and files, but not what is pasted into a field', {}, async (page) => {
    await iterations(page, 1);
    await paste(page, { text: lattice.replaceAll(',', '\t') });
    await dialog(page).getByRole('heading', { name: 'Pasted points' }).waitFor();
    await page.getByRole('button', { name: 'Use these points' }).waitFor();
    assert.match(await fact(page, 'Format'), /TSV|tab/i);
    await useIt(page);
    await exemplar(page, 'Pasted points');
    await paste(page, { text: '0.1 0.1\n0.5 0.75\n0.9 0.2' });
    await page.waitForFunction(() => document.getElementById('import-points')?.textContent === '3 points');
    await dialog(page).getByRole('button', { name: 'Cancel' }).click();
    await paste(page, { file: { name: 'points.json', content: JSON.stringify(places) } });
    await dialog(page).getByRole('heading', { name: 'points.json' }).waitFor();
    await useIt(page);
    await exemplar(page, 'points.json');
    await paste(page, { text: lattice }, '#seed');
    await page.waitForTimeout(300);
    assert.ok(await dialog(page).isHidden(), 'what is pasted into the seed is a seed');
    await paste(page, { text: ' ' });
    assert.ok(await dialog(page).isHidden(), 'nothing is not opened');
  });

  pageTest('can be typed or pasted into a field of their own', { viewport: { width: 360, height: 740 } }, async (page) => {
    await iterations(page, 1);
    await page.getByRole('button', { name: 'Paste…' }).click();
    const field = dialog(page).getByRole('textbox');
    assert.ok(await field.evaluate((element) => element === document.activeElement));
    await field.fill('0.25 0.25\n0.75 nowhere');
    await page.getByRole('button', { name: 'Read' }).click();
    await dialog(page).getByRole('alert').waitFor();
    await dialog(page).getByRole('button', { name: 'Close' }).last().click();
    await page.getByRole('button', { name: 'Paste…' }).click();
    assert.equal(await field.inputValue(), '', 'it begins anew');
    await paste(page, { text: lattice }, '#import-text');
    await useIt(page);
    await exemplar(page, 'Pasted points');
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= document.documentElement.clientWidth));
  });

  pageTest('are read that were chosen in the moment in which the dialog closes', {}, async (page) => {
    await iterations(page, 1);
    await pick(page, 'empty.csv', '\n\n');
    await dialog(page).getByRole('alert').waitFor();
    await page.evaluate((text) => {
      document.getElementById('import-close')?.click();
      const transfer = new DataTransfer();
      transfer.items.add(new File([text], 'lattice.csv'));
      const picker = /** @type {HTMLInputElement} */ (document.getElementById('file'));
      picker.files = transfer.files;
      picker.dispatchEvent(new Event('change'));
    }, lattice);
    await useIt(page);
    await exemplar(page, 'lattice.csv');
  });

  pageTest('that can’t be read are shown where they are wrong', {}, async (page) => {
    await iterations(page, 1);
    const rows = lattice.split('\n');
    rows[4] = '0.5,oops';
    await pick(page, 'broken.csv', rows.join('\n'));
    const alert = dialog(page).getByRole('alert');
    await alert.waitFor();
    assert.match(await alert.innerText(), /line 5, column 2/i);
    assert.equal(await page.locator('#import-place [data-wrong] .line-number').innerText(), '5');
    assert.equal(await page.locator('#import-place mark').innerText(), 'oops');
    assert.equal(await page.locator('#import-place .line').count(), 3);
    assert.ok(await page.getByRole('button', { name: 'Use these points' }).isHidden());
    assert.ok(await page.getByRole('button', { name: 'Choose a file' }).isVisible());
    await dialog(page).getByRole('button', { name: 'Cancel' }).click();
    await pick(page, 'broken.json', '{"points": [[0.5, 0.5],\n [0.25, x]]}');
    await alert.waitFor();
    assert.match(await alert.innerText(), /line 2, column 9/i);
    assert.equal(await page.locator('.import-excerpt mark').innerText(), 'x');
    await dialog(page).getByRole('button', { name: 'Close' }).last().click();
    await pick(page, 'empty.csv', '\n\n');
    assert.match(await alert.innerText(), /no points/);
    assert.ok(await page.locator('.import-excerpt').isHidden());
    await dialog(page).getByRole('button', { name: 'Close' }).last().click();
    assert.equal(await page.locator('#exemplar-title').innerText(), 'Rings');
    const { totalIterations } = await peek(page, 'progress');
    await iterations(page, totalIterations + 1);
  });

  pageTest('get the border and the domain the person knows better', {}, async (page) => {
    await iterations(page, 1);
    await pick(page, 'lattice.csv', lattice);
    await page.getByRole('button', { name: 'Use these points' }).waitFor();
    assert.ok(await dialog(page).getByRole('radio', { name: 'Window' }).isChecked());
    await dialog(page).getByRole('radio', { name: 'Tile' }).check();
    await page.getByText('Set the domain').click();
    await page.getByLabel('x to').fill('2');
    await page.keyboard.press('Tab');
    await page.waitForFunction(() => document.getElementById('import-extent')?.textContent === '0 to 2 × 0 to 1');
    // Points would be outside: said beside what there is, and nothing can be used.
    await page.getByLabel('x from').fill('0.5');
    await page.keyboard.press('Tab');
    await page.locator('#import-objection').filter({ hasText: /domain/ }).waitFor();
    assert.ok(await page.getByRole('button', { name: 'Use these points' }).isDisabled());
    await page.getByLabel('x from').fill('-1');
    await page.keyboard.press('Tab');
    await page.waitForFunction(() => document.getElementById('import-extent')?.textContent === '-1 to 2 × 0 to 1');
    assert.equal(await page.locator('#import-objection').innerText(), '');
    await useIt(page);
    await exemplar(page, 'lattice.csv');
    await status(page, 'playing');
    await iterations(page, 1);
    assert.equal((await peek(page, 'parameters')).boundary, 'periodic');
  });

  pageTest('come out of a picture, by threshold, colour and size', {}, async (page) => {
    await iterations(page, 1);
    await pick(page, 'dots.png', await picture(page));
    await page.getByRole('button', { name: 'Use these points' }).waitFor();
    assert.equal(await fact(page, 'Points'), '32 points');
    assert.match(await fact(page, 'Attributes'), /^radius 7\.\d+ to 1[78]\.\d+/);
    const counted = (/** @type {number} */ count) => page.waitForFunction((wanted) => document.getElementById('import-points')?.textContent === `${wanted} point${wanted === 1 ? '' : 's'}`, count);
    const drawn = () => page.locator('#import-canvas').evaluate((canvas) => /** @type {HTMLCanvasElement} */ (canvas).toDataURL());
    const before = await drawn();
    // 18² π is about 1000 pixels, 8² π about 200.
    await page.getByLabel('Smallest blob').fill('54');
    await counted(4);
    assert.notEqual(await drawn(), before, 'the rings follow');
    await page.getByLabel('Smallest blob').fill('-1');
    await page.getByLabel('Largest blob').fill('54');
    await counted(28);
    await page.getByLabel('Largest blob').fill('120');
    await counted(32);
    // A threshold without any blob is said, and put right by the automatic one.
    await page.getByLabel('Threshold').fill('0');
    await page.locator('#import-objection').filter({ hasText: /no dark blobs/ }).waitFor();
    assert.ok(await page.getByRole('button', { name: 'Use these points' }).isDisabled());
    await dialog(page).getByRole('button', { name: 'Auto' }).click();
    await counted(32);
    assert.equal(await dialog(page).getByRole('button', { name: 'Auto' }).getAttribute('aria-pressed'), 'true');
    await useIt(page);
    await exemplar(page, 'dots.png');
    await status(page, 'playing');
    await iterations(page, 1);
    await pick(page, 'stars.png', await picture(page, { ink: '#fff', paper: ['#000', '#444'] }));
    await dialog(page).getByRole('heading', { name: 'stars.png' }).waitFor();
    await counted(32);
    await dialog(page).getByRole('radio', { name: 'Dark' }).check();
    await counted(1);
    await dialog(page).getByRole('radio', { name: 'Light' }).check();
    await counted(32);
  });
});

describe('points from an address', () => {
  const headers = { 'Access-Control-Allow-Origin': '*', 'Cross-Origin-Resource-Policy': 'cross-origin' };
  /** @param {import('playwright-core').Page} page @param {import('playwright-core').Route['fulfill'] extends (options: infer O) => any ? O : never} answer */
  async function serves(page, answer) {
    /** @type {string[]} */
    const asked = [];
    await page.route(`${DATA}/**`, async (route) => {
      asked.push(route.request().url());
      assert.equal(await route.request().headerValue('cookie'), null);
      await route.fulfill({ headers, ...answer });
    });
    return asked;
  }

  const query = `?url=${encodeURIComponent(`${DATA}/some/lattice.csv`)}`;
  pageTest('are fetched only after a yes, with the name of the site in sight', { query, allows: DATA }, async (page) => {
    const asked = await serves(page, { body: lattice });
    await dialog(page).waitFor();
    assert.equal(await page.locator('#import-origin').innerText(), 'data.example');
    assert.match(await dialog(page).innerText(), /https:\/\/data\.example\/some\/lattice\.csv/);
    assert.ok(await page.locator('#import-cancel').evaluate((button) => button === document.activeElement), 'a key pressed too soon means no');
    await iterations(page, 1);
    assert.deepEqual(asked, []);
    assert.equal(new URL(page.url()).search, '', 'a reload does not ask again');
    await page.getByRole('button', { name: 'Load', exact: true }).click();
    await useIt(page);
    await exemplar(page, 'lattice.csv');
    assert.deepEqual(asked, [`${DATA}/some/lattice.csv`]);
  });

  pageTest('are not fetched after a no, and a pasted address asks as well', { allows: DATA }, async (page) => {
    const asked = await serves(page, { body: lattice });
    await iterations(page, 1);
    await paste(page, { text: `${DATA}/lattice.csv` });
    await page.getByRole('button', { name: 'Load', exact: true }).waitFor();
    await dialog(page).getByRole('button', { name: 'Cancel' }).click();
    await page.waitForTimeout(300);
    assert.deepEqual(asked, []);
    assert.equal(await page.locator('#exemplar-title').innerText(), 'Rings');
    await page.getByRole('button', { name: 'Paste…' }).click();
    await dialog(page).getByRole('textbox').fill(`${DATA}/lattice.csv`);
    await page.getByRole('button', { name: 'Read' }).click();
    await page.getByRole('button', { name: 'Load', exact: true }).click();
    await useIt(page);
    assert.equal(asked.length, 1);
  });

  pageTest('may be of the same site', { query: '?url=version.json', reads: 'version.json' }, async (page) => {
    await dialog(page).waitFor();
    assert.match(await page.locator('#import-origin').innerText(), /this site/);
    await page.getByRole('button', { name: 'Load', exact: true }).click();
    await dialog(page).getByRole('heading', { name: 'version.json' }).waitFor();
    // All of it is here, and no points are in it.
    assert.match(await dialog(page).getByRole('alert').innerText(), /it holds 'version'/);
  });

  pageTest('that may not be read by other pages are refused in words', { allows: DATA, expectErrors: true }, async (page) => {
    await iterations(page, 1);
    // The site gives leave to its friends only.
    await page.route(`${DATA}/**`, (route) => route.fulfill({ headers: { 'Access-Control-Allow-Origin': 'https://friends.example' }, body: lattice }));
    await paste(page, { text: `${DATA}/closed.csv` });
    await page.getByRole('button', { name: 'Load', exact: true }).click();
    await dialog(page).getByRole('alert').waitFor();
    assert.match(await dialog(page).getByRole('alert').innerText(), /data\.example can't be reached, or does not let other pages read/);
  });

  pageTest('are nothing that a browser runs', { query: `?url=${encodeURIComponent('javascript:alert(1)')}` }, async (page) => {
    await dialog(page).getByRole('alert').waitFor();
    assert.match(await dialog(page).getByRole('alert').innerText(), /must begin with https/);
  });
});
