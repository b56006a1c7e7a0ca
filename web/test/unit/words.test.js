// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {count, fixed, flatten, interval, list, plural, probability, significant, tick, withSd} from '../../src/lib/format.js';
import {typeset} from '../../src/lib/groups.js';
import {bestModel, judgedErrors, undetermined, verdict} from '../../src/lib/verdict.js';
import {wordsOn} from '../../src/sections/models.js';

const good = {
  status: 'converged', objections: [], remarks: [],
  rmse_3d_mm: {uncalibrated: 8, offsets_only: 4, geometric: 2, full: 0.25},
  kfold: {rmse_3d_mm: {uncalibrated: 8.1, geometric: 2.1, full: 0.3}},
  held_out_rmse_3d_mm: {uncalibrated: 8.5, geometric: 3, full: 0.354},
  parameters: [
    {name: 'a.theta', status: 'estimated'}, {name: 'b.alpha', status: 'unsupported'},
    {name: 'marker.M.x', status: 'unsupported'}, {name: 'c.d', status: 'dropped'},
  ],
};

test('numbers', () => {
  assert.equal(fixed(-1.005, 1), '−1.0');
  assert.equal(fixed(-0.0001, 2), '0.00');
  assert.equal(fixed(NaN), '–');
  assert.equal(fixed(null), '–');
  assert.equal(significant(0.0123456), '0.0123');
  assert.equal(significant(27826), '27\u202f800');
  assert.equal(significant(123.4), '123');
  assert.equal(count(1234567), '1\u202f234\u202f567');
  assert.equal(plural(1, 'posture'), '1 posture');
});

test('a standard deviation has two significant digits, the estimate the same decimals', () => {
  const of = (value, sd, decimals) => Object.values(withSd(value, sd, decimals));
  assert.deepEqual(of(1.23456, 0.0123), ['1.235', '0.012']);
  assert.deepEqual(of(-0.00004, 0.012), ['0.000', '0.012']);
  assert.deepEqual(of(-1.5, 0.5), ['−1.50', '0.50']);
  assert.deepEqual(of(0.5, 0.00001), ['0.500000', '0.000010']);
  assert.deepEqual(of(0.5, 0.0996), ['0.50', '0.10'], 'rounding carries into the next decimal');
  assert.deepEqual(of(57.4, 9.96), ['57', '10']);
  assert.deepEqual(of(1234.5, 123.4), ['1\u202f230', '120']);
  assert.deepEqual(of(-3, 123.4), ['0', '120']);
  assert.deepEqual(of(-27826, 2345), ['−27\u202f800', '2\u202f300']);
  assert.deepEqual(of(0.123456789123, 3.21e-12), ['0.12345679', '3.2·10⁻¹²']);
});

test('without a standard deviation the estimate has the decimals asked for', () => {
  const of = (value, sd, decimals) => Object.values(withSd(value, sd, decimals));
  assert.deepEqual(of(1.23456, 0, 3), ['1.235', '0']);
  assert.deepEqual(of(1.23456, NaN, 3), ['1.235', '–']);
  assert.deepEqual(of(1.23456, Infinity, 1), ['1.2', '–']);
  assert.deepEqual(of(1.23456, null), ['1.23', '–']);
  assert.deepEqual(of(NaN, 0.0123), ['–', '0.012']);
  assert.deepEqual(of(Infinity, 0.0123), ['–', '0.012']);
});

test('ends of an interval have the digits that their distance calls for', () => {
  assert.equal(interval(0.98765, 1.01234), '0.988 to 1.012');
  assert.equal(interval(25400.3, 30211.9), '25\u202f400 to 30\u202f200');
  assert.equal(interval(1234.5, Infinity), '1\u202f230 to ∞');
});

test('very small numbers', () => {
  assert.equal(significant(1e-9), '1.00·10⁻⁹');
  assert.equal(significant(-2.5e12, 2), '−2.5·10¹²');
  assert.equal(significant(0.0996, 2), '0.10');
  assert.equal(significant(9.996), '10.0');
  assert.equal(probability(3e-7), '< 0.0001');
  assert.equal(probability(0.0412), '0.041');
  assert.equal(probability(null), '–');
});

test('lists of names', () => {
  assert.equal(list([]), '');
  assert.equal(list(['a']), 'a');
  assert.equal(list(['a', 'b', 'c']), 'a, b and c');
  assert.equal(list(['a', 'b', 'c', 'd'], 2), 'a, b and 2 more');
});

test('margins of any layout become rows', () => {
  assert.deepEqual(flatten({zmp_m: 0.5, collision: {pair: 'a b', torque_share: 0.25}, sets: [1]}),
                   [['zmp', 500, 'mm'], ['collision, pair', 'a b', ''], ['collision, torque', 25, '%']]);
  assert.deepEqual(flatten(undefined), []);
});

