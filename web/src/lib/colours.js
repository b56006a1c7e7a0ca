// SPDX-License-Identifier: Apache-2.0
// Okabe and Ito's palette, whose colours people with the usual colour-vision deficiencies can tell apart.
export const OKABE_ITO = {
  black: '#000000', orange: '#e69f00', sky: '#56b4e9', green: '#009e73',
  yellow: '#f0e442', blue: '#0072b2', vermillion: '#d55e00', purple: '#cc79a7',
};

/** Each model has one colour in all figures: warm before the calibration, blue after it. */
export const MODEL_COLOURS = {
  uncalibrated: OKABE_ITO.vermillion,
  offsets_only: OKABE_ITO.orange,
  geometric: OKABE_ITO.sky,
  rigid: OKABE_ITO.green,
  full: OKABE_ITO.blue,
  calibrated: OKABE_ITO.blue,
};

/** Colours of series that only need to differ. */
export const SERIES = [
  OKABE_ITO.blue, OKABE_ITO.orange, OKABE_ITO.green, OKABE_ITO.purple, OKABE_ITO.vermillion,
  OKABE_ITO.sky,
];

// Plasma (van der Walt and Smith) without its darkest colours. Its steps of lightness are even, so that
// every eye sees them.
const PLASMA = [
  [42, 5, 147], [92, 1, 166], [135, 7, 166], [175, 39, 146], [205, 74, 118], [228, 107, 92],
  [246, 144, 68], [253, 186, 44], [244, 234, 39],
];

function between(stops, t) {
  const x = Math.min(1, Math.max(0, t)) * (stops.length - 1);
  const i = Math.min(stops.length - 2, Math.floor(x));
  return stops[i].map((low, k) => Math.round(low + (x - i) * (stops[i + 1][k] - low)));
}

/** [r, g, b] in 0..255 for 0 (small) to 1 (large). */
export const sequential = (t) => between(PLASMA, t);

// Blue, near white or near black, vermillion.
const DIVERGING = {light: [247, 247, 245], dark: [28, 31, 36]};

/** [r, g, b] for -1 to 1. Zero has the colour of the page. */
export function diverging(t, dark) {
  const middle = dark ? DIVERGING.dark : DIVERGING.light;
  const end = t < 0 ? (dark ? [86, 180, 233] : [0, 94, 158]) : (dark ? [240, 128, 40] : [200, 80, 0]);
  return between([middle, end], Math.abs(t));
}

export const css = ([r, g, b]) => `rgb(${r} ${g} ${b})`;
