// SPDX-License-Identifier: Apache-2.0
// Warnings that say the same about several joints, markers, trials or times become one.
import {list} from './format.js';

const escaped = (name) => name.replace(/[.*+?^${}()|[\]\\]/g, '\\$&');
const NUMBER = '(?<![\\w.])[-−+]?\\d+(?:\\.\\d+)?(?:e[-+]?\\d+)?(?![\\w])';
const IDENTIFIER = '[\\w+-]*(?:\\w_\\w|[A-Za-z]\\d)[\\w+-]*(?:\\.\\w+)*';
const QUOTED = '"[^"]*"';

/** A pattern for known names (longest first), for words that look like names, and for numbers. */
function slotPattern(known) {
  const names = [...new Set(known)].filter((name) => name.length > 1).sort((a, b) => b.length - a.length)
    .map((name) => `(?<![\\w])${escaped(name)}(?![\\w])`);
  const name = [QUOTED, ...names, IDENTIFIER].map((pattern) => `(?:${pattern})`).join('|');
  return new RegExp(`(?<names>(?:${name})(?:, (?:${name}))*)|(?<number>${NUMBER})`, 'g');
}

/** A text without its names and numbers, and these names. */
function skeleton(text, pattern) {
  const names = [];
  const frame = text.replace(pattern, (found, ...rest) => {
    const {names: isName} = rest.at(-1);
    if (isName) names.push(found);
    return isName ? '\u0001' : '\u0002';
  });
  return {frame, names};
}

/** Places at which several lists of names differ. */
const differing = (all) => all[0].map((_, k) => k).filter((k) => all.some((names) => names[k] !== all[0][k]));

/**
 * Groups texts that differ only in names and numbers, in the order of their first: [{text, names, all}].
 * `text` is the first one, `names` are the subjects of the others (empty if only numbers differ), and
 * `all` has the whole texts. `known`: names of joints, markers, trials and clusters. Words that look
 * like names (arm_1, LF2, "x y") need not be known.
 */
export function groupTexts(texts, known = []) {
  const pattern = slotPattern(known);
  const groups = new Map();
  for (const text of texts) {
    const {frame, names} = skeleton(text, pattern);
    if (!groups.has(frame)) groups.set(frame, new Map());
    groups.get(frame).set(text, names);  // identical texts are kept once
  }
  return [...groups.values()].map((group) => {
    const all = [...group.keys()];
    const names = [...group.values()];
    const places = differing(names);
    const subjects = names.slice(1).map((own) => places.map((k) => own[k]).join(' / '));
    return {text: all[0], names: places.length > 0 ? [...new Set(subjects)] : [], all};
  });
}

/** 'The same is true of a, b and c.' or 'The same was found 3 more times.' for a group; '' for a single text. */
export function othersOf(group) {
  const more = group.all.length - 1;
  if (more === 0) return '';
  if (group.names.some((name) => name.includes(','))) return `The same is true of ${group.names.join('; ')}.`;
  if (group.names.length > 0) return `The same is true of ${list(group.names, Infinity)}.`;
  return `The same was found ${more === 1 ? 'once' : `${more} times`} more.`;
}

/** All names in a summary: joints, markers, clusters, trials. */
export function knownNames(report) {
  const {summary = {}, data = {}} = report;
  const owners = (summary.parameters ?? []).map(({name}) => name.startsWith('marker.') ? name.split('.')[1] : name.slice(0, name.lastIndexOf('.')));
  const named = [data?.markers, data?.clusters, summary.trials, summary.legs].flatMap((items) => (items ?? []).map((item) => item.name));
  return [...owners, ...named].filter(Boolean);
}

/** A text as a sentence: with a full stop, and with a capital unless it begins with a name. */
export function sentence(text, known = []) {
  const [first] = text.match(/^[a-z]+(?=[ ,:])/) ?? [''];
  const begun = first && !known.includes(first) ? text[0].toUpperCase() + text.slice(1) : text;
  return typeset(/[.?!]$/.test(begun) ? begun : `${begun}.`);
}

/** Replaces the program's '+-' and '-7.1' by '±' and '−7.1'. */
export const typeset = (text) => text.replaceAll('+-', '±').replace(/(^|[\s(])-(?=\d)/g, '$1−');

/** {objections, remarks, warnings} with each text once. (In a summary, warnings repeat remarks and findings.) */
export function spoken(summary) {
  const objections = summary.objections ?? [];
  const remarks = (summary.remarks ?? []).filter((text) => !objections.includes(text));
  const elsewhere = new Set([...objections, ...remarks, ...(summary.trials ?? []).flatMap((trial) => trial.findings ?? [])]);
  return {objections, remarks, warnings: (summary.warnings ?? []).filter((text) => !elsewhere.has(text))};
}
