// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import {test} from 'node:test';

import {contactVerdict} from '../../src/sections/contact.js';

const figures = (height, tilt) => ({height_mm: height, tilt_deg: tilt, uncalibrated: {height_mm: 12.8, tilt_deg: 1.16}});
const good = {status: 'converged', objections: [], model: 'full', contact: {fit: figures(1.58, 0.15), kfold: figures(3.07, 0.274)}};

test('touches that were left out decide', () => {
  const verdict = contactVerdict(good);
  assert.equal(verdict.state, 'deploy');
  assert.match(verdict.sentence, /12\.80 to 3\.07\u00a0mm .* 1\.16 to 0\.27\u00a0degrees, on touches that were left out/);
  assert.match(verdict.rest, /compensates elasticity/);
});

test('without touches left out the result is to be validated', () => {
  assert.equal(contactVerdict({...good, contact: {fit: good.contact.fit}}).state, 'check');
});

test('objections reject', () => {
  const verdict = contactVerdict({...good, objections: ['no better than before']});
  assert.equal(verdict.state, 'reject');
  assert.equal(verdict.rest, 'no better than before');
});