test('the verdict stands on the most independent data there are', () => {
  assert.equal(judgedErrors(good).after, 0.354);
  assert.equal(judgedErrors({...good, held_out_rmse_3d_mm: undefined}).after, 0.3);
  assert.match(judgedErrors({...good, held_out_rmse_3d_mm: undefined, kfold: undefined}).on, /calibration postures themselves/);
  assert.equal(bestModel({rmse_3d_mm: {uncalibrated: 1, offsets_only: 1, geometric: 1}}), 'geometric');
});

test('a sound calibration is to be deployed, and what could not be identified is named', () => {
  const result = verdict(good);
  assert.equal(result.state, 'deploy');
  assert.equal(result.sentence, 'Calibrated from 8.50 to 0.35\u00a0mm on motions that took no part in the estimate.');
  assert.deepEqual(undetermined(good), ['b.alpha']);
  // The URDF has its value, so it is not at nominal.
  assert.equal(result.rest, 'The recording hardly tells b.alpha: this parameter has its most probable value.');
});

test('postures that were left out are of the same recording, which the verdict says', () => {
  const deployed = {judged_on: 'held-out postures', urdf: {rmse_3d_mm: 4, uncalibrated: 5, interval_95_mm: [3, 6]}, compensated: {rmse_3d_mm: 2, interval_95_mm: [1.5, 3]}};
  const result = verdict({...good, deployed});
  assert.match(result.rest, /^Another day and other postures may show more: validate on another recording\. The recording hardly/);
  assert.deepEqual([result.errors.interval, result.errors.compensatedInterval], [[3, 6], [1.5, 3]]);
  const validation = {status: 'better', own_recording: false, mistakes: [], rmse_3d_mm: {uncalibrated: 4, calibrated: 0.2, urdf: 0.5}};
  assert.match(verdict({...good, deployed}, validation).rest, /^The recording hardly/);
});

test('signs of the program are printed as such', () => {
  assert.equal(typeset('hysteresis of -7.1 +- 1.2 mrad (-3), by x-1 and --json'), 'hysteresis of −7.1 ± 1.2 mrad (−3), by x-1 and --json');
});

test('remarks ask for a look, objections forbid', () => {
  assert.equal(verdict({...good, remarks: ['look']}).state, 'check');
  const bad = verdict({...good, status: 'implausible', objections: ['the model does not explain the recording']});
  assert.equal(bad.state, 'reject');
  assert.equal(bad.word, 'Do not deploy');
  assert.match(bad.rest, /does not explain/);
  assert.equal(verdict({status: 'not converged', message: 'out of iterations'}).rest, 'out of iterations');
});

test('nothing is deployed by the fit alone, and what validate found on another recording counts', () => {
  const fit = {...good, held_out_rmse_3d_mm: undefined, kfold: undefined};
  assert.equal(verdict(fit).state, 'check');
  assert.equal(verdict(fit).word, 'Validate before deploying');
  const validation = {status: 'better', own_recording: false, mistakes: [], rmse_3d_mm: {uncalibrated: 4, calibrated: 0.2, urdf: 0.5}};
  const better = verdict(fit, validation);
  assert.equal(better.state, 'deploy');
  assert.equal(better.sentence, 'Calibrated from 4.00 to 0.50\u00a0mm on another recording.');
  assert.equal(better.errors.compensated, 0.2);
  assert.equal(verdict(fit, {...validation, own_recording: true}).state, 'check');
  assert.equal(verdict(fit, {...validation, mistakes: ['labels exchanged']}).state, 'check');
  assert.equal(verdict(good, {...validation, status: 'not better'}).state, 'reject');
  const all = {...validation, rmse_3d_mm_all: {uncalibrated: 6, calibrated: 0.9, urdf: 1.25}};
  assert.equal(verdict(fit, all).sentence, 'Calibrated from 6.00 to 1.25\u00a0mm on another recording.');
  assert.equal(verdict(good, validation).errors.on, 'on motions that took no part in the estimate');
});

test('a validation that could not judge all of its recording leaves no plain "Deploy"', () => {
  const validation = {status: 'better', own_recording: false, mistakes: [], not_judged: [], rmse_3d_mm: {uncalibrated: 4, calibrated: 0.2, urdf: 0.5}};
  assert.equal(verdict(good, validation).state, 'deploy');
  const lost = verdict(good, {...validation, not_judged: ['trial a cannot be used']});
  assert.equal(lost.state, 'check');
  assert.match(lost.rest, /did not judge all trials: trial a cannot be used\./);
  const wrong = verdict(good, {...validation, status: 'implausible', mistakes: ['elbow: its sign is reversed']});
  assert.equal(wrong.state, 'check');
  assert.match(wrong.rest, /elbow: its sign is reversed\./);
  assert.equal(verdict(good, {...validation, status: 'not converged'}).state, 'check');
});

test('figures are said to be without outliers where they are', () => {
  assert.match(wordsOn(['geometric']), /Those of the fit are without outliers, all others with them\./);
});

test('marks of an axis are written as the numbers of the tables', () => {
  assert.deepEqual([0, 1400, -50, -1.5, 0.1 + 0.2, 12345.25, null].map(tick), ['0', '1\u202f400', '−50', '−1.5', '0.3', '12\u202f345.25', '']);
});
