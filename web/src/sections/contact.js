// SPDX-License-Identifier: Apache-2.0
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure, section} from '../lib/figure.js';
import {count, fixed, plural} from '../lib/format.js';
import {table} from '../lib/table.js';

const judged = (contact) => contact.kfold ?? contact.fit;
const where = (contact) => contact.kfold ? 'on touches that were left out' : 'on the touches of the fit';

/** {state, word, sentence}: what the touches say of the calibration. */
export function contactVerdict(summary) {
  const {contact} = summary;
  const after = judged(contact);
  const before = after.uncalibrated;
  const errors = `The height of touches went from ${fixed(before.height_mm)} to ${fixed(after.height_mm)}\u00a0mm and their tilt from ${fixed(before.tilt_deg)} to ${fixed(after.tilt_deg)}\u00a0degrees, ${where(contact)}`;
  if (summary.status !== 'converged' || summary.objections?.length) {
    return {state: 'reject', word: 'Do not deploy', sentence: `${errors}, but the result must not be trusted.`, rest: summary.objections?.[0] ?? summary.status};
  }
  const rest = summary.model === 'full' ? 'These figures hold for a controller that compensates elasticity.' : '';
  if (!contact.kfold) return {state: 'check', word: 'Validate first', sentence: `${errors}.`, rest};
  return {state: 'deploy', word: 'Deploy', sentence: `${errors}.`, rest};
}

function fact(value, unit, what) {
  return h('div', {class: 'fact'}, h('dt', {}, what), h('dd', {}, value, unit && h('span', {class: 'unit'}, ` ${unit}`)));
}

/** The head of the page for a robot that touched tables. */
export function contactVerdictSection(report) {
  const {summary} = report;
  const result = contactVerdict(summary);
  const after = judged(summary.contact);
  const {contact} = summary;
  return h('section', {id: 'verdict', 'data-short': 'Verdict', class: `verdict state-${result.state}`, 'aria-labelledby': 'verdict-title'},
    h('h2', {id: 'verdict-title', class: 'verdict-word'}, h('span', {class: 'mark', 'aria-hidden': 'true'}), result.word),
    h('p', {class: 'verdict-sentence'}, result.sentence), h('p', {class: 'verdict-rest'}, result.rest),
    h('dl', {class: 'facts'},
      fact(fixed(after.height_mm), 'mm', `height of touches (root mean square) ${where(contact)}`),
      fact(fixed(after.tilt_deg), 'deg', 'tilt of touches, over both axes'),
      fact(count(contact.touches), '', `touches in ${plural(contact.sessions, 'session')}`),
      fact(count(Math.round(summary.effective_parameters)), '', 'numbers that they determine'),
      fact(count(contact.outliers.length), '', contact.outliers.length === 1 ? 'outlier left out' : 'outliers left out')));
}

const KEYS = ['file', 'line', 'plate', 'session', 'height_mm', 'tilt_x_deg', 'tilt_y_deg'];

function errorRows(contact) {
  const figures = judged(contact);
  const urdf = contact.urdf_alone;
  const cells = (of) => [count(of.touches), fixed(of.height_mm), fixed(of.tilt_x_deg, 3), fixed(of.tilt_y_deg, 3), fixed(of.max_height_mm)];
  return [['uncalibrated', figures.uncalibrated], urdf && ['URDF alone', urdf], ['calibrated', figures]].filter(Boolean).flatMap(([name, of]) => [
    [name, ...cells(of)], ...Object.entries(of.by_side).map(([side, own]) => [`${name}, ${side}`, ...cells(own)])]);
}

const COLUMNS = [{text: 'Robot'}, {text: 'Touches', number: true}, {text: 'Height', unit: 'mm', number: true}, {text: 'Tilt x', unit: 'deg', number: true}, {text: 'Tilt y', unit: 'deg', number: true}, {text: 'Largest height', unit: 'mm', number: true}];

/** Touches of another day. */
function validationFigure(validation) {
  if (!validation?.contact) return null;
  return figure({title: 'On another recording', note: `${validation.recording}; the table ${validation.contact.table === 'refitted' ? 'was registered anew on the other touches' : 'is where it was in the calibration'}.`,
    body: table({caption: 'Errors on another recording', columns: COLUMNS, rows: errorRows({fit: validation.contact})})});
}

/** Errors of the touches, by plate, and the tables that were found. */
export function contactSection(report) {
  const {contact} = report.summary;
  const touches = contact.kfold?.of_touches ?? [];
  return section('touches', 'Touches', 'Touches of the tables', `Errors ${where(contact)}, as root mean squares. Height is along the normal of the table; tilts are about the axes of the plate.`,
    figure({title: 'Errors of touches', body: table({caption: 'Errors of touches', columns: COLUMNS, rows: errorRows(contact)}),
    data: touches.length > 0 ? {name: 'touches.csv', text: () => toCsv(KEYS, touches.map((t) => [t.file, t.line, t.plate, t.session, t.height_mm, ...t.tilt_deg]))} : undefined}),
    validationFigure(report.validation),
    figure({title: 'Plates and tables', note: 'A plate\u2019s tilt on its link and the plane of its table, seen from the first foot.', body: table({caption: 'Plates and tables',
      columns: [{text: 'Plate'}, {text: 'Touches', number: true}, {text: 'Tilts of the plate', unit: 'deg', number: true}, {text: 'Height of the table', unit: 'mm', number: true}, {text: 'Tilts of the table', unit: 'deg', number: true}],
      rows: contact.plates.map((p) => [p.name, count(p.touches), p.tilts_deg.map((t) => fixed(t)).join(', '), fixed(p.table_height_mm, 1), p.table_tilts_deg.map((t) => fixed(t)).join(', ')])})}));
}
