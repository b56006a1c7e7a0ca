// SPDX-License-Identifier: Apache-2.0
// The sections of a fleet's page, which `elastocal batch` writes.
import {OKABE_ITO} from '../lib/colours.js';
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure, section} from '../lib/figure.js';
import {batchRows, fleetVerdict, robotRows, verdictText} from '../lib/fleet.js';
import {count, fixed, list, plural, probability, significant, withSd} from '../lib/format.js';
import {plot} from '../lib/plot.js';
import {table} from '../lib/table.js';
import {userUnit} from '../lib/units.js';

const MOST_ROBOTS = 200;
const MOST_FINDINGS = 50;
const MOST_PLOTS = 6;
const A_MONTH = 30;  // days

const inUnit = (si, value, sd) => {
  const {unit, factor} = userUnit(si);
  const text = withSd(factor * value, factor * sd);
  return [text.value, h('span', {class: 'sd'}, ` ± ${text.sd}`), h('span', {class: 'unit'}, ` ${unit}`)];
};

const plain = (si, value) => {
  const {unit, factor} = userUnit(si);
  return [significant(factor * value), h('span', {class: 'unit'}, ` ${unit}`)];
};

const shownOf = (all, most, what) => all > most ? `The table has the first ${count(most)} of ${count(all)} ${what}; the CSV has all. ` : '';

function fact(value, unit, what) {
  return h('div', {class: 'fact'}, h('dt', {}, what), h('dd', {}, value, unit && h('span', {class: 'unit'}, ` ${unit}`)));
}

/** The verdict on the fleet in one sentence, and its figures. */
export function fleetVerdictSection(report) {
  const robots = robotRows(report);
  const {state, fine, refused, failed, workshop} = fleetVerdict(robots);
  const parts = [`${count(fine)} of ${plural(robots.length, 'robot')} ${fine === 1 ? 'has' : 'have'} a calibration to be deployed`,
    refused > 0 && `${count(refused)} ${refused === 1 ? 'has' : 'have'} one that is not`, failed > 0 && `${count(failed)} ${failed === 1 ? 'has' : 'have'} none`,
    workshop > 0 && `${count(workshop)} ${workshop === 1 ? 'needs' : 'need'} a workshop`].filter(Boolean);
  const days = report.sessions.map((s) => s.day).filter((day) => typeof day === 'number');
  const words = {deploy: 'All can be deployed', check: 'Look at some robots', reject: 'Some robots cannot be deployed'};
  return h('section', {id: 'verdict', 'data-short': 'Verdict', class: `verdict state-${state}`, 'aria-labelledby': 'verdict-title'},
    h('h2', {id: 'verdict-title', class: 'verdict-word'}, h('span', {class: 'mark', 'aria-hidden': 'true'}), words[state]),
    h('p', {class: 'verdict-sentence'}, `${list(parts)}.`),
    workshop > 0 && h('p', {class: 'verdict-rest'}, `To the workshop: ${list(report.fleet.workshop, 12)}.`),
    h('dl', {class: 'facts'},
      fact(count(report.sessions.length), '', 'sessions'),
      typeof report.fleet.median_urdf_rmse_3d_mm === 'number' && fact(fixed(report.fleet.median_urdf_rmse_3d_mm), 'mm', 'half of the calibrated URDFs err by less'),
      days.length > 1 && fact(count(Math.max(...days) - Math.min(...days)), 'days', 'from the first session to the last'),
      fact(count(report.fleet.out_of_family?.length ?? 0), '', 'parameters out of family'),
      fact(count(report.fleet.drifts?.length ?? 0), '', 'parameters that drift')));
}

const parameterNames = (names) => list(names, 3);

