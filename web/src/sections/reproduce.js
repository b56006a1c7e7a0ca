// SPDX-License-Identifier: Apache-2.0
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure, section} from '../lib/figure.js';
import {count} from '../lib/format.js';
import {table} from '../lib/table.js';

function runBlock(run) {
  const facts = [['Version', run.version], ['Seed', run.seed === null || run.seed === undefined ? 'as in the project file' : String(run.seed)], ['Written', run.time]].filter(([, value]) => value);
  const inputs = run.inputs ?? [];
  return h('div', {class: 'run'}, h('h3', {}, run.command),
    h('pre', {tabindex: '0'}, h('code', {}, run.command_line)),
    h('p', {class: 'run-facts'}, facts.map(([name, value]) => h('span', {}, `${name} `, h('strong', {}, value)))),
    inputs.length > 0 && figure({title: 'Inputs', data: {name: `${run.command}_inputs.csv`, text: () => toCsv(['file', 'bytes', 'sha256'], inputs.map((i) => [i.file, i.bytes, i.sha256]))},
      body: table({caption: `Inputs of ${run.command}`, className: 'sums', columns: [{text: 'File'}, {text: 'Bytes', number: true}, {text: 'SHA-256'}],
        rows: inputs.map((i) => [i.file, count(i.bytes), h('code', {class: 'sum', title: i.sha256}, i.sha256)])})}));
}

/** How to reproduce this result. */
export function reproduceSection(report) {
  const runs = Object.entries(report.runs ?? {}).map(([command, run]) => ({command, ...run}));
  if (runs.length === 0) return null;
  return section('reproduce', 'Reproduce', 'How to reproduce this result', 'The same version, command line and inputs give the same result.', ...runs.map(runBlock));
}

/** Missing parts of this report, and the commands that make them. */
export function missingSection(report) {
  const missing = report.missing ?? [];
  if (missing.length === 0) return null;
  return section('missing', 'Missing', 'Not in this report', 'The folder has no data for these parts of the report. The command after each makes them.',
    h('ul', {class: 'missing'}, ...missing.map((m) => h('li', {}, `${m.what}: `, h('code', {}, m.command)))));
}
