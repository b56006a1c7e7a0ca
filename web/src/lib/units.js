const DEGREE = Math.PI / 180;

/** By the SI unit of summary.json: the unit that people use, and how much of it one SI unit is. */
const USER = {
  'rad': {unit: '°', factor: 1 / DEGREE, digits: 3},
  'm': {unit: 'mm', factor: 1e3, digits: 2},
  'rad/(N.m)': {unit: 'µrad/(N·m)', factor: 1e6, digits: 1},
  'm/N': {unit: 'µm/N', factor: 1e6, digits: 2},
  'N.m': {unit: 'N·m', factor: 1, digits: 2},
  'N': {unit: 'N', factor: 1, digits: 1},
};

export const userUnit = (si) => USER[si] ?? {unit: si, factor: 1, digits: 4};

/** The stiffness that a compliance is the inverse of, with its unit; null for other parameters. */
export function stiffness(parameter) {
  if (!(parameter.value > 0)) return null;
  if (parameter.unit === 'rad/(N.m)') return {value: 1 / parameter.value, unit: 'N·m/rad'};
  if (parameter.unit === 'm/N') return {value: 1e-3 / parameter.value, unit: 'N/mm'};
  return null;
}
