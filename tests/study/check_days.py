#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How often `check` is right about a robot from a few postures of another day.

    check_days.py PROGRAM PROJECT [--robots 20] [--first 1] [--turn-deg 0.2] [--postures 8] [--work DIR]

A robot with errors that the estimator does not model (`simulate`) is calibrated with the default
settings. On another day, each chain takes a few other postures (at another place, with another
clock and other noise): nothing should be said to have moved. Then one joint is turned, as after its
motor was remounted, and should be named. The seed of the robot draws it among the joints whose zero
the postures tell. The seed also draws a link whose markers are displaced in the calibration, as if
fixed anew since (1 mm each) or moved as one piece (1 mm and 10 mrad): no joint should be said to have
moved. Finally, a calibration from both days and the first one updated by the second
(`calibrate --prior`) are compared on a third day. Everything follows from the seeds.
"""

import argparse
import json
import math
import pathlib
import random
import shutil
import tempfile

from compare_pairs import DESIGN, move_markers, run, turn


def few(postures):
    words = list(DESIGN)
    # The number for the head stays, because its short trial needs these postures to find the clock.
    for option, count in (("--arm-postures", postures), ("--leg-postures", postures)):
        words[words.index(option) + 1] = str(count)
    return words


def check(arguments, scratch, day, calibration="a_out"):
    file = scratch / "check.json"
    file.unlink(missing_ok=True)
    run(arguments.program, "check", arguments.project, "--calibration", scratch / calibration,
        "--recording", day, "--json", file, "--quiet", may_fail=True)
    return json.loads(file.read_text())


def error(arguments, scratch, calibration, day):
    file = scratch / "validation.json"
    file.unlink(missing_ok=True)
    run(arguments.program, "validate", arguments.project, "--calibration", scratch / calibration,
        "--recording", day, "--json", file, "--quiet", may_fail=True)
    return json.loads(file.read_text())["rmse_3d_mm_all"]["calibrated"]


def robot(arguments, seed, scratch):
    program, project = arguments.program, arguments.project
    for folder, day, words in (("a", 1, DESIGN), ("b", 2, few(arguments.postures)), ("c", 3, DESIGN)):
        run(program, "simulate", project, "-o", scratch / folder, "--robot-seed", seed,
            "--seed", 1000 * day + seed, *words)
    run(program, "calibrate", project, "--recording", scratch / "a", "-o", scratch / "a_out",
        may_fail=True)
    run(program, "calibrate", project, "--recording", scratch / "b", "--prior", scratch / "a_out",
        "-o", scratch / "updated", may_fail=True)
    run(program, "calibrate", project, "--recording", scratch / "a", scratch / "b",
        "-o", scratch / "together", may_fail=True)
    errors = {name: error(arguments, scratch, name, scratch / "c")
              for name in ("a_out", "updated", "together")}
    same = check(arguments, scratch, scratch / "b")
    draw = random.Random(seed)
    elsewhere = []
    for rigid in (False, True):
        link = move_markers(scratch / "a_out", scratch / "moved_out", draw, rigid)
        found = check(arguments, scratch, scratch / "b", "moved_out")
        seen = not next(one["same"] for one in found["markers"] if one["link"] == link)
        elsewhere.append((link, seen, found["status"]))
    joint = draw.choice(
        sorted(j["joint"] for j in same["joints"] if j["joint"] not in same["not_told"]))
    turn(scratch / "b", joint, math.radians(arguments.turn_deg))
    return same, joint, check(arguments, scratch, scratch / "b"), errors, elsewhere


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("project")
    parser.add_argument("--robots", type=int, default=20)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--turn-deg", type=float, default=0.2)
    parser.add_argument("--postures", type=int, default=8, help="of each arm and leg")
    parser.add_argument("--work", help="keep the files here")
    arguments = parser.parse_args()
    false_alarms = named = alone = seen = markers_seen = accused = 0
    for seed in range(arguments.first, arguments.first + arguments.robots):
        scratch = pathlib.Path(tempfile.mkdtemp(prefix=f"robot_{seed}_", dir=arguments.work))
        same, joint, changed, errors, elsewhere = robot(arguments, seed, scratch)
        moved = [one["joint"] for one in changed["moved"]]
        false_alarms += same["status"] != "unchanged"
        named += joint in moved
        alone += moved == [joint]
        seen += changed["status"] != "unchanged"
        print(f"{seed}: unchanged: {same['status']} {[one['joint'] for one in same['moved']]} "
              f"{same['suspects']} (not told: {same['not_told']}); {joint} turned: moved {moved}, suspects "
              f"{changed['suspects']}, or markers on {changed['or_markers']}; "
              "third day, mm: " + ", ".join(f"{name} {mm:.3f}" for name, mm in errors.items()),
              flush=True)
        for link, was_seen, status in elsewhere:
            markers_seen += was_seen
            accused += status != "unchanged"
            print(f"    markers of {link} elsewhere: {'seen' if was_seen else 'not seen'}, {status}", flush=True)
        if arguments.work is None:
            shutil.rmtree(scratch)
    print(f"{arguments.robots} robots: a false alarm in {false_alarms}; a change is seen in {seen}, "
          f"the turned joint is named in {named}, alone in {alone}")
    print(f"{2 * arguments.robots} times markers of a link elsewhere: seen in {markers_seen}, not unchanged in {accused}")


if __name__ == "__main__":
    main()
