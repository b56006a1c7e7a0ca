#!/usr/bin/env python3
"""Puts faults of a laboratory into a simulated recording and says what `calibrate` makes of them.

    laboratory_faults.py PROGRAM PROJECT RECORDING JOINT_1:TRIAL_1 [JOINT_2:TRIAL_2...]

Each joint is one that its trial exercises. Prints a table: the fault, the exit code, whether the
verdict names the joint or trial, and the beginning of the verdict.
"""

import csv
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

DEGREE = math.pi / 180.0


def change_log(folder, trial, joint, change):
    """`change(position, share of the trial gone by)` for every position of the joint."""
    path = folder / f"{trial}.csv"
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    column = rows[0].index(joint)
    for i, row in enumerate(rows[1:]):
        row[column] = repr(change(float(row[column]), i / len(rows)))
    with open(path, "w", newline="") as file:
        csv.writer(file).writerows(rows)


def scale_cameras(folder, trial, scale):
    path = folder / f"{trial}.tsv"
    lines = path.read_text().split("\n")
    for i, line in enumerate(lines):
        cells = line.split("\t")
        if len(cells) > 10 and cells[0].isdigit():
            lines[i] = "\t".join(cells[:2] + [f"{float(c) * scale:.3f}" if c else c for c in cells[2:]])
    path.write_text("\n".join(lines))


def frozen():
    kept = []

    def change(position, share):
        if share >= 0.5 and not kept:
            kept.append(position)
        return kept[0] if kept else position

    return change


def faults(trials, joint, trial):
    def in_all(change):
        return lambda folder: [change_log(folder, name, joint, change()) for name in trials]

    def in_one(change):
        return lambda folder: change_log(folder, trial, joint, change())

    yield f"{joint}: gain 1.01", joint, in_all(lambda: lambda q, share: 1.01 * q)
    yield f"{joint}: gain 1.05", joint, in_all(lambda: lambda q, share: 1.05 * q)
    yield f"{joint}: sign", joint, in_all(lambda: lambda q, share: -q)
    yield f"{joint}: 1 deg off in {trial}", joint, in_one(lambda: lambda q, share: q + DEGREE)
    yield f"{joint}: 5 deg off from half of {trial} on", joint, in_one(
        lambda: lambda q, share: q + (5 * DEGREE if share > 0.5 else 0.0))
    yield f"{joint}: frozen from half of {trial} on", joint, in_one(frozen)
    yield f"cameras' scale 1.02 in {trial}", trial, lambda folder: scale_cameras(folder, trial, 1.02)


def main():
    program, project, recording = sys.argv[1:4]
    pairs = [pair.split(":") for pair in sys.argv[4:]]
    trials = sorted(path.stem for path in pathlib.Path(recording).glob("*.tsv"))
    cases = [("none", None, lambda folder: None)]
    for joint, trial in pairs:
        cases += faults(trials, joint, trial)
    print("| fault | exit | named | verdict |\n|---|---|---|---|")
    for name, culprit, put in cases:
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch) / "recording"
            shutil.copytree(recording, folder)
            put(folder)
            run = subprocess.run(
                [program, "calibrate", project, "--recording", folder, "-o", pathlib.Path(scratch) / "out"],
                capture_output=True, text=True)
        lines = [line for line in run.stdout.splitlines() if line.startswith("Verdict")]
        verdict = lines[0] if lines else run.stderr.strip().splitlines()[-1]
        named = "-" if culprit is None else "yes" if culprit in run.stdout else "no"
        print(f"| {name} | {run.returncode} | {named} | {verdict[:90]} |", flush=True)


if __name__ == "__main__":
    main()
