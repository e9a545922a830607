// @ts-check
/** The advanced parameters, as a person uses them. */
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';

import { iterations, launch, parameter, peek, settled, status, withPage } from './browser.mjs';

/** @typedef {import('playwright-core').Page} Page */

/** @type {import('./browser.mjs').Browser} */
let browser;
before(async () => {
  browser = await launch();
  await browser.context.grantPermissions(['clipboard-read', 'clipboard-write'], { origin: new URL(browser.url).origin });
});
after(() => browser?.close());

/** @param {string} name @param {(page: Page) => Promise<void>} body @param {Parameters<typeof withPage>[1]} [options] */
const pageTest = (name, body, options = {}) =>
  test(name, { timeout: 120_000 }, () =>
    withPage(browser, options, async (page) => {
      await iterations(page, 1);
      await body(page);
    }),
  );

/** @param {Page} page */
const fold = (page) => page.locator('#advanced-fold');
/** @param {Page} page */
const isOpen = (page) => fold(page).evaluate((details) => /** @type {HTMLDetailsElement} */ (details).open);
/** Opens the fold; the browser remembers what the test before left. @param {Page} page */
async function open(page) {
  if (!(await isOpen(page))) await fold(page).locator('summary').click();
}

/** @param {Page} page @param {string} name */
const number = (page, name) => page.getByRole('spinbutton', { name, exact: true });
/** What is wrong with a control, in words; empty where nothing is. @param {Page} page @param {string} name */
const wrong = (page, name) => page.locator(`[data-parameter="${name}"] [role="alert"]`).innerText();
/** Names of the parameters that are marked as changed. @param {Page} page @returns {Promise<string[]>} */
const marked = (page) =>
  page.locator('#advanced [data-differs]').evaluateAll((fields) => fields.map((field) => /** @type {HTMLElement} */ (field).dataset.parameter ?? ''));

/** @param {Page} page */
async function copyLink(page) {
  await page.getByRole('button', { name: 'Copy a link' }).click();
  await page.waitForFunction(() => document.getElementById('link-note')?.textContent !== '');
  const link = await page.locator('#link').inputValue();
  return link.slice(link.indexOf('#'));
}

