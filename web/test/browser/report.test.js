// SPDX-License-Identifier: Apache-2.0
// The page in a real browser, with a report made by hand and, if REPORT names one, also with one that
// the program made. TEMPLATE is the built page, by default web/dist/index.html.
import assert from 'node:assert/strict';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {after, before, test} from 'node:test';
import {fileURLToPath, pathToFileURL} from 'node:url';

import {page as fill, sampleReport} from '../sample.js';
import {EVIL} from '../sample_robot.js';
import {openBrowser} from './chromium.js';
import {embeddedReport, openPage, picture, waitForViewer} from './pages.js';
import {trianglePage} from './triangle.js';

const template = process.env.TEMPLATE ?? fileURLToPath(new URL('../../dist/index.html', import.meta.url));
const folder = mkdtempSync(join(tmpdir(), 'elastocal-report-'));
const sample = join(folder, 'sample.html');
const triangle = join(folder, 'triangle.html');
const files = {sample, ...(process.env.REPORT && {program: resolve(process.env.REPORT)})};
let browser;

/** Tests that only read share a page of 1280 x 900, because opening one takes longer than such a test. */
const kept = {};
const keptPage = (file) => kept[file] ??= openPage(browser, file);

before(async () => {
  writeFileSync(triangle, trianglePage);
  writeFileSync(sample, fill(readFileSync(template, 'utf8'), sampleReport()));
  browser = await openBrowser();
});
after(async () => {
  await browser?.close();
  rmSync(folder, {recursive: true, force: true});
});

