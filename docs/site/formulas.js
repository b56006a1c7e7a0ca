// SPDX-License-Identifier: Apache-2.0
// Draws the formulas that Sphinx wrote as \(...\) and \[...\], by KaTeX.
for (const element of document.querySelectorAll('.math')) {
  const formula = element.textContent.trim().slice(2, -2);
  katex.render(formula, element, {displayMode: element.tagName === 'DIV'});
}
