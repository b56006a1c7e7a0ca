// SPDX-License-Identifier: Apache-2.0
// A fleet's page in a real browser, with data made by hand and, if FLEET names a page, also with one that the program made.
import assert from 'node:assert/strict';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {after, before, test} from 'node:test';
import {fileURLToPath} from 'node:url';

import {page as fill} from '../sample.js';
import {sampleFleet} from '../sample_fleet.js';
import {EVIL} from '../sample_robot.js';
import {openBrowser} from './chromium.js';
import {openPage} from './pages.js';

const template = process.env.TEMPLATE ?? fileURLToPath(new URL('../../dist/index.html', import.meta.url));
const folder = mkdtempSync(join(tmpdir(), 'elastocal-fleet-'));
const sample = join(folder, 'fleet.html');
const files = {sample, ...(process.env.FLEET && {program: resolve(process.env.FLEET)})};
let browser;

before(async () => {
  writeFileSync(sample, fill(readFileSync(template, 'utf8'), sampleFleet()));
  browser = await openBrowser();
});
after(async () => {
  await browser?.close();
  rmSync(folder, {recursive: true, force: true});
});

for (const [name, file] of Object.entries(files)) {
  test(`fleet ${name}: opens without an error or a request, and fits a screen, a phone and paper`, async () => {
    const {page, problems, requests} = await openPage(browser, file, {viewport: {width: 390, height: 900}});
    await page.waitForSelector('#robots table');
    for (const [width, media] of [[390, 'screen'], [1280, 'screen'], [680, 'print']]) {
      await page.setViewportSize({width, height: 900});
      await page.emulateMedia({media});
      const [content, room] = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
      assert.ok(content <= room, `${media} ${width}: ${content} > ${room}`);
    }
    assert.deepEqual(problems, []);
    assert.deepEqual(requests, [], 'nothing is loaded');
    await page.close();
  });

  test(`fleet ${name}: every figure gives its data as CSV`, async () => {
    const {page, problems} = await openPage(browser, file);
    await page.$$eval('details', (all) => { for (const one of all) one.open = true; });
    const buttons = await page.$$('figure .figure-head button');
    assert.equal(buttons.length, await page.$$eval('figure', (figures) => figures.length));
    for (const button of buttons) {
      const [download] = await Promise.all([page.waitForEvent('download'), button.evaluate((b) => b.click())]);
      assert.match(download.suggestedFilename(), /\.csv$/);
      assert.ok(readFileSync(await download.path(), 'utf8').trimEnd().split('\n').length > 1, download.suggestedFilename());
    }
    assert.deepEqual(problems, []);
    await page.close();
  });
}

test('robots are rows, those that need somebody first; names are shown, not run', async () => {
  const {page, problems} = await openPage(browser, sample);
  const rows = await page.$$eval('#robots tbody tr', (all) => all.map((row) => [...row.cells].map((cell) => cell.textContent)));
  assert.equal(rows.length, 12);
  assert.deepEqual(rows[0].slice(0, 5), ['talos_12', 'A', 'failed', '1', '–']);
  assert.deepEqual(rows[1].slice(0, 3), [EVIL, 'B', 'not to be deployed']);
  assert.deepEqual(rows[2], ['talos_7', 'B', 'to be deployed; workshop', '2', '6.20', '4.40', '0.50', 'arm_3_joint.theta', '']);
  assert.deepEqual(rows[3].slice(-1), ['arm_1_joint.theta']);
  assert.match(await page.textContent('.verdict-sentence'), /^10 of 12 robots have .* deployed, 1 has one that is not, 1 has none and 1 needs a workshop\.$/);
  assert.match(await page.textContent('#family tbody tr'), /talos_7arm_3_joint\.theta2\.01 °0\.06 ± 0\.23 °< 0\.0001/);
  assert.match(await page.textContent('#drift tbody tr'), /talos_2arm_1_joint\.theta0\.0859 ± 0\.0069 °3< 0\.0001/);
  // Plots are drawn once the page is laid out.
  const drawn = () => [...document.querySelectorAll('#drift .plot canvas')].filter((canvas) => canvas.width > 100).length;
  await page.waitForFunction(`(${drawn})() > 0`);
  assert.equal(await page.evaluate(drawn), 1);
  assert.match(await page.textContent('#batches'), /leg_2_joint\.r1\.20 ± 0\.20 mm/);
  assert.equal(await page.$$eval('#app script', (all) => all.length), 0);
  assert.ok((await page.textContent('#notes')).includes(EVIL));
  assert.match(await page.title(), /^Fleet/);
  assert.deepEqual(problems, []);
  await page.close();
});