/** A row for each robot. Those that need attention come first. */
export function fleetRobotsSection(report) {
  const robots = robotRows(report);
  if (robots.length === 0) return null;
  const batches = robots.some((robot) => robot.batch !== '');
  const many = robots.some((robot) => robot.sessions > 1);
  const row = (robot) => [robot.robot, batches ? robot.batch : null,
    robot.workshop || robot.verdict !== 'fine' ? h('strong', {}, `${verdictText(robot.verdict)}${robot.workshop ? '; workshop' : ''}`) : verdictText(robot.verdict),
    many ? count(robot.sessions) : null, fixed(robot.uncalibrated), fixed(robot.urdf), fixed(robot.compensated),
    parameterNames(robot.out), parameterNames(robot.drifts)].filter((cell) => cell !== null);
  return section('robots', 'Robots', 'Robots', 'A row has the last session of a robot. Robots that need a look stand first, the others by the error of their calibrated URDF.',
    figure({title: plural(robots.length, 'robot'), note: `${shownOf(robots.length, MOST_ROBOTS, 'robots')}Errors are RMSE of marker distances on held-out data, or on the fit where nothing was held out: of the nominal robot, of the calibrated URDF, and with elasticity compensated.`,
      body: table({caption: 'Robots', className: 'robots',
        columns: [{text: 'Robot'}, batches && {text: 'Batch'}, {text: 'Verdict'}, many && {text: 'Sessions', number: true}, {text: 'Nominal', unit: 'mm', number: true}, {text: 'URDF', unit: 'mm', number: true},
          {text: 'Compensated', unit: 'mm', number: true}, {text: 'Out of family'}, {text: 'Drift'}].filter(Boolean),
        rows: robots.slice(0, MOST_ROBOTS).map(row)}),
      data: {name: 'robots.csv', text: () => toCsv(['robot', 'batch', 'verdict', 'workshop', 'session', 'day', 'sessions', 'postures', 'uncalibrated_mm', 'urdf_mm', 'compensated_mm', 'out_of_family', 'drifts'],
        robots.map((r) => [r.robot, r.batch, r.verdict, String(r.workshop), r.last.name, r.day, r.sessions, r.postures, r.uncalibrated, r.urdf, r.compensated, r.out.join(' '), r.drifts.join(' ')]))}}));
}

/** Parameters of robots that are unlike the others. */
export function outOfFamilySection(report) {
  const all = report.fleet.out_of_family ?? [];
  const lead = all.length > 0 ? 'A parameter of a robot is unlike those of the others, whose mean is given with the scatter of a robot among them. The robot may have been assembled otherwise, repaired, or hit.'
    : 'No robot has a parameter that is unlike those of the others.';
  return section('family', 'Out of family', 'Joints out of family', lead, all.length > 0 && figure({title: plural(all.length, 'parameter'),
    note: `${shownOf(all.length, MOST_FINDINGS, 'parameters')}p is adjusted for all robots and parameters that were compared.`,
    body: table({caption: 'Out of family', columns: [{text: 'Robot'}, {text: 'Parameter'}, {text: 'It has', number: true}, {text: 'The others', number: true}, {text: 'p', number: true}],
      rows: all.slice(0, MOST_FINDINGS).map((o) => [o.robot, o.parameter, plain(o.unit, o.value), inUnit(o.unit, o.family, o.sd), probability(o.p_adjusted)])}),
    data: {name: 'out_of_family.csv', text: () => toCsv(['robot', 'parameter', 'unit', 'value', 'family', 'sd', 'p_adjusted'], all.map((o) => [o.robot, o.parameter, o.unit, o.value, o.family, o.sd, o.p_adjusted]))}}));
}

/** Comparison of the maker's batches, and where one is unlike the others. */
export function batchesSection(report) {
  const rows = batchRows(robotRows(report));
  if (rows.length < 2) return null;
  const all = report.fleet.batches ?? [];
  return section('batches', 'Batches', 'Batches of the maker',
    all.length > 0 ? 'In some parameters a batch differs from the others: what it was made with or how was not the same.' : 'No batch differs from the others.',
    figure({title: plural(rows.length, 'batch', 'batches'), body: table({caption: 'Batches',
      columns: [{text: 'Batch'}, {text: 'Robots', number: true}, {text: 'To be deployed', number: true}, {text: 'Workshop', number: true}, {text: 'URDF, half err by less than', unit: 'mm', number: true}],
      rows: rows.map((r) => [r.batch || 'none given', count(r.robots), count(r.fine), count(r.workshop), fixed(r.urdf)])}),
    data: {name: 'batches.csv', text: () => toCsv(['batch', 'robots', 'to_be_deployed', 'workshop', 'median_urdf_mm'], rows.map((r) => [r.batch, r.robots, r.fine, r.workshop, r.urdf]))}}),
    all.length > 0 && figure({title: 'Where a batch differs', note: shownOf(all.length, MOST_FINDINGS, 'differences') || null,
      body: table({caption: 'Batches that differ', columns: [{text: 'Batch'}, {text: 'Parameter'}, {text: 'Differs by', number: true}, {text: 'p', number: true}],
        rows: all.slice(0, MOST_FINDINGS).map((b) => [b.batch, b.parameter, inUnit(b.unit, b.difference, b.sd), probability(b.p_adjusted)])}),
      data: {name: 'batch_differences.csv', text: () => toCsv(['batch', 'parameter', 'unit', 'difference', 'sd', 'p_adjusted'], all.map((b) => [b.batch, b.parameter, b.unit, b.difference, b.sd, b.p_adjusted]))}}));
}

