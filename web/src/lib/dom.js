// SPDX-License-Identifier: Apache-2.0
/**
 * Makes an element. Texts become text nodes, so that no content of a user's file is read as HTML.
 * `attributes`: `class`, `onclick`-like listeners, booleans, `style` as an object of CSS properties;
 * others are set as they are.
 */
export function h(tag, attributes = {}, ...children) {
  const svg = tag === 'svg' || SVG_TAGS.has(tag);
  const element = svg ? document.createElementNS('http://www.w3.org/2000/svg', tag)
                      : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes ?? {})) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith('on')) {
      element.addEventListener(name.slice(2), value);
    } else if (name === 'style') {
      for (const [property, text] of Object.entries(value)) element.style.setProperty(property, text);
    } else {
      element.setAttribute(name, value === true ? '' : String(value));
    }
  }
  append(element, children);
  return element;
}

const SVG_TAGS = new Set(['g', 'line', 'circle', 'rect', 'path', 'text', 'title']);

function append(element, children) {
  for (const child of children) {
    if (child === undefined || child === null || child === false) continue;
    if (Array.isArray(child)) {
      append(element, child);
    } else {
      element.append(child);  // strings become text nodes
    }
  }
}

/** The current value of a CSS variable, which differs between light, dark and paper. */
export function cssColour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
