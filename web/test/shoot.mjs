// SPDX-License-Identifier: Apache-2.0
// Takes pictures of a report for people to look at: node test/shoot.mjs REPORT.html FOLDER
import {mkdirSync} from 'node:fs';
import {resolve} from 'node:path';
import {openBrowser} from './browser/chromium.js';

const [file, folder] = process.argv.slice(2);
mkdirSync(folder, {recursive: true});
const browser = await openBrowser();
for (const [name, width, scheme] of [['1280-light', 1280, 'light'], ['1280-dark', 1280, 'dark'], ['390-light', 390, 'light']]) {
  const page = await browser.newPage({viewport: {width, height: 900}, colorScheme: scheme});
  page.on('console', (m) => console.log(name, m.type(), m.text()));
  page.on('pageerror', (e) => console.log(name, 'pageerror', e.message));
  await page.goto(`file://${resolve(file)}`);
  await page.waitForSelector('.viewer[data-ready], .viewer .notice', {timeout: 20000}).catch(() => console.log('no viewer'));
  await page.waitForTimeout(400);
  const height = await page.evaluate(() => document.documentElement.scrollHeight);
  console.log(name, 'ready', await page.getAttribute('.viewer', 'data-ready'), 'height', height);
  const step = 2200;
  for (let y = 0, k = 0; y < Math.min(height, 9 * step); y += step, ++k) {
    await page.screenshot({path: `${folder}/${name}-${k}.png`, fullPage: true, clip: {x: 0, y, width, height: Math.min(step, height - y)}});
  }
  if (name === '1280-dark') await page.pdf({path: `${folder}/print.pdf`, preferCSSPageSize: true, printBackground: false});
  await page.close();
}
await browser.close();