for (const [name, file] of Object.entries(files)) {
  test(`${name}: opens without an error, a request or a jump, and draws the robot`, async () => {
    const {page, problems, requests} = await openPage(browser, file);
    await waitForViewer(page);
    const drawn = await picture(page);
    assert.ok(drawn.opaque > 0.02 * drawn.pixels, `${drawn.opaque} of ${drawn.pixels} pixels are drawn`);
    assert.ok(drawn.colours > 50, `${drawn.colours} colours`);
    const jump = await page.evaluate(() => new Promise((done) => {
      let sum = 0;
      new PerformanceObserver((list) => { for (const e of list.getEntries()) sum += e.value; }).observe({type: 'layout-shift', buffered: true});
      setTimeout(() => done(sum), 300);
    }));
    assert.ok(jump < 0.01, `layout shift ${jump}`);
    assert.deepEqual(problems, []);
    assert.deepEqual(requests, [], 'nothing is loaded');
    await page.close();
  });

  test(`${name}: has the licences of others' software`, async () => {
    const {page} = await keptPage(file);
    const text = await page.$eval('#licences pre', (pre) => pre.textContent);
    for (const words of ['three 0', 'uplot 1', 'urdf-loader 0', 'MIT', 'Apache License']) assert.ok(text.includes(words), words);
  });

  test(`${name}: fits widths of 390 and 1280, and paper`, async () => {
    const {page} = await openPage(browser, file, {viewport: {width: 390, height: 900}});
    await waitForViewer(page);
    for (const [width, media] of [[390, 'screen'], [1280, 'screen'], [680, 'print']]) {
      await page.setViewportSize({width, height: 900});
      await page.emulateMedia({media});
      const [content, room] = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
      assert.ok(content <= room, `${media} ${width}: ${content} > ${room}`);
      // On paper nothing scrolls, so tables must fit as well.
      const wide = media === 'print' ? await page.$$eval('table', (all) => all.filter((t) => t.getBoundingClientRect().right > innerWidth + 1).map((t) => t.caption?.textContent)) : [];
      assert.deepEqual(wide, []);
    }
    await page.close();
  });

  test(`${name}: no figure runs into the next`, async () => {
    const {page} = await keptPage(file);
    for (const [width, media] of [[320, 'screen'], [390, 'screen'], [900, 'screen'], [1280, 'screen'], [680, 'print']]) {
      await page.setViewportSize({width, height: 900});
      await page.emulateMedia({media});
      const meetings = await page.evaluate(() => {
        // Measure the drawn text, which may stick out of its box.
        const drawn = (element) => { const range = document.createRange(); range.selectNodeContents(element); return [...range.getClientRects()]; };
        const meet = (a, b) => a.left < b.right - 0.5 && b.left < a.right - 0.5 && a.top < b.bottom - 0.5 && b.top < a.bottom - 0.5;
        return [...document.querySelectorAll('.facts')].flatMap((facts) => {
          const items = [...facts.querySelectorAll('.fact')].map((fact) => ({text: fact.textContent, rects: ['dt', 'dd'].flatMap((tag) => drawn(fact.querySelector(tag)))}));
          return items.flatMap((a, i) => items.slice(i + 1).filter((b) => a.rects.some((x) => b.rects.some((y) => meet(x, y)))).map((b) => `${a.text} | ${b.text}`));
        });
      });
      assert.deepEqual(meetings, [], `${media} ${width}`);
      assert.ok(await page.$$eval('.fact', (all) => all.length) >= 9);
    }
    await page.setViewportSize({width: 1280, height: 900});
    await page.emulateMedia({media: null});
  });

  test(`${name}: a standard deviation on the page has two significant digits, and its estimate the same decimals`, async () => {
    const {page} = await keptPage(file);
    const cells = await page.$$eval('#parameters .estimate', (all) => all.map((e) => [e.querySelector('.value').textContent, e.querySelector('.sd').textContent]));
    const decimals = (text) => text.split('.')[1]?.length ?? 0;
    for (const [value, sd] of cells) {
      assert.match(sd, /^±(0\.0*[1-9]\d|[1-9]\.\d|[1-9][\d\u202f]*)$/);
      assert.equal(decimals(value), decimals(sd), `${value} ${sd}`);
    }
    assert.ok(cells.length > 5);
  });

  test(`${name}: slider, play and magnification change the picture`, async () => {
    const {page, problems} = await openPage(browser, file);
    await waitForViewer(page);
    const first = await picture(page);
    await page.focus('#posture');
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('ArrowRight');
    const second = await picture(page);
    assert.notEqual(second.hash, first.hash, 'slider');
    const label = () => page.textContent('.viewer-status ~ .transport output');
    const still = await label();
    await page.click('.play');
    await page.waitForFunction((before) => document.querySelector('.transport output').textContent !== before, still, {timeout: 5000});
    await page.click('.play');
    assert.equal(await page.getAttribute('.play', 'aria-pressed'), 'false');
    const third = await picture(page);
    assert.notEqual(third.hash, second.hash, 'play');
    await page.focus('#magnification');
    await page.keyboard.press('End');
    assert.notEqual((await picture(page)).hash, third.hash, 'magnification');
    await page.focus('.viewer canvas');
    const before = await picture(page);
    for (let i = 0; i < 5; ++i) await page.keyboard.press('ArrowLeft');
    await page.waitForTimeout(100);
    assert.notEqual((await picture(page)).hash, before.hash, 'arrow keys turn the view');
    assert.deepEqual(problems, []);
    await page.close();
  });

  test(`${name}: the tables hold the numbers of summary.json`, async () => {
    const {summary, validation} = embeddedReport(file);
    const {page} = await keptPage(file);
    const shown = new Map(await page.$$eval('#parameters [data-parameter]', (all) => all.map((e) => [e.dataset.parameter, {value: e.dataset.value, text: e.querySelector('.value')?.textContent}])));
    const unit = {'rad': 180 / Math.PI, 'm': 1e3, 'rad/(N.m)': 1e6};
    let checked = 0;
    for (const p of summary.parameters) {
      if (!['estimated', 'unsupported'].includes(p.status) || /^(marker|waist)\./.test(p.name) || !shown.has(p.name)) continue;
      const factor = unit[p.unit];
      assert.equal(Number(shown.get(p.name).value), p.value);
      // Rounding to the second digit of the standard deviation changes the value by at most half a unit, so by sd / 20.
      const off = Math.abs(Number(shown.get(p.name).text.replace('−', '-').replaceAll('\u202f', '')) - p.value * factor);
      assert.ok(off <= 0.051 * p.sd * factor, `${p.name}: ${shown.get(p.name).text}`);
      ++checked;
    }
    assert.ok(checked > 5, `${checked} parameters`);
    const text = await page.textContent('#models');
    const errors = summary.kfold ?? summary;
    for (const value of Object.values(errors.rmse_3d_mm)) assert.ok(text.includes(value.toFixed(2)), `${value}`);
    for (const value of Object.values(validation?.rmse_3d_mm_all ?? {})) assert.ok(text.includes(value.toFixed(2)), `${value}`);
    for (const mistake of validation?.mistakes ?? []) assert.ok(text.includes(mistake), mistake);
  });

  test(`${name}: every figure gives its data as CSV`, async () => {
    const {page, problems} = await openPage(browser, file);
    await waitForViewer(page);
    const buttons = await page.$$('figure .figure-head button');
    assert.equal(buttons.length, await page.$$eval('figure', (figures) => figures.length));
    const saved = [];
    const real = 8;  // Chromium asks the user at the eleventh download of a page
    for (const button of buttons.slice(0, real)) {
      const [download] = await Promise.all([page.waitForEvent('download'), button.evaluate((b) => b.click())]);
      saved.push([download.suggestedFilename(), readFileSync(await download.path(), 'utf8')]);
    }
    // For the others, take the data that the page would save. Opening the page once more would take longer.
    saved.push(...await page.evaluate((others) => {
      const names = [], blobs = [];
      URL.createObjectURL = (blob) => { blobs.push(blob); return 'blob:kept'; };
      HTMLAnchorElement.prototype.click = function () { names.push(this.download); };
      for (const button of others) button.click();
      return Promise.all(blobs.map(async (blob, i) => [names[i], await blob.text()]));
    }, buttons.slice(real)));
    assert.equal(saved.length, buttons.length);
    for (const [name, text] of saved) {
      assert.match(name, /\.csv$/);
      assert.ok(text.trimEnd().split('\n').length > 1, name);
    }
    assert.deepEqual(problems, []);
    await page.close();
  });

  test(`${name}: the executed robots end where the data have them`, async () => {
    const {time_s: times, robots} = embeddedReport(file).deployment.playback;
    const {page, problems} = await openPage(browser, file);
    await page.$eval('.side-by-side', (element) => element.scrollIntoView());
    await page.waitForSelector('.side-by-side[data-ready]', {timeout: 20000});
    const first = await picture(page, '.side-by-side canvas');
    await page.focus('#playback-time');
    await page.keyboard.press('End');
    assert.notEqual((await picture(page, '.side-by-side canvas')).hash, first.hash);
    const hands = await page.$$eval('.playback-now tbody tr', (rows) => rows.map((row) => row.cells[1].textContent));
    assert.deepEqual(hands, robots.map(({tips}) => Math.max(...tips.filter((tip) => tip.place === 'hand').map((tip) => tip.distance_mm.at(-1))).toFixed(1)));
    assert.ok(robots.some((robot) => robot.pictures === times.length), 'one stood to the end');
    assert.deepEqual(problems, []);
    await page.close();
  });

  test(`${name}: the viewer is there within 2 s, or 16 times what one triangle takes, in less than 5 MB`, async (t) => {
    const times = {viewer: [], triangle: []};
    // Other tests may run at the same time, so the quickest of up to six counts.
    const limit = () => Math.max(2000, 16 * Math.min(...times.triangle));
    const tooLate = () => !(Math.min(...times.viewer) < limit());
    while (times.viewer.length < 6 && tooLate()) {
      for (const [what, path] of [['triangle', triangle], ['viewer', file]]) {
        const page = await browser.newPage({viewport: {width: 1280, height: 900}, deviceScaleFactor: 0.5});
        await page.goto(pathToFileURL(path).href);
        times[what].push(Number(await waitForViewer(page)));
        await page.close();
      }
    }
    t.diagnostic(`first picture of the viewer after ${times.viewer.join(', ')} ms, of a triangle after ${times.triangle.join(', ')} ms; ${(readFileSync(file).length / 1e6).toFixed(2)} MB`);
    assert.ok(!tooLate(), `${times.viewer} ms, limit ${limit()} ms`);
    assert.ok(readFileSync(file).length < 5e6);
  });
}

