#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How long `calibrate` takes on posture tables of many rows.

    long_table.py PROGRAM WORK [--robot ROBOT] [--rows 10000 30000 90000]

ROBOT is as for nine_robots.py, whose independent kinematics make the tables (0.1 mm of noise). Prints
rows, markers, seconds of processor time, seconds, largest memory in MiB, and the exit code.
"""

import argparse
import os
import pathlib
import random
import time
import xml.etree.ElementTree as ET

import yaml

import nine_robots


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("--robot", default="coaxial7")
    parser.add_argument("--rows", type=int, nargs="+", default=[10000, 30000, 90000])
    arguments = parser.parse_args()
    draw = random.Random(1)
    name, xml, project = nine_robots.load(arguments.robot, True)
    markers = nine_robots.markers_of(project, draw)
    truth = nine_robots.true_robot(xml, draw)
    arguments.work.mkdir(parents=True, exist_ok=True)
    ET.ElementTree(xml).write(arguments.work / "robot.urdf")
    (arguments.work / "project.yaml").write_text(
        yaml.safe_dump(dict(project, robot={"urdf": "robot.urdf"})))
    print("| rows | markers | processor s | s | MiB | exit |\n|---|---|---|---|---|---|")
    for rows in arguments.rows:
        table = arguments.work / f"table_{rows}.csv"
        if not table.exists():
            postures = nine_robots.random_postures(truth, rows, draw)
            nine_robots.write_table(table, truth, markers, postures,
                                    (nine_robots.rotation([0.1, 0.2, 0.3]), [1, 2, 3]), draw)
        begin = time.monotonic()
        child = os.spawnv(os.P_NOWAIT, arguments.program, [
            arguments.program, "calibrate", str(arguments.work / "project.yaml"), "--recording",
            str(table), "-o", str(arguments.work / "out"), "--quiet"])
        _, status, used = os.wait4(child, 0)
        print(f"| {rows} | {len(markers)} | {used.ru_utime + used.ru_stime:.1f} | "
              f"{time.monotonic() - begin:.1f} | {used.ru_maxrss // 1024} | "
              f"{os.waitstatus_to_exitcode(status)} |", flush=True)


if __name__ == "__main__":
    main()
