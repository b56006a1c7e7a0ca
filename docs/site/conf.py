# SPDX-License-Identifier: Apache-2.0
"""Sphinx: the documentation as pages that need no network (target `site`, cmake/ElastocalSite.cmake)."""

project = "elastocal"
html_title = "elastocal"
copyright = "2026 The authors of elastocal, Apache-2.0"
extensions = ["myst_parser", "sphinx.ext.mathjax"]
root_doc = "index"
exclude_patterns = ["models/*/README.md"]

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4  # links to headings, as on GitHub
highlight_language = "none"

html_theme = "furo"
html_copy_source = False
html_show_sphinx = False
html_static_path = ["static"]
html_extra_path = ["extra"]  # the C++ reference by Doxygen, the demo's report
html_css_files = ["katex/katex.min.css", "site.css"]
# KaTeX in place of MathJax: a hundredth of the files. It is in the pages with formulas alone.
mathjax_path = "katex/katex.min.js"
mathjax_options = {"defer": "defer"}
html_js_files = [("formulas.js", {"defer": "defer"})]