test('names from the user’s files are shown, not run', async () => {
  const {page, problems} = await keptPage(sample);
  await waitForViewer(page);
  assert.equal(await page.$$eval('#app script', (all) => all.length), 0);
  assert.ok((await page.textContent('h1')).includes(EVIL));
  for (const id of ['parameters', 'models', 'residuals', 'findings', 'reproduce', 'history', 'identifiability']) {
    assert.ok((await page.textContent(`#${id}`)).includes(EVIL), id);
  }
  assert.deepEqual(problems, []);
});

test('the stiffness of a leg has its interval, or is unknown', async () => {
  const {page, problems} = await keptPage(sample);
  const row = await page.$$eval('[aria-label="Stiffness of the legs"] tbody tr', (all) => [...all[0].cells].map((cell) => cell.innerText.replaceAll('\n', ' ')));
  assert.deepEqual(row.slice(1), ['unknown, > 33.0', 'unknown, > 32.0', '186 181.5 to 190.2', '24\u202f700 22\u202f500 to 26\u202f800', '5\u202f230 5\u202f190 to 5\u202f270', 'unknown']);
  assert.deepEqual(problems, []);
});

test('the spring of a sole has its deviation, or is not told', async () => {
  const {page, problems} = await keptPage(sample);
  const rows = await page.$$eval('[aria-label="Springs below the markers of the feet"] tbody tr', (all) => all.map((row) => [...row.cells].map((cell) => cell.innerText)));
  assert.deepEqual(rows, [['leg left', '0.742 ± 0.041', '3'], ['leg right', 'not told', '0']]);
  assert.deepEqual(problems, []);
});

