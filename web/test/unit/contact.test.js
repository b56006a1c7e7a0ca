// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {contactVerdict, instrumentErrors, sessionBands} from '../../src/lib/contact.js';

const figures = (height, tilt) => ({height_mm: height, tilt_deg: tilt, uncalibrated: {height_mm: 12.8, tilt_deg: 1.16}});
const good = {status: 'converged', objections: [], model: 'full', contact: {touches: 50, fit: figures(1.58, 0.15), kfold: figures(3.07, 0.274), holds_with: 'compensation of elasticity and of hip.hysteresis, which no export applies'}};

test('touches that were left out decide', () => {
  const verdict = contactVerdict(good);
  assert.equal(verdict.state, 'deploy');
  assert.match(verdict.sentence, /12\.80 to 3\.07\u00a0mm .* 1\.16 to 0\.27\u00a0degrees, on touches that were left out/);
  assert.equal(verdict.rest, 'These figures hold with compensation of elasticity and of hip.hysteresis, which no export applies.');
});

test('without touches left out the result is to be validated', () => {
  assert.equal(contactVerdict({...good, contact: {touches: 50, fit: good.contact.fit}}).state, 'check');
});

test('objections reject', () => {
  const verdict = contactVerdict({...good, objections: ['no better than before']});
  assert.equal(verdict.state, 'reject');
  assert.equal(verdict.rest, 'no better than before');
});

test('what the validation and the remarks say counts', () => {
  assert.equal(contactVerdict(good, {status: 'better', objections: []}).state, 'deploy');
  assert.equal(contactVerdict({...good, remarks: ['look']}).state, 'check');
  const refuted = contactVerdict(good, {status: 'not better', objections: ['calibrated is no better than uncalibrated']});
  assert.equal(refuted.state, 'reject');
  assert.equal(refuted.rest, 'calibrated is no better than uncalibrated');
  const fit = {...good, contact: {touches: 50, fit: good.contact.fit}};
  const confirmed = contactVerdict(fit, {status: 'better', objections: [], contact: {...figures(2.5, 0.2), touches: 20}});
  assert.equal(confirmed.state, 'deploy');
  assert.match(confirmed.sentence, /12\.80 to 2\.50\u00a0mm .* on another recording\.$/);
});

const measured = {touches: 0, kfold: {
  instruments: [{name: 'imu', kind: 'inertial_unit', observations: 40, acceleration_m_per_s2: 0.03}, {name: 'hand', kind: 'pose', observations: 20, position_mm: 0.6, rotation_deg: 0.2}],
  uncalibrated: {instruments: [{name: 'imu', acceleration_m_per_s2: 0.06}, {name: 'hand', position_mm: 6, rotation_deg: 1}]}}};

test('errors of instruments stand beside those before', () => {
  assert.deepEqual(instrumentErrors(measured), [
    {name: 'imu', kind: 'inertial_unit', what: 'acceleration', unit: 'm/s²', observations: 40, before: 0.06, after: 0.03},
    {name: 'hand', kind: 'pose', what: 'position', unit: 'mm', observations: 20, before: 6, after: 0.6},
    {name: 'hand', kind: 'pose', what: 'rotation', unit: 'deg', observations: 20, before: 1, after: 0.2}]);
});

test('without touches the verdict says what gained most', () => {
  const {sentence} = contactVerdict({...good, contact: measured});
  assert.equal(sentence, 'What hand shows (position) went from 6.00 to 0.600\u00a0mm, on observations that were left out.');
});

test('every second session has a band, also a plate in the same session', () => {
  const touch = (plate, session) => ({plate, session});
  assert.deepEqual(sessionBands([touch('l', 'a'), touch('l', 'a'), touch('l', 'b'), touch('r', 'b'), touch('r', 'c')]), [[2.5, 3.5], [4.5, 5.5]]);
  assert.deepEqual(sessionBands([]), []);
});
