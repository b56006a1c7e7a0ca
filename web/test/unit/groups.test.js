// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {groupTexts, knownNames, othersOf, sentence, spoken} from '../../src/lib/groups.js';
import {outlierRows} from '../../src/lib/outliers.js';

const moves = (joint, carried) => `the correction of ${joint} also moves what ${carried} carries, of which this recording shows nothing: it may belong to the recorded branch alone`;

test('nine equal warnings are one, with the names of the others', () => {
  const texts = Array.from({length: 9}, (_, i) => `joint "arm_${i + 1}_joint" is at 1.${i} rad, 0.5 degrees beyond its limit of 1 rad`);
  const groups = groupTexts(texts);
  assert.equal(groups.length, 1);
  assert.equal(groups[0].text, texts[0]);
  assert.deepEqual(groups[0].all, texts);
  assert.equal(groups[0].names.length, 8);
  assert.equal(othersOf(groups[0]), 'The same is true of "arm_2_joint", "arm_3_joint", "arm_4_joint", "arm_5_joint", "arm_6_joint", "arm_7_joint", "arm_8_joint" and "arm_9_joint".');
});

test('what differs is named, and nothing that is the same', () => {
  const [group] = groupTexts([moves('torso_2_joint', 'head_1_joint'), moves('torso_2_joint', 'leg_1_joint')]);
  assert.equal(othersOf(group), 'The same is true of leg_1_joint.');
  const [both] = groupTexts(['trial leg: LFOO was lost for 12 % of the time', 'trial arm: LHAN was lost for 30 % of the time'], ['leg', 'arm', 'LFOO', 'LHAN']);
  assert.equal(othersOf(both), 'The same is true of arm / LHAN.');
});

test('lists of names of any length are one place', () => {
  const axes = (names, mm) => `the axes of ${names} no longer meet in a point (${mm} mm apart)`;
  const groups = groupTexts([axes('a_1, a_2, a_3', 1.9), axes('b_1, b_2', 0.3), axes('c_1, c_2', 2)]);
  assert.equal(groups.length, 1);
  assert.equal(othersOf(groups[0]), 'The same is true of b_1, b_2; c_1, c_2.');
});

test('different sentences stay apart, in the order in which they came', () => {
  const texts = ['noise is large', 'joint a_1 moved', 'the base is loose', 'joint a_2 moved'];
  assert.deepEqual(groupTexts(texts).map((group) => group.all.length), [1, 2, 1]);
  assert.deepEqual(groupTexts(texts).map((group) => group.text), texts.slice(0, 3));
  assert.equal(groupTexts(['joint hip moved', 'joint knee moved']).length, 2, 'no names are known');
  assert.equal(groupTexts(['joint hip moved', 'joint knee moved'], ['hip', 'knee']).length, 1);
  assert.deepEqual(groupTexts([]), []);
});

test('the same text twice is said once; where only numbers differ, they are counted', () => {
  const [twice] = groupTexts(['a b', 'a b']);
  assert.equal(othersOf(twice), '');
  const [frames] = groupTexts(['labels exchanged from 1.5 s to 2 s', 'labels exchanged from 3 s to 4.25 s', 'labels exchanged from 5 s to 6 s']);
  assert.deepEqual(frames.names, []);
  assert.equal(othersOf(frames), 'The same was found 2 times more.');
});

test('names may hold signs of patterns and of HTML', () => {
  const names = ['a(1', '<script>alert(1)</script>', '.*'];
  assert.equal(groupTexts(names.map((name) => `marker ${name}: was it lost?`), names).length, 1);
});

test('texts become sentences, names keep their letters', () => {
  assert.equal(sentence('the axes no longer meet'), 'The axes no longer meet.');
  assert.equal(sentence('was it lost?'), 'Was it lost?');
  assert.equal(sentence('leg: lost', ['leg']), 'leg: lost.');
  assert.equal(sentence('arm_1 moved'), 'arm_1 moved.');
});

test('what stands elsewhere on the page is no warning again', () => {
  const summary = {objections: ['o'], remarks: ['r', 'o'], warnings: ['r', 't', 'w', 'o'], trials: [{name: 'x', findings: ['t']}, {name: 'y'}]};
  assert.deepEqual(spoken(summary), {objections: ['o'], remarks: ['r'], warnings: ['w']});
  assert.deepEqual(spoken({}), {objections: [], remarks: [], warnings: []});
  const names = knownNames({summary: {...summary, parameters: [{name: 'hip.theta'}, {name: 'marker.M.x'}]}, data: {clusters: [{name: 'HAND'}]}});
  assert.deepEqual(names.sort(), ['HAND', 'M', 'hip', 'x', 'y']);
  assert.deepEqual(knownNames({}), []);
});

test('outliers of one marker in one trial are one row, and so are markers in the same postures', () => {
  const outlier = (posture, marker, residual_mm) => ({posture, marker, residual_mm, normalised: residual_mm / 2});
  const place = ({posture}) => ({trial: posture < 10 ? 'leg' : 'arm', posture: String(posture % 10 + 1)});
  const rows = outlierRows([outlier(0, 'M', 4), outlier(3, 'M', 8), outlier(12, 'M', 20), outlier(3, 'N', 2), outlier(12, 'N', 22), outlier(3, 'O', 3)], place);
  assert.deepEqual(rows, [
    {trial: 'arm', markers: ['M', 'N'], postures: ['3'], count: 2, residual_mm: 22, normalised: 11},
    {trial: 'leg', markers: ['M'], postures: ['1', '4'], count: 2, residual_mm: 8, normalised: 4},
    {trial: 'leg', markers: ['N', 'O'], postures: ['4'], count: 2, residual_mm: 3, normalised: 1.5},
  ]);
});
