// @ts-check
/** What the import's dialog lets a person choose: columns, other domains, degrees, pictures of every kind; and what it says of them. */
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { after, before, describe, test } from 'node:test';

import { downloadText, iterations, launch, pause, peek, status, useIt, withPage } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */

const AXE = await readFile(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const PHONE = { width: 360, height: 740 };

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

const COUNT = 49;
const indices = Array.from({ length: COUNT }, (_, i) => i);
/** Places that are easily told apart from all other columns: x about 600, y about 2000. */
const place = (/** @type {number} */ i) => [600 + 10 * (i % 7) + ((i * 5) % 3), 2000 + 10 * Math.floor(i / 7) + ((i * 7) % 4)];
const species = ['oak', 'birch', 'pine'];
/** @param {string} header */
const forest = (header) => [header, ...indices.map((i) => [...place(i), species[i % 3], 1 + (i % 4), 10 + i].join(','))].join('\n');
const NAMED = forest('x,y,species,crown,height');
const UNNAMED = forest('mass,width,species,crown,height');

/** Points of a map: seven by seven, a thousandth of a degree apart, about 60° north. */
const map = JSON.stringify({
  type: 'FeatureCollection',
  features: indices.map((i) => ({
    type: 'Feature',
    geometry: { type: 'Point', coordinates: [10.7 + 0.001 * (i % 7) + 0.0001 * (i % 3), 60 + 0.001 * Math.floor(i / 7) + 0.0001 * (i % 2)] },
    properties: { species: species[i % 3], height: 10 + i },
  })),
});

/** @param {Page} page */
const dialog = (page) => page.getByRole('dialog');
/** @param {Page} page @param {string} name @param {string | Buffer} content */
const pick = (page, name, content) => page.locator('#file').setInputFiles({ name, mimeType: '', buffer: Buffer.from(content) });
/** Waits until an element says something. @param {Page} page @param {string} id @param {RegExp} words */
const says = (page, id, words) =>
  page.waitForFunction(
    ([key, source]) => new RegExp(source).test(document.getElementById(key)?.textContent ?? ''),
    /** @type {const} */ ([id, words.source]),
  );
/** @param {Page} page @param {string} id */
const words = (page, id) => page.locator(`#${id}`).innerText();
const usable = (/** @type {Page} */ page) => page.waitForFunction(() => {
  const button = /** @type {HTMLButtonElement} */ (document.getElementById('import-use'));
  return !button.hidden && !button.disabled;
});
/** What axe finds, as one line each. @param {Page} page @returns {Promise<string[]>} */
async function violations(page) {
  if (!(await page.evaluate(() => 'axe' in window))) await page.evaluate(AXE);
  const found = await page.evaluate(() => /** @type {any} */ (window).axe.run(document, { resultTypes: ['violations'] }));
  return found.violations
    .filter((/** @type {any} */ { impact }) => impact === 'serious' || impact === 'critical')
    .map((/** @type {any} */ { id, nodes }) => `${id}: ${nodes.map((/** @type {any} */ node) => node.target.join(' ')).join(', ')}`);
}
/** Nothing stands out of the dialog on a side. @param {Page} page */
const fits = (page) =>
  page.evaluate(() => [...document.querySelectorAll('.import section:not([hidden])')].every((part) => part.scrollWidth <= part.clientWidth));

/** A picture of disks, in the format of that media type. @param {Page} page @param {string} type @param {[number, number]} [size] */
async function picture(page, type, size = [400, 200]) {
  const bytes = await page.evaluate(
    async ([kind, width, height]) => {
      const canvas = document.createElement('canvas');
      [canvas.width, canvas.height] = [width, height];
      const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
      context.fillStyle = '#fff';
      context.fillRect(0, 0, width, height);
      context.fillStyle = '#222';
      const unit = width / 400;
      for (let i = 0; i < 32; i++) {
        context.beginPath();
        context.arc(unit * (25 + 50 * (i % 8)), unit * (25 + 50 * Math.floor(i / 8)), unit * 9, 0, 7);
        context.fill();
      }
      const blob = await new Promise((/** @type {BlobCallback} */ resolve) => canvas.toBlob(resolve, kind, 0.9));
      // Another format where the browser can't write this one.
      return blob?.type === kind ? [...new Uint8Array(await blob.arrayBuffer())] : null;
    },
    /** @type {const} */ ([type, ...size]),
  );
  assert.ok(bytes, `the browser writes ${type}`);
  return Buffer.from(bytes);
}

/** The same JPEG, held as a camera held it: six says that it has to be turned to the right. @param {Buffer} jpeg @param {number} orientation */
function turned(jpeg, orientation) {
  const entry = [0x01, 0x12, 0, 3, 0, 0, 0, 1, 0, orientation, 0, 0];
  const exif = [...Buffer.from('Exif\0\0'), ...Buffer.from('MM'), 0, 42, 0, 0, 0, 8, 0, 1, ...entry, 0, 0, 0, 0];
  const segment = [0xff, 0xe1, 0, exif.length + 2, ...exif];
  return Buffer.concat([jpeg.subarray(0, 2), Buffer.from(segment), jpeg.subarray(2)]);
}

/** Dots of a bitmap for Windows: black on white, one pixel in four a dot. */
function bmp() {
  const [width, height] = [32, 16];
  const pixels = Buffer.alloc(width * height * 3, 255);
  for (let y = 2; y < height; y += 4) for (let x = 2; x < width; x += 4) pixels.fill(0, 3 * (y * width + x), 3 * (y * width + x) + 3);
  const head = Buffer.alloc(54);
  head.write('BM');
  head.writeUInt32LE(54 + pixels.length, 2);
  head.writeUInt32LE(54, 10);
  head.writeUInt32LE(40, 14);
  head.writeInt32LE(width, 18);
  head.writeInt32LE(height, 22);
  head.writeUInt16LE(1, 26);
  head.writeUInt16LE(24, 28);
  return Buffer.concat([head, pixels]);
}

describe('columns', () => {
  pageTest('that were guessed are one line; wrong ones are said, put right, and undone', {}, async (page) => {
    await iterations(page, 1);
    await pick(page, 'forest.csv', NAMED);
    await usable(page);
    const line = page.locator('#import-columns summary');
    assert.match(await line.innerText(), /^Columns: x = x, y = y, class = species.*Change$/s);
    assert.ok(await page.getByLabel('x', { exact: true }).isHidden(), 'folded away while the guess is fine');
    const found = await words(page, 'import-extent');
    await line.press('Enter');
    const x = page.getByLabel('x', { exact: true });
    assert.match(await x.locator('option:checked').innerText(), /^x \(600, 61\d, /, 'a column is known by its name and by what is in it');
    const asGuessed = page.getByRole('button', { name: 'As guessed' });
    assert.ok(await asGuessed.isDisabled());
    const above = await page.locator('#import-board').boundingBox();
    // Words are no places: said beside what is to be put right.
    await x.selectOption('species');
    await says(page, 'import-objection', /oak/);
    assert.ok(await page.getByRole('button', { name: 'Use these points' }).isDisabled());
    assert.equal(await words(page, 'import-place').then((text) => /oak/.test(text)), true, 'the line of the file is shown');
    assert.ok(await page.locator('#import-said').isVisible());
    await x.selectOption('height');
    await usable(page);
    assert.ok(await page.locator('#import-said').isHidden());
    assert.match(await words(page, 'import-columns-words'), /^Columns: x = height, y = y, class = species/, 'the class has come back');
    await says(page, 'import-extent', /^9\.|^10/);
    assert.deepEqual(await page.locator('#import-board').boundingBox(), above, 'nothing has jumped');
    assert.match(await words(page, 'import-status'), /^49 points\./);
    // The other way round by one choice.
    await x.selectOption('y');
    await usable(page);
    await says(page, 'import-columns-words', /x = y, y = height/);
    await asGuessed.click();
    await says(page, 'import-columns-words', /^Columns: x = x, y = y, class = species/);
    await usable(page);
    assert.equal(await words(page, 'import-extent'), found);
    assert.ok(await asGuessed.isDisabled());
    assert.ok(await x.evaluate((element) => element === document.activeElement), 'the keyboard is not lost');
  });

  pageTest('are classes, sizes and attributes as a person says', {}, async (page) => {
    await iterations(page, 1);
    await pick(page, 'forest.csv', NAMED);
    await usable(page);
    await page.locator('#import-columns summary').click();
    await page.getByLabel('Radius').selectOption('crown');
    await says(page, 'import-attributes', /radius 1 to 4/);
    await page.getByRole('checkbox', { name: /^height/ }).uncheck();
    await page.waitForFunction(() => document.getElementById('import-attributes')?.textContent === 'radius 1 to 4');
    await dialog(page).getByLabel('Class', { exact: true }).selectOption('');
    await page.waitForFunction(() => !/oak/.test(document.getElementById('import-classes')?.textContent ?? ''));
    assert.ok(await page.getByRole('checkbox', { name: /^species/ }).isDisabled(), 'words are no attribute');
    await page.getByRole('checkbox', { name: /^height/ }).check();
    await says(page, 'import-attributes', /height 10 to 58/);
    await page.getByLabel('x', { exact: true }).selectOption('y');
    await says(page, 'import-columns-words', /^Columns: x = y, y = x, radius = crown$/);
    await usable(page);
    await useIt(page);
    await status(page, 'playing');
    await page.getByRole('button', { name: 'Edit', exact: true }).click();
    const drawing = await page.evaluate(() => {
      const { positions, attributes, classNames } = /** @type {any} */ (window).pointweave.drawing;
      return { first: [...positions.slice(0, 2)], names: attributes.map((/** @type {any} */ { name }) => name).sort(), classNames };
    });
    assert.deepEqual(drawing, { first: [place(0)[1], place(0)[0]], names: ['height', 'radius'], classNames: ['points'] });
  });

  pageTest('can be told when the file could not be read for want of them', { viewport: PHONE }, async (page) => {
    await iterations(page, 1);
    await pick(page, 'table.csv', UNNAMED);
    await says(page, 'import-objection', /no column is called 'x'/);
    assert.deepEqual(await violations(page), []);
    const x = page.getByLabel('x', { exact: true });
    assert.ok(await x.evaluate((element) => element === document.activeElement), 'what is missing comes first');
    assert.ok(await page.getByRole('button', { name: 'Use these points' }).isHidden());
    await x.selectOption('mass');
    await says(page, 'import-objection', /Choose the column of y/);
    await page.getByLabel('y', { exact: true }).selectOption('width');
    await usable(page);
    await says(page, 'import-columns-words', /^Columns: x = mass, y = width/);
    await page.waitForFunction(() => document.getElementById('import-points')?.textContent === '49 points');
    assert.ok(await fits(page));
    assert.deepEqual(await violations(page), []);
    await page.getByRole('button', { name: 'As guessed' }).click();
    await says(page, 'import-objection', /no column is called 'x'/);
    await x.selectOption('mass');
    await page.getByLabel('y', { exact: true }).selectOption('width');
    await usable(page);
    await useIt(page);
    await page.waitForFunction(() => document.getElementById('exemplar-title')?.textContent === 'table.csv');
  });
});

describe('what there is to say of a file', () => {
  pageTest('is a list with a word and a sign for each kind', { viewport: PHONE, media: { colorScheme: 'dark' } }, async (page) => {
    await iterations(page, 1);
    // Two in one place, a row without a place, and words that have no place in a pattern.
    const rows = NAMED.split('\n').map((line, i) => `${line},${i === 0 ? 'remark' : `tree ${i} of the survey`}`);
    await pick(page, 'forest.csv', [...rows, rows[1], 'NA,NA,oak,1,5,gone'].join('\n'));
    await usable(page);
    const notes = page.locator('#import-notes li');
    const kinds = await notes.evaluateAll((items) => items.map((item) => /** @type {HTMLElement} */ (item).dataset.kind));
    const texts = await notes.allInnerTexts();
    assert.ok(kinds.includes('left-out') && kinds.includes('odd'), `${kinds}: ${texts}`);
    for (const [i, kind] of kinds.entries()) {
      const word = { 'left-out': 'Left out: ', changed: 'Changed: ', odd: 'Odd: ' }[String(kind)];
      assert.ok(word && texts[i].startsWith(word), texts[i]);
    }
    assert.equal(await page.locator('#import-notes svg').count(), kinds.length);
    assert.deepEqual(await violations(page), []);
    assert.ok(await fits(page));
  });

  pageTest('may be a rectangle that the points were cut from', {}, async (page) => {
    await iterations(page, 1);
    // All in the unit square, and far from filling it.
    const corner = ['x,y', ...indices.map((i) => place(i).map((value, k) => (value - [600, 2000][k]) / 200).join(','))].join('\n');
    await pick(page, 'corner.csv', corner);
    await usable(page);
    const found = await words(page, 'import-extent');
    const group = dialog(page).getByRole('group', { name: 'Domain', exact: true });
    const asFound = group.getByRole('button', { name: 'As found' });
    const other = group.getByRole('button', { name: /^Use the (unit square|points' box)$/ }).first();
    assert.equal(await asFound.getAttribute('aria-pressed'), 'true');
    await other.press('Enter');
    await page.waitForFunction((before) => document.getElementById('import-extent')?.textContent !== before, found);
    assert.equal(await other.getAttribute('aria-pressed'), 'true');
    assert.equal(await asFound.getAttribute('aria-pressed'), 'false');
    assert.ok(await other.evaluate((element) => element === document.activeElement), 'the keyboard is not lost');
    await asFound.click();
    await page.waitForFunction((before) => document.getElementById('import-extent')?.textContent === before, found);
    assert.equal(await other.getAttribute('aria-pressed'), 'false');
  });
});

describe('a picture', () => {
  for (const type of ['image/jpeg', 'image/webp']) {
    pageTest(`of the type ${type} is decoded by the browser`, {}, async (page) => {
      await iterations(page, 1);
      await pick(page, `dots.${type.slice(6)}`, await picture(page, type));
      await usable(page);
      assert.equal(await words(page, 'import-points'), '32 points');
      assert.equal(await words(page, 'import-extent'), '0 to 400 × 0 to 200');
      const drawn = () => page.locator('#import-canvas').evaluate((canvas) => /** @type {HTMLCanvasElement} */ (canvas).toDataURL());
      const before = await drawn();
      await page.getByLabel('Threshold').fill('254');
      await page.waitForFunction((old) => /** @type {HTMLCanvasElement} */ (document.getElementById('import-canvas')).toDataURL() !== old, before);
      await dialog(page).getByRole('button', { name: 'Auto' }).click();
      await says(page, 'import-points', /^32 points$/);
      await useIt(page);
      await status(page, 'playing');
    });
  }

  pageTest('stands as its camera says', {}, async (page) => {
    await iterations(page, 1);
    await pick(page, 'turned.jpg', turned(await picture(page, 'image/jpeg'), 6));
    await usable(page);
    assert.equal(await words(page, 'import-extent'), '0 to 200 × 0 to 400');
    assert.equal(await words(page, 'import-points'), '32 points');
    const shape = await page.locator('#import-canvas').evaluate(({ clientWidth, clientHeight }) => clientWidth / clientHeight);
    assert.ok(Math.abs(shape - 0.5) < 0.02, `it is shown so, too: ${shape}`);
  });

  pageTest('of a kind that only the browser knows is read, and one that is broken is refused in words', {}, async (page) => {
    await iterations(page, 1);
    await pick(page, 'dots.bmp', bmp());
    await usable(page);
    assert.equal(await words(page, 'import-points'), '32 points');
    await page.keyboard.press('Escape');
    await pick(page, 'broken.jpg', (await picture(page, 'image/jpeg')).subarray(0, 30));
    await dialog(page).getByRole('alert').waitFor();
    assert.match(await dialog(page).getByRole('alert').innerText(), /^It looks like a JPEG picture, but this browser can't decode it/);
    await page.keyboard.press('Escape');
    await pick(page, 'archive.gz', Buffer.from([0x1f, 0x8b, 8, 0, 0, 0, 0, 0]));
    await dialog(page).getByRole('alert').waitFor();
    assert.match(await dialog(page).getByRole('alert').innerText(), /gzip/, 'what is no picture is called what it is');
  });

  pageTest('of very many pixels is made smaller, and says so', {}, async (page) => {
    await iterations(page, 1);
    await pick(page, 'large.png', await picture(page, 'image/png', [8000, 4000]));
    await usable(page);
    assert.equal(await words(page, 'import-points'), '32 points');
    assert.match(await words(page, 'import-notes'), /^Changed: The picture has 8,000 × 4,000 pixels\. It was made smaller, to 5,792 × 2,896,/);
    assert.equal(await words(page, 'import-extent'), '0 to 5792 × 0 to 2896');
  });
});

describe('a map', () => {
  pageTest('comes in metres, or keeps its degrees', { viewport: PHONE }, async (page) => {
    await iterations(page, 1);
    await pick(page, 'forest.geojson', map);
    await usable(page);
    assert.ok(await page.getByLabel('x', { exact: true }).isHidden(), 'its places are no columns');
    assert.match(await words(page, 'import-projection'), /^Degrees became metres about 60\.003\d° N, 10\.703\d° E$/);
    const metres = await words(page, 'import-extent');
    const keeps = page.getByRole('checkbox', { name: 'Keep degrees' });
    await keeps.press('Space');
    await says(page, 'import-extent', /^10\.7|^10\.6/);
    assert.ok(await keeps.isChecked());
    assert.match(await words(page, 'import-projection'), /^Degrees are taken as they are/);
    assert.deepEqual(await violations(page), []);
    assert.ok(await fits(page));
    await keeps.press('Space');
    await page.waitForFunction((before) => document.getElementById('import-extent')?.textContent === before, metres);
    assert.ok(!(await keeps.isChecked()));
  });

  pageTest('goes out as it came in, also after a reload and out of a project', {}, async (page) => {
    await iterations(page, 1);
    await pick(page, 'forest.geojson', map);
    await usable(page);
    await useIt(page);
    await page.waitForFunction(() => document.getElementById('exemplar-title')?.textContent === 'forest.geojson');
    await status(page, 'playing');
    await iterations(page, 1);
    await pause(page);
    const formats = page.locator('.formats button');
    assert.match(await formats.first().innerText(), /GeoJSON/, 'what it came as is offered first');
    const written = await downloadText(page, 'Download GeoJSON');
    assert.equal(written.name, 'pointweave-forest.geojson');
    const { features } = JSON.parse(written.text);
    assert.equal(features.length, (await peek(page, 'positions')).length / 2);
    const inDegrees = (/** @type {any[]} */ list) => list.every(({ geometry: { coordinates: [longitude, latitude] } }) =>
      Math.abs(longitude - 10.7) < 0.1 && Math.abs(latitude - 60) < 0.1);
    assert.ok(inDegrees(features), `in degrees: ${JSON.stringify(features[0])}`);
    assert.deepEqual(Object.keys(features[0].properties).sort(), ['height', 'species']);
    // Opened again it is the same pattern.
    await pick(page, written.name, written.text);
    await usable(page);
    assert.equal(await words(page, 'import-points'), `${features.length} points`);
    assert.match(await words(page, 'import-classes'), /oak/);
    await page.keyboard.press('Escape');
    const project = await downloadText(page, 'Save project');
    await page.reload();
    await status(page, 'paused');
    assert.ok(inDegrees(JSON.parse((await downloadText(page, 'Download GeoJSON')).text).features), 'after a reload');
    await page.getByText('Maze', { exact: true }).first().click();
    await page.waitForFunction(() => document.getElementById('exemplar-title')?.textContent === 'Maze');
    assert.match(await formats.first().innerText(), /CSV/);
    await pick(page, project.name, project.text);
    await usable(page);
    await useIt(page);
    await status(page, 'paused');
    assert.match(await formats.first().innerText(), /GeoJSON/);
    assert.ok(inDegrees(JSON.parse((await downloadText(page, 'Download GeoJSON')).text).features), 'out of a project');
  });
});

describe('a table', () => {
  pageTest('goes out with the columns it came with', {}, async (page) => {
    await iterations(page, 1);
    await pick(page, 'forest.csv', forest('easting_m,northing_m,species,crown,height_m'));
    await usable(page);
    await useIt(page);
    await page.waitForFunction(() => document.getElementById('exemplar-title')?.textContent === 'forest.csv');
    await status(page, 'playing');
    await pause(page);
    const { text } = await downloadText(page, 'Download CSV');
    const header = text.split('\n').find((line) => !line.startsWith('#')) ?? '';
    assert.deepEqual(header.split(',').slice(0, 3), ['easting_m', 'northing_m', 'species']);
    assert.match(header, /height_m/);
    // Drawn upon, they are still the same columns; what is drawn from nothing has none.
    await page.getByRole('button', { name: 'Edit', exact: true }).click();
    await page.locator('#editor-mirror-x').click();
    await page.getByRole('button', { name: 'Use it' }).click();
    await status(page, 'playing');
    await pause(page);
    assert.match((await downloadText(page, 'Download CSV')).text, /easting_m,northing_m,species/);
  });
});
