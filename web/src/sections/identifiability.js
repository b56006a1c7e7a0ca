// SPDX-License-Identifier: Apache-2.0
import {correlationFigure} from './correlation.js';
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure, section} from '../lib/figure.js';
import {count, list, significant} from '../lib/format.js';
import {byJoint, kindsOf, STATUS_WORDS} from '../lib/parameters.js';
import {table} from '../lib/table.js';

const MARKS = {estimated: '●', unsupported: '◐', held: '×', not_in_model: '–'};
const SHORT = {estimated: 'estimated', unsupported: 'told hardly, or only together with others', held: 'kept at nominal by the project file', not_in_model: 'not in the model'};

function statusTable(summary) {
  const joints = byJoint(summary.parameters, (summary.legs ?? []).map((leg) => leg.name));
  const kinds = kindsOf(joints);
  const cell = (p) => p ? h('span', {class: `status ${p.status}`, title: `${p.name}: ${STATUS_WORDS[p.status] ?? p.status}`},
    MARKS[p.status] ?? '?', h('span', {class: 'sr-only'}, SHORT[p.status] ?? p.status)) : '';
  const shown = new Set([...joints.values()].flatMap((own) => [...own.values()].map((p) => p.status)));
  const present = Object.keys(MARKS).filter((status) => shown.has(status));
  return figure({
    title: 'What became of each parameter',
    note: present.map((s) => `${MARKS[s]}\u00a0${SHORT[s]}`).join(',  '),
    body: table({caption: 'Status of each parameter', className: 'status-table',
      columns: [{text: 'Joint'}, ...kinds.map(({symbol, what}) => ({text: h('abbr', {title: what}, symbol)}))],
      rows: [...joints].map(([joint, own]) => [joint.replace(/_joint$/, '').replaceAll('_', ' '), ...kinds.map(({kind}) => cell(own.get(kind)))])}),
    data: {name: 'status.csv', text: () => toCsv(['parameter', 'status'], summary.parameters.map((p) => [p.name, p.status]))},
  });
}

/** Figures of the recording with their meaning: [words, value]. */
function excitationFacts(summary) {
  const e = summary.excitation ?? {};
  const theory = summary.identifiable_theory ? `of ${count(summary.identifiable_theory)} parameters that are identifiable in theory` : 'identifiable parameters';
  const items = [
    [theory, count(summary.identifiable)],
    ['equations: measured marker coordinates', count(summary.equations)],
    ['condition number: 1 would be best', significant(e.condition_base)],
    ['O1: the larger, the smaller the standard deviations', significant(e.O1)],
  ].filter(([, value]) => value !== '–');
  return h('dl', {class: 'facts small'}, ...items.map(([what, value]) => h('div', {class: 'fact'}, h('dt', {}, what), h('dd', {}, value))));
}

/** The parameters that the recording determines, and those that it cannot tell apart. */
export function identifiabilitySection(report) {
  const {summary} = report;
  if (!summary?.parameters?.length) return null;
  const hardly = summary.excitation?.hardly_excited ?? [];
  const pairs = summary.correlations ?? [];
  const lead = [
    hardly.length > 0 && `The postures hardly excite ${list(hardly, 5)}.`,
  ].filter(Boolean).join(' ');
  return section('identifiability', 'Identifiability', 'What the recording could tell', lead,
    excitationFacts(summary), statusTable(summary),
    correlationFigure(report.correlation, pairs));
}
