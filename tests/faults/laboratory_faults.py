#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Puts faults of a laboratory into a simulated recording and says what `calibrate` makes of them.

    laboratory_faults.py PROGRAM PROJECT RECORDING [--seed 1] [--only KIND...] [--most 60] [--judge FOLDER]
                         [--table docs/robustness.md] [--list] [--demand]

RECORDING is a folder with trials for calibration and validation (`simulate`). Joints, trials, sizes
and markers of the faults are drawn with the seed. Each fault is "named" if one sentence of the
verdict, refusal or warnings has all its key words: the joint (trial, cluster) and the kind of fault. A
fault that ends with exit 0 is judged by `validate` on the trials of FOLDER (default: the clean
recording's own trials for validation), against the calibration of the clean recording: its error
should not be above 1.3 times the clean one. PyYAML is needed. With --demand the exit code is 1 where one
is, where the program has a defect (exit codes other than 0, 3 and 4), or where less than 80 % of the faults are named.
"""

import argparse
import json
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True  # no files in the sources
try:
    import yaml  # noqa: F401, pylint: disable=unused-import
except ImportError:
    print("PyYAML is not installed", file=sys.stderr)
    sys.exit(77)
from laboratory_cases import (  # noqa: E402, pylint: disable=wrong-import-position
    Laboratory, Recording, all_faults)

LIMIT = 1.3  # largest error relative to that without a fault
NAMED = 0.8  # share of the faults that must be named


def sentences(done, out):
    """What the user is told."""
    told = done.stdout.split("\n") + done.stderr.split("\n")
    summary = out / "summary.json"
    if summary.exists():
        read = json.loads(summary.read_text())
        told += read.get("objections", []) + read.get("warnings", [])
    return told


def calibrate(program, project, folder, out):
    return subprocess.run([program, "calibrate", project, "--recording", folder, "-o", out, "--verbose"],
                          capture_output=True, text=True)


def true_error(program, project, out, judge, scratch):
    file = scratch / "true.json"
    done = subprocess.run([program, "validate", project, "--calibration", out, "--recording", judge,
                           "--json", file, "--quiet"], capture_output=True, text=True)
    if not file.exists():
        sys.exit(f"validate: {done.stderr}")
    return json.loads(file.read_text())["rmse_3d_mm_all"]["calibrated"]


def validation_only(recording, folder):
    copy = Recording(recording, folder)
    copy.experiment["trials"] = [t for t in copy.experiment["trials"] if t["kind"] != "calibration"]
    copy.write_experiment()
    return folder


def put_table(path, lines):
    text = path.read_text()
    begin, end = "<!-- laboratory_faults.py -->\n", "<!-- end of laboratory_faults.py -->"
    before, rest = text.split(begin, 1)
    path.write_text(before + begin + "\n".join(lines) + "\n" + end + rest.split(end, 1)[1])


def drawn_cases(a):
    cases = []
    for seed in a.seed:
        draw = random.Random(seed)
        cases += all_faults(Laboratory(a.project, a.recording, draw), draw)
    if a.only:
        cases = [case for case in cases if case[0] in a.only]
    if a.most and a.most < len(cases):
        cases = random.Random(a.seed[0]).sample(cases, a.most)
    return cases


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("project", type=pathlib.Path)
    parser.add_argument("recording", type=pathlib.Path)
    parser.add_argument("--seed", type=int, nargs="+", default=[1], help="each seed draws a fault of every kind and more")
    parser.add_argument("--only", nargs="+", help="kinds of faults")
    parser.add_argument("--most", type=int, help="of the faults, so many drawn by the first seed are tried")
    parser.add_argument("--judge", type=pathlib.Path)
    parser.add_argument("--table", type=pathlib.Path, help="the document that gets the table")
    parser.add_argument("--list", action="store_true", help="only say what would be tried")
    parser.add_argument("--verbose", action="store_true", help="print all that the program says")
    parser.add_argument("--demand", action="store_true", help="fail where the program does not do as it should")
    a = parser.parse_args()
    cases = drawn_cases(a)
    if a.list:
        print("\n".join(f"{kind}: {name}" for kind, name, _, _ in cases))
        return 0
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        judge = a.judge or validation_only(a.recording, scratch / "judge")
        done = calibrate(a.program, a.project, a.recording, scratch / "clean_out")
        if done.returncode:
            sys.exit(f"the clean recording is refused: {done.stdout}{done.stderr}")
        clean = true_error(a.program, a.project, scratch / "clean_out", judge, scratch)
        if not cases:
            sys.exit("no fault of these kinds")
        lines = ["| fault | exit | named | error / clean | said |", "|---|---|---|---|---|"]
        named_count = bad = 0
        for kind, name, words, put in cases:
            folder, out = scratch / "recording", scratch / "out"
            for old in (folder, out):
                shutil.rmtree(old, ignore_errors=True)
            put(Recording(a.recording, folder))
            done = calibrate(a.program, a.project, folder, out)
            told = sentences(done, out)
            hits = [line for line in told
                    if all(re.search(rf"(?<![\w]){re.escape(w)}" if w[0].isalnum() else re.escape(w),
                                     line) for w in words)]
            ratio = ""
            if done.returncode == 0:
                error = true_error(a.program, a.project, out, judge, scratch) / clean
                ratio = f"{error:.2f}"
                bad += not error <= LIMIT
            elif done.returncode not in (3, 4):
                ratio = "defect"
                bad += 1
            named_count += bool(hits)
            said = hits[0] if hits else next((l for l in told if l.startswith("Verdict")), told[-2:][0])
            said = re.sub(r"^(elastocal: \w+: |Verdict: (do not )?deploy\. )", "", said.strip())
            said = said.replace(f"{folder}/", "")
            lines.append(f"| {name} | {done.returncode} | {'yes' if hits else 'no'} | {ratio} | "
                         f"{said[:110].replace('|', '/')} |")
            print(lines[-1], flush=True)
            if a.verbose:
                print("\n".join(told))
        lines.append(f"| **{len(cases)} faults** | | **{named_count}** | **{bad} above {LIMIT}, or a defect** | |")
        print(lines[-1])
    if a.table:
        put_table(a.table, lines)
    return int(a.demand and (bad > 0 or named_count < NAMED * len(cases)))


if __name__ == "__main__":
    sys.exit(main())
