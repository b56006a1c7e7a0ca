// SPDX-License-Identifier: Apache-2.0
/** A number for people to read, or '–' if there is none. */
export function fixed(value, digits = 2) {
  if (typeof value !== 'number' || !Number.isFinite(value)) return '–';
  const text = value.toFixed(digits);
  return (Number(text) === 0 ? text.replace('-', '') : text).replace('-', '−');
}

/** The power of ten of the first digit after rounding to so many digits: −1 for 0.0996 with two digits. */
const power = (value, digits) => Number(value.toExponential(digits - 1).split('e')[1]);

const SUPERSCRIPTS = {'-': '⁻', 0: '⁰', 1: '¹', 2: '²', 3: '³', 4: '⁴', 5: '⁵', 6: '⁶', 7: '⁷', 8: '⁸', 9: '⁹'};

/** 1.2·10⁻⁹ */
function exponential(value, digits) {
  const [mantissa, exponent] = value.toExponential(digits - 1).replace('e+', 'e').split('e');
  return `${mantissa.replace('-', '−')}·10${[...exponent].map((c) => SUPERSCRIPTS[c]).join('')}`;
}

/** A number of any size with three significant digits. */
export function significant(value, digits = 3) {
  if (typeof value !== 'number' || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e9 || size < 1e-4) return exponential(value, digits);
  return rounded(value, digits - 1 - power(value, digits));
}

/** Rounds to so many decimals. A negative number of decimals rounds to tens, hundreds and so on. */
function rounded(value, decimals) {
  if (decimals > 0) return fixed(value, decimals);
  const step = 10 ** -decimals;
  return count(step * Math.round(value / step));
}

const MOST_DECIMALS = 8;  // smaller standard deviations have a power of ten

/**
 * An estimate and its standard deviation as texts {value, sd}. The standard deviation has two
 * significant digits, and the estimate has the same decimals. Without a standard deviation (zero,
 * infinite or none), the estimate has `decimals`.
 */
export function withSd(value, sd, decimals = 2) {
  const known = typeof sd === 'number' && Number.isFinite(sd) && sd > 0;
  if (!known) return {value: fixed(value, decimals), sd: sd === 0 ? '0' : '–'};
  const same = 1 - power(sd, 2);
  if (same > MOST_DECIMALS) return {value: fixed(value, MOST_DECIMALS), sd: exponential(sd, 2)};
  return {value: Number.isFinite(value) ? rounded(value, same) : '–', sd: rounded(Number(sd.toPrecision(2)), same)};
}

/** 'low to high' with as many decimals as two significant digits of half their distance need; '∞' for no end. */
export function interval(low, high) {
  const half = (high - low) / 2;
  const end = (x) => !Number.isFinite(x) ? (x < 0 ? '−∞' : '∞') : Number.isFinite(half) && half > 0 ? withSd(x, half).value : significant(x);
  return `${end(low)} to ${end(high)}`;
}

/** The probability of a test. The digits of very small ones are not shown. */
export function probability(p) {
  if (typeof p !== 'number' || !Number.isFinite(p)) return '–';
  return p < 1e-4 ? '< 0.0001' : significant(p, 2);
}

/** The digits of a whole number with a minus sign, and narrow spaces between thousands. */
const grouped = (digits) => digits.replace('-', '−').replace(/\B(?=(\d{3})+(?!\d))/g, '\u202f');

/** 12 345, with narrow spaces. */
export function count(value) {
  if (typeof value !== 'number' || !Number.isFinite(value)) return '–';
  return grouped(String(Math.round(value))).replace(/^−0$/, '0');
}

/** The label of a tick with all its decimals, or none if the axis has no text there. */
export function tick(value) {
  if (value === null || value === undefined) return '';
  const [whole, decimals] = String(Number(value.toPrecision(9))).split('.');
  return decimals === undefined ? grouped(whole) : `${grouped(whole)}.${decimals}`;
}

/** '1 posture', '2 postures'. */
export function plural(number, one, many = one + 's') {
  return `${count(number)} ${number === 1 ? one : many}`;
}

/** 'a', 'a and b', 'a, b and c'. Items beyond `most` are counted. */
export function list(items, most = 6) {
  const shown = items.length > most ? [...items.slice(0, most), `${items.length - most} more`] : items;
  if (shown.length < 2) return shown.join('');
  return `${shown.slice(0, -1).join(', ')} and ${shown.at(-1)}`;
}

/** Units as the page shows them. */
export function prettyUnit(unit) {
  return unit.replace('N.m', 'N·m').replace(/^deg$/, '°').replace(/^u(?=rad|m)/, 'µ');
}

const MODEL_NAMES = {
  uncalibrated: 'uncalibrated',
  offsets_only: 'offsets only',
  geometric: 'geometric',
  rigid: 'rigid',
  full: 'full',
  calibrated: 'calibrated',
  urdf: 'calibrated URDF',
};
export const modelName = (model) => MODEL_NAMES[model] ?? model;

const KIND_NAMES = {
  calibration: 'calibration postures',
  sine: 'sinusoidal motion',
  random: 'random postures',
  repeatability: 'repeatability motion',
};
export const kindName = (kind) => KIND_NAMES[kind] ?? kind;

/** Suffix of a key, factor for its numbers, and unit to show. */
const SUFFIXES = [['_mm', 1, 'mm'], ['_m', 1e3, 'mm'], ['_share', 100, '%'], ['_deg', 1, '°'], ['_s', 1, 's']];

/** Numbers and texts of a nested object for a table: [name, value, unit]. Lists are skipped. */
export function flatten(object, path = []) {
  return Object.entries(object ?? {}).flatMap(([key, value]) => {
    const [suffix, factor, unit] = SUFFIXES.find(([end]) => key.endsWith(end)) ?? ['', 1, ''];
    const here = [...path, key.slice(0, key.length - suffix.length).replaceAll('_', ' ')];
    if (typeof value === 'number') return [[here.join(', '), factor * value, unit]];
    if (typeof value === 'string' || typeof value === 'boolean') return [[here.join(', '), String(value), '']];
    return value && typeof value === 'object' && !Array.isArray(value) ? flatten(value, here) : [];
  });
}
