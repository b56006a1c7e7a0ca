#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How far the swinging foot of an executed motion is from the plan, seen from the standing one, and how much of that is
the spring between ankle and sole of the standing foot, which no marker sees.

    landings.py --weight-n 916 --right 85 105 --left 162 182 DEPLOYMENT.json=TRUTH.yaml ...

DEPLOYMENT.json: `deployment.json` of `simulate --deploy`, whose first robot is taken; TRUTH.yaml: `truth.yaml` of that
robot's recording. --right and --left: seconds of the motion, the robot standing on that foot alone and swinging the
other one little. Prints the mean displacement of the swinging sole [mm] and what the true spring of the standing foot
lowers it by under the weight.
"""

import argparse
import base64
import json
import pathlib
import zlib

import numpy
import yaml

FEET = {"left": "left_sole_link", "right": "right_sole_link"}
APART = {"left": -0.2, "right": 0.2}  # place of the other foot along y [m]


def displacements(robot, links, unit):
    """Displacements as pictures x links x 6, m and rad: see playback.cpp."""
    packed = zlib.decompress(base64.b64decode(robot["displacement"]))
    at, before, pictures = 0, [0] * (6 * links), []
    for _ in range(robot["pictures"]):
        for k in range(6 * links):
            step = int.from_bytes(packed[at:at + 1], "little", signed=True)
            at += 1
            if step == -128:
                before[k] = int.from_bytes(packed[at:at + 4], "little", signed=True)
                at += 4
            else:
                before[k] += step
        pictures.append(list(before))
    return unit * numpy.array(pictures, float).reshape(-1, links, 6)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--weight-n", type=float, required=True)
    for foot in FEET:
        parser.add_argument(f"--{foot}", type=float, nargs=2, required=True, metavar="S")
    parser.add_argument("robots", nargs="+")
    arguments = parser.parse_args()
    found = []
    for pair in arguments.robots:
        deployment, truth = (pathlib.Path(name) for name in pair.split("="))
        playback = json.loads(deployment.read_text())["playback"]
        legs = yaml.safe_load(truth.read_text())["legs"].values()
        links = playback["links"]
        moved = displacements(playback["robots"][0], len(links), playback["unit_m"])
        time = numpy.array(playback["time_s"][:len(moved)])
        for foot, link in FEET.items():
            first, last = getattr(arguments, foot)
            picture = moved[(time > first) & (time < last)]
            standing, other = links.index(link), links.index(FEET["right" if foot == "left" else "left"])
            turned = numpy.cross(picture[:, standing, 3:], [0.0, APART[foot], 0.0])
            mean = 1e3 * (picture[:, other, :3] - picture[:, standing, :3] - turned).mean(axis=0)
            leg = next(leg for leg in legs if leg["foot"] == link)
            spring = -1e3 * float(leg["foot_compliance"][2]) * arguments.weight_n
            found.append((mean[2], spring))
            print(f"{deployment}, on the {foot} foot: {mean.round(2)} mm; its spring lowers by {-spring:.2f} mm")
    height, spring = numpy.array(found).T
    print(f"height: mean {height.mean():.2f}, by the springs {spring.mean():.2f} mm; rms {numpy.sqrt((height**2).mean()):.2f}, "
          f"without the springs {numpy.sqrt(((height - spring) ** 2).mean()):.2f} mm")


if __name__ == "__main__":
    main()
