// SPDX-License-Identifier: Apache-2.0
import {saveText} from './csv.js';
import {h} from './dom.js';

/**
 * A figure with a title, a note and its data as CSV.
 * `data`: {name: file name, text: () => CSV}. The CSV is made only on request.
 */
export function figure({title, note, body, data, controls}) {
  const download = data && h('button', {
    class: 'quiet', type: 'button', onclick: () => saveText(data.name, data.text()),
    'aria-label': `Download the data of “${title}” as CSV`,
  }, 'CSV');
  return h('figure', {}, h('div', {class: 'figure-head'}, h('h3', {}, title), controls, download),
           body, note && h('figcaption', {}, note));
}

/** A section of the page with its heading, a short title for the contents, and a leading sentence. */
export function section(id, short, title, lead, ...children) {
  return h('section', {id, 'data-short': short, 'aria-labelledby': `${id}-title`},
           h('h2', {id: `${id}-title`}, title), lead && h('p', {class: 'lead'}, lead), ...children);
}

/** Buttons of which one is active. A change calls `choose(value)`. */
export function choice(label, options, chosen, choose) {
  const name = `choice-${++choice.count}`;
  return h('fieldset', {class: 'choice'}, h('legend', {class: 'sr-only'}, label),
           ...options.map(({value, text}) => h('label', {},
             h('input', {type: 'radio', name, value, checked: value === chosen,
                         onchange: () => choose(value)}),
             h('span', {}, text))));
}
choice.count = 0;
