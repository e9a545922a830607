// @ts-check
/**
 * Times an iteration in headless Chromium: `node benches/web/run.mjs URL WORKLOAD` with the address of the served
 * `benches/web/` and a workload as JSON. Prints the report, one JSON object in one line.
 */
import { openChromium } from '../../tests/browser/chromium.mjs';

const [url, workload] = process.argv.slice(2);
if (!url || !workload) {
  console.error('usage: node benches/web/run.mjs URL WORKLOAD');
  process.exit(2);
}

const { context, close } = await openChromium();
try {
  const page = await context.newPage();
  // Otherwise a policy violation or a script that throws would only show as a page that waits.
  page.on('console', (message) => console.error(`${message.type()}: ${message.text()}`));
  page.on('pageerror', (error) => console.error(`exception: ${error.message}`));
  await page.goto(url);
  await page.waitForFunction(() => 'bench' in window);
  // As large as the workload: no limit of time here, whoever started this sees it run.
  const report = await page.evaluate((text) => /** @type {any} */ (window).bench(text), workload);
  console.log(JSON.stringify(JSON.parse(report)));
} finally {
  await close();
}
