/** Numbers as a person reads them; '–' where there is none. */
export function fixed(value, digits = 2) {
  if (typeof value !== 'number' || !Number.isFinite(value)) return '–';
  const text = value.toFixed(digits);
  return (Number(text) === 0 ? text.replace('-', '') : text).replace('-', '−');
}

/** Three significant digits, whatever the size. */
export function significant(value, digits = 3) {
  if (typeof value !== 'number' || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e9 || size < 1e-4) return value.toExponential(digits - 1).replace('-', '−');
  if (size >= 1e3) return count(Number(value.toPrecision(digits)));
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return fixed(value, decimals);
}

/** 12 345, with narrow spaces. */
export function count(value) {
  if (typeof value !== 'number' || !Number.isFinite(value)) return '–';
  return String(Math.round(value)).replace(/\B(?=(\d{3})+(?!\d))/g, '\u202f');
}

/** '1 posture', '2 postures'. */
export function plural(number, one, many = one + 's') {
  return `${count(number)} ${number === 1 ? one : many}`;
}

/** 'a', 'a and b', 'a, b and c'; beyond `most` the rest is counted. */
export function list(items, most = 6) {
  const shown = items.length > most ? [...items.slice(0, most), `${items.length - most} more`] : items;
  if (shown.length < 2) return shown.join('');
  return `${shown.slice(0, -1).join(', ')} and ${shown.at(-1)}`;
}

/** How units stand on the page. */
export function prettyUnit(unit) {
  return unit.replace('N.m', 'N·m').replace(/^deg$/, '°').replace(/^u(?=rad|m)/, 'µ');
}

const MODEL_NAMES = {
  uncalibrated: 'uncalibrated',
  offsets_only: 'offsets only',
  geometric: 'geometric',
  full: 'full',
  calibrated: 'calibrated',
};
export const modelName = (model) => MODEL_NAMES[model] ?? model;

const KIND_NAMES = {
  calibration: 'calibration postures',
  sine: 'sinusoidal motion',
  random: 'random postures',
  repeatability: 'repeatability motion',
};
export const kindName = (kind) => KIND_NAMES[kind] ?? kind;

/** Suffix of a key, what its numbers are multiplied by, and the unit to show. */
const SUFFIXES = [['_mm', 1, 'mm'], ['_m', 1e3, 'mm'], ['_share', 100, '%'], ['_deg', 1, '°'], ['_s', 1, 's']];

/** Numbers and texts of a nested object for a table: [name, value, unit]; lists are passed over. */
export function flatten(object, path = []) {
  return Object.entries(object ?? {}).flatMap(([key, value]) => {
    const [suffix, factor, unit] = SUFFIXES.find(([end]) => key.endsWith(end)) ?? ['', 1, ''];
    const here = [...path, key.slice(0, key.length - suffix.length).replaceAll('_', ' ')];
    if (typeof value === 'number') return [[here.join(', '), factor * value, unit]];
    if (typeof value === 'string' || typeof value === 'boolean') return [[here.join(', '), String(value), '']];
    return value && typeof value === 'object' && !Array.isArray(value) ? flatten(value, here) : [];
  });
}
