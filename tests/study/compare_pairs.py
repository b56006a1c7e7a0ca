#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How often `compare` is right about two recordings of one virtual robot.

    compare_pairs.py PROGRAM PROJECT [--pairs 40] [--first 1] [--turn-deg 0.3] [--marker-mm 1 ...]
                     [--marker-draws 1] [--work DIR]

A pair is a robot with errors that the estimator does not model (`simulate`), recorded twice: other
random postures, places, clocks and noise, the same robot. Both are calibrated with the default
settings and compared: no joint should be said to have moved. Then one joint of the second recording
is turned (its logged positions are off by this angle in all trials, as after its motor was remounted),
and only this joint should be named. The seed of the pair draws it among all joints that the calibration
tells. The unchanged robot is also compared with displaced markers of one link, which the seed draws too:
each of them fixed anew (1 mm), or all as one piece on a plate that moved (1 mm and 10 mrad, or by each
--marker-mm). This changes the second calibration's estimates and nominal places of these markers, which
follow their places exactly. No joint should be said to have moved. If the plate moved as a joint would
have moved it, this link should be named as the other explanation. Prints a line for each pair and the
counts. Everything follows from the seeds.
"""

import argparse
import collections
import csv
import json
import math
import pathlib
import random
import re
import shutil
import subprocess
import tempfile

# A short experiment with all chains, and with fewer and quicker postures than the paper's.
DESIGN = ["--trials", "calibration", "--head-postures", "8", "--arm-postures", "20",
          "--leg-postures", "20", "--move-s", "1.5", "--rest-s", "0.8", "--lead-in-s", "3"]


def run(*words, may_fail=False):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode != 0 and not may_fail:
        raise SystemExit(f"{words[1]}: exit {done.returncode}\n{done.stdout[-600:]}{done.stderr}")
    return done


def turn(folder, joint, angle):
    """Turns the joint: from now on its encoder shows `angle` more."""
    for log in folder.glob("*.csv"):
        if log.name.endswith("_waist.csv"):
            continue
        with open(log, newline="") as file:
            rows = list(csv.reader(file))
        if joint not in rows[0]:
            continue
        column = rows[0].index(joint)
        for row in rows[1:]:
            row[column] = f"{float(row[column]) + angle:.9g}"
        with open(log, "w", newline="") as file:
            csv.writer(file).writerows(rows)


def displaced(entries, link, draw, rigid, size):
    """Lines of a calibration.yaml with the markers of a link displaced."""
    normal = lambda sd: [draw.gauss(0, sd) for _ in range(3)]
    shift, turn = normal(size), normal(10.0 * size)
    steps = {}
    for name, (on, p) in entries.items():
        if on != link:
            continue
        turned = [turn[(i + 1) % 3] * p[(i + 2) % 3] - turn[(i + 2) % 3] * p[(i + 1) % 3] for i in range(3)]
        own = [s + t for s, t in zip(shift, turned)] if rigid else normal(size)
        steps.update({f"marker.{name}.{axis}": step for axis, step in zip("xyz", own)})
    return steps


def move_markers(source, target, draw, rigid, size=1e-3):
    """Writes the calibration of `source` with the markers of a link displaced. Returns the link."""
    target.mkdir(exist_ok=True)
    shutil.copy(source / "covariance.csv", target)
    text = (source / "calibration.yaml").read_text()
    entries = {}
    for name, link, places in re.findall(r"- {name: (\S+), link: (\S+), xyz_m: \[(.*)\]}", text):
        entries[name] = (link, [float(number) for number in places.split(",")])
    link = draw.choice(sorted({link for link, _ in entries.values()}))
    steps = displaced(entries, link, draw, rigid, size)

    def moved(found):
        return f"{found[1]}{float(found[3]) + steps[found[2]]!r}" if found[2] in steps else found[0]

    text = re.sub(r"(- {name: (marker\.\S+), unit: m, value: )([^,]+)", moved, text)
    (target / "calibration.yaml").write_text(text)
    return link


WAYS = {"anew": "fixed anew", "plate": "moved as one piece"}


def pair(arguments, seed, scratch):
    """Joints that are named without a change, the joint that is turned, and those that are named then."""
    program, project = arguments.program, arguments.project
    a, b = scratch / "a", scratch / "b"
    for folder, day in ((a, 1), (b, 2)):
        run(program, "simulate", project, "-o", folder, "--threads", 1, "--robot-seed", seed,
            "--seed", 1000 * day + seed, *DESIGN)
        run(program, "calibrate", project, "--recording", folder, "-o", scratch / f"{folder.name}_out",
            may_fail=True)
    compared = compare(program, scratch, "b_out")
    draw = random.Random(seed)
    elsewhere = []
    for size in arguments.marker_mm:
        for way in list(WAYS) * arguments.marker_draws:
            link = move_markers(scratch / "b_out", scratch / "moved_out", draw, way == "plate", 1e-3 * size)
            elsewhere.append(((size, way), link, compare(program, scratch, "moved_out")))
    joints = sorted({entry["joint"] for entry in compared["joints"]
                     if entry["joint"] + ".theta" in {p["name"] for p in compared["parameters"]}})
    joint = random.Random(seed).choice(joints)
    turn(b, joint, math.radians(arguments.turn_deg))
    run(program, "calibrate", project, "--recording", b, "-o", scratch / "c_out", may_fail=True)
    changed = compare(program, scratch, "c_out")
    return compared, joint, changed, elsewhere


def compare(program, scratch, other):
    file = scratch / "comparison.json"
    file.unlink(missing_ok=True)
    run(program, "compare", scratch / "a_out", scratch / other, "--json", file, "--quiet")
    return json.loads(file.read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("project")
    parser.add_argument("--pairs", type=int, default=40)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--turn-deg", type=float, default=0.3)
    parser.add_argument("--marker-mm", type=float, default=[1.0], nargs="+", help="by how much markers of a link move")
    parser.add_argument("--marker-draws", type=int, default=1, help="links of a pair, for each of these and each way")
    parser.add_argument("--work", help="keep the files here")
    arguments = parser.parse_args()
    false_alarms = named = alone = 0
    seen, accused, wrong = collections.Counter(), collections.Counter(), collections.Counter()
    for seed in range(arguments.first, arguments.first + arguments.pairs):
        scratch = pathlib.Path(tempfile.mkdtemp(prefix=f"pair_{seed}_", dir=arguments.work))
        same, joint, changed, elsewhere = pair(arguments, seed, scratch)
        false_alarms += bool(same["moved"])
        named += joint in changed["moved"]
        alone += changed["moved"] == [joint]
        least = same["joints"][0]
        print(f"{seed}: unchanged: moved {same['moved']} (least p {least['joint']} {least['p']:.2g}, "
              f"overall {same['overall']['p']:.2g}); {joint} turned: moved {changed['moved']}")
        for way, link, found in elsewhere:
            seen[way] += not next(one["same"] for one in found["markers"] if one["link"] == link)
            others = {one["joint"]: one["or_markers"] for one in found["joints"] if one["moved"]}
            accused[way] += bool(others)
            wrong[way] += any(link not in links for links in others.values())
            print(f"    markers of {link} {way[1]} ({way[0]} mm): moved {others}", flush=True)
        if arguments.work is None:
            shutil.rmtree(scratch)
        else:
            for name in ("a", "b"):
                shutil.rmtree(scratch / name)
    pairs = arguments.pairs
    print(f"{pairs} pairs: a false alarm in {false_alarms}; the turned joint is named in {named}, "
          f"alone in {alone}")
    for way in [(size, way) for size in arguments.marker_mm for way in WAYS]:
        print(f"markers of a link {WAYS[way[1]]} ({way[0]} mm), {pairs * arguments.marker_draws}: seen in {seen[way]}; "
              f"a joint accused in {accused[way]}, without naming that link in {wrong[way]}")


if __name__ == "__main__":
    main()
