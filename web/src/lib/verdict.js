// SPDX-License-Identifier: Apache-2.0
import {fixed, list} from './format.js';
import {family} from './parameters.js';

/** The most complete model that was calibrated: full, or geometric. */
export function bestModel(summary) {
  const models = Object.keys(summary.rmse_3d_mm ?? {});
  return ['full', 'geometric', 'offsets_only'].find((model) => models.includes(model)) ?? 'geometric';
}

const JUDGED_ON = {
  'held-out trials': 'on motions that took no part in the estimate',
  'held-out postures': 'on held-out postures',
  'the fit': 'on the calibration postures themselves',
};

/** The errors (mm) that decide on the robot description (URDF): {before, after, compensated, on}, from the most independent data. */
export function judgedErrors(summary) {
  const urdf = summary.deployed?.urdf;
  if (typeof urdf?.rmse_3d_mm === 'number' && typeof urdf?.uncalibrated === 'number') {
    const on = JUDGED_ON[summary.deployed.judged_on] ?? JUDGED_ON['the fit'];
    const {compensated} = summary.deployed;
    return {before: urdf.uncalibrated, after: urdf.rmse_3d_mm, compensated: compensated?.rmse_3d_mm, on, best: urdf.model,
      interval: urdf.interval_95_mm, compensatedInterval: compensated?.interval_95_mm};
  }
  const best = bestModel(summary);
  const sources = [
    [summary.held_out_rmse_3d_mm, 'on motions that took no part in the estimate'],
    [summary.kfold?.rmse_3d_mm, 'on held-out postures'],
    [summary.rmse_3d_mm, 'on the calibration postures themselves'],
  ];
  for (const [figures, on] of sources) {
    if (typeof figures?.uncalibrated === 'number' && typeof figures?.[best] === 'number') {
      return {before: figures.uncalibrated, after: figures[best], on, best};
    }
  }
  return null;
}

/** Errors of a `validate` into the same folder, outliers included, if its recording is another one and sound. */
function onAnotherRecording(validation) {
  const figures = validation?.rmse_3d_mm_all ?? validation?.rmse_3d_mm;
  const after = figures?.urdf ?? figures?.calibrated;
  if (typeof figures?.uncalibrated !== 'number' || typeof after !== 'number') return null;
  if (validation.own_recording || validation.status === 'not converged' || (validation.mistakes ?? []).length > 0) return null;
  return {before: figures.uncalibrated, after, compensated: figures.calibrated, on: 'on another recording', better: validation.status === 'better', plausible: validation.status !== 'implausible'};
}

/** Why a `validate` into the same folder did not judge all of its recording; empty: it did. */
export function openOfValidation(validation) {
  const mistakes = validation?.mistakes ?? [];
  if (mistakes.length > 0) return `The recording of the validation has a mistake or contradicts the calibration: ${mistakes[0]}.`;
  const lost = validation?.not_judged ?? [];
  if (lost.length > 0) return `The validation did not judge all trials: ${lost[0]}.`;
  return validation?.status === 'not converged' ? 'The fit of the validation has not converged.' : '';
}

const deployable = (summary) => summary.status === 'converged' && (summary.objections ?? []).length === 0;

/** Joint and leg parameters that the recording could not determine, for the end of the verdict. */
export function undetermined(summary) {
  const legs = (summary.legs ?? []).map((leg) => leg.name);
  return (summary.parameters ?? []).filter((parameter) => parameter.status === 'unsupported' &&
    ['joint', 'leg'].includes(family(parameter, legs))).map((parameter) => parameter.name);
}

/**
 * The verdict as {state: 'deploy' | 'check' | 'reject', word, sentence, rest, errors}. The sentence has the
 * errors before and after, and their data. `rest` says what the recording hardly tells. `validation`: the
 * result of `validate` in the same folder, if there is one.
 */
export function verdict(summary, validation) {
  const own = judgedErrors(summary);
  const inFit = !own || own.on === JUDGED_ON['the fit'];
  const another = onAnotherRecording(validation);
  const errors = inFit && another ? another : own;
  const from = errors ? `from ${fixed(errors.before)} to ${fixed(errors.after)}\u00a0mm ${errors.on}` : '';
  if (!deployable(summary)) {
    const why = summary.objections?.[0] ?? summary.message ?? summary.status;
    return {state: 'reject', word: 'Do not deploy', sentence: from ? `The errors went ${from}, but the result must not be trusted.` : 'The result must not be trusted.', rest: why, errors};
  }
  if (another && !another.better) {
    return {state: 'reject', word: 'Do not deploy', sentence: `On another recording the errors went from ${fixed(another.before)} to ${fixed(another.after)}\u00a0mm.`,
      rest: another.plausible ? 'The calibration does not help there.' : 'That is more than an uncalibrated robot should have: recording, project and calibration do not belong together.', errors: another};
  }
  const open = undetermined(summary);
  const rest = open.length === 0
    ? 'The recording determines every identifiable parameter of the model.'
    : `The recording hardly tells ${list(open, 4)}: ${open.length === 1 ? 'this parameter has its most probable value' : 'these parameters have their most probable values'}.`;
  const openQuestion = openOfValidation(validation);
  if (openQuestion) {
    return {state: 'check', word: 'Look at the validation before deploying', sentence: errors ? `Calibrated ${from}.` : 'Calibrated.',
      rest: `${openQuestion} ${rest}`, errors};
  }
  if (inFit && !another) {
    return {state: 'check', word: 'Validate before deploying', sentence: errors ? `Calibrated ${from}.` : 'Calibrated.',
      rest: `Nothing shows yet how well it predicts what it was not estimated from: cross-validate (--kfold 10), and validate on another recording. ${rest}`, errors};
  }
  const sameRecording = errors?.on === JUDGED_ON['held-out postures'] && !another;
  const remarks = (summary.remarks ?? []).length > 0;
  return {
    state: remarks ? 'check' : 'deploy',
    word: remarks ? 'Deploy after a look at the remarks' : 'Deploy',
    sentence: errors ? `Calibrated ${from}.` : 'Calibrated.',
    rest: sameRecording ? `Another day and other postures may show more: validate on another recording. ${rest}` : rest,
    errors,
  };
}
