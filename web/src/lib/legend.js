// SPDX-License-Identifier: Apache-2.0
import {h} from './dom.js';

/** Explains colours. `items`: [{text, colour, shape: 'line' | 'dot'}]. */
export function legend(items) {
  return h('ul', {class: 'legend'}, ...items.map(({text, colour, shape, dashed}) => h('li', {},
    h('span', {class: `key ${shape ?? 'line'}${dashed ? ' dashed' : ''}`,
               style: {'--key': colour}, 'aria-hidden': 'true'}),
    text)));
}
