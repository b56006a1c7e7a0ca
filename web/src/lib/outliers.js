// SPDX-License-Identifier: Apache-2.0
/** {trial, posture} of an outlier, whose number in the summary counts all trials. A table has lines, not trials. */
export function placeOf(outlier, report) {
  if (outlier.line) return {trial: '', posture: `${outlier.posture + 1} (line ${outlier.line})`};
  let first = 0;
  for (const scene of report.data?.scenes ?? []) {
    if (outlier.posture < first + scene.total) return {trial: scene.name, posture: String(outlier.posture - first + 1)};
    first += scene.total;
  }
  return {trial: '', posture: String(outlier.posture + 1)};
}

/**
 * One row for all outliers of a marker in a trial, and for markers that are outliers in the same
 * postures: [{trial, markers, postures, count, residual_mm, normalised}], largest residual first.
 * `place`: {trial, posture} of an outlier.
 */
export function outlierRows(outliers, place) {
  const own = new Map();
  for (const outlier of outliers) {
    const {trial, posture} = place(outlier);
    const key = JSON.stringify([trial, outlier.marker]);
    if (!own.has(key)) own.set(key, {trial, markers: [outlier.marker], postures: [], count: 0, residual_mm: 0, normalised: 0});
    const row = own.get(key);
    row.postures.push(posture);
    add(row, {count: 1, ...outlier});
  }
  const rows = new Map();
  for (const row of own.values()) {
    const key = JSON.stringify([row.trial, ...row.postures]);
    const same = rows.get(key);
    if (same) {
      same.markers.push(...row.markers);
      add(same, row);
    } else {
      rows.set(key, row);
    }
  }
  return [...rows.values()].sort((a, b) => b.residual_mm - a.residual_mm);
}

function add(row, {count, residual_mm, normalised}) {
  row.count += count;
  row.residual_mm = Math.max(row.residual_mm, residual_mm);
  row.normalised = Math.max(row.normalised, normalised);
}
