// SPDX-License-Identifier: Apache-2.0
const listeners = new Set();
const darkWanted = matchMedia('(prefers-color-scheme: dark)');
const paper = matchMedia('print');
let printing = false;

/** Calls `listener` whenever the colours of the page change. */
export function onTheme(listener) {
  listeners.add(listener);
}

export function isDark() {
  if (printing || paper.matches) return false;
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === 'dark' : darkWanted.matches;
}

function tell() {
  for (const listener of listeners) listener();
}

export function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  tell();
}

darkWanted.addEventListener('change', tell);
paper.addEventListener('change', tell);
addEventListener('beforeprint', () => {
  printing = true;
  document.documentElement.classList.add('printing');
  tell();
});
addEventListener('afterprint', () => {
  printing = false;
  document.documentElement.classList.remove('printing');
  tell();
});
