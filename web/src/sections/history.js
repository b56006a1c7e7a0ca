// SPDX-License-Identifier: Apache-2.0
import {SERIES} from '../lib/colours.js';
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure, section} from '../lib/figure.js';
import {list, probability, significant, withSd} from '../lib/format.js';
import {legend} from '../lib/legend.js';
import {offsetsOverTime} from '../lib/parameters.js';
import {table} from '../lib/table.js';

function offsetText(offset, unit) {
  if (!offset) return 'not estimated';
  const {value, sd} = withSd(offset.value, offset.sd);
  return [value, h('span', {class: 'unit'}, ` ± ${sd} ${unit}`)];
}

/** A row for each joint: the offset in each calibration with its 95 % interval, on a common scale. */
function dotsAndWhiskers(rows, labels) {
  const end = Math.max(1e-6, ...rows.flatMap((r) => r.of.filter(Boolean).map((o) => Math.abs(o.value) + 1.96 * o.sd)));
  const position = (x) => `${50 + 50 * x / end}%`;
  const mark = (offset, i) => offset && h('i', {class: 'whisker', style: {
    left: position(offset.value - 1.96 * offset.sd), width: `${50 * 2 * 1.96 * offset.sd / end}%`,
    '--key': SERIES[i % SERIES.length], top: `${(i + 0.5) / labels.length * 100}%`}, },
    h('i', {class: 'dot', style: {background: SERIES[i % SERIES.length]}}));
  return h('div', {}, legend(labels.map((text, i) => ({text, colour: SERIES[i % SERIES.length], shape: 'dot'}))),
    h('ol', {class: 'dumbbells offsets'}, ...rows.map((row) => h('li', {},
      h('span', {class: 'name'}, row.joint.replace(/_joint$/, '').replaceAll('_', ' ')),
      h('span', {class: 'track zero', style: {height: `${Math.max(20, 12 * labels.length)}px`}, 'aria-hidden': 'true'}, row.of.map(mark)),
      h('span', {class: 'figures'}, row.of.map((o) => h('span', {class: 'line'}, offsetText(o, row.unit))))))),
    h('p', {class: 'readout'}, `The vertical line is the nominal robot; the scale goes from −${significant(end)} to ${significant(end)} ${rows[0]?.unit ?? ''}. The dots are the estimates, the lines through them the 95 % intervals.`));
}

const SHOWN = 12;

function movedFigure(comparison) {
  const joints = (comparison.joints ?? []).slice(0, SHOWN);
  if (joints.length === 0) return null;
  return figure({title: 'Did joints move?', note: `${comparison.joints?.length > SHOWN ? `The table has the ${SHOWN} joints with the most significant changes; the CSV has all. ` : ''}Compared with ${comparison.a?.recording ?? 'the earlier calibration'}. F measures the change against the uncertainty of both calibrations; p is the probability of so large an F if the joint had not moved, adjusted for the number of joints.`,
    body: table({caption: 'Joints by significance of their change',
      columns: [{text: 'Joint'}, {text: 'F', number: true}, {text: 'p', number: true}, {text: 'Moved?'}],
      rows: joints.map((j) => [j.joint ?? j.name ?? '', significant(j.F), probability(j.p_adjusted), j.moved ? h('strong', {}, 'yes') : 'no'])}),
    data: {name: 'comparison.csv', text: () => toCsv(['joint', 'F', 'p_adjusted', 'moved'], comparison.joints.map((j) => [j.joint ?? j.name, j.F, j.p_adjusted, String(j.moved)]))}});
}

/** Fig. 7: this calibration and earlier ones. */
export function historySection(report) {
  const calibrations = report.calibrations ?? [];
  const rows = calibrations.length > 1 ? offsetsOverTime(calibrations) : [];
  const {comparison} = report;
  if (rows.length === 0 && !comparison) return null;
  const moved = comparison?.moved ?? [];
  const lead = comparison ? (moved.length > 0 ? `Since the earlier calibration, ${moved.length === 1 ? 'one joint has' : `${moved.length} joints have`} moved: ${list(moved)}.` : comparison.status === 'unchanged' ? 'No joint moved by more than the uncertainty of the two calibrations.' : 'The robot changed, but the data do not tell which joint moved.')
    : 'The figure shows the joint offsets that each calibration found.';
  const labels = calibrations.map((c) => c.label);
  return section('history', 'Over time', 'Calibrations over time', lead, comparison && movedFigure(comparison),
    rows.length > 0 && figure({title: 'Joint offsets', body: dotsAndWhiskers(rows, labels),
      data: {name: 'offsets_over_time.csv', text: () => toCsv(['joint', 'unit', ...labels.flatMap((l) => [l, `${l} sd`])],
        rows.map((r) => [r.joint, r.unit, ...r.of.flatMap((o) => [o?.value, o?.sd])]))}}));
}
