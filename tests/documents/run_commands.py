#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the commands of README.md and docs/ as a reader would give them.

  run_commands.py --source REPOSITORY --program elastocal --python MODULE_FOLDER --ctest NAMES --chain DIR WORK

Blocks marked `sh` and `python` are commands. Those of a document run one after the other in a folder of their own, which
has the files that the reader is told to have (USER_FILES). A comment above a block says that it does not run here, and why:

  <!-- covered by: NAME -->   the test NAME runs the same
  <!-- not run: REASON -->

In these blocks, and in sentences, the names of commands and options are compared with --help.
"""

import argparse
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path

BLOCK = re.compile(r"(?:^<!-- (covered by|not run): ([^\n]*?) -->\n)?^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
INLINE = re.compile(r"`elastocal ([a-z][^`]*)`")
ARM = "talos_left_arm_mocap/talos_left_arm_02_10_contact.csv"
TABLE = "talos_table_contact"

# The files that a reader of a document has, and what replaces them: parts of the repository, of the
# shared data, or of the demo's results.
COMMON = {name: f"source:{name}" for name in ("models", "examples", "tests", "docs")}
USER_FILES = {
    "README.md": {
        "my_robot.urdf": "source:tests/robots/arm6.urdf", "my_robot.srdf": "source:tests/documents/arm6.srdf",
        "talos_left_arm_02_10_contact.csv": f"shared:{ARM}", "another_day.csv": f"shared:{ARM}",
        "out_before": "chain:", "out_after": "chain:", "out_talos": "chain:", "motion.csv": "chain:sine.csv",
    },
    "docs/tutorial.md": {
        "my_robot.urdf": "source:tests/robots/arm6.urdf", "my_robot.srdf": "source:tests/documents/arm6.srdf",
        "project.yaml": "source:models/talos/project.yaml", "talos.urdf": "source:models/talos/talos.urdf",
        "experiment": "chain:recording", "other_day": "chain:recording_random", "experiment_autumn": "chain:recording",
    },
    "docs/diagnose.md": {"training.csv": f"shared:{ARM}"},
    "docs/python.md": {"talos_left_arm_02_10_contact.csv": f"shared:{ARM}"},
    "docs/howto/laser_tracker.md": {"arm.csv": f"shared:{ARM}", "arm_again.csv": f"shared:{ARM}"},
    "docs/howto/five_robots.md": {"tiago_arm.urdf": "shared:../robots/tiago/tiago_arm.urdf"},
    "docs/howto/table.md": {
        "left.csv": f"shared:{TABLE}/left.csv", "right.csv": f"shared:{TABLE}/right.csv",
        "another_day.csv": f"shared:{TABLE}/right.csv",
    },
    "docs/howto/ros2_control.md": {"out": "chain:", "motion.csv": "chain:sine.csv"},
    "docs/accuracy.md": {"../shared/data": "shared:"},
    "docs/howto/daily_check.md": {"out": "chain:", "today": "chain:recording"},
}


def prepare(document: str, args: argparse.Namespace) -> tuple[Path, str]:
    """The folder in which a document's commands run, and the first file that is missing."""
    folder = args.work / document.replace("/", "_").removesuffix(".md")
    (folder / "bin").mkdir(parents=True)
    (folder / "bin/elastocal").symlink_to(args.program)
    (folder / "bin/xdg-open").write_text('#!/bin/sh\ntest -s "$1"\n')
    (folder / "bin/xdg-open").chmod(0o755)
    places = {"source": args.source, "shared": args.shared, "chain": args.chain}
    missing = ""
    for name, origin in {**COMMON, **USER_FILES.get(document, {})}.items():
        kind, path = origin.split(":", 1)
        if not (places[kind] / path).exists():
            missing = missing or name
        elif origin == "chain:":  # commands add files to results: a copy without recordings
            shutil.copytree(args.chain, folder / name, ignore=shutil.ignore_patterns("recording*"))
        else:
            (folder / name).parent.mkdir(exist_ok=True)
            (folder / name).symlink_to(places[kind] / path)
    return folder, missing