describe('the advanced parameters', () => {
  pageTest('are all there, in groups, with the preset’s values', async (page) => {
    await open(page);
    const values = await peek(page, 'parameters');
    const shared = ['expansion-x', 'expansion-y', 'boundary', 'seed'];
    const names = Object.keys(values).filter((name) => !shared.includes(name));
    assert.ok(names.length > 20, `${names.length} parameters`);
    const shown = await page.locator('#advanced [data-parameter]').evaluateAll((fields) =>
      fields.map((field) => {
        const control = /** @type {HTMLInputElement} */ (field.querySelector('select, input[type="number"]'));
        return [/** @type {HTMLElement} */ (field).dataset.parameter, control.value, control.labels?.[0]?.textContent];
      }),
    );
    assert.deepEqual(shown.map(([name]) => name).sort(), names.sort());
    for (const [name, value, label] of shown) {
      const held = values[/** @type {string} */ (name)];
      assert.equal(value, typeof held === 'number' ? String(Number(held.toPrecision(6))) : held, `${name}`);
      assert.ok(label, `${name} has a label`);
    }
    assert.ok((await page.locator('#advanced fieldset').count()) > 3, 'groups');
    assert.deepEqual(await marked(page), []);
    // Another preset has other values.
    await page.getByRole('radio', { name: 'Balanced' }).check();
    await page.waitForFunction((before) => /** @type {any} */ (window).pointweave.parameters['restarts'] !== before, values['restarts']);
    await page.waitForFunction(
      () => /** @type {HTMLInputElement | null} */ (document.querySelector('#advanced-restarts'))?.value === String(/** @type {any} */ (window).pointweave.parameters['restarts']),
    );
    assert.deepEqual(await marked(page), []);
  });

  pageTest('change the run, travel in a link, and go back to the preset’s', async (page) => {
    const preset = (await peek(page, 'parameters')).channels;
    await open(page);
    const channels = number(page, 'Channels');
    assert.equal(await channels.inputValue(), String(preset));
    await channels.fill('12');
    await parameter(page, 'channels', 12);
    await status(page, 'playing');
    assert.deepEqual(await marked(page), ['channels']);
    assert.equal(await page.locator('#advanced-count').innerText(), '1 changed');
    const fragment = await copyLink(page);
    assert.match(fragment, /[&]channels=12(&|$)/);
    await withPage(browser, { query: fragment }, async (other) => {
      await parameter(other, 'channels', 12);
      await open(other);
      assert.equal(await number(other, 'Channels').inputValue(), '12');
      assert.deepEqual(await marked(other), ['channels']);
      // Of everything that a run has, only this was changed.
      await other.getByRole('button', { name: `Channels: back to ${preset}` }).click();
      await parameter(other, 'channels', preset);
      assert.equal(await number(other, 'Channels').inputValue(), String(preset));
      assert.deepEqual(await marked(other), []);
      assert.equal(await other.locator('#advanced-count').innerText(), '');
      assert.doesNotMatch(await copyLink(other), /channels/);
    });
  });

  pageTest('say what is wrong with a number, and the run goes on', async (page) => {
    await open(page);
    const { channels: before } = await peek(page, 'parameters');
    const channels = number(page, 'Channels');
    for (const [text, words] of /** @type {[string, RegExp][]} */ ([
      ['100000', /^100000 is too large\. It must be a whole number between 4 and \d+\.$/],
      ['0', /^0 is too small\. It must be a whole number between 4 and \d+\.$/],
      ['12.5', /^12\.5 is not whole\. It must be a whole number between/],
    ])) {
      await channels.fill(text);
      await channels.press('Enter');
      assert.equal(await channels.getAttribute('aria-invalid'), 'true');
      assert.match(await wrong(page, 'channels'), words);
      const described = (await channels.getAttribute('aria-describedby')) ?? '';
      assert.ok(described.split(' ').includes((await page.locator('[data-parameter="channels"] [role="alert"]').getAttribute('id')) ?? '-'));
    }
    await iterations(page, (await peek(page, 'progress')).totalIterations + 5);
    assert.equal((await peek(page, 'parameters')).channels, before, 'nothing was sent');
    assert.equal(await page.locator('.notice').count(), 0);
    assert.deepEqual(await marked(page), []);
    // An empty field is the preset's again.
    await channels.fill('');
    await channels.press('Enter');
    assert.equal(await channels.inputValue(), String(before));
    assert.equal(await channels.getAttribute('aria-invalid'), null);
    assert.equal(await wrong(page, 'channels'), '');
  });

  pageTest('can be words, and are kept over a reload', async (page) => {
    await open(page);
    const maps = page.getByRole('combobox', { name: 'Maps', exact: true });
    const before = await maps.inputValue();
    const options = await maps.locator('option').evaluateAll((all) => all.map((option) => /** @type {HTMLOptionElement} */ (option).value));
    assert.ok(options.length > 1 && options.includes(before));
    const wanted = /** @type {string} */ (options.find((option) => option !== before));
    await maps.selectOption(wanted);
    await parameter(page, 'class-maps', wanted);
    assert.deepEqual(await marked(page), ['class-maps']);
    assert.match(await copyLink(page), new RegExp(`class-maps=${wanted}`));
    await status(page, 'playing');
    await page.getByRole('button', { name: 'Pause' }).click();
    await settled(page);
    await page.waitForTimeout(500);
    await page.reload();
    await parameter(page, 'class-maps', wanted);
    assert.deepEqual(await marked(page), ['class-maps']);
    assert.equal(await maps.inputValue(), wanted);
    // A preset stands for all of them.
    await page.getByRole('radio', { name: 'Balanced' }).check();
    await page.waitForFunction((word) => /** @type {any} */ (window).pointweave.parameters['class-maps'] !== word, wanted);
    assert.deepEqual(await marked(page), []);
  });

  pageTest('can be set with the keyboard alone', async (page) => {
    const summary = fold(page).locator('summary');
    if (await isOpen(page)) await summary.click();
    await summary.focus();
    await page.keyboard.press('Enter');
    assert.equal(await isOpen(page), true);
    const focused = () => page.evaluate(() => document.activeElement?.id);
    await page.keyboard.press('Tab');
    assert.equal(await focused(), 'advanced-channels', 'the first control');
    const { channels: before } = await peek(page, 'parameters');
    await page.keyboard.press('ArrowDown');
    await parameter(page, 'channels', before - 1);
    // The way back lies next.
    await page.keyboard.press('Tab');
    assert.equal(await page.evaluate(() => document.activeElement?.getAttribute('aria-label')), `Channels: back to ${before}`);
    await page.keyboard.press('Enter');
    await parameter(page, 'channels', before);
    assert.equal(await focused(), 'advanced-channels', 'the focus is not lost with the button');
    await page.keyboard.press('Tab');
    assert.notEqual(await focused(), 'advanced-channels');
    assert.match((await focused()) ?? '', /^advanced-/, 'one stop a parameter');
    assert.equal(await peek(page, 'status'), 'playing', 'none of the keys was the run’s');
  });

  pageTest(
    'fit on a phone',
    async (page) => {
      await open(page);
      await number(page, 'Channels').fill('100000');
      await page.locator('#advanced-channels[aria-invalid="true"]').waitFor();
      for (const width of [360, 390, 768, 1280]) {
        await page.setViewportSize({ width, height: 740 });
        await page.waitForTimeout(200);
        const spare = await page.evaluate(() => document.documentElement.clientWidth - document.documentElement.scrollWidth);
        assert.ok(spare >= 0, `${-spare} px too wide at ${width}`);
      }
    },
    { viewport: { width: 360, height: 740 } },
  );
});
