// SPDX-License-Identifier: Apache-2.0
import {h} from '../lib/dom.js';
import {count, fixed, list, plural, significant} from '../lib/format.js';
import {countByStatus} from '../lib/parameters.js';
import {groupTexts, knownNames, spoken} from '../lib/groups.js';
import {verdict} from '../lib/verdict.js';

function fact(value, unit, what) {
  return h('div', {class: 'fact'}, h('dt', {}, what),
           h('dd', {}, value, unit && h('span', {class: 'unit'}, ` ${unit}`)));
}

/** A link to the findings further down, which the reader must see. */
function linkToFindings(report) {
  const names = knownNames(report);
  const {objections, remarks, warnings} = spoken(report.summary);
  const numbers = [[objections, 'objection'], [remarks, 'remark'], [warnings, 'warning']]
    .map(([texts, word]) => [groupTexts(texts, names).length, word]).filter(([n]) => n > 0);
  if (numbers.length === 0) return null;
  return h('p', {class: 'verdict-link'}, h('a', {href: '#findings'}, `Read ${list(numbers.map(([n, word]) => plural(n, word)))}`));
}

/** Words, followed by the interval for the error of many such postures. */
const withInterval = (words, ends) => ends ? `${words} (95 % interval for many such postures: ${fixed(ends[0])} to ${fixed(ends[1])})` : words;

/** The error with a controller that corrects elasticity as well; nothing if the model is the same. */
function compensatedFact(errors, causes) {
  if (typeof errors?.compensated !== 'number' || errors.compensated === errors.after) return null;
  const what = causes.length === 0 ? 'elasticity, of which a URDF has none' : `elasticity and ${plural(causes.length, 'other cause')}, which a URDF cannot carry`;
  return fact(fixed(errors.compensated), 'mm', withInterval(`the same with compensation of ${what}`, errors.compensatedInterval));
}

/** Uncertainty in the URDF of the least known end of a limb, which no marker shows. */
function frameFact(frames) {
  if (!frames?.length) return null;
  const worst = frames.reduce((a, b) => b.position_sd_mm > a.position_sd_mm ? b : a);
  return fact(significant(worst.position_sd_mm, 2), 'mm',
    `expected error (sd) of ${worst.link} against the root link, unseen by fitted markers`);
}

const FIT = /themselves/;

function facts(summary, errors) {
  const counts = countByStatus(summary.parameters ?? [], (summary.legs ?? []).map((leg) => leg.name));
  const held = Object.entries(counts).reduce((sum, [status, n]) => status === 'estimated' ? sum : sum + n, 0);
  const outliers = (summary.outliers ?? []).length;
  return h('dl', {class: 'facts'},
    errors && fact([fixed(errors.before), h('span', {class: 'arrow', 'aria-label': 'to'}, ' → '),
                    h('strong', {}, fixed(errors.after))], 'mm', withInterval(`RMSE of the marker distances ${FIT.test(errors.on) ? 'on the data of the fit' : 'on held-out data'}`, errors.interval)),
    compensatedFact(errors, summary.extra ?? []),
    frameFact(summary.frames),
    fact(count(counts.estimated ?? 0), held ? `of ${count((counts.estimated ?? 0) + held)}` : '', 'joint and leg errors estimated'),
    fact(count(summary.postures), '', `postures, ${plural(summary.markers, 'marker')}`),
    fact(significant(summary.marker_sd_mm, 2), 'mm', 'standard deviation of the noise of a marker coordinate'),
    fact(count(outliers), '', outliers === 1 ? 'outlier left out' : 'outliers left out'));
}

/** The head of the page: the result in one sentence, and its figures. */
export function verdictSection(report) {
  const {summary, validation} = report;
  if (!summary) return null;
  const result = verdict(summary, validation);
  return h('section', {id: 'verdict', 'data-short': 'Verdict', class: `verdict state-${result.state}`, 'aria-labelledby': 'verdict-title'},
    h('h2', {id: 'verdict-title', class: 'verdict-word'}, h('span', {class: 'mark', 'aria-hidden': 'true'}), result.word),
    h('p', {class: 'verdict-sentence'}, result.sentence), h('p', {class: 'verdict-rest'}, result.rest),
    linkToFindings(report), facts(summary, result.errors));
}
