/** {trial, posture} of an outlier; the summary counts the postures of all trials. A table has no trials, but lines. */
export function placeOf(outlier, report) {
  if (outlier.line) return {trial: '', posture: `${outlier.posture + 1} (line ${outlier.line})`};
  let first = 0;
  for (const scene of report.data?.scenes ?? []) {
    if (outlier.posture < first + scene.total) return {trial: scene.name, posture: String(outlier.posture - first + 1)};
    first += scene.total;
  }
  return {trial: '', posture: String(outlier.posture + 1)};
}

/** Outliers of one marker in one trial as one row: [{where, marker, count, residual_mm, normalised}], the largest first. */
export function outlierRows(outliers, place) {
  const rows = new Map();
  for (const outlier of outliers) {
    const {trial, posture} = place(outlier);
    const key = JSON.stringify([trial, outlier.marker]);
    const row = rows.get(key) ?? {trial, marker: outlier.marker, postures: [], residual_mm: 0, normalised: 0};
    row.postures.push(posture);
    row.residual_mm = Math.max(row.residual_mm, outlier.residual_mm);
    row.normalised = Math.max(row.normalised, outlier.normalised);
    rows.set(key, row);
  }
  return [...rows.values()].sort((a, b) => b.residual_mm - a.residual_mm);
}
