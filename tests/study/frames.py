#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How far a calibrated URDF has the ends of limbs from where a simulated robot truly has them.

    frames.py URDF TRUTH FOLDER...

URDF is the robot description, TRUTH the truth.yaml of `simulate`, a FOLDER is one of `calibrate -o`. In 100 random
postures, without springs: root mean square of the error in the frame of the root link, of the nominal URDF and of the
calibrated one, and the error that `frames` of summary.json expects.
"""

import json
import math
import pathlib
import random
import sys
import xml.etree.ElementTree as ET

import yaml

from own_kinematics import Robot, mat_mul, rotation, times, transpose


def with_truth(robot, truth):
    for joint in robot.joints:
        error = truth["joints"].get(joint["name"])
        if error is None:
            continue
        turn = rotation([math.radians(x) for x in error["turn_deg"]])
        joint["origin"] = times(joint["origin"], (turn, [1e-3 * x for x in error["shift_mm"]]))
        joint["zero"] = math.radians(error["offset_deg"]) if "offset_deg" in error else 1e-3 * error["offset_mm"]
    return robot


def read(path):
    return Robot(ET.parse(path).getroot())


def difference(a, b):
    """Difference of two poses in mm and degrees."""
    R = mat_mul(transpose(a[0]), b[0])
    angle = math.acos(max(-1.0, min(1.0, (sum(R[k][k] for k in range(3)) - 1.0) / 2.0)))
    return 1e3 * math.dist(a[1], b[1]), math.degrees(angle)


def rms(values):
    return math.sqrt(sum(x * x for x in values) / len(values))


def main():
    urdf, truth_file, *folders = sys.argv[1:]
    truth = with_truth(read(urdf), yaml.safe_load(pathlib.Path(truth_file).read_text()))
    print("| folder | end of a limb | nominal mm, deg | calibrated mm, deg | expected mm, deg |\n|---|---|---|---|---|")
    for folder in map(pathlib.Path, folders):
        robots = [read(urdf), read(next(folder.glob("*_calibrated.urdf")))]
        for frame in json.loads((folder / "summary.json").read_text())["frames"]:
            draw = random.Random(5)
            errors = [[], []]
            for _ in range(100):
                encoders = {j["name"]: draw.uniform(j["lower"], j["upper"]) for j in truth.moving()}
                there = truth.links(truth.positions(encoders))[frame["link"]]
                for found, robot in zip(errors, robots):
                    found.append(difference(there, robot.links(robot.positions(encoders))[frame["link"]]))
            cells = [f"{rms([e[0] for e in found]):.2f}, {rms([e[1] for e in found]):.2f}" for found in errors]
            cells.append(f"{frame['position_sd_mm']:.2f}, {frame['attitude_sd_deg']:.2f}")
            print(f"| {folder.name} | `{frame['link']}` | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
