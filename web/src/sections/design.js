// SPDX-License-Identifier: Apache-2.0
import {SERIES} from '../lib/colours.js';
import {toCsv} from '../lib/csv.js';
import {chainRows, medianCurves} from '../lib/curves.js';
import {h} from '../lib/dom.js';
import {choice, figure, section} from '../lib/figure.js';
import {count, fixed, significant} from '../lib/format.js';
import {plot} from '../lib/plot.js';
import {table} from '../lib/table.js';

const ALGORITHMS = {nocp: 'NOCP', cocp: 'COCP', ioops: 'IOOPS'};

function curvesPlot(columns, chain, bound) {
  const {postures, curves} = medianCurves(columns, chain);
  const series = curves.map(({algorithm}, i) => ({text: ALGORITHMS[algorithm] ?? algorithm, colour: SERIES[i % SERIES.length], dots: true, spanGaps: true}));
  const data = [postures, ...curves.map((c) => c.o1)];
  if (typeof bound === 'number') {
    series.push({text: 'upper bound', colour: '#8a8f98', dashed: true});
    data.push(postures.map(() => bound));
  }
  return plot({label: `O1 against the number of postures, ${chain}`, x: {label: 'number of postures', short: 'postures', whole: true},
               y: {label: 'O1, median over seeds'}, series, data, height: 280});
}

/** Efficiency in per cent. Files give it as a share or in per cent. */
const percent = (x) => typeof x === 'number' ? fixed(x <= 1.5 ? 100 * x : x, 1) : '–';

function programme(summary) {
  const rows = chainRows(summary);
  if (rows.length === 0) return null;
  return figure({
    title: 'The chosen postures',
    note: 'No set of as many postures can have an O1 above the upper bound; the efficiency is O1 as a share of it. A chain without a search time has the mirrored postures of another.',
    body: table({caption: 'Designed postures by chain',
      columns: [{text: 'Chain'}, {text: 'Postures', number: true}, {text: 'O1', number: true}, {text: 'Upper bound', number: true}, {text: 'Efficiency', unit: '%', number: true}, {text: 'Search time', unit: 's', number: true}],
      rows: rows.map((r) => [(r.chain ?? r.name ?? '').replaceAll('_', ' '), count(r.postures), significant(r.o1), significant(r.bound), percent(r.efficiency), r.mirror_of ? '–' : significant(r.time_s, 2)])}),
    data: {name: 'programme.csv', text: () => toCsv(['chain', 'postures', 'o1', 'bound', 'efficiency', 'time_s'], rows.map((r) => [r.chain ?? r.name, r.postures, r.o1, r.bound, r.efficiency, r.time_s]))},
  });
}

/** Fig. 6: O1 against the number of postures. */
export function designSection(report) {
  const {design} = report;
  if (!design) return null;
  const columns = design.curves;
  const usable = ['algorithm', 'chain', 'postures', 'o1'].every((name) => columns?.[name]?.length);
  const chains = usable ? [...new Set(columns.chain.map(String))] : [];
  const bounds = new Map(chainRows(design.summary).map((r) => [r.chain ?? r.name, r.bound]));
  const holder = h('div', {class: 'hold-plot'});
  const show = (chain) => holder.replaceChildren(curvesPlot(columns, chain, bounds.get(chain)));
  if (usable) show(chains[0]);
  const names = usable ? Object.keys(columns) : [];
  return section('design', 'Postures', 'Choice of the postures',
    'The observability index O1 says how much a set of postures tells about the parameters: the larger it is, the smaller their standard deviations. The figure shows how it grows with the number of postures, for each algorithm.',
    usable && figure({title: 'O1 against the number of postures',
      body: [chains.length > 1 && choice('Chain', chains.map((c) => ({value: c, text: c.replaceAll('_', ' ')})), chains[0], show), holder],
      data: {name: 'o1_curves.csv', text: () => toCsv(names, columns[names[0]].map((_, i) => names.map((n) => columns[n][i])))}}),
    programme(design.summary));
}
