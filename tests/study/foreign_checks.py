#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`check` and `calibrate --prior` by tables of a laser tracker, on the arm of foreign_arm.py, which shares no code with the
program: 50 postures calibrate it, and eight of another day, with the tracker elsewhere, are checked as they are, with a joint
turned by 0.2 degrees, and with mistakes. Prints tables for docs/accuracy.md (Markdown). Needs NumPy.

  /usr/bin/python3 tests/study/foreign_checks.py --program build/release/bin/elastocal --work DIR [--arms 40]
"""

import argparse
import collections
import json
import pathlib
import sys

import numpy as np

sys.dont_write_bytecode = True  # no files in the sources
from foreign_arm import (  # noqa: E402, pylint: disable=wrong-import-position
    NAMES, UPRIGHT, Arm, Study, poses_of, postures, tracker_project, turned, write_poses)

ELSEWHERE = (turned(np.array((0.01, 0.3, 1.1))) @ UPRIGHT[0], UPRIGHT[1] + np.array((0.4, -0.3, 0.05)))


class OneArm:
    """An arm that is calibrated from 50 postures, and recorded on another day."""

    def __init__(self, study, seed):
        self.study, self.seed = study, seed
        self.file, self.rng, self.arm = tracker_project(study), np.random.default_rng(seed), Arm.real(300 + seed)
        self.then = postures(8, 1000 + seed)
        self.first = self.table(postures(50, seed), UPRIGHT, "first.csv")
        study.run("calibrate", self.file, "--recording", self.first, "-o", study.work / "cal", "--kfold", 5)

    def table(self, q, base, name):
        return write_poses(self.study.work / name, q, poses_of(self.arm, q, self.rng, base))

    def check(self, q, poses):
        table, file = write_poses(self.study.work / "then.csv", q, poses), self.study.work / "check.json"
        self.study.run("check", self.file, "--calibration", self.study.work / "cal", "--recording", table, "--json", file)
        return json.loads(file.read_text())

    def seen(self, arm=None):
        return poses_of(arm or self.arm, self.then, self.rng, ELSEWHERE)


def moved(found):
    return [joint["joint"] for joint in found["moved"]] + found["suspects"]


def mistakes(one):
    """Name, postures, poses, and the words that one sentence should have."""
    row = one.seen()
    row[3, 0] += 0.01
    scale = one.seen()
    scale[:, :3] *= 1.005
    gain, sign = one.then.copy(), one.then.copy()
    gain[:, 2] *= 1.02
    sign[:, 3] *= -1
    yield "one posture 10 mm off", one.then, row, "then.csv:5: "
    yield "lengths times 1.005", one.then, scale, "scale=1.00"
    yield "upper_roll times 1.02", gain, one.seen(), "gain:upper_roll=1.0"
    yield "sign of elbow", sign, one.seen(), "sign:elbow"


def update(one):
    """Errors (mm) in 60 other postures: of the first calibration, updated by ten, from these ten alone, from both tables."""
    ten = one.table(postures(10, 2000 + one.seed), ELSEWHERE, "ten.csv")
    judge = one.table(postures(60, 3000 + one.seed), ELSEWHERE, "judge.csv")
    errors = []
    for words in ([], [ten, "--prior", one.study.work / "cal", "--days", 0], [ten, "--prior", one.study.work / "cal"], [ten],
                  [one.first, ten]):
        folder = one.study.work / ("cal" if not words else "updated")
        if words:
            one.study.run("calibrate", one.file, "--recording", *words, "-o", folder, "--kfold", 5)
        file = one.study.work / "judged.json"
        one.study.run("validate", one.file, "--calibration", folder, "--recording", judge, "--refit", "table", "--json", file)
        errors.append(json.loads(file.read_text())["contact"]["instruments"][0]["position_mm"])
    return errors


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--arms", type=int, default=40)
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    study, count, errors = Study(options.program, options.work), collections.Counter(), []
    for seed in range(options.arms):
        one = OneArm(study, seed)
        count["unchanged: false alarms"] += one.check(one.then, one.seen())["status"] != "unchanged"
        turned_arm, k = Arm.real(300 + seed), int(one.rng.integers(1, 6))
        turned_arm.offset[k] += np.radians(0.2)
        found = moved(one.check(one.then, one.seen(turned_arm)))
        count["turned joint: named"] += NAMES[k] in found
        count["turned joint: named alone"] += found == [NAMES[k]]
        for name, q, poses, words in mistakes(one):
            found = one.check(q, poses)
            told = any(words in text for text in found["mistakes"] + found["alternatives"])
            count[name + ": named"] += told and found["status"] == "recording wrong"
        errors.append(update(one))
    print(f"| of {options.arms} | |\n|---|---|")
    for name, number in count.items():
        print(f"| {name} | {number} |")
    means = np.sqrt(np.mean(np.square(errors), axis=0))
    print("\n| first | updated at once | updated after a day | ten alone | all 60 together |\n|---|---|---|---|---|")
    print("| " + " | ".join(f"{x:.4f}" for x in means) + " |")


if __name__ == "__main__":
    main()
