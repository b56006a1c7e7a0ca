// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {batchRows, fleetVerdict, robotRows} from '../../src/lib/fleet.js';
import {sampleFleet} from '../sample_fleet.js';
import {EVIL} from '../sample_robot.js';

test('a robot is judged by its last session, and the urgent ones stand first', () => {
  const rows = robotRows(sampleFleet());
  assert.equal(rows.length, 12);
  assert.deepEqual(rows.slice(0, 4).map((r) => r.robot), ['talos_12', EVIL, 'talos_7', 'talos_2']);
  assert.deepEqual(rows.slice(0, 4).map((r) => r.verdict), ['failed', 'refused', 'fine', 'fine']);
  const [, , seven, two] = rows;
  assert.equal(seven.workshop, true);
  assert.deepEqual(seven.out, ['arm_3_joint.theta']);
  assert.equal(two.last.name, 'talos_2_3', 'day 90, though day 40 stands behind it');
  assert.equal(two.urdf, 1.1);
  assert.equal(two.sessions, 3);
  assert.deepEqual(two.drifts, ['arm_1_joint.theta']);
  assert.deepEqual(rows.slice(4).map((r) => r.urdf.toFixed(2)), ['0.79', '0.78', '0.77', '0.75', '0.74', '0.73', '0.72', '0.70']);
});

test('sessions without a day count in their order', () => {
  const sessions = ['first', 'second'].map((name) => ({name, robot: 'r', batch: '', day: null, exit_code: 0, urdf_mm: 1}));
  assert.equal(robotRows({sessions, fleet: {}})[0].last.name, 'second');
});

test('batches count their robots', () => {
  const rows = batchRows(robotRows(sampleFleet()));
  assert.deepEqual(rows.map((r) => [r.batch, r.robots, r.fine, r.workshop]), [['A', 6, 5, 0], ['B', 6, 5, 1]]);
  assert.equal(rows[0].urdf.toFixed(2), '0.73');
});

test('a fleet is as good as its worst robot', () => {
  const rows = robotRows(sampleFleet());
  assert.deepEqual(fleetVerdict(rows), {state: 'reject', fine: 10, refused: 1, failed: 1, workshop: 1});
  assert.equal(fleetVerdict(rows.slice(2)).state, 'check');
  assert.equal(fleetVerdict(rows.slice(4)).state, 'deploy');
});
