// SPDX-License-Identifier: Apache-2.0
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';

import {cssColour, h} from './dom.js';
import {significant, tick} from './format.js';
import {legend} from './legend.js';
import {onTheme} from './theme.js';

const FONT = '12px system-ui, sans-serif';
const WHOLE = [0, 1, 2, 3].flatMap((digits) => [1, 2, 5].map((step) => step * 10 ** digits));  // ticks for whole numbers

function axis(label, extra = {}) {
  const colour = cssColour('--muted');
  return {
    label, font: FONT, labelFont: FONT, stroke: colour, labelSize: 22, labelGap: 2, gap: 6,
    grid: {stroke: cssColour('--grid'), width: 1}, ticks: {stroke: cssColour('--grid'), width: 1, size: 4},
    values: (u, splits) => splits.map(tick), ...extra,
  };
}

/** Options of uPlot for one of our series. */
function seriesOptions(series) {
  const dots = series.dots ?? false;
  return {
    label: series.text,
    stroke: series.colour,
    width: dots === 'only' ? 0 : series.width ?? 1.75,
    dash: series.dashed ? [6, 4] : undefined,
    fill: series.fill,
    spanGaps: series.spanGaps ?? false,
    paths: dots === 'only' ? () => null : series.steps ? uPlot.paths.stepped({align: 1}) : undefined,
    points: {show: Boolean(dots), size: series.dotSize ?? 6, fill: series.colour, stroke: series.colour},
  };
}

/** Draws bands behind the lines, given as `[from, to]` on the x axis. */
function bandsPlugin(bands) {
  return {hooks: {drawClear: (u) => {
    u.ctx.save();
    u.ctx.fillStyle = cssColour('--band');
    for (const [from, to] of bands) {
      const left = u.valToPos(Math.max(from, u.scales.x.min), 'x', true);
      const right = u.valToPos(Math.min(to, u.scales.x.max), 'x', true);
      if (right > left) u.ctx.fillRect(left, u.bbox.top, right - left, u.bbox.height);
    }
    u.ctx.restore();
  }}};
}

/** Shows the numbers under the cursor in a line that always has its place. */
function readout(element, options) {
  return (u) => {
    const {idx} = u.cursor;
    if (idx === null || idx === undefined) {
      element.textContent = options.hint;
      return;
    }
    const parts = [`${options.x.short ?? options.x.label} ${significant(u.data[0][idx])}`];
    options.series.forEach((series, k) => {
      const value = u.data[k + 1][idx];
      if (value !== null && value !== undefined) parts.push(`${series.text} ${significant(value)}`);
    });
    element.textContent = parts.join('  ·  ');
  };
}

/** Left and right move the cursor, Home and End move it to the ends, Escape resets the zoom. */
function onKey(event, u, reset) {
  const last = u.data[0].length - 1;
  const now = u.cursor.idx ?? (event.key === 'ArrowLeft' ? last + 1 : -1);
  const to = {ArrowLeft: now - 1, ArrowRight: now + 1, Home: 0, End: last}[event.key];
  if (event.key === 'Escape') return reset();
  if (to === undefined) return undefined;
  event.preventDefault();
  const i = Math.min(last, Math.max(0, to));
  const left = u.valToPos(u.data[0][i], 'x');
  u.setCursor({left, top: u.over.clientHeight / 2});
  return undefined;
}

/**
 * A plot of columns against a common x. `options`: {x: {label, short, log, whole}, y: {label, min, log},
 * series: [{text, colour, dots, dashed, steps}], data: [x, y1, ...], bands, height, label}.
 * It has its height from the beginning, follows the width of the page, and is redrawn in the colours of
 * a new theme.
 */
export function plot(options) {
  const {height = 260, series, data} = options;
  // The hint appears once, but every plot has room for its line.
  const settings = {...options, hint: plot.explained ? '\u00a0' : 'Point at a plot, or focus it and use the arrow keys, to read values; drag to zoom, double-click to go back.'};
  plot.explained = true;
  const values = h('p', {class: 'readout'}, settings.hint);
  const holder = h('div', {class: 'plot', style: {height: `${height}px`}, tabindex: '0', role: 'img',
                           'aria-label': options.label ?? `Plot of ${options.y.label} against ${options.x.label}`});
  let u = null;
  const draw = () => {
    const width = Math.floor(holder.clientWidth);
    if (width < 50) return;
    u?.destroy();
    u = new uPlot({
      width, height, legend: {show: false}, cursor: {drag: {x: true, y: false}, points: {size: 7}},
      scales: {x: {time: false, distr: options.x.log ? 3 : 1},
               y: {distr: options.y.log ? 3 : 1, range: options.y.range}},
      axes: [axis(options.x.label, {size: 30, ...(options.x.whole && {incrs: WHOLE})}), axis(options.y.label, {size: 52})],
      series: [{}, ...series.map(seriesOptions)],
      plugins: options.bands ? [bandsPlugin(options.bands)] : [],
      hooks: {setCursor: [readout(values, settings)]},
    }, data, holder);
  };
  holder.addEventListener('keydown', (event) => u && onKey(event, u, draw));
  new ResizeObserver(() => {
    if (!u || Math.abs(u.width - holder.clientWidth) >= 1) draw();
  }).observe(holder);
  onTheme(draw);
  return h('div', {class: 'plot-block'}, series.length > 1 && legend(series.map((s) => ({...s, shape: s.dots === 'only' ? 'dot' : 'line'}))), holder, values);
}
