#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What recordings tell of frames that no marker tells: standard deviations over those of the prior.

    open_frames.py FOLDER...

A FOLDER is one of `calibrate -o` for models/talos/project.yaml, with the default prior (0.5 degrees and 1 mm, as widened).
1 means: as before the recording. For the root link, it is the mean displacement of its three joints along their axes (`r`).
"""
import csv
import math
import pathlib
import sys

import yaml

ENDS = {"arm_left_7_joint": "theta r", "arm_right_7_joint": "theta r", "leg_left_6_joint": "r", "leg_right_6_joint": "r"}
ROOT = ("torso_1_joint", "leg_left_1_joint", "leg_right_1_joint")


def main():
    for folder in map(pathlib.Path, sys.argv[1:]):
        scale = yaml.safe_load((folder / "calibration.yaml").read_text())["prior_scale"]
        prior = {"theta": math.radians(0.5) * scale["angles"], "r": 1e-3 * scale["lengths"]}
        rows = list(csv.reader((folder / "covariance.csv").open()))
        covariance = {row[0]: dict(zip(rows[0][1:], map(float, row[1:]))) for row in rows[1:]}
        print(folder)
        for joint, quantities in ENDS.items():
            for quantity in quantities.split():
                name = f"{joint}.{quantity}"
                print(f"  {name:24} {math.sqrt(covariance[name][name]) / prior[quantity]:.5f}")
        mean = sum(covariance[f"{a}.r"][f"{b}.r"] for a in ROOT for b in ROOT) / len(ROOT) ** 2
        print(f"  {'root link along z':24} {math.sqrt(mean) / (prior['r'] / math.sqrt(len(ROOT))):.5f}")


if __name__ == "__main__":
    main()
