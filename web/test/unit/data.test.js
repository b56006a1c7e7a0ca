// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {differences, floats, signedBytes, unpackTriangle} from '../../src/lib/binary.js';
import {diverging, sequential} from '../../src/lib/colours.js';
import {columnsToCsv, toCsv} from '../../src/lib/csv.js';
import {chainRows, medianCurves} from '../../src/lib/curves.js';
import {byJoint, countByStatus, family, kindsOf, offsetsOverTime, splitName, strongestPairs} from '../../src/lib/parameters.js';
import {pictureAt, playedRobots, readPlayback} from '../../src/lib/playback.js';
import {table2Rows} from '../../src/lib/table2.js';
import {stiffness, stiffnessInterval, userUnit} from '../../src/lib/units.js';
import {advance, feet} from '../../src/viewer/clips.js';
import {sampleReport} from '../sample.js';

test('floats are little-endian and keep NaN', () => {
  assert.deepEqual([...floats('AACAPwAAAMA=')], [1, -2]);
  assert.ok(Number.isNaN(floats('AADAfw==')[0]));
  assert.deepEqual([...signedBytes('ZM5k')], [100, -50, 100]);
});

test('displacements come as differences in a byte, large ones as themselves', () => {
  const bytes = Uint8Array.from([5, 0x80, 0xb0, 0x3c, 0xff, 0xff, 0xff, 3]);  // 5, -50000; -1 and 3 more
  assert.deepEqual([...differences(bytes, 2, 2)], [5, -50000, 4, -49997]);
});

test('a playback has each robot where it was, and leaves a fallen one where it lay', async () => {
  const playback = await readPlayback(sampleReport().deployment.playback);
  const [fallen, stood] = playback.robots;
  assert.equal(playback.times.length, 40);
  assert.ok(Math.abs(stood.displacement(39, 6)[0] - 1.5e-3) < 1e-12);
  assert.ok(Math.abs(stood.displacement(39, 6)[5] - 6e-4) < 1e-12);
  assert.deepEqual(fallen.displacement(39, 2), fallen.displacement(24, 2));
  assert.ok(Math.abs(fallen.distance(39, 'hand') - 14.4) < 1e-9);
  assert.equal(stood.distance(3, 'foot'), null, 'it stands');
  assert.equal(stood.distance(20, 'foot'), 0.75);
  assert.equal(stood.factor(5, 10), 10);
  assert.ok(Math.abs(fallen.factor(5, 50) - 0.35 / 12e-3) < 1e-9, 'no further than 0.35 m');
  assert.equal(pictureAt(playback.times, 0), 0);
  assert.equal(pictureAt(playback.times, 1.05), 4);
  assert.equal(pictureAt(playback.times, 99), 39);
  assert.deepEqual(playedRobots(undefined), []);
  assert.ok(Math.abs(playback.posture(3)[1] - 1e-4 * Math.round(120 * Math.sin(0.08 + 1))) < 1e-12);
});

test('a triangle of correlations becomes a symmetric matrix', () => {
  const matrix = unpackTriangle(Int8Array.from([100, -50, 100]), 2);
  assert.equal(matrix[0][1], -0.5);
  assert.equal(matrix[1][0], -0.5);
  assert.equal(matrix[1][1], 1);
});

test('the strongest pairs are of the joints, and of waist and markers only on request', () => {
  const pairs = [['marker.A.x', 'marker.B.x'], ['leg_6.r', 'marker.A.x'], ['waist.T0.z', 'leg_1.d'], ['leg_1.d', 'leg_2.d']].map(([first, second]) => ({first, second, coefficient: 1}));
  assert.deepEqual(strongestPairs(pairs, false), pairs.slice(3));
  assert.deepEqual(strongestPairs(pairs, true), pairs);
  assert.deepEqual(strongestPairs(pairs, true, 2), pairs.slice(0, 2));
});

test('CSV quotes, keeps gaps, and hands no formula to a spreadsheet', () => {
  assert.equal(toCsv(['a', 'b'], [['x,"y"', null], ['=1+1', NaN], [-1.5, 'p']]), 'a,b\n"x,""y""",\n\'=1+1,\n-1.5,p\n');
  assert.equal(columnsToCsv(['t', 'x'], [[0, 1], [2, null]]), 't,x\n0,2\n1,\n');
});

test('parameters are told apart by their names', () => {
  assert.deepEqual(splitName('a.b_joint.theta'), {owner: 'a.b_joint', kind: 'theta'});
  const of = (name) => family({name}, ['leg']);
  assert.equal(of('marker.M.x'), 'marker');
  assert.equal(of('waist.T0.r'), 'waist');
  assert.equal(of('leg.compliance_x'), 'leg');
  assert.equal(of('leg_1.compliance_x'), 'joint');
});

