// SPDX-License-Identifier: Apache-2.0
import {SERIES} from '../lib/colours.js';
import {sessionBands} from '../lib/contact.js';
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure} from '../lib/figure.js';
import {count, significant, withSd} from '../lib/format.js';
import {plot} from '../lib/plot.js';
import {table} from '../lib/table.js';

/** An estimate with its standard deviation. */
function estimate(value, sd, digits = 2) {
  const text = withSd(value, sd, digits);
  return h('span', {class: 'estimate'}, h('span', {class: 'value'}, text.value), h('span', {class: 'sd'}, typeof sd === 'number' ? ` ±${text.sd}` : ''));
}
const estimates = (values, sds) => values.map((value, i) => estimate(value, sds?.[i]));
const tilts = (of) => ['x', 'y'].map((axis) => ({text: `${of} ${axis}`.trim(), unit: 'deg', number: true}));

/** The name of a file without its folders, to keep tables narrow. Other names are unchanged. */
const short = (session) => session.replace(/^.*\/(?=[^/]*\.\w+)/, '');

/** Height and tilt of each touch, in the order of the recording. */
export function touchPlots(contact) {
  const touches = contact.kfold?.of_touches ?? [];
  if (touches.length === 0) return null;
  const x = touches.map((_, i) => i + 1);
  const plates = [...new Set(touches.map((t) => t.plate))];
  const series = (names) => names.map((text, i) => ({text, colour: SERIES[i % SERIES.length], dots: 'only'}));
  const axis = {label: 'Touch, in the order of the recording', short: 'touch', whole: true};
  const heights = plates.map((plate) => touches.map((t) => t.plate === plate ? t.height_mm : null));
  const bands = sessionBands(touches);
  return figure({
    title: 'Each touch, left out', note: 'What is left of each touch by the calibration from the others. A change of the shade is another session or another plate.',
    body: h('div', {},
      plot({x: axis, y: {label: 'Height, mm'}, series: series(plates), data: [x, ...heights], bands, height: 220}),
      plot({x: axis, y: {label: 'Tilt, deg'}, series: series(['about x', 'about y']), data: [x, ...[0, 1].map((k) => touches.map((t) => t.tilt_deg[k]))], bands, height: 220})),
  });
}

const ROW_NAMES = {position: 'position', rotation: 'rotation', acceleration: 'acceleration', height: 'height', length: 'length', pixel: 'image point'};

/** A figure of `instrumentErrors`. */
export function instrumentErrorsFigure(errors) {
  if (errors.length === 0) return null;
  return figure({title: 'Errors by instrument', note: 'Root mean square of one coordinate.',
    body: table({caption: 'Errors by instrument',
      columns: [{text: 'Instrument'}, {text: 'Kind'}, {text: 'Shows'}, {text: 'Observations', number: true}, {text: 'Uncalibrated', number: true}, {text: 'Calibrated', number: true}, {text: 'Unit'}],
      rows: errors.map((of) => [of.name, of.kind.replaceAll('_', ' '), ROW_NAMES[of.what] ?? of.what, count(of.observations), significant(of.before), significant(of.after), of.unit])}),
    data: {name: 'instruments.csv', text: () => toCsv(['instrument', 'kind', 'what', 'observations', 'uncalibrated', 'calibrated', 'unit'],
      errors.map((of) => [of.name, of.kind, of.what, of.observations, of.before, of.after, of.unit]))}});
}

export function platesFigure(contact) {
  return figure({title: 'Plates and tables', note: 'A plate\u2019s tilt on its link and the plane of its table, seen from the first foot, with standard deviations.', body: table({caption: 'Plates and tables',
    columns: [{text: 'Plate'}, {text: 'Touches', number: true}, ...tilts('Plate: tilt'), {text: 'Table: height', unit: 'mm', number: true}, ...tilts('Table: tilt')],
    rows: contact.plates.map((p) => [p.name, count(p.touches), ...estimates(p.tilts_deg, p.tilts_sd_deg), estimate(p.table_height_mm, p.table_height_sd_mm, 1), ...estimates(p.table_tilts_deg, p.table_tilts_sd_deg)])})});
}

const SHOWN = {m: [1e3, 'mm'], rad: [180 / Math.PI, 'deg']};

/** A number of a quantity in the unit that people use. */
function shownNumber(value, sd, unit) {
  const [factor, name] = SHOWN[unit] ?? [1, unit];
  return [estimate(factor * value, typeof sd === 'number' ? factor * sd : null, 4), name];
}

/** A table of the numbers of mountings and surroundings. */
export function quantitiesFigure(contact) {
  const quantities = (contact.quantities ?? []).filter((q) => q.units?.length === q.values.length);
  if (quantities.length === 0) return null;
  return figure({title: 'Mountings and surroundings', note: 'Each number is a displacement from the origin that the project file or a first look at the data gives (calibration.yaml has both): along axes, then about them. It has its standard deviation.',
    body: table({caption: 'Mountings and surroundings', columns: [{text: 'Quantity'}, {text: 'Number', number: true}, {text: 'Value', number: true}, {text: 'Unit'}],
      rows: quantities.flatMap((q) => q.values.map((value, k) => [q.name, count(k + 1), ...shownNumber(value, q.sds[k], q.units[k])]))}),
    data: {name: 'quantities.csv', text: () => toCsv(['quantity', 'number', 'value', 'sd', 'unit'], quantities.flatMap((q) => q.values.map((value, k) => [q.name, k + 1, value, q.sds[k], q.units[k]])))}});
}

/** Displacements of tables, trackers and so on in each session. */
export function sessionsFigure(contact) {
  const effects = contact.session_effects ?? [];
  if (effects.length < 2) return null;
  const planes = effects.filter((e) => 'height_mm' in e);
  if (planes.length === 0) return null;
  return figure({title: 'Sessions', note: 'How far the table lies from its mean in each session, as seen from the feet. A robot that is homed anew sees it elsewhere.',
    body: table({caption: 'Sessions', columns: [{text: 'Session'}, {text: 'Of'}, {text: 'Touches', number: true}, {text: 'Height', unit: 'mm', number: true}, ...tilts('Tilt')],
      rows: planes.map((e) => [h('span', {title: e.session}, short(e.session)), e.quantity.replaceAll('.', ' '), count(e.observations), estimate(e.height_mm, e.height_sd_mm), ...estimates(e.tilts_deg, e.tilts_sd_deg)])}),
    data: {name: 'sessions.csv', text: () => toCsv(['session', 'quantity', 'observations', 'height_mm', 'height_sd_mm', 'tilt_x_deg', 'tilt_y_deg', 'tilt_x_sd_deg', 'tilt_y_sd_deg'],
      planes.map((e) => [e.session, e.quantity, e.observations, e.height_mm, e.height_sd_mm, ...e.tilts_deg, ...e.tilts_sd_deg]))}});
}
