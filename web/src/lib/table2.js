// SPDX-License-Identifier: Apache-2.0
import {kindName} from './format.js';

const CASES = {SW: 'sine', RP: 'random', RM: 'repeatability'};
const readable = (chain) => chain.replaceAll('+', ' + ').replaceAll('_', ' ');

/** Rows of Table 2: chains and motions, then whole chains, then the mean. */
export function table2Rows(errors, models) {
  const values = (row, figure) => models.map((model) => row[figure]?.[model]);
  const row = (chain, motion, item) => ({chain, motion, rmse: values(item, 'rmse_3d_mm'), max: values(item, 'max_mm')});
  const rows = (errors.rows ?? []).map((item) =>
    row(readable(item.chain), kindName(CASES[item.case] ?? item.case), item));
  if ((errors.rows ?? []).length > (errors.chains ?? []).length) {
    rows.push(...errors.chains.map((item) => ({...row(readable(item.chain), 'all motions', item), total: true})));
  }
  rows.push({chain: 'Mean', motion: '', rmse: models.map((m) => errors.mean_rmse_3d_mm?.[m]), max: models.map(() => undefined), total: true});
  return rows;
}

/** Rows for recordings without trials for validation: in sample, and in held-out folds. */
export function inSampleRows(summary, models) {
  const row = (chain, motion, item) => ({chain, motion, rmse: models.map((m) => item.rmse_3d_mm?.[m]), max: models.map((m) => item.max_mm?.[m])});
  const rows = [row('All chains', 'those of the fit', summary)];
  if (summary.kfold) rows.push(row('All chains', `held out in turn, ${summary.kfold.folds} folds`, summary.kfold));
  return rows;
}