test('nine equal warnings are one line with the names, and fold out', async () => {
  const {page, problems} = await keptPage(sample);
  const lines = await page.$$eval('#findings .words.state- > ul > li', (all) => all.map((li) => li.firstChild.textContent + (li.querySelector(':scope > .others')?.textContent ?? '')));
  assert.equal(lines.length, 2);
  assert.match(lines[1], /"arm_1_joint".*The same is true of "arm_2_joint", .* and "arm_9_joint"\.$/);
  await page.click('#findings .words details summary');
  assert.equal(await page.$$eval('#findings .words details[open] li', (all) => all.filter((li) => li.offsetHeight > 0).length), 9);
  assert.match(await page.textContent('.verdict-link'), /^Read 1 remark and 2 warnings$/);
  assert.deepEqual(problems, []);
});

test('the chain filter, dark colours and keys on plots work', async () => {
  const {page, problems} = await openPage(browser, sample, {colorScheme: 'dark'});
  await waitForViewer(page);
  const rows = () => page.$$eval('#parameters figure:first-of-type tbody tr', (all) => all.length);
  const all = await rows();
  await page.click('#parameters .choice label:nth-of-type(2)');
  assert.ok(await rows() < all);
  const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const dark = await background();
  await page.click('.top button');
  assert.notEqual(await background(), dark);
  const readout = () => page.textContent('#residuals .readout');
  const hint = await readout();
  await page.focus('#residuals .plot');
  await page.keyboard.press('ArrowRight');
  assert.notEqual(await readout(), hint);
  assert.deepEqual(problems, []);
  await page.close();
});

test('a planned motion plays, with spheres and workspaces', async () => {
  const {page, problems} = await openPage(browser, sample);
  await waitForViewer(page);
  await page.selectOption('#clip', {label: 'motion'});
  const plain = await picture(page);
  await page.getByLabel('Collision spheres').check();
  const spheres = await picture(page);
  assert.notEqual(spheres.hash, plain.hash);
  await page.getByLabel('Workspaces').check();
  assert.notEqual((await picture(page)).hash, spheres.hash);
  await page.focus('#posture');
  await page.keyboard.press('End');
  assert.notEqual((await picture(page)).hash, spheres.hash);
  assert.deepEqual(problems, []);
  await page.close();
});

test('the executed robots play beside the plan, with one clock', async () => {
  const {page, problems} = await openPage(browser, sample);
  assert.equal(await page.$('.side-by-side[data-ready]'), null, 'nobody looks yet');
  await page.$eval('.side-by-side', (element) => element.scrollIntoView());
  await page.waitForSelector('.side-by-side[data-ready]', {timeout: 20000});
  const look = () => picture(page, '.side-by-side canvas');
  const numbers = () => page.$$eval('.playback-now tbody tr', (rows) => rows.map((row) => [...row.cells].map((cell) => cell.textContent)));
  const first = await look();
  assert.ok(first.opaque > 0.01 * first.pixels, `${first.opaque} of ${first.pixels} pixels are drawn`);
  assert.deepEqual(await numbers(), [['the nominal URDF', '12.0', '–', ''], ['geometry and elasticity', '1.5', '–', '']]);
  assert.deepEqual(await page.$$eval('.robot-name', (names) => names.map((name) => name.textContent)), ['the plan', 'the nominal URDF', 'geometry and elasticity']);
  await page.focus('#playback-time');
  await page.keyboard.press('End');
  const last = await look();
  assert.notEqual(last.hash, first.hash, 'the clock moves the robots');
  assert.deepEqual(await numbers(), [['the nominal URDF', '14.4', '6.0', 'fell at 5 s'], ['geometry and elasticity', '5.4', '0.8', '']]);
  await page.focus('#playback-factor');
  await page.keyboard.press('End');
  assert.notEqual((await look()).hash, last.hash, 'magnification');
  assert.deepEqual((await numbers()).map((row) => row[3]), ['fell at 5 s, drawn × 29', '']);
  await page.click('.playback .play');
  await page.waitForFunction(() => Number(document.querySelector('#playback-time').value) < 7, undefined, {timeout: 5000});
  await page.click('.playback .play');
  assert.equal(await page.getAttribute('.playback .play', 'aria-pressed'), 'false');
  await page.emulateMedia({media: 'print'});
  assert.equal(await page.isVisible('.playback'), false, 'on paper there is the table');
  assert.ok(await page.isVisible('#deployment figure:not(.playback) table'));
  assert.deepEqual(problems, []);
  await page.close();
});

