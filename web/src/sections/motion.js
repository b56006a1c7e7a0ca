// SPDX-License-Identifier: Apache-2.0
import {SERIES} from '../lib/colours.js';
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure, section} from '../lib/figure.js';
import {count, fixed, flatten, significant} from '../lib/format.js';
import {plot} from '../lib/plot.js';
import {table} from '../lib/table.js';

const TORQUE = 'torque_';

/** Explanations of the margins of `plan` by their names in the file. */
const MARGIN_WORDS = {
  clearance: 'Least distance between two parts of the robot',
  zmp: 'Least distance of the zero-moment point from the edge of the standing feet',
  torque: 'Largest torque, as a share of its limit',
  velocity: 'Largest joint velocity, as a share of its limit',
  friction: 'Largest ratio of horizontal to vertical force of a foot',
  'foot moved': 'Largest movement of a standing foot',
};

const marginText = (value, unit) => unit === 'mm' && value >= 0 && value < 1e-3 ? '< 0.001' : significant(value);

function marginsFigure(motion) {
  const rows = flatten(motion.margins?.margins ?? motion.margins);
  if (rows.length === 0) return null;
  return figure({title: 'Margins', data: {name: 'margins.csv', text: () => toCsv(['margin', 'value', 'unit'], rows)},
    body: table({caption: 'Margins of the motion', className: 'wrap-first', columns: [{text: 'Margin'}, {text: 'Worst moment of the motion', number: true}],
      rows: rows.map(([name, value, unit]) => [MARGIN_WORDS[name] ?? name, [typeof value === 'number' ? marginText(value, unit) : value, h('span', {class: 'unit'}, ` ${unit}`)]])})});
}

/** Postures that could not be kept or reached, with the reason. */
function leftOut(motion) {
  const items = (motion.margins?.sets ?? []).flatMap((set) => (set.left_out ?? []).map((left) =>
    `${set.name}, posture ${left.posture + 1}: ${left.reason}`));
  return items.length > 0 && h('div', {class: 'words'}, h('h3', {}, 'Postures that were left out'), h('ul', {}, ...items.map((text) => h('li', {}, text))));
}

function zmpFigure(motion) {
  const c = motion.columns;
  if (!c.zmp_x || !c.zmp_y) return null;
  return figure({title: 'Zero-moment point', note: 'The point of the floor about which weight and inertia have no horizontal moment. It must stay within the standing feet.', data: {name: 'zmp.csv', text: () => toCsv(['time_s', 'zmp_x_m', 'zmp_y_m'], c.time.map((t, i) => [t, c.zmp_x[i], c.zmp_y[i]]))},
    body: plot({label: 'Zero-moment point against time', x: {label: 'time [s]', short: 's'}, y: {label: 'zero-moment point [mm]'}, height: 220,
      series: [{text: 'x', colour: SERIES[0]}, {text: 'y', colour: SERIES[1]}], data: [c.time, c.zmp_x.map((x) => 1e3 * x), c.zmp_y.map((y) => 1e3 * y)]})});
}

function jointPlot(c, joint) {
  return plot({label: `Position of ${joint} against time`, x: {label: 'time [s]', short: 's'}, y: {label: 'position [rad; m if prismatic]'}, height: 220,
               series: [{text: 'position', colour: SERIES[0]}], data: [c.time, c[joint]]});
}

function torquePlot(c, joint) {
  return plot({label: `Torque of ${joint} against time`, x: {label: 'time [s]', short: 's'}, y: {label: 'torque [N·m]'}, height: 220,
               series: [{text: 'torque', colour: SERIES[2]}], data: [c.time, c[TORQUE + joint]]});
}

function jointFigure(motion, joints) {
  const c = motion.columns;
  if (joints.length === 0) return null;
  let joint = joints[0];
  const holder = h('div', {class: 'hold-plot two'});
  const show = () => holder.replaceChildren(...[jointPlot(c, joint), c[TORQUE + joint] && torquePlot(c, joint)].filter(Boolean));
  show();
  return figure({title: 'Joints', body: [h('label', {class: 'select'}, h('span', {}, 'Joint'),
    h('select', {onchange: (e) => { joint = e.target.value; show(); }}, ...joints.map((j) => h('option', {value: j}, j)))), holder],
    data: {name: 'motion_joint.csv', text: () => toCsv(['time_s', joint, TORQUE + joint], c.time.map((t, i) => [t, c[joint][i], c[TORQUE + joint]?.[i]]))}});
}

const seconds = ({columns}) => `${fixed(columns.time.at(-1) - columns.time[0], 0)} s`;

const samples = ({columns, rows}) => rows > columns.time.length ? `, ${count(columns.time.length)} of ${count(rows)} samples in this report` : '';

/** The planned motions: margins, balance and joints. */
export function motionSection(report) {
  const motions = (report.motions ?? []).filter((m) => m.columns?.time?.length);
  if (motions.length === 0) return null;
  const several = motions.length > 1;
  const parts = motions.flatMap((motion) => {
    const joints = Object.keys(motion.columns).filter((n) => !['time', 'support', 'zmp_x', 'zmp_y'].includes(n) && !n.startsWith(TORQUE) && typeof motion.columns[n][0] === 'number');
    return [several && h('h3', {class: 'motion-name'}, `Motion “${motion.name}”, ${seconds(motion)}${samples(motion)}`),
      marginsFigure(motion), leftOut(motion), zmpFigure(motion), jointFigure(motion, joints)];
  });
  const lead = several ? 'These motions take the robot through the postures while it stands.'
    : `In ${seconds(motions[0])} this motion takes the robot through the postures while it stands${samples(motions[0])}.`;
  return section('motion', 'Motion', several ? 'The planned motions' : 'The planned motion', `${lead} The view of the robot above plays ${several ? 'them' : 'it'}.`, ...parts);
}
