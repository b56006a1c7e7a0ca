// SPDX-License-Identifier: Apache-2.0
// Saves the top of a report as a PNG: node test/picture.mjs REPORT.html PICTURE.png
import {resolve} from 'node:path';

import {openBrowser} from './browser/chromium.js';

const [report, picture] = process.argv.slice(2);
const browser = await openBrowser();
const page = await browser.newPage({viewport: {width: 1280, height: 1180}, colorScheme: 'light'});
await page.goto(`file://${resolve(report)}`);
await page.waitForSelector('.viewer[data-ready]');
// Choose a posture with something to see.
await page.focus('#posture');
for (let i = 0; i < 4; ++i) await page.keyboard.press('ArrowRight');
await page.evaluate(() => { document.activeElement.blur(); scrollTo(0, 0); });
await page.waitForTimeout(300);
await page.screenshot({path: picture});
await browser.close();