test('Table 1 has a row a joint and the columns that occur, in order', () => {
  const parameters = [{name: 'b.compliance_z', status: 'estimated'}, {name: 'a.r', status: 'held'}, {name: 'a.theta', status: 'estimated'}, {name: 'marker.M.x', status: 'estimated'}];
  const joints = byJoint(parameters, []);
  assert.deepEqual([...joints.keys()], ['b', 'a']);
  assert.deepEqual(kindsOf(joints).map((k) => k.kind), ['theta', 'r', 'compliance_z']);
  assert.deepEqual(countByStatus(parameters, []), {estimated: 2, held: 1});
});

test('units', () => {
  assert.equal(Math.PI * userUnit('rad').factor, 180);
  assert.deepEqual(stiffness({unit: 'm/N', value: 5e-6, sd: 2.5e-6}), {value: 200, sd: 100, unit: 'N/mm'});
  assert.equal(stiffness({unit: 'm/N', value: 5e-6, sd: null}).sd, null);
  const rigid = {unit: 'rad/(N.m)', value: 1e-5, sd: 1e-5};
  const [low, high] = stiffnessInterval(rigid);
  assert.ok(Math.abs(low - 1e5 / 2.96) < 1e-6);
  assert.equal(high, Infinity, 'the interval has no compliance at all in it');
  assert.equal(stiffness({unit: 'rad/(N.m)', value: 0}), null);
});

test('Table 2 has motions, then chains, then the mean', () => {
  const row = (chain, value) => ({chain, case: 'SW', rmse_3d_mm: {full: value}, max_mm: {full: 2 * value}});
  const errors = {rows: [row('a+b_c', 1), row('d', 3), {...row('d', 5), case: 'RP'}], chains: [row('a+b_c', 1), row('d', 4)], mean_rmse_3d_mm: {full: 3}};
  const rows = table2Rows(errors, ['full']);
  assert.deepEqual(rows.map((r) => r.chain), ['a + b c', 'd', 'd', 'a + b c', 'd', 'Mean']);
  assert.deepEqual(rows.map((r) => r.rmse[0]), [1, 3, 5, 1, 4, 3]);
  assert.equal(rows[2].motion, 'random postures');
});

test('curves are medians over seeds, with gaps where an algorithm has none', () => {
  const columns = {algorithm: ['A', 'A', 'A', 'B', 'A'], chain: ['leg', 'leg', 'leg', 'leg', 'arm'], postures: [4, 4, 4, 8, 4], o1: [1, 3, 2, 9, 100]};
  const {postures, curves} = medianCurves(columns, 'leg');
  assert.deepEqual(postures, [4, 8]);
  assert.deepEqual(curves, [{algorithm: 'A', o1: [2, null]}, {algorithm: 'B', o1: [null, 9]}]);
  assert.deepEqual(chainRows({leg: {o1: 1}, seed: 3}), [{chain: 'leg', o1: 1}]);
  assert.deepEqual(chainRows({chains: [{chain: 'leg', index: 2}]}), [{chain: 'leg', index: 2, o1: 2}]);
});

test('offsets of several calibrations stand side by side in degrees', () => {
  const p = (name, value, status = 'estimated') => ({name, unit: 'rad', value, sd: 0.01, status});
  const rows = offsetsOverTime([{parameters: [p('a.theta', Math.PI / 180), p('b.theta', 0, 'dropped')]}, {parameters: [p('b.theta', 0)]}]);
  assert.deepEqual(rows.map((r) => r.joint), ['a', 'b']);
  assert.ok(Math.abs(rows[0].of[0].value - 1) < 1e-12);
  assert.equal(rows[0].of[1], null);
});

test('playing goes with the recording’s time, passes gaps quickly and begins anew at the end', () => {
  const motion = {moving: true, count: 3, time: [0, 0.1, 60]};
  assert.equal(advance(motion, 0, 0.1), 1);
  assert.equal(advance(motion, 1, 0.5), 2);
  assert.ok(advance({moving: false, count: 3, time: []}, 2.9, 1) < 2.9);
});

test('the feet of a planned motion', () => {
  assert.deepEqual(feet('a+b', []), ['a', 'b']);
  assert.deepEqual(feet('both', ['l', 'r']), ['l', 'r']);
  assert.deepEqual(feet(undefined, ['l']), ['l']);
  assert.deepEqual(feet('none', ['l']), []);
});

test('colours run evenly from one end to the other', () => {
  assert.notDeepEqual(sequential(0), sequential(1));
  assert.deepEqual(sequential(2), sequential(1));
  assert.deepEqual(diverging(0, false), [247, 247, 245]);
});
