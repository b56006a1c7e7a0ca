import {h} from '../lib/dom.js';
import {count, fixed, plural, significant} from '../lib/format.js';
import {countByStatus} from '../lib/parameters.js';
import {judgedErrors, verdict} from '../lib/verdict.js';

function fact(value, unit, what) {
  return h('div', {class: 'fact'}, h('dt', {}, what),
           h('dd', {}, value, unit && h('span', {class: 'unit'}, ` ${unit}`)));
}

function facts(summary) {
  const errors = judgedErrors(summary);
  const counts = countByStatus(summary.parameters ?? [], (summary.legs ?? []).map((leg) => leg.name));
  const held = Object.entries(counts).reduce((sum, [status, n]) => status === 'estimated' ? sum : sum + n, 0);
  const outliers = (summary.outliers ?? []).length;
  return h('dl', {class: 'facts'},
    errors && fact([fixed(errors.before), h('span', {class: 'arrow', 'aria-label': 'to'}, ' → '),
                    h('strong', {}, fixed(errors.after))], 'mm', `RMSE ${errors.on.includes('held') || errors.on.includes('no part') ? 'on held-out data' : 'in sample'}`),
    fact(count(counts.estimated ?? 0), held ? `of ${count((counts.estimated ?? 0) + held)}` : '', 'joint and leg errors estimated'),
    fact(count(summary.postures), '', `postures, ${plural(summary.markers, 'marker')}`),
    fact(significant(summary.marker_sd_mm, 2), 'mm', 'noise of a marker coordinate'),
    fact(count(outliers), '', outliers === 1 ? 'outlier left out' : 'outliers left out'));
}

/** The head of the page: what came out, in one sentence, and the figures behind it. */
export function verdictSection(report) {
  const {summary} = report;
  if (!summary) return null;
  const result = verdict(summary);
  return h('section', {id: 'verdict', 'data-short': 'Verdict', class: `verdict state-${result.state}`, 'aria-labelledby': 'verdict-title'},
    h('h2', {id: 'verdict-title', class: 'verdict-word'}, h('span', {class: 'mark', 'aria-hidden': 'true'}), result.word),
    h('p', {class: 'verdict-sentence'}, result.sentence), h('p', {class: 'verdict-rest'}, result.rest),
    facts(summary));
}
