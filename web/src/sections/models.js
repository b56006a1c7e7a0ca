import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure, section} from '../lib/figure.js';
import {fixed, kindName, modelName} from '../lib/format.js';
import {table} from '../lib/table.js';

const CASES = {SW: 'sine', RP: 'random', RM: 'repeatability'};
const PAPER = {full: 'FCM', geometric: 'GCM', uncalibrated: 'NCM'};
const readable = (chain) => chain.replaceAll('+', ' + ').replaceAll('_', ' ');

/** Rows of Table 2: by chain and motion, then the chains as a whole and the mean. */
export function table2Rows(errors, models) {
  const values = (row, figure) => models.map((model) => row[figure]?.[model]);
  const row = (chain, motion, item) => ({chain, motion, rmse: values(item, 'rmse_3d_mm'), max: values(item, 'max_mm')});
  const rows = (errors.rows ?? []).map((item) =>
    row(readable(item.chain), kindName(CASES[item.case] ?? item.case), item));
  if ((errors.rows ?? []).length > (errors.chains ?? []).length) {
    rows.push(...errors.chains.map((item) => ({...row(readable(item.chain), 'all motions', item), total: true})));
  }
  rows.push({chain: 'Mean', motion: '', rmse: models.map((m) => errors.mean_rmse_3d_mm?.[m]), max: models.map(() => undefined), total: true});
  return rows;
}

/** Recordings without trials for validation: in sample, and held-out folds. */
function inSampleRows(summary, models) {
  const row = (chain, motion, item) => ({chain, motion, rmse: models.map((m) => item.rmse_3d_mm?.[m]), max: models.map((m) => item.max_mm?.[m])});
  const rows = [row('All chains', 'calibration postures, in sample', summary)];
  if (summary.kfold) rows.push(row('All chains', `held out, ${summary.kfold.folds} folds`, summary.kfold));
  return rows;
}

function build(title, rows, models) {
  const columns = [{text: 'Chain'}, {text: 'Motion'}, ...models.map((m) => ({text: modelName(m), unit: 'mm', number: true}))];
  const cells = rows.map((row) => {
    const least = Math.min(...row.rmse.filter((x) => typeof x === 'number'));
    const pair = (x, i) => [x === least ? h('strong', {}, fixed(x)) : fixed(x),
      h('span', {class: 'largest'}, typeof row.max[i] === 'number' ? fixed(row.max[i], 1) : '')];
    return {class: row.total ? 'total' : '', cells: [row.chain, row.motion, ...row.rmse.map(pair)]};
  });
  const paper = models.filter((m) => PAPER[m]).map((m) => `${modelName(m)} ${PAPER[m]}`).join(', ');
  return figure({
    title, body: table({caption: title, columns, rows: cells, className: 'wide-first-two'}),
    note: `RMSE of the distance between measured and predicted marker, outliers aside; small and grey: the largest. In the paper: ${paper}.`,
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
  if (heldOut) parts.push(build('On motions that took no part in the estimate', table2Rows(errors, models), models));
  if (!heldOut || summary.kfold) parts.push(build('On the calibration postures', inSampleRows(summary, models), models));
  if (validation) parts.push(validationTable(validation));
  return section('models', 'Models', 'Models against motions',
    heldOut ? 'How far each model’s prediction is from the markers, on trials that took no part in the estimate.'
            : 'How far each model’s prediction is from the markers.', ...parts);
}

function validationTable(validation) {
  const models = Object.keys(validation.rmse_3d_mm ?? {});
  const figures = [['RMSE of distances', 'rmse_3d_mm'], ['RMSE of coordinates', 'rmse_coordinate_mm'],
                   ['largest', 'max_mm'], ['RMSE with outliers', 'rmse_3d_mm_with_outliers']];
  return figure({
    title: 'On another recording',
    note: `${validation.recording}: waist and markers fitted anew, joints as calibrated.`,
    body: table({caption: 'Validation on another recording',
      columns: [{text: 'Figure'}, ...models.map((m) => ({text: modelName(m), unit: 'mm', number: true}))],
      rows: figures.map(([text, key]) => [text, ...models.map((m) => fixed(validation[key]?.[m]))])}),
    data: {name: 'validation.csv', text: () => toCsv(['figure', ...models],
      figures.map(([, key]) => [key, ...models.map((m) => validation[key]?.[m])]))},
  });
}
