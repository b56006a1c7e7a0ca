import {correlationFigure} from './correlation.js';
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure, section} from '../lib/figure.js';
import {count, list, significant} from '../lib/format.js';
import {byJoint, kindsOf, STATUS_WORDS} from '../lib/parameters.js';
import {table} from '../lib/table.js';

const MARKS = {estimated: '●', unsupported: '◐', dropped: '○', held: '×', not_in_model: '–'};
const SHORT = {estimated: 'estimated', unsupported: 'not supported by the data', dropped: 'dependent on others', held: 'held by the project', not_in_model: 'not in the model'};

function statusTable(summary) {
  const joints = byJoint(summary.parameters, (summary.legs ?? []).map((leg) => leg.name));
  const kinds = kindsOf(joints);
  const cell = (p) => p ? h('span', {class: `status ${p.status}`, title: `${p.name}: ${STATUS_WORDS[p.status] ?? p.status}`},
    MARKS[p.status] ?? '?', h('span', {class: 'sr-only'}, SHORT[p.status] ?? p.status)) : '';
  const present = Object.keys(MARKS).filter((s) => summary.parameters.some((p) => p.status === s));
  return figure({
    title: 'What each joint’s parameters became',
    note: present.map((s) => `${MARKS[s]} ${SHORT[s]}`).join('   '),
    body: table({caption: 'Status of each parameter', className: 'status-table',
      columns: [{text: 'Joint'}, ...kinds.map(({symbol, what}) => ({text: h('abbr', {title: what}, symbol)}))],
      rows: [...joints].map(([joint, own]) => [joint.replace(/_joint$/, '').replaceAll('_', ' '), ...kinds.map(({kind}) => cell(own.get(kind)))])}),
    data: {name: 'status.csv', text: () => toCsv(['parameter', 'status'], summary.parameters.map((p) => [p.name, p.status]))},
  });
}

function excitationFacts(summary) {
  const e = summary.excitation ?? {};
  const items = [
    ['Identifiable', `${count(summary.identifiable)}${summary.identifiable_theory ? ` of ${count(summary.identifiable_theory)} in theory` : ''}`],
    ['Equations', count(summary.equations)],
    ['Condition number', significant(e.condition_base)],
    ['O1', significant(e.O1)],
  ];
  return h('dl', {class: 'facts small'}, ...items.map(([what, value]) => h('div', {class: 'fact'}, h('dt', {}, what), h('dd', {}, value))));
}

/** What the recording could tell, and which parameters it could not tell apart. */
export function identifiabilitySection(report) {
  const {summary} = report;
  if (!summary?.parameters?.length) return null;
  const hardly = summary.excitation?.hardly_excited ?? [];
  const pairs = summary.correlations ?? [];
  const groups = summary.parameters.filter((p) => p.status === 'dropped').length;
  return section('identifiability', 'Identifiability', 'What the recording could tell',
    `${hardly.length > 0 ? `Hardly excited: ${list(hardly, 5)}. ` : ''}${groups} parameters depend on others whatever is measured; they are counted in those.`,
    excitationFacts(summary), statusTable(summary),
    correlationFigure(report.correlation, pairs));
}
