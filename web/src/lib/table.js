// SPDX-License-Identifier: Apache-2.0
import {h} from './dom.js';

/**
 * A table that scrolls if it is wider than the page. `columns`: [{text, unit, number}]. `rows`: arrays
 * of texts or nodes, of which the first is the heading of its row. A row may be {cells, class}.
 */
export function table({caption, columns, rows, className = ''}) {
  const head = columns.map((column) => h('th', {scope: 'col', class: column.number ? 'number' : ''},
    column.text, column.unit && h('span', {class: 'unit'}, ` ${column.unit}`)));
  const body = rows.map((row) => {
    const cells = row.cells ?? row;
    return h('tr', {class: row.class}, ...cells.map((cell, i) => {
      const kind = columns[i]?.number ? 'number' : '';
      return i === 0 ? h('th', {scope: 'row', class: kind}, cell) : h('td', {class: kind}, cell);
    }));
  });
  return h('div', {class: `table-scroll ${className}`, tabindex: '0', role: 'region',
                   'aria-label': caption},
    h('table', {}, h('caption', {class: 'sr-only'}, caption), h('thead', {}, h('tr', {}, ...head)),
      h('tbody', {}, ...body)));
}
