#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Lays out the sources of the documentation site in an empty folder, for Sphinx.

  make_pages.py --source REPOSITORY --program elastocal --api HTML_OF_DOXYGEN --report REPORT.html --katex DIR FOLDER

The files keep their places, so that links between them hold. Added are the page of the commands, from their own
--help, and that of the Python module, from elastocal.pyi. Where there is no REPORT, the quick demo makes one.
"""

import argparse
import ast
import re
import shutil
import subprocess
from pathlib import Path

COPIED = ["docs", "examples", "models", "README.md", "CONTRIBUTING.md", "CHANGELOG.md"]


def commands_page(program: str) -> str:
    """Each command with its help."""

    def help_of(*words: str) -> str:
        return subprocess.run([program, *words, "--help"], check=True, capture_output=True, text=True).stdout

    top = help_of()
    listed = top.split("Subcommands:\n")[1].split("\n\n")[0]
    names = re.findall(r"^  (\w+) ", listed, re.MULTILINE)
    parts = ["# Commands", f"```text\n{top}```"]
    parts += [f"## {name}\n\n```text\n{help_of(name)}```" for name in names]
    return "\n\n".join(parts) + "\n"


def python_page(stub: str) -> str:
    """Classes and functions of the stub file, with what it says of them."""

    def entry(node: ast.stmt) -> str:
        kind = "class" if isinstance(node, ast.ClassDef) else "function"
        return f"## {kind} {node.name}\n\n```python\n{ast.get_source_segment(stub, node)}\n```"

    module = ast.parse(stub)
    shown = [n for n in module.body if isinstance(n, (ast.ClassDef, ast.FunctionDef)) and not n.name.startswith("_")]
    head = f"# Python module\n\n{ast.get_docstring(module)} [Examples](docs/python.md).\n\n`_Array` is a NumPy array of " \
        "numbers, `_Path` a `str` or a `Path`."
    return "\n\n".join([head, *map(entry, shown)]) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("source", "program", "api", "report", "katex"):
        parser.add_argument(f"--{name}", required=True)
    parser.add_argument("folder", type=Path)
    args = parser.parse_args()

    source, folder = Path(args.source), args.folder
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name in COPIED:
        if (source / name).is_dir():
            shutil.copytree(source / name, folder / name, ignore=shutil.ignore_patterns("site"))
        else:
            shutil.copy(source / name, folder / name)
    shutil.copy(source / "docs/site/index.md", folder)
    shutil.copy(source / "docs/site/conf.py", folder)
    (folder / "commands.md").write_text(commands_page(args.program))
    (folder / "python_api.md").write_text(python_page((source / "python/elastocal.pyi").read_text()))
    (folder / "cpp_api.md").write_text(
        '# C++ libraries\n\nFrom the headers, by Doxygen: <a href="api/annotated.html">classes</a>, '
        '<a href="api/namespacemembers_func.html">functions</a>, <a href="api/files.html">headers</a>. '
        "Begin with [an example](examples/calibrate_recording.cpp).\n")

    shutil.copytree(args.katex, folder / "static/katex",
                    ignore=shutil.ignore_patterns("*.mjs", "katex.js", "katex.css", "contrib"))
    for name in ("formulas.js", "site.css"):
        shutil.copy(source / "docs/site" / name, folder / "static")
    shutil.copytree(args.api, folder / "extra/api")
    report = Path(args.report)
    if not report.exists():
        subprocess.run([args.program, "demo", "--quick", "--quiet", "-o", folder / "demo"], check=True)
        report = folder / "demo/report.html"
    shutil.copy(report, folder / "extra/report.html")
    shutil.rmtree(folder / "demo", ignore_errors=True)


if __name__ == "__main__":
    main()