class Help:
    """Commands and options as the program has them."""

    def __init__(self, program: Path) -> None:
        self.program, self.texts = program, {}

    def wrong(self, command: str) -> str:
        words = command.split()
        if words[0] not in self.texts:
            shown = subprocess.run([self.program, words[0], "--help"], capture_output=True, text=True)
            self.texts[words[0]] = shown.stdout if shown.returncode == 0 else ""
        if not self.texts[words[0]]:
            return f"there is no command {words[0]}"
        for option in re.findall(r"(?<!\S)--[a-z-]+", command):
            if not re.search(rf"{option}\b(?!-)", self.texts[words[0]]):
                return f"{words[0]} has no option {option}"
        return ""


def commands_of(block: str) -> list[str]:
    """The commands of elastocal in a block of the shell, without their first word."""
    joined = re.sub(r"\\\n\s*", " ", block)
    return re.findall(r"(?:^|; |&& )(?:elastocal|\$E|build/release/bin/elastocal) ([a-z][^;\n#]*)", joined, re.MULTILINE)


def wrong_scripts(block: str, source: Path) -> list[str]:
    """Scripts of the repository that a block calls but that are missing or cannot be run in this way."""
    calls = re.findall(r"^\s*(python3 )?((?:tests|scripts)/[\w./]+)", block, re.MULTILINE)
    return [f"{path} cannot be run" for by_python, path in calls
            if not os.access(source / path, os.R_OK if by_python else os.X_OK)]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("source", "program", "python", "chain", "ctest"):
        parser.add_argument(f"--{name}", required=True, type=Path)
    parser.add_argument("work", type=Path)
    args = parser.parse_args()
    args.shared = Path(os.environ.get("ELASTOCAL_SHARED_DATA", args.source / "../shared/data")).resolve()
    shutil.rmtree(args.work, ignore_errors=True)
    tests = set(re.findall(r"^\s*Test\s+#\d+: (\S+)", subprocess.run(
        ["ctest", "-N"], cwd=args.ctest, capture_output=True, text=True).stdout, re.MULTILINE))

    known, errors, run, listed = Help(args.program), [], 0, []
    for path in [args.source / "README.md", *sorted((args.source / "docs").rglob("*.md"))]:
        document, text = str(path.relative_to(args.source)), path.read_text()
        folder, missing = None, ""
        for match in BLOCK.finditer(text):
            mark, reason, language, block = match.groups()
            place = f"{document}:{text[: match.start(4)].count(chr(10)) + 1}"
            if language not in ("sh", "python"):
                if commands_of(block):
                    errors.append(f"{place}: a command in a block that is not marked sh")
                continue
            errors += [f"{place}: {wrong}" for c in commands_of(block) if (wrong := known.wrong(c))]
            errors += [f"{place}: {wrong}" for wrong in wrong_scripts(block, args.source)]
            if mark == "covered by" and reason not in tests:
                errors.append(f"{place}: there is no test {reason}")
            if not mark:
                if folder is None:
                    folder, missing = prepare(document, args)
                if missing:
                    mark, reason = "not run", f"{missing} is not here"
            if mark:
                listed.append(f"{place}: {mark} {reason}")
                continue
            begin = time.monotonic()
            done = subprocess.run(
                ["bash", "-e", "-c", block] if language == "sh" else [sys.executable, "-c", block], cwd=folder,
                capture_output=True, text=True, stdin=subprocess.DEVNULL,
                env={**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}", "PYTHONPATH": str(args.python),
                     "E": shlex.quote(str(args.program)), "ELASTOCAL_SHARED_DATA": str(args.shared)})
            print(f"{place}: ran, {time.monotonic() - begin:.1f} s", flush=True)
            run += 1
            if done.returncode:
                errors.append(f"{place}: ended with {done.returncode}\n{block}{done.stdout[-1500:]}{done.stderr[-1500:]}")
        sentences = BLOCK.sub(lambda m: "\n" * m[0].count("\n"), text)
        for match in INLINE.finditer(sentences):
            if wrong := known.wrong(match[1]):
                errors.append(f"{document}:{sentences[: match.start()].count(chr(10)) + 1}: {wrong}")
    print(*listed, f"{run} blocks ran, {len(listed)} did not", sep="\n")
    print(*errors, sep="\n", file=sys.stderr)
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