function driftPlot(drift) {
  const {unit, factor} = userUnit(drift.unit);
  const sessions = [...(drift.sessions ?? [])].sort((a, b) => a.day - b.day);
  const weights = sessions.map((s) => 1 / (s.sd * s.sd));
  const sum = weights.reduce((a, b) => a + b, 0);
  const mean = (of) => sessions.reduce((total, s, i) => total + weights[i] * of(s), 0) / sum;
  const [day, value] = [mean((s) => s.day), mean((s) => s.value)];
  return h('div', {class: 'cause'}, h('h4', {}, `${drift.robot}: ${drift.parameter}`),
    plot({label: `${drift.parameter} of ${drift.robot} by session`, height: 190, x: {label: 'day', short: 'day'}, y: {label: `deviation [${unit}]`},
      series: [{text: 'a session', colour: OKABE_ITO.blue, dots: 'only'}, {text: 'drift', colour: OKABE_ITO.vermillion}],
      data: [sessions.map((s) => s.day), sessions.map((s) => factor * s.value), sessions.map((s) => factor * (value + drift.per_day * (s.day - day)))]}));
}

/** Parameters that change from session to session. */
export function driftSection(report) {
  const all = report.fleet.drifts ?? [];
  const dated = report.sessions.some((s) => typeof s.day === 'number');
  if (!dated && all.length === 0) return null;
  return section('drift', 'Drift', 'Drift over months', all.length > 0 ? 'A parameter changes along a line through the sessions of a robot by more than their uncertainty.' : 'No parameter of a robot changes from session to session by more than the uncertainty.',
    all.length > 0 && figure({title: plural(all.length, 'parameter that drifts', 'parameters that drift'),
      note: `${shownOf(all.length, MOST_FINDINGS, 'parameters')}${all.length > MOST_PLOTS ? `The plots show the first ${MOST_PLOTS}. ` : ''}p is adjusted for all robots and parameters.`,
      body: [table({caption: 'Drift', columns: [{text: 'Robot'}, {text: 'Parameter'}, {text: `In ${A_MONTH} days`, number: true}, {text: 'Sessions', number: true}, {text: 'p', number: true}],
        rows: all.slice(0, MOST_FINDINGS).map((d) => [d.robot, d.parameter, inUnit(d.unit, A_MONTH * d.per_day, A_MONTH * d.sd), count(d.sessions?.length), probability(d.p_adjusted)])}),
      h('div', {class: 'causes drifts'}, ...all.slice(0, MOST_PLOTS).filter((d) => d.sessions?.length > 1).map(driftPlot))],
      data: {name: 'drifts.csv', text: () => toCsv(['robot', 'parameter', 'unit', 'per_day', 'sd', 'p_adjusted', 'day', 'value', 'value_sd'],
        all.flatMap((d) => (d.sessions ?? []).map((s) => [d.robot, d.parameter, d.unit, d.per_day, d.sd, d.p_adjusted, s.day, s.value, s.sd])))}}));
}

/** Mean and scatter of every parameter, which predict the next robot. */
export function familySection(report) {
  const all = report.family ?? [];
  if (all.length === 0) return null;
  return section('parameters', 'The family', 'What the robots have in common', report.prior ? 'Mean over the robots and scatter between them, without the uncertainty of the calibrations. The folder prior has this for the next robot.' : 'Mean over the robots and scatter between them, without the uncertainty of the calibrations.',
    h('details', {class: 'fold'}, h('summary', {}, `All ${plural(all.length, 'parameter')}`),
      figure({title: 'Parameters', body: table({caption: 'Parameters of the family', columns: [{text: 'Parameter'}, {text: 'Mean', number: true}, {text: 'Scatter', number: true}, {text: 'Robots', number: true}],
        rows: all.map((p) => [p.parameter, plain(p.unit, p.mean), plain(p.unit, p.sd), count(p.robots)])}),
      data: {name: 'family.csv', text: () => toCsv(['parameter', 'unit', 'mean', 'sd', 'robots'], all.map((p) => [p.parameter, p.unit, p.mean, p.sd, p.robots]))}})));
}

/** Sessions that failed or do not belong to the family. */
export function fleetNotesSection(report) {
  const failed = report.sessions.filter((s) => s.exit_code !== 0 && s.exit_code !== 4);
  const notes = [...failed.map((s) => `${s.name}: no result (exit code ${s.exit_code}); see ${s.name}.log`), ...(report.fleet.notes ?? [])];
  if (notes.length === 0) return null;
  return section('notes', 'Notes', 'Sessions without a place in the family', null,
    h('div', {class: 'words state-check'}, h('ul', {}, ...notes.map((note) => h('li', {}, note)))));
}
