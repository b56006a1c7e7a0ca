// SPDX-License-Identifier: Apache-2.0
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure, section} from '../lib/figure.js';
import {count, fixed, list, plural, withSd} from '../lib/format.js';
import {groupTexts, knownNames, othersOf, sentence, spoken, typeset} from '../lib/groups.js';
import {outlierRows, placeOf} from '../lib/outliers.js';
import {table} from '../lib/table.js';
import {causesFigure} from './causes.js';

const SHOWN = 25;

/** One line for a group of texts that say the same. Several texts can be unfolded. */
function groupLine(group, names) {
  const text = sentence(group.text, names);
  if (group.all.length === 1) return h('li', {}, text);
  return h('li', {}, text, h('span', {class: 'others'}, ` ${othersOf(group)}`),
    h('details', {class: 'fold'}, h('summary', {}, group.all.length === 2 ? 'Both in full' : `All ${count(group.all.length)} in full`), h('ul', {}, ...group.all.map((whole) => h('li', {}, sentence(whole, names))))));
}

function words(title, kind, items, names) {
  if (!items?.length) return null;
  return h('div', {class: `words state-${kind}`}, h('h3', {}, title), h('ul', {}, ...groupTexts(items, names).map((group) => groupLine(group, names))));
}

/** The sentences of `diagnose`. They are not grouped, because each has its own numbers. */
function causeWords(texts, names) {
  if (texts.length === 0) return null;
  return h('div', {class: 'words'}, h('h3', {}, 'What geometry and springs leave, and why'),
    h('ul', {}, ...texts.map((text) => h('li', {}, text.endsWith(':') ? typeset(text) : sentence(text.trim(), names)))));
}

function outlierFigure(report) {
  const {summary} = report;
  const outliers = summary.outliers ?? [];
  if (outliers.length === 0) return null;
  const rows = outlierRows(outliers, (outlier) => placeOf(outlier, report));
  const inTrials = rows.some((row) => row.trial);
  const where = (row) => `${row.postures.length > 1 ? 'postures' : 'posture'} ${list(row.postures, 5)}`;
  return figure({title: `${plural(outliers.length, 'outlier')} left out`,
    note: `These sightings are further from their prediction than noise and the uncertainty of the model explain, so the estimate does not use them. The last column is the largest residual divided by its expected standard deviation.${rows.length > SHOWN ? ` The table has the ${SHOWN} rows with the largest residuals; the CSV has all outliers.` : ''}`,
    body: table({caption: 'Outliers', className: 'wide-first-two', columns: [{text: 'Markers'}, inTrials && {text: 'Trial'}, {text: 'Where'}, {text: 'Sightings', number: true}, {text: 'Largest residual', unit: 'mm', number: true}, {text: 'Residual / sd', number: true}].filter(Boolean),
      rows: rows.slice(0, SHOWN).map((row) => [list(row.markers, 4), inTrials ? row.trial : null, where(row), count(row.count), fixed(row.residual_mm), fixed(row.normalised, 1)].filter((cell) => cell !== null))}),
    data: {name: 'outliers.csv', text: () => toCsv(['trial', 'posture', 'marker', 'residual_mm', 'normalised'], outliers.map((o) => [placeOf(o, report).trial, placeOf(o, report).posture, o.marker, o.residual_mm, o.normalised]))}});
}

/** Findings in a trial, without its name, which is the heading of the row. */
function trialFindings(trial, names) {
  const found = trial.findings ?? [];
  if (found.length === 0) return trial.used ? '' : 'not used';
  const prefix = `trial ${trial.name}: `;
  const texts = found.map((text) => text.startsWith(prefix) ? text.slice(prefix.length) : text);
  return groupTexts(texts, names).map((group) => h('div', {title: group.all.length > 1 ? group.all.join('\n') : null}, [sentence(group.text, names), othersOf(group)].filter(Boolean).join(' ')));
}

/** A table of the trials with findings. Of the others, only the names are listed. */
function trialsFigure(report) {
  const {summary} = report;
  const trials = summary.trials ?? [];
  if (trials.length === 0) return null;
  const names = knownNames(report);
  const lag = ({clock}) => typeof clock?.lag_s === 'number' ? withSd(1e3 * clock.lag_s, clock.sd_s * 1e3, 0) : {value: '–', sd: ''};
  const clock = (trial) => {
    const {value, sd} = lag(trial);
    return [value, h('span', {class: 'sd'}, /\d/.test(sd) && sd !== '0' ? ` ± ${sd}` : '')];
  };
  return figure({title: 'Trials', note: 'The clock lag is the time of the cameras minus the time of the robot at the beginning of the trial, ± its standard deviation. A trial in grey was not used.',
    body: table({caption: 'Trials and what was used of them', className: 'findings',
      columns: [{text: 'Trial'}, {text: 'Postures', number: true}, {text: 'Samples', number: true}, {text: 'Clock lag', unit: 'ms', number: true}, {text: 'Findings'}],
      rows: trials.map((t) => ({class: t.used ? '' : 'held', cells: [t.name, count(t.postures), count(t.samples), clock(t), trialFindings(t, names)]}))}),
    data: {name: 'trials.csv', text: () => toCsv(['trial', 'used', 'postures', 'samples', 'lag_s', 'lag_sd_s', 'findings'], trials.map((t) => [t.name, String(t.used), t.postures, t.samples, t.clock?.lag_s, t.clock?.sd_s, (t.findings ?? []).join(' ')]))}});
}

/** Warnings and outliers in words. */
export function findingsSection(report) {
  const {summary} = report;
  if (!summary) return null;
  const names = knownNames(report);
  const {objections, remarks, warnings} = spoken(summary);
  const diagnosis = Array.isArray(report.diagnosis?.words) ? report.diagnosis.words : summary.diagnosis ?? [];
  const quiet = !objections.length && !remarks.length && !warnings.length && !summary.outliers?.length && !diagnosis.length;
  return section('findings', 'Findings', 'Warnings and outliers', quiet ? 'The program found nothing that needs a look.' : 'This is what the program found on the way, the gravest first.',
    words('Why the result should not be deployed', 'bad', objections, names), words('Look at these before deploying', 'check', remarks, names),
    causeWords(diagnosis, names), causesFigure(report),
    words('Warnings', '', warnings, names), outlierFigure(report), trialsFigure(report));
}
