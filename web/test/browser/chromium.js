// SPDX-License-Identifier: Apache-2.0
import {existsSync, mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

import {chromium} from 'playwright-core';

const PLACES = [process.env.CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];

/** Path of a Chromium, or undefined. */
export const chromiumPath = () => PLACES.find((path) => path && existsSync(path));

/** Options: headless, WebGL in software, no calls home. */
const FLAGS = [
  '--headless=new', '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
  '--disable-background-networking', '--disable-component-update', '--disable-sync', '--no-first-run', '--disable-quic',
];

/** A real browser with a new profile, which is removed when it closes. */
export async function openBrowser() {
  const profile = mkdtempSync(join(tmpdir(), 'elastocal-chromium-'));
  const context = await chromium.launchPersistentContext(profile, {executablePath: chromiumPath(), args: FLAGS, acceptDownloads: true});
  const browser = context.browser();
  return {
    newPage: async (options) => browser ? (await browser.newContext(options)).newPage() : context.newPage(),
    close: async () => {
      await context.close();
      // Its last processes may still be writing.
      for (let i = 0; i < 20 && existsSync(profile); ++i) {
        try {
          rmSync(profile, {recursive: true, force: true});
        } catch {
          await new Promise((done) => setTimeout(done, 100));
        }
      }
    },
  };
}
