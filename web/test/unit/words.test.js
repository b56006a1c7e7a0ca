import assert from 'node:assert/strict';
import {test} from 'node:test';

import {count, fixed, flatten, list, plural, significant} from '../../src/lib/format.js';
import {bestModel, judgedErrors, undetermined, verdict} from '../../src/lib/verdict.js';

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
  assert.match(result.rest, /b\.alpha/);
});

test('remarks ask for a look, objections forbid', () => {
  assert.equal(verdict({...good, remarks: ['look']}).state, 'check');
  const bad = verdict({...good, status: 'implausible', objections: ['the model does not explain the recording']});
  assert.equal(bad.state, 'reject');
  assert.equal(bad.word, 'Do not deploy');
  assert.match(bad.rest, /does not explain/);
  assert.equal(verdict({status: 'not converged', message: 'out of iterations'}).rest, 'out of iterations');
});
