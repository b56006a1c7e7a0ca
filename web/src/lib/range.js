// SPDX-License-Identifier: Apache-2.0
import {h} from './dom.js';

/** A slider with its label and its value: {output, slider, row}. */
export function range(label, attributes, input) {
  const output = h('output', {});
  const slider = h('input', {type: 'range', 'aria-label': label, ...attributes, oninput: (e) => input(Number(e.target.value))});
  return {output, slider, row: h('label', {class: 'range'}, h('span', {}, label), slider, output)};
}