test('causes are shown with their curve, and the file of diagnose goes before the summary', async () => {
  const {page, problems} = await openPage(browser, sample);
  const names = () => page.$$eval('#findings .cause h4', (all) => all.map((h4) => h4.textContent));
  assert.deepEqual(await names(), ['arm_1_joint.eccentricity', `${EVIL}.hysteresis`, 'waist.drift']);
  assert.equal(await page.$$eval('#findings .cause .plot canvas', (all) => all.filter((c) => c.width > 100).length), 3);
  await page.focus('#findings .cause .plot');
  await page.keyboard.press('Home');
  assert.match(await page.textContent('#findings .cause .readout'), /position of arm_1_joint −[89]\d/);
  assert.deepEqual(problems, []);
  await page.close();
  const report = sampleReport();
  report.diagnosis = {words: ['None of 44 causes was found.'], pictures: report.summary.diagnosis_pictures.slice(2)};
  const file = join(folder, 'diagnosed.html');
  writeFileSync(file, fill(readFileSync(template, 'utf8'), report));
  const other = await openPage(browser, file);
  assert.deepEqual(await other.page.$$eval('#findings .cause h4', (all) => all.map((h4) => h4.textContent)), ['waist.drift']);
  assert.ok((await other.page.textContent('#findings')).includes('None of 44 causes was found.'));
  assert.ok((await other.page.textContent('#findings')).includes('1.2 ± 0.1 mrad'));
  assert.deepEqual(other.problems, []);
  await other.page.close();
});

test('a slide has its own units, causes have a table, and causes that were not found do not pass for found ones', async () => {
  const report = sampleReport();
  report.summary.parameters.push(
    {name: 'lift_joint.compliance_z', unit: 'm/N', value: 2e-6, sd: 2e-7, status: 'estimated', significant: true},
    {name: 'arm_1_joint.coupling_lift_joint', unit: 'rad/m', value: -0.0287, sd: 0.0069, status: 'estimated', significant: true});
  report.summary.diagnosis_pictures = report.summary.diagnosis_pictures.map((picture) => ({...picture, p_adjusted: 0.3}));
  report.summary.extra = ['arm_1_joint.coupling_lift_joint'];
  delete report.validation;  // of a recording with a mistake, which would stand first
  report.summary.deployed = {judged_on: 'held-out postures', urdf: {rmse_3d_mm: 4.06, uncalibrated: 5.19, interval_95_mm: [2.9, 5.7], model: 'rigid'},
    compensated: {rmse_3d_mm: 2.59, uncalibrated: 5.19, interval_95_mm: [1.7, 4]}};
  const file = join(folder, 'slide.html');
  writeFileSync(file, fill(readFileSync(template, 'utf8'), report));
  const {page, problems} = await openPage(browser, file);
  const row = await page.$eval('#parameters [data-parameter="lift_joint.compliance_z"]', (e) => e.closest('tr').textContent);
  assert.match(row, /2\.00±0\.20 µm\/N500 N\/mm/);
  const cause = await page.$eval('#parameters [data-parameter="arm_1_joint.coupling_lift_joint"]', (e) => e.closest('tr').textContent);
  assert.match(cause, /−28\.7±6\.9 mrad\/m/);
  assert.ok((await page.textContent('#findings')).includes('none of which is significant'));
  const facts = await page.textContent('#verdict .facts');
  assert.match(facts, /elasticity and 1 other cause, which a URDF cannot carry \(95 % interval for many such postures: 1\.70 to 4\.00\)/);
  assert.match(await page.textContent('#verdict .verdict-rest'), /^Another day and other postures may show more/);
  assert.deepEqual(problems, []);
  await page.close();
});

test('a report with nothing but a summary says what is missing', async () => {
  const {summary, missing} = sampleReport();
  const file = join(folder, 'poor.html');
  writeFileSync(file, fill(readFileSync(template, 'utf8'), {format: 'elastocal-report-1', folder: 'out', summary, motions: [], calibrations: [], missing}));
  const {page, problems} = await openPage(browser, file);
  assert.ok((await page.textContent('#missing')).includes('elastocal report DIR --earlier OLD'));
  assert.equal(await page.$('.viewer'), null);
  assert.deepEqual(problems, []);
  await page.close();
});
