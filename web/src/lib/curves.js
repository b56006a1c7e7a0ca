// SPDX-License-Identifier: Apache-2.0
const median = (values) => {
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
};

/** For one chain: numbers of postures, and for each algorithm the median of O1 over the seeds. */
export function medianCurves(columns, chain) {
  const cells = new Map();
  columns.algorithm.forEach((algorithm, i) => {
    if (String(columns.chain[i]) !== chain) return;
    if (!cells.has(algorithm)) cells.set(algorithm, new Map());
    const postures = Number(columns.postures[i]);
    const values = cells.get(algorithm);
    values.set(postures, [...(values.get(postures) ?? []), Number(columns.o1[i])]);
  });
  const postures = [...new Set([...cells.values()].flatMap((v) => [...v.keys()]))].sort((a, b) => a - b);
  const curves = [...cells].map(([algorithm, values]) => ({
    algorithm: String(algorithm), o1: postures.map((n) => values.has(n) ? median(values.get(n)) : null)}));
  return {postures, curves};
}

/** Chains in the summary of `design`: an array, or an object by name, under `chains` or at the top level. */
export function chainRows(summary) {
  const chains = summary?.chains ?? summary ?? {};
  const rows = Array.isArray(chains) ? chains
    : Object.entries(chains).filter(([, row]) => typeof row === 'object' && row !== null).map(([chain, row]) => ({chain, ...row}));
  return rows.map((row) => ({...row, o1: row.o1 ?? row.index}));
}
