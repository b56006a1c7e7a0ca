#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`check` on real touches of TALOS (../shared/data/talos_table_contact): some of the 50 represent another day, as they
were measured, with a joint that is off in all of them, and with a joint that is off in one. Prints the answers.

  /usr/bin/python3 tests/study/table_days.py --program build/release/bin/elastocal --work DIR [--draws 8]
"""

import argparse
import csv
import json
import math
import os
import pathlib
import random
import subprocess

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PROJECT = SOURCE / "examples/talos_table/project.yaml"
SHARED = pathlib.Path(os.environ.get("ELASTOCAL_SHARED_DATA", SOURCE.parent / "shared" / "data")) / "talos_table_contact"
SIDES = ("left", "right")
JOINTS = [f"arm_{side}_{k}_joint" for side in SIDES for k in range(1, 6)] + ["torso_1_joint", "torso_2_joint"]


class Touches:
    """A part of the touches calibrates the robot, the rest is of another day."""

    def __init__(self, options, other_day):
        self.program, self.work = options.program, options.work
        self.head, self.rest, tables = {}, {}, []
        for side in SIDES:
            rows = list(csv.reader((SHARED / f"{side}.csv").open()))
            self.head[side], rows = rows[0], rows[1:]
            other = other_day(len(rows))
            self.rest[side] = [rows[i] for i in sorted(other)]
            tables.append(self.write(f"first_{side}.csv", side, [row for i, row in enumerate(rows) if i not in other]))
        self.run("calibrate", PROJECT, "--recording", *tables, "--kfold", 0, "-o", self.work / "out")

    def run(self, *words):
        subprocess.run([self.program, *map(str, words)], capture_output=True, check=False)

    def write(self, name, side, rows):
        with (self.work / name).open("w", newline="") as file:
            csv.writer(file).writerows([self.head[side], *rows])
        return self.work / name

    def check(self, joint=None, degrees=0.0, only=None):
        """The dict of `check --json`. `only`: (side, row); without it, the joint is off in all touches."""
        tables = []
        for side in SIDES:
            rows = [list(row) for row in self.rest[side]]
            for i, row in enumerate(rows):
                if joint and only in (None, (side, i)):
                    column = self.head[side].index(joint)
                    row[column] = repr(float(row[column]) + math.radians(degrees))
            tables.append(self.write(f"then_{side}.csv", side, rows))
        file = self.work / "check.json"
        self.run("check", PROJECT, "--calibration", self.work / "out", "--recording", *tables, "--json", file)
        return json.loads(file.read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--draws", type=int, default=8)
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    print("| draw | as measured | joint | off by 1 degree | 2 degrees |\n|---|---|---|---|---|")
    for seed in range(1, options.draws + 1):
        draw = random.Random(seed)
        touches = Touches(options, lambda count, draw=draw: set(draw.sample(range(count), 7)))
        joint, cells = draw.choice(JOINTS), [touches.check()["status"]]
        for degrees in (1.0, 2.0):
            found = touches.check(joint, degrees)
            names = [one["joint"] for one in found["moved"]] + found["suspects"]
            cells.append(found["status"] + ": " + ", ".join(names))
        print(f"| {seed} | {cells[0]} | {joint} | {cells[1]} | {cells[2]} |", flush=True)
    touches = Touches(options, lambda count: {i for i in range(count) if i % 4 == 3})
    print("\n| joint | touch of the right hand | off by degrees | said |\n|---|---|---|---|")
    for joint in ("arm_right_2_joint", "arm_right_4_joint", "arm_right_5_joint", "arm_right_6_joint"):
        for row in (1, 4):
            for degrees in (3.0, 4.0):
                found = touches.check(joint, degrees, ("right", row))
                said = found["alternatives"][0].split("/")[-1] if found["alternatives"] else ""
                print(f"| {joint} | {row + 2} | {degrees:.0f} | {found['status']}: {said[:60]} |", flush=True)


if __name__ == "__main__":
    main()
