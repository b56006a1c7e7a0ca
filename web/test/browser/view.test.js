// SPDX-License-Identifier: Apache-2.0
// The 3-D view of a robot without a calibration.
import assert from 'node:assert/strict';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import {fileURLToPath} from 'node:url';

import {page as fill, sampleReport} from '../sample.js';
import {openBrowser} from './chromium.js';
import {openPage, picture, waitForViewer} from './pages.js';

const template = process.env.TEMPLATE ?? fileURLToPath(new URL('../../dist/index.html', import.meta.url));
const folder = mkdtempSync(join(tmpdir(), 'elastocal-view-'));
let browser;

before(async () => { browser = await openBrowser(); });
after(async () => {
  await browser?.close();
  rmSync(folder, {recursive: true, force: true});
});

test('a folder with a plan alone plays it', async () => {
  const {data: {robot, spheres}, motions} = sampleReport();
  const file = join(folder, 'plan.html');
  writeFileSync(file, fill(readFileSync(template, 'utf8'), {format: 'elastocal-report-1', folder: 'out', data: {robot, spheres}, motions, calibrations: [], missing: []}));
  const {page, problems} = await openPage(browser, file);
  await waitForViewer(page);
  const first = await picture(page);
  assert.ok(first.opaque > 0.005 * first.pixels);
  await page.focus('#posture');
  await page.keyboard.press('End');
  assert.notEqual((await picture(page)).hash, first.hash);
  assert.deepEqual(problems, []);
  await page.close();
});

test('meshes are drawn where they came along, and a robot without any is drawn by its bones', async () => {
  const pictures = [];
  for (const change of [(robot) => robot, (robot) => ({...robot, meshes: {}}), (robot) => ({...robot, urdf: robot.urdf.replace(/<visual>[^]*?<\/visual>/g, '')})]) {
    const report = sampleReport();
    report.data.robot = change(report.data.robot);
    const file = join(folder, `robot${pictures.length}.html`);
    writeFileSync(file, fill(readFileSync(template, 'utf8'), report));
    const {page, problems} = await openPage(browser, file);
    await waitForViewer(page);
    pictures.push(await picture(page));
    assert.deepEqual(problems, []);
    await page.close();
  }
  assert.equal(new Set(pictures.map((p) => p.hash)).size, 3);
  for (const {opaque, pixels} of pictures) assert.ok(opaque > 0.005 * pixels, `${opaque}`);
});

test('a robot that stands with its feet apart does not jump when the weight goes to the other foot', async () => {
  const speck = '<visual><geometry><box size="1e-6 1e-6 1e-6"/></geometry></visual>';  // too small to show the green of a foot
  const leg = (side, y) => `<link name="${side}">${speck}</link><joint name="${side}_hip" type="revolute"><parent link="root"/><child link="${side}"/><origin xyz="0 ${y} 0"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
    <link name="${side}_sole">${speck}</link><joint name="${side}_fixed" type="fixed"><parent link="${side}"/><child link="${side}_sole"/><origin xyz="0 0 -0.8"/></joint>`;
  const urdf = `<robot name="r"><link name="root"><visual><geometry><box size="0.3 0.3 0.3"/></geometry></visual></link>${leg('left', 0.1)}${leg('right', -0.1)}</robot>`;
  const spread = [0.3, 0.3, 0.3];
  const columns = {time: [0, 1, 2], support: ['left_sole+right_sole', 'left_sole', 'right_sole'], left_hip: spread, right_hip: spread.map((q) => -q)};
  const data = {robot: {name: 'r', urdf, coordinates: ['left_hip', 'right_hip'], meshes: {}}, spheres: [], workspaces: []};
  const file = join(folder, 'feet.html');
  writeFileSync(file, fill(readFileSync(template, 'utf8'), {format: 'elastocal-report-1', folder: 'out', data, motions: [{name: 'm', rows: 3, columns}], calibrations: [], missing: []}));
  const {page, problems} = await openPage(browser, file);
  await waitForViewer(page);
  await page.focus('#posture');
  const hashes = [];
  for (let i = 0; i < 2; ++i) {
    await page.keyboard.press('ArrowRight');
    hashes.push((await picture(page)).hash);
  }
  assert.equal(hashes[0], hashes[1]);
  assert.deepEqual(problems, []);
  await page.close();
});

test('a project alone is drawn in its posture of rest, with markers and soles', async () => {
  const {data: {robot, spheres, workspaces}} = sampleReport();
  const link = robot.urdf.match(/<link name="([^"]+)"/)[1];
  const rest = robot.coordinates.map(() => 0);
  const marker = {name: 'M', link, position_m: [0.2, 0, 0.1]};
  const sole = {link, min_m: [-0.1, -0.1], max_m: [0.1, 0.1]};
  const pictures = [];
  for (const project of [{rest, markers: [], soles: []}, {rest, markers: [marker], soles: []}, {rest, markers: [marker], soles: [sole]}, {rest: rest.map(() => 0.4), markers: [marker], soles: [sole]}]) {
    const file = join(folder, `project${pictures.length}.html`);
    writeFileSync(file, fill(readFileSync(template, 'utf8'), {format: 'elastocal-report-1', folder: 'my_robot', data: {robot, chains: [], spheres, workspaces, project}, motions: [], calibrations: [], missing: []}));
    const {page, problems} = await openPage(browser, file);
    await waitForViewer(page);
    pictures.push(await picture(page));
    assert.ok((await page.textContent('#robot')).includes('correct it in the project file'));
    assert.equal(await page.isDisabled('.play'), true);
    assert.deepEqual(problems, []);
    await page.close();
  }
  assert.equal(new Set(pictures.map((p) => p.hash)).size, 4);
});
