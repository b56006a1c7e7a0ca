import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure, section} from '../lib/figure.js';
import {fixed, plural} from '../lib/format.js';
import {table} from '../lib/table.js';

const SHOWN = 25;

function words(title, kind, items) {
  if (!items?.length) return null;
  return h('div', {class: `words state-${kind}`}, h('h3', {}, title), h('ul', {}, ...items.map((text) => h('li', {}, text))));
}

/** 'leg_left, posture 3' where the summary counts the postures of all trials; or the line of a table. */
function where(outlier, report) {
  if (outlier.line) return `posture ${outlier.posture + 1} (line ${outlier.line})`;
  let first = 0;
  for (const scene of report.data?.scenes ?? []) {
    if (outlier.posture < first + scene.total) return `${scene.name}, posture ${outlier.posture - first + 1}`;
    first += scene.total;
  }
  return `posture ${outlier.posture + 1}`;
}

function outlierFigure(report) {
  const {summary} = report;
  const outliers = [...(summary.outliers ?? [])].sort((a, b) => b.residual_mm - a.residual_mm);
  if (outliers.length === 0) return null;
  return figure({title: `${plural(outliers.length, 'outlier')} left out`,
    note: outliers.length > SHOWN ? `The ${SHOWN} largest; all are in the CSV.` : 'Beyond what noise and the uncertainty of the model explain.',
    body: table({caption: 'Outliers', columns: [{text: 'Where'}, {text: 'Marker'}, {text: 'Residual', unit: 'mm', number: true}, {text: 'in sd', number: true}],
      rows: outliers.slice(0, SHOWN).map((o) => [where(o, report), o.marker, fixed(o.residual_mm), fixed(o.normalised, 1)])}),
    data: {name: 'outliers.csv', text: () => toCsv(['where', 'marker', 'residual_mm', 'normalised'], outliers.map((o) => [where(o, report), o.marker, o.residual_mm, o.normalised]))}});
}

/** One line a finding; the name of the trial stands before it already. */
function trialFindings(trial) {
  const found = trial.findings ?? [];
  if (found.length === 0) return trial.used ? '' : 'not used';
  const prefix = `trial ${trial.name}: `;
  return found.map((text) => h('div', {}, text.startsWith(prefix) ? text.slice(prefix.length) : text));
}

function trialsFigure(summary) {
  const trials = summary.trials ?? [];
  if (trials.length === 0) return null;
  const clock = (t) => t.clock?.lag_s === null || t.clock?.lag_s === undefined ? '–' : fixed(t.clock.lag_s, 3);
  return figure({title: 'Trials', body: table({caption: 'Trials and what was used of them',
    columns: [{text: 'Trial'}, {text: 'Postures', number: true}, {text: 'Samples', number: true}, {text: 'Clock lag', unit: 's', number: true}, {text: 'Findings'}],
    rows: trials.map((t) => ({class: t.used ? '' : 'held', cells: [t.name, String(t.postures), String(t.samples), clock(t), trialFindings(t)]}))}),
    data: {name: 'trials.csv', text: () => toCsv(['trial', 'used', 'postures', 'samples', 'lag_s', 'findings'], trials.map((t) => [t.name, String(t.used), t.postures, t.samples, t.clock?.lag_s, (t.findings ?? []).join(' ')]))}});
}

/** Warnings and outliers, in words. */
export function findingsSection(report) {
  const {summary} = report;
  if (!summary) return null;
  const remarks = new Set(summary.remarks ?? []);
  const ofTrials = new Set((summary.trials ?? []).flatMap((t) => t.findings ?? []));
  const warnings = (summary.warnings ?? []).filter((w) => !remarks.has(w) && !ofTrials.has(w));
  const quiet = !summary.objections?.length && !remarks.size && !warnings.length && !summary.outliers?.length;
  return section('findings', 'Findings', 'Warnings and outliers', quiet ? 'Nothing was found that needs a look.' : 'What was found on the way; the gravest first.',
    words('Why it should not be deployed', 'bad', summary.objections), words('Look at these before deploying', 'check', [...remarks]),
    words('Warnings', '', warnings), outlierFigure(report), trialsFigure(summary));
}
