import {SERIES} from '../lib/colours.js';
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure, section} from '../lib/figure.js';
import {fixed, list, significant} from '../lib/format.js';
import {legend} from '../lib/legend.js';
import {offsetsOverTime} from '../lib/parameters.js';
import {table} from '../lib/table.js';

/** A row a joint: each calibration's offset with its 95 % interval, on one scale around zero. */
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
      h('span', {class: 'figures'}, row.of.map((o) => o ? fixed(o.value, 2) : '–').join(' · '), h('span', {class: 'unit'}, ` ${row.unit}`))))),
    h('p', {class: 'readout'}, `Scale: ±${significant(end)} ${rows[0]?.unit ?? ''}; whiskers are 95 % intervals.`));
}

function movedFigure(comparison) {
  const joints = (comparison.joints ?? []).slice(0, 12);
  if (joints.length === 0) return null;
  return figure({title: 'Did joints move?', note: `Against ${comparison.a?.recording ?? 'the earlier calibration'}; p without a change, adjusted for the number of joints.`,
    body: table({caption: 'Joints by significance of their change',
      columns: [{text: 'Joint'}, {text: 'F', number: true}, {text: 'p', number: true}, {text: 'Moved'}],
      rows: joints.map((j) => [j.joint ?? j.name ?? '', significant(j.F), significant(j.p_adjusted), j.moved ? h('strong', {}, 'yes') : 'no'])}),
    data: {name: 'comparison.csv', text: () => toCsv(['joint', 'F', 'p_adjusted', 'moved'], comparison.joints.map((j) => [j.joint ?? j.name, j.F, j.p_adjusted, String(j.moved)]))}});
}

/** Fig. 7: this calibration beside earlier ones. */
export function historySection(report) {
  const calibrations = report.calibrations ?? [];
  const rows = calibrations.length > 1 ? offsetsOverTime(calibrations) : [];
  const {comparison} = report;
  if (rows.length === 0 && !comparison) return null;
  const moved = comparison?.moved ?? [];
  const lead = comparison ? (moved.length > 0 ? `Moved since the earlier calibration: ${list(moved)}.` : comparison.status === 'unchanged' ? 'No joint moved by more than both calibrations are uncertain by.' : 'The robot changed, but no joint can be singled out.')
    : 'Offsets of the joints as each calibration found them.';
  const labels = calibrations.map((c) => c.label);
  return section('history', 'Over time', 'Calibrations over time', lead, comparison && movedFigure(comparison),
    rows.length > 0 && figure({title: 'Joint offsets', body: dotsAndWhiskers(rows, labels),
      data: {name: 'offsets_over_time.csv', text: () => toCsv(['joint', 'unit', ...labels.flatMap((l) => [l, `${l} sd`])],
        rows.map((r) => [r.joint, r.unit, ...r.of.flatMap((o) => [o?.value, o?.sd])]))}}));
}
