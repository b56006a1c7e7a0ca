import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure, section} from '../lib/figure.js';
import {fixed, modelName} from '../lib/format.js';
import {table} from '../lib/table.js';
import {inSampleRows, table2Rows} from '../lib/table2.js';

const PAPER = {full: 'FCM', geometric: 'GCM', uncalibrated: 'NCM'};

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
  parts.push(build('On the calibration postures', inSampleRows(summary, models), models));
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
