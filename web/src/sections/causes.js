// SPDX-License-Identifier: Apache-2.0
import {OKABE_ITO} from '../lib/colours.js';
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure} from '../lib/figure.js';
import {prettyUnit, probability} from '../lib/format.js';
import {typeset} from '../lib/groups.js';
import {legend} from '../lib/legend.js';
import {plot} from '../lib/plot.js';

const withUnit = (what, unit) => unit ? `${what} [${prettyUnit(unit)}]` : what;

/** Spreads two columns of dots a little, always in the same way, so that dots can be told apart. */
const spread = (picture, i) => picture.against_unit === '' ? 0.16 * (((i * 0.618034) % 1) - 0.5) : 0;

/** Points and curve with a common ascending x, as plots need them. */
export function pictureColumns(picture) {
  const dots = picture.x.map((x, i) => [x + spread(picture, i), picture.y[i], null]);
  const curve = picture.curve_x.map((x, i) => [x, null, picture.curve_y[i]]);
  const rows = [...dots, ...curve].sort((a, b) => a[0] - b[0]);
  return [0, 1, 2].map((k) => rows.map((row) => row[k]));
}

// 'displacement' for 'displacement of arm_6_joint', 'rotation about x' for 'rotation of the root link about x'. The title
// names the rest.
const shortly = (displaced) => displaced.replace(/ of .*?(?=( (along|about) [xyz])?$)/, '');

const SERIES = [{text: 'a posture', colour: OKABE_ITO.sky, dots: 'only', dotSize: 4, shape: 'dot'},
                {text: 'the cause as estimated', colour: OKABE_ITO.vermillion, spanGaps: true, width: 2.25}];

function causePlot(picture) {
  return h('div', {class: 'cause'}, h('h4', {}, picture.name),
    plot({
      label: `${picture.displaced} against ${picture.against}`, height: 210,
      x: {label: withUnit(picture.against, picture.against_unit), short: picture.against}, y: {label: withUnit(shortly(picture.displaced), picture.unit)},
      series: SERIES,
      data: pictureColumns(picture),
    }),
    h('p', {class: 'cause-words'}, typeset(`${picture.words}. p ${probability(picture.p_adjusted)}.`)));
}

/** Pictures of the causes that were taken, or of the nearest ones; null if none was searched for. */
export function causesFigure(report) {
  const own = report.diagnosis?.pictures;
  const pictures = (Array.isArray(own) ? own : report.summary.diagnosis_pictures ?? []).filter((picture) => picture.x?.length > 0);
  if (pictures.length === 0) return null;
  const found = pictures.some((picture) => picture.p_adjusted < 0.05);
  return figure({title: found ? 'What they look like' : 'The likeliest of them, none of which is significant', body: [legend(SERIES), h('div', {class: 'causes'}, ...pictures.map(causePlot))],
    note: 'Each dot is a posture: the displacement that the cause has there, and what the residuals of that posture ask for beside it. Where the cause is real, the dots follow the curve. p is that of the score test, adjusted for all causes that were tried.',
    data: {name: 'causes.csv', text: () => toCsv(['cause', 'posture', 'variable', 'variable_unit', 'displacement', 'displacement_sd', 'displacement_unit'],
      pictures.flatMap((p) => p.x.map((x, i) => [p.name, p.postures[i], x, p.against_unit, p.y[i], p.sd[i], p.unit])))}});
}
