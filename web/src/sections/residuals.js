// SPDX-License-Identifier: Apache-2.0
import {columnsToCsv, toCsv} from '../lib/csv.js';
import {MODEL_COLOURS} from '../lib/colours.js';
import {h} from '../lib/dom.js';
import {choice, figure, section} from '../lib/figure.js';
import {fixed, modelName} from '../lib/format.js';
import {legend} from '../lib/legend.js';
import {plot} from '../lib/plot.js';

const firstAndLast = (models) => models.length > 1 ? [models[0], models.at(-1)] : models;

/** Histogram: shares of the observations in bins of equal width, before and after. */
function histogram(distribution, models) {
  const {edges_mm: edges, counts} = distribution;
  const total = (model) => counts[model].reduce((sum, n) => sum + n, 0) || 1;
  const shares = models.map((model) => [...counts[model].map((n) => 100 * n / total(model)), 0]);
  return plot({
    label: `Distribution of residuals, ${distribution.name}`,
    x: {label: 'residual [mm]', short: 'mm'},
    y: {label: 'share of sightings [%]', range: (u, min, max) => [0, max * 1.05]},
    series: models.map((m) => ({text: modelName(m), colour: MODEL_COLOURS[m], steps: true, fill: `${MODEL_COLOURS[m]}30`})),
    data: [edges, ...shares],
    height: 240,
  });
}

function distributionFigure(data, models) {
  const sets = data.distributions.filter((d) => Object.values(d.counts).some((c) => c.some((n) => n > 0)));
  if (sets.length === 0) return null;
  let chosen = sets.length - 1;
  const holder = h('div', {class: 'hold-plot'}, histogram(sets[chosen], models));
  const chooser = sets.length > 1 && choice('Data', sets.map((d, i) => ({value: String(i), text: d.name.replaceAll('+', ' + ').replaceAll('_', ' ')})), String(chosen),
    (i) => { chosen = Number(i); holder.replaceChildren(histogram(sets[chosen], models)); });
  return figure({
    title: 'Distribution of residuals, before and after', body: [chooser, holder],
    note: 'The last bin also has all residuals beyond it.',
    data: {name: 'residual_distribution.csv', text: () => {
      const {edges_mm: edges, counts} = sets[chosen];
      return toCsv(['from_mm', 'to_mm', ...models], counts[models[0]].map((_, i) => [edges[i], edges[i + 1], ...models.map((m) => counts[m][i])]));
    }},
  });
}

/** A row for each marker or cluster, from its RMSE before to its RMSE after, on a common scale. */
export function dumbbells(rows, models, unit) {
  const end = Math.max(1e-9, ...rows.flatMap((row) => models.map((m) => row.values[m] ?? 0)));
  const position = (value) => `${100 * value / end}%`;
  const line = (row) => {
    const [a, b] = models.map((m) => row.values[m]);
    return h('li', {}, h('span', {class: 'name'}, row.name),
      h('span', {class: 'track', 'aria-hidden': 'true'},
        h('i', {class: 'bar', style: {left: position(Math.min(a, b)), width: position(Math.abs(a - b))}}),
        models.map((m) => h('i', {class: 'dot', style: {left: position(row.values[m]), background: MODEL_COLOURS[m]}}))),
      h('span', {class: 'figures'}, `${fixed(a)} → `, h('strong', {}, fixed(b)), h('span', {class: 'unit'}, ` ${unit}`)));
  };
  return h('div', {}, legend(models.map((m) => ({text: modelName(m), colour: MODEL_COLOURS[m], shape: 'dot'}))),
           h('ol', {class: 'dumbbells'}, ...rows.map(line)));
}

function clusterFigure(data, models) {
  const rows = (data.clusters ?? []).filter((c) => models.every((m) => typeof c.rmse_3d_mm?.[m] === 'number'))
    .map((c) => ({name: c.name, values: c.rmse_3d_mm}));
  if (rows.length === 0) return null;
  return figure({
    title: 'Where on the body', body: dumbbells(rows, models, 'mm'),
    note: `The dots show the RMSE of the markers of each cluster before and after calibration${data.clusters_on ? `, ${data.clusters_on}` : ''}.`,
    data: {name: 'cluster_rmse.csv', text: () => toCsv(['cluster', 'link', ...models.map((m) => `rmse_3d_${m}_mm`)],
      data.clusters.map((c) => [c.name, c.link, ...models.map((m) => c.rmse_3d_mm?.[m])]))},
  });
}

/** RMS over the markers along a motion, before and after (Fig. 8a). */
function tracePlot(trace, models) {
  return plot({
    label: `Tracking error along ${trace.trial}`,
    x: {label: 'time [s]', short: 's'}, y: {label: 'RMS over the markers [mm]', range: (u, min, max) => [0, max * 1.05]},
    series: models.map((m) => ({text: modelName(m), colour: MODEL_COLOURS[m], dots: trace.time_s.length < 60})),
    data: [trace.time_s, ...models.map((m) => trace.rms_mm[m])],
    height: 240,
  });
}

function traceFigure(data, models) {
  const traces = (data.traces ?? []).filter((t) => t.time_s.length > 1);
  if (traces.length === 0) return null;
  let chosen = Math.max(0, traces.findIndex((t) => t.kind === 'sine'));
  const holder = h('div', {class: 'hold-plot'}, tracePlot(traces[chosen], models));
  const chooser = traces.length > 1 && h('label', {class: 'select'}, h('span', {}, 'Trial'),
    h('select', {onchange: (e) => { chosen = Number(e.target.value); holder.replaceChildren(tracePlot(traces[chosen], models)); }},
      ...traces.map((t, i) => h('option', {value: i, selected: i === chosen}, t.trial))));
  return figure({
    title: 'Along a motion', body: [chooser, holder],
    note: 'RMS: the root mean square over the markers that were seen at each moment.',
    data: {name: 'tracking_error.csv', text: () => {
      const trace = traces[chosen];
      return columnsToCsv(['time_s', ...models.map((m) => `rms_${m}_mm`)], [trace.time_s, ...models.map((m) => trace.rms_mm[m])]);
    }},
  });
}

/** Fig. 8: residuals before and after. */
export function residualsSection(report) {
  const {data} = report;
  if (!data?.distributions?.length) return null;
  const models = firstAndLast(data.models);
  return section('residuals', 'Residuals', 'Residuals before and after',
    'A residual is the distance between a measured marker and where the model predicts it: before calibration with the nominal robot, after it with the calibrated one.',
    distributionFigure(data, models), clusterFigure(data, models), traceFigure(data, models));
}
