// SPDX-License-Identifier: Apache-2.0
import {signedBytes, unpackTriangle} from '../lib/binary.js';
import {css, diverging} from '../lib/colours.js';
import {toCsv} from '../lib/csv.js';
import {h} from '../lib/dom.js';
import {figure} from '../lib/figure.js';
import {fixed} from '../lib/format.js';
import {isExternal, strongestPairs} from '../lib/parameters.js';
import {isDark, onTheme} from '../lib/theme.js';

function drawMap(canvas, matrix, shown) {
  const n = shown.length;
  canvas.width = canvas.height = n;
  const context = canvas.getContext('2d');
  const image = context.createImageData(n, n);
  const dark = isDark();
  shown.forEach((row, i) => shown.forEach((column, j) => {
    image.data.set([...diverging(matrix[row][column], dark), 255], 4 * (n * i + j));
  }));
  context.putImageData(image, 0, 0);
}

function colourScale() {
  const bar = h('span', {class: 'bar', 'aria-hidden': 'true'});
  const paint = () => bar.style.setProperty('background', `linear-gradient(90deg, ${[-1, -0.5, 0, 0.5, 1].map((t) => css(diverging(t, isDark()))).join(', ')})`);
  paint();
  onTheme(paint);
  return h('p', {class: 'colour-bar'}, h('span', {}, '−1'), bar, h('span', {}, '+1'));
}

function pairItem(p) {
  return h('li', {}, h('span', {}, `${p.first} and ${p.second}`), h('strong', {}, fixed(p.coefficient, Math.abs(p.coefficient) > 0.99 ? 4 : 2)));
}

/** The map of correlations between estimates. The pointer or the arrow keys select a pair, which is named. */
export function correlationFigure(correlation, pairs) {
  if (!correlation?.names?.length) return null;
  const {names} = correlation;
  const matrix = unpackTriangle(signedBytes(correlation.lower), names.length);
  let shown = [];
  const canvas = h('canvas', {class: 'map', tabindex: '0', role: 'img', 'aria-label': 'Map of correlations between estimated parameters; arrow keys move over it'});
  const readout = h('p', {class: 'readout'}, 'Point at the map, or move over it with the arrow keys, to read the names of a pair.');
  let at = [0, 0];
  const tell = () => {
    const [i, j] = at.map((k) => shown[Math.min(shown.length - 1, Math.max(0, k))]);
    readout.textContent = `${names[i]}  ·  ${names[j]}  ·  ${fixed(matrix[i][j])}`;
  };
  canvas.addEventListener('pointermove', (event) => {
    const box = canvas.getBoundingClientRect();
    at = [event.clientY - box.top, event.clientX - box.left].map((x) => Math.floor(x / box.width * shown.length));
    tell();
  });
  canvas.addEventListener('keydown', (event) => {
    const step = {ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1]}[event.key];
    if (!step) return;
    event.preventDefault();
    at = at.map((x, k) => Math.min(shown.length - 1, Math.max(0, x + step[k])));
    tell();
  });
  const draw = () => drawMap(canvas, matrix, shown);
  const list = h('ol', {class: 'pairs'});
  const listed = h('div', {}, h('h4', {}, 'Strongest pairs'), list);
  const choose = (withExternal) => {
    shown = names.map((_, i) => i).filter((i) => withExternal || !isExternal(names[i]));
    const strongest = strongestPairs(pairs, withExternal);
    list.replaceChildren(...strongest.map(pairItem));
    listed.hidden = strongest.length === 0;
    draw();
  };
  const all = h('label', {class: 'check'}, h('input', {type: 'checkbox', onchange: (e) => choose(e.target.checked)}), 'show waist and markers too');
  onTheme(draw);
  choose(false);
  return figure({
    title: 'Correlation of the estimates', controls: all,
    body: h('div', {class: 'map-block'}, h('div', {}, canvas, colourScale(), readout), listed),
    note: 'Each row and each column is an estimated parameter, in the order of the table above. Where a pair comes near +1 or −1, the recording determines a combination of the two much better than either one.',
    data: {name: 'correlation.csv', text: () => toCsv(['parameter', ...names], names.map((name, i) => [name, ...Array.from(matrix[i], (x) => Number(x.toFixed(2)))]))},
  });
}
