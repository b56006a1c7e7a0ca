// SPDX-License-Identifier: Apache-2.0
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure, section} from '../lib/figure.js';
import {fixed, list, modelName} from '../lib/format.js';
import {table} from '../lib/table.js';
import {inSampleRows, table2Rows} from '../lib/table2.js';

const PAPER = {full: 'FCM', geometric: 'GCM', uncalibrated: 'NCM'};

const MODEL_WORDS = {
  uncalibrated: '“uncalibrated” is the nominal robot', offsets_only: '“offsets only” corrects the joint offsets',
  geometric: '“geometric” corrects all geometric errors', full: '“full” also models elasticity',
  rigid: '“rigid” is the geometry of “full” without its springs, as a URDF can carry it',
};

/** Explains the cells of the tables and the models in their columns. */
export function wordsOn(models) {
  const paper = list(models.filter((m) => PAPER[m]).map((m) => `the ${modelName(m)} model ${PAPER[m]}`));
  return 'Each cell has the root mean square (RMSE) of the distances between measured and predicted markers and, small and grey, the largest of them. Those of the fit are without outliers, all others with them. ' +
    `Model ${list(models.filter((m) => MODEL_WORDS[m]).map((m) => MODEL_WORDS[m]))}.${paper ? ` The paper calls ${paper}.` : ''}`;
}

function build({title, what = 'Motion', words}, rows, models) {
  const columns = [{text: 'Chain'}, {text: what}, ...models.map((m) => ({text: modelName(m), unit: 'mm', number: true}))];
  const cells = rows.map((row) => {
    const least = Math.min(...row.rmse.filter((x) => typeof x === 'number'));
    const pair = (x, i) => [x === least ? h('strong', {}, fixed(x)) : fixed(x),
      h('span', {class: 'largest'}, typeof row.max[i] === 'number' ? fixed(row.max[i], 1) : '')];
    return {class: row.total ? 'total' : '', cells: [row.chain, row.motion, ...row.rmse.map(pair)]};
  });
  return figure({
    title, body: table({caption: title, columns, rows: cells, className: 'wide-first-two'}),
    note: words || 'The cells are as in the table above.',
    data: {name: 'models_by_motion.csv', text: () => toCsv(
      ['chain', 'motion', ...models.map((m) => `rmse_3d_${m}_mm`), ...models.map((m) => `max_${m}_mm`)],
      rows.map((row) => [row.chain, row.motion, ...row.rmse, ...row.max]))},
  });
}

/** Table 2 of the paper: models by motions. */
export function modelsSection(report) {
  const {summary, data, validation} = report;
  if (!summary) return null;
  const models = Object.keys(summary.rmse_3d_mm ?? {});
  const errors = data?.error_table;
  const heldOut = (errors?.rows ?? []).length > 0;
  const parts = [];
  if (heldOut) parts.push(build({title: 'On motions that took no part in the estimate', words: wordsOn(models)}, table2Rows(errors, models), models));
  parts.push(build({title: 'On the calibration postures', what: 'Postures', words: heldOut ? '' : wordsOn(models)}, inSampleRows(summary, models), models));
  if (validation) parts.push(validationTable(validation));
  return section('models', 'Models', 'How well each model predicts the markers',
    `The tables show how far the markers were from where each model predicts them${heldOut ? ', first on trials that took no part in the estimate' : ''}.`, ...parts);
}

function validationTable(validation) {
  const models = Object.keys(validation.rmse_3d_mm ?? {});
  const figures = [['RMSE of the distances', 'rmse_3d_mm'], ['RMSE of single coordinates', 'rmse_coordinate_mm'],
                   ['Largest distance', 'max_mm'], ['RMSE of the distances, with outliers', 'rmse_3d_mm_all']];
  return figure({
    title: 'On another recording',
    note: [`Recording: ${validation.recording}.`, validation.frozen
      ? 'Nothing was fitted to it: the waist and the markers are as in the calibration.'
      : 'The poses of the waist and the positions of the markers were fitted to it; the joints stayed as calibrated.',
      ...(validation.own_recording ? ['The calibration was made from this recording: it says nothing of another day.'] : []),
      ...(validation.predicted_mm !== undefined ? [`The calibration predicted ${fixed(validation.predicted_mm)} mm${validation.frozen ? '' : ' of the URDF'}.`] : []),
      ...(validation.mistakes ?? []).map((mistake) => `The recording is wrong: ${mistake}.`),
      ...(validation.status === 'implausible' ? [`A robot that was never calibrated should err by some ${fixed(validation.expected_error_mm)} mm: recording, project and calibration do not belong together.`] : []),
    ].join(' '),
    body: table({caption: 'Validation on another recording',
      columns: [{text: 'Error'}, ...models.map((m) => ({text: modelName(m), unit: 'mm', number: true}))],
      rows: figures.map(([text, key]) => [text, ...models.map((m) => fixed(validation[key]?.[m]))])}),
    data: {name: 'validation.csv', text: () => toCsv(['figure', ...models],
      figures.map(([, key]) => [key, ...models.map((m) => validation[key]?.[m])]))},
  });
}
