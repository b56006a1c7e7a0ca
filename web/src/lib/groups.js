// SPDX-License-Identifier: Apache-2.0
// Texts of warnings that say the same of several joints, markers, trials or times become one.
import {list} from './format.js';

const escaped = (name) => name.replace(/[.*+?^${}()|[\]\\]/g, '\\$&');
const NUMBER = '(?<![\\w.])[-−+]?\\d+(?:\\.\\d+)?(?:e[-+]?\\d+)?(?![\\w])';
const IDENTIFIER = '[\\w+-]*(?:\\w_\\w|[A-Za-z]\\d)[\\w+-]*(?:\\.\\w+)*';
const QUOTED = '"[^"]*"';

/** Finds names, known ones first and the longest of these first, and what looks like a name; then numbers. */
function slotPattern(known) {
  const names = [...new Set(known)].filter((name) => name.length > 1).sort((a, b) => b.length - a.length)
    .map((name) => `(?<![\\w])${escaped(name)}(?![\\w])`);
  const name = [QUOTED, ...names, IDENTIFIER].map((pattern) => `(?:${pattern})`).join('|');
  return new RegExp(`(?<names>(?:${name})(?:, (?:${name}))*)|(?<number>${NUMBER})`, 'g');
}

/** A text without its names and numbers, and the names that it had. */
function skeleton(text, pattern) {
  const names = [];
  const frame = text.replace(pattern, (found, ...rest) => {
    const {names: isName} = rest.at(-1);
    if (isName) names.push(found);
    return isName ? '\u0001' : '\u0002';
  });
  return {frame, names};
}

/** Of several lists of names the places where they are not all the same. */
const differing = (all) => all[0].map((_, k) => k).filter((k) => all.some((names) => names[k] !== all[0][k]));

/**
 * Texts that differ only in names and numbers, together, in the order of their first:
 * [{text, names, all}]. `text` is the first one, `names` says of whom or what each of the others
 * speaks (empty where only numbers differ), `all` has the whole texts. `known`: names of joints,
 * markers, trials and clusters; what looks like a name (arm_1, LF2, "x y") is one without that.
 */
export function groupTexts(texts, known = []) {
  const pattern = slotPattern(known);
  const groups = new Map();
  for (const text of texts) {
    const {frame, names} = skeleton(text, pattern);
    if (!groups.has(frame)) groups.set(frame, new Map());
    groups.get(frame).set(text, names);  // what is said twice word by word is said once
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

/** Every name that a summary knows: joints, markers, clusters, trials. */
export function knownNames(report) {
  const {summary = {}, data = {}} = report;
  const owners = (summary.parameters ?? []).map(({name}) => name.startsWith('marker.') ? name.split('.')[1] : name.slice(0, name.lastIndexOf('.')));
  const named = [data?.markers, data?.clusters, summary.trials, summary.legs].flatMap((items) => (items ?? []).map((item) => item.name));
  return [...owners, ...named].filter(Boolean);
}

/** A text as a sentence: with a capital where it begins with a word of the language, and an end. */
export function sentence(text, known = []) {
  const [first] = text.match(/^[a-z]+(?=[ ,:])/) ?? [''];
  const begun = first && !known.includes(first) ? text[0].toUpperCase() + text.slice(1) : text;
  return typeset(/[.?!]$/.test(begun) ? begun : `${begun}.`);
}

/** The program's '+-' and '-7.1' as they are printed: '±' and '−7.1'. */
export const typeset = (text) => text.replaceAll('+-', '±').replace(/(^|[\s(])-(?=\d)/g, '$1−');

/** {objections, remarks, warnings}, each text once: the warnings also have the remarks and the trials' findings. */
export function spoken(summary) {
  const objections = summary.objections ?? [];
  const remarks = (summary.remarks ?? []).filter((text) => !objections.includes(text));
  const elsewhere = new Set([...objections, ...remarks, ...(summary.trials ?? []).flatMap((trial) => trial.findings ?? [])]);
  return {objections, remarks, warnings: (summary.warnings ?? []).filter((text) => !elsewhere.has(text))};
}
