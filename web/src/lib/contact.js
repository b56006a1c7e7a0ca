// SPDX-License-Identifier: Apache-2.0
// Summary of the observations in a calibration without a tracker.
import {fixed, significant} from './format.js';

export const judged = (contact) => contact.kfold ?? contact.fit;
export const thing = (contact) => contact.touches > 0 ? 'touches' : 'observations';
export const where = (contact) => contact.kfold ? `on ${thing(contact)} that were left out` : `on the ${thing(contact)} of the fit`;

/** A clause with the errors before and after: of touches, or of the instrument that gained most. */
function errorClause(contact, place = where(contact)) {
  const after = judged(contact);
  const before = after.uncalibrated;
  if (contact.touches > 0) {
    return `The height of touches went from ${fixed(before.height_mm)} to ${fixed(after.height_mm)}\u00a0mm and their tilt from ${fixed(before.tilt_deg)} to ${fixed(after.tilt_deg)}\u00a0degrees, ${place}`;
  }
  const gains = instrumentErrors(contact).sort((a, b) => a.after / a.before - b.after / b.before);
  if (gains.length === 0) return 'The robot was calibrated';
  const [best] = gains;
  return `What ${best.name} shows (${best.what}) went from ${significant(best.before)} to ${significant(best.after)}\u00a0${best.unit}, ${place}`;
}

/** {state, word, sentence}: the verdict on the calibration by its observations. `validation`: the result of `validate` in the same folder, if there is one. */
export function contactVerdict(summary, validation) {
  const {contact} = summary;
  const confirmed = validation?.status === 'better' && validation.contact;
  const errors = !contact.kfold && confirmed ? errorClause({...contact, kfold: validation.contact}, 'on another recording') : errorClause(contact);
  if (summary.status !== 'converged' || summary.objections?.length) {
    return {state: 'reject', word: 'Do not deploy', sentence: `${errors}, but the result must not be trusted.`, rest: summary.objections?.[0] ?? summary.status};
  }
  const rest = contact.holds_with ? `These figures hold with ${contact.holds_with}.` : '';
  const refuted = validation?.objections ?? [];
  if (refuted.length > 0 || validation?.status === 'not better') {
    return {state: 'reject', word: 'Do not deploy', sentence: `${errors}, but another recording refutes the calibration.`, rest: refuted[0] ?? 'The calibration does not help there.'};
  }
  if (!contact.kfold && !confirmed) return {state: 'check', word: 'Validate first', sentence: `${errors}.`, rest};
  const remarks = summary.remarks ?? [];
  if (remarks.length > 0) return {state: 'check', word: 'Deploy after a look at the remarks', sentence: `${errors}.`, rest};
  return {state: 'deploy', word: 'Deploy', sentence: `${errors}.`, rest};
}

/** Errors by instrument before and after the calibration: [{name, kind, what, unit, observations, before, after}]. */
export function instrumentErrors(contact) {
  const after = judged(contact);
  const before = new Map((after.uncalibrated?.instruments ?? []).map((of) => [of.name, of]));
  return (after.instruments ?? []).flatMap(({name, kind, observations, ...rows}) => Object.entries(rows).map(([key, rms]) => {
    const [what, ...unit] = key.split('_');
    return {name, kind, what, unit: unit.join('_').replace('m_per_s2', 'm/s²'), observations, before: before.get(name)?.[key], after: rms};
  }));
}

/** Ranges of consecutive touches of every second session, for the bands behind a plot. */
export function sessionBands(touches) {
  const runs = [];
  touches.forEach((touch, i) => {
    if (i === 0 || touch.session !== touches[i - 1].session || touch.plate !== touches[i - 1].plate) runs.push([i + 0.5, i + 0.5]);
    runs.at(-1)[1] = i + 1.5;
  });
  return runs.filter((_, i) => i % 2 === 1);
}
