// SPDX-License-Identifier: Apache-2.0
const DEGREE = Math.PI / 180;

/** For each SI unit of summary.json: the unit that people use, and how many of it are one SI unit. */
const USER = {
  'rad': {unit: '°', factor: 1 / DEGREE, digits: 3},
  'm': {unit: 'mm', factor: 1e3, digits: 2},
  'rad/(N.m)': {unit: 'µrad/(N·m)', factor: 1e6, digits: 1},
  'm/N': {unit: 'µm/N', factor: 1e6, digits: 2},
  'N.m': {unit: 'N·m', factor: 1, digits: 2},
  'N': {unit: 'N', factor: 1, digits: 1},
  'm/h': {unit: 'mm/h', factor: 1e3, digits: 2},
  'm/rad': {unit: 'mm/rad', factor: 1e3, digits: 3},
  'rad/m': {unit: 'mrad/m', factor: 1e3, digits: 3},
};

export const userUnit = (si) => USER[si] ?? {unit: si, factor: 1, digits: 4};

/**
 * The inverse of a compliance, which is a stiffness, with its unit and its standard deviation to first
 * order; null for other parameters.
 */
export function stiffness(parameter) {
  if (!(parameter.value > 0)) return null;
  const inverse = {'rad/(N.m)': {factor: 1, unit: 'N·m/rad'}, 'm/N': {factor: 1e-3, unit: 'N/mm'}}[parameter.unit];
  if (!inverse) return null;
  const value = inverse.factor / parameter.value;
  return {value, sd: typeof parameter.sd === 'number' ? value * parameter.sd / parameter.value : null, unit: inverse.unit};
}

/** Ends of the stiffness's 95 % interval, the inverses of the compliance's ends; Infinity for a rigid joint. */
export function stiffnessInterval(parameter) {
  return [1, -1].map((sign) => stiffness({...parameter, value: parameter.value + sign * 1.96 * parameter.sd})?.value ?? Infinity);
}
