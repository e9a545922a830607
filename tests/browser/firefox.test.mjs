// @ts-check
/** The page in Firefox: another engine, without WebGPU, so the processor computes. */
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { test } from 'node:test';
import puppeteer from 'puppeteer-core';

import { DIST, PATIENCE, farthest } from './browser.mjs';
import { serve } from './server.mjs';

const FIREFOX = process.env.POINTWEAVE_FIREFOX ?? '/usr/bin/firefox-esr';
const skip = process.env.POINTWEAVE_FIREFOX || existsSync(FIREFOX) ? false : `there is no ${FIREFOX}`;

test('Firefox opens the page, computes on the processor, and the points move', { timeout: 180_000, skip }, async () => {
  const server = await serve(DIST);
  const browser = await puppeteer.launch({ browser: 'firefox', executablePath: FIREFOX, headless: true });
  try {
    const page = await browser.newPage();
    page.setDefaultTimeout(PATIENCE);
    /** @type {string[]} */
    const complaints = [];
    page.on('pageerror', (error) => complaints.push(/** @type {Error} */ (error).message));
    page.on('console', (message) => void (message.type() === 'error' && complaints.push(message.text())));
    await page.setViewport({ width: 1280, height: 800 });
    await page.goto(server.url);
    const peek = (/** @type {string} */ name) => page.evaluate((member) => /** @type {any} */ (window).pointweave[member], name);
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave?.progress?.totalIterations >= 1);
    assert.equal(await page.$eval('#engine', (engine) => engine.textContent), 'CPU · SIMD, 1 thread');
    const start = await peek('positions');
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.progress.totalIterations >= 8);
    assert.ok(farthest(start, await peek('positions')) > 1e-3, 'points have moved');
    const losses = await peek('losses');
    assert.ok(losses[7] < losses[0], `the loss went from ${losses[0]} to ${losses[7]}`);
    await page.keyboard.press(' ');
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave.status === 'paused');
    // Dark by choice, over a reload that keeps the run.
    await page.click('.theme label:nth-of-type(3)');
    const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    assert.equal(await paper(), 'rgb(16, 18, 24)');
    await page.waitForNetworkIdle();
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 500)));
    await page.reload();
    await page.waitForFunction(() => /** @type {any} */ (window).pointweave?.progress?.totalIterations >= 8);
    assert.equal(await paper(), 'rgb(16, 18, 24)');
    assert.deepEqual(complaints, []);
  } finally {
    await browser.close();
    await server.close();
  }
});
