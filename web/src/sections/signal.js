// SPDX-License-Identifier: Apache-2.0
import {floats} from '../lib/binary.js';
import {columnsToCsv} from '../lib/csv.js';
import {OKABE_ITO} from '../lib/colours.js';
import {h} from '../lib/dom.js';
import {figure, section} from '../lib/figure.js';
import {fixed, plural} from '../lib/format.js';
import {plot} from '../lib/plot.js';

/** Columns of an excerpt: time, raw, filtered, and filtered in the chosen frames only. */
export function signalColumns(signal) {
  const millimetres = (text) => Array.from(floats(text), (x) => Number.isFinite(x) ? 1e3 * x : null);
  const filtered = millimetres(signal.filtered);
  const raw = millimetres(signal.raw);
  const time = filtered.map((_, i) => i / signal.rate_hz);
  const chosen = new Set(signal.chosen);
  return {time, raw, filtered, chosen: filtered.map((x, i) => chosen.has(i) ? x : null)};
}

function signalPlot(signal) {
  const {time, raw, filtered, chosen} = signalColumns(signal);
  return plot({
    label: `Signal of marker ${signal.marker} in ${signal.trial}`,
    x: {label: 'time [s]', short: 's'}, y: {label: `marker ${signal.marker}, ${signal.axis} [mm]`},
    series: [{text: 'raw', colour: '#9aa0a8', width: 1}, {text: 'filtered', colour: OKABE_ITO.blue},
             {text: 'chosen sample', colour: OKABE_ITO.vermillion, dots: 'only', dotSize: 5}],
    data: [time, raw, filtered, chosen],
    bands: signal.rests.map(([from, to]) => [from / signal.rate_hz, to / signal.rate_hz]),
    height: 300,
  });
}

/** Fig. 4: the filtered signal and its chosen samples. */
export function signalSection(report) {
  const signals = report.data?.signals ?? [];
  if (signals.length === 0) return null;
  let chosen = signals[0];
  const holder = h('div', {class: 'hold-plot'}, signalPlot(chosen));
  const note = h('span', {});
  const describe = () => { note.textContent = `The robot rests where the plot is shaded: all markers together are slower than ${fixed(chosen.threshold_mm_per_s, 1)} mm/s there. ${plural(chosen.chosen.length, 'frame')} of ${plural(chosen.rests.length, 'rest')} became samples.`; };
  describe();
  const chooser = signals.length > 1 && h('label', {class: 'select'}, h('span', {}, 'Trial'),
    h('select', {onchange: (e) => { chosen = signals[Number(e.target.value)]; holder.replaceChildren(signalPlot(chosen)); describe(); }},
      ...signals.map((s, i) => h('option', {value: i}, s.trial))));
  return section('signal', 'Signal', 'From the cameras to samples',
    'The plot shows one coordinate of the marker that moves most, as measured and low-pass filtered without delay, and the frames at rest from which the postures come.',
    figure({title: 'Filtered signal and chosen samples', body: [chooser, holder], note,
      data: {name: 'signal.csv', text: () => {
        const {time, raw, filtered, chosen: dots} = signalColumns(chosen);
        return columnsToCsv(['time_s', 'raw_mm', 'filtered_mm', 'chosen_mm'], [time, raw, filtered, dots]);
      }}}));
}
