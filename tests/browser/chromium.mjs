// @ts-check
/** A headless Chromium with a profile of its own, for the page's tests and for the benchmark in the browser. */
import { mkdtemp, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { chromium } from 'playwright-core';

const CHROMIUM = process.env.POINTWEAVE_CHROMIUM ?? '/usr/bin/chromium';

/**
 * @param {{ webgpu?: boolean, serviceWorkers?: 'allow' | 'block', args?: string[] }} [options] service workers are blocked unless a test
 *   is about them: what they answer can't be watched or replaced
 */
export async function openChromium({ webgpu = false, serviceWorkers = 'block', args = [] } = {}) {
  const profile = await mkdtemp(join(tmpdir(), 'pointweave-browser-'));
  const forget = () => rm(profile, { recursive: true, force: true });
  try {
    const context = await chromium.launchPersistentContext(profile, {
      executablePath: CHROMIUM,
      headless: false,
      acceptDownloads: true,
      serviceWorkers,
      args: [
        '--headless=new',
        '--no-sandbox',
        '--disable-quic',
        '--no-first-run',
        '--disable-background-networking',
        '--disable-component-update',
        '--disable-sync',
        // Pages in the background must not be slowed down: tests open several.
        '--disable-renderer-backgrounding',
        ...(webgpu ? ['--enable-unsafe-webgpu'] : []),
        ...args,
      ],
    });
    return {
      context,
      async close() {
        await context.close();
        await forget();
      },
    };
  } catch (error) {
    await forget();
    throw error;
  }
}
