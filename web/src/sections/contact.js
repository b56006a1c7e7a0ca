// SPDX-License-Identifier: Apache-2.0
import {contactVerdict, instrumentErrors, judged, thing, where} from '../lib/contact.js';
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure, section} from '../lib/figure.js';
import {count, fixed, plural} from '../lib/format.js';
import {table} from '../lib/table.js';
import {instrumentErrorsFigure, platesFigure, quantitiesFigure, sessionsFigure, touchPlots} from './contact_figures.js';

function fact(value, unit, what) {
  return h('div', {class: 'fact'}, h('dt', {}, what), h('dd', {}, value, unit && h('span', {class: 'unit'}, ` ${unit}`)));
}

/** The head of the page for a robot that touched tables or that instruments measured. */
export function contactVerdictSection(report) {
  const {summary, validation} = report;
  const result = contactVerdict(summary, validation);
  const after = judged(summary.contact);
  const {contact} = summary;
  const touched = contact.touches > 0;
  return h('section', {id: 'verdict', 'data-short': 'Verdict', class: `verdict state-${result.state}`, 'aria-labelledby': 'verdict-title'},
    h('h2', {id: 'verdict-title', class: 'verdict-word'}, h('span', {class: 'mark', 'aria-hidden': 'true'}), result.word),
    h('p', {class: 'verdict-sentence'}, result.sentence), h('p', {class: 'verdict-rest'}, result.rest),
    h('dl', {class: 'facts'},
      touched && fact(fixed(after.height_mm), 'mm', `height of touches (root mean square) ${where(contact)}`),
      touched && fact(fixed(after.tilt_deg), 'deg', 'tilt of touches, over both axes'),
      fact(count(touched ? contact.touches : contact.observations), '', `${thing(contact)} in ${plural(Math.max(1, contact.sessions), 'session')}`),
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

/** A figure of the touches of another day. */
function validationFigure(validation) {
  if (!validation?.contact) return null;
  return figure({title: 'On another recording', note: `${validation.recording}; the table ${validation.contact.table === 'refitted' ? 'was registered anew on the other touches' : 'is where it was in the calibration'}.`,
    body: table({caption: 'Errors on another recording', columns: COLUMNS, rows: errorRows({fit: validation.contact})})});
}

function touchErrorsFigure(contact) {
  const touches = contact.kfold?.of_touches ?? [];
  return figure({title: 'Errors of touches', body: table({caption: 'Errors of touches', columns: COLUMNS, rows: errorRows(contact)}),
    data: touches.length > 0 ? {name: 'touches.csv', text: () => toCsv(KEYS, touches.map((t) => [t.file, t.line, t.plate, t.session, t.height_mm, ...t.tilt_deg]))} : undefined});
}

/** Errors of touches and measurements, and the estimated tables, mountings and sessions. */
export function contactSection(report) {
  const {contact} = report.summary;
  const touched = contact.touches > 0;
  const lead = `Errors ${where(contact)}, as root mean squares.${touched ? ' Height is along the normal of the table; tilts are about the axes of the plate.' : ''}`;
  return section('touches', touched ? 'Touches' : 'Instruments', touched ? 'Touches of the tables' : 'What instruments measured', lead,
    touched && touchErrorsFigure(contact), touched && touchPlots(contact),
    instrumentErrorsFigure(instrumentErrors(contact)), validationFigure(report.validation),
    touched && platesFigure(contact), quantitiesFigure(contact), sessionsFigure(contact));
}
