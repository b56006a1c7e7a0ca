#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What touches, inertial units and cameras tell of a virtual TALOS, of which no tracker knows.

    touch_study.py KIND --program PROGRAM [--robots 10] [--first 1] [--work DIR]

Robots of examples/talos_touch with errors that the estimator does not model in part (`simulate`: all
joints have springs and friction, links are elastic, feet touch by MuJoCo) play designed postures, are
calibrated, and predict what another recording of the same robot shows.

  touches   30 designed touches; height and tilt of the plates in 30 random touches, table as it was
  offsets   the same of robots whose geometry errs in zero offsets alone, so that the truth of each
            parameter is known: how often it lies in its 95 % interval
  kinds     touches alone, inertial units alone, both: numbers that are determined, sds of offsets
  camera    tags on both hands and a pole in 40 designed images of the head's camera; corners in
            images without noise of other postures, and the pose of the camera
  mixed     8 postures with markers, 20 touches, both: error of markers in other postures
  checks    `check` of another recording of 6 touches of each hand and 6 looks, and of the same with one joint,
            drawn with the seed, that is off by 0.5 degrees; from which change of it on these postures would tell

Everything follows from the seeds. PyYAML is needed.
"""

import argparse
import copy
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "talos_touch" / "project.yaml"


def run(arguments, *words, may_fail=False):
    command = [str(arguments.program), *map(str, words), "--quiet"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0 and not (may_fail and result.returncode == 4):
        sys.exit(f"{' '.join(command)}\n{result.stderr}")


def write_project(folder, instruments=(), plates=True, extra=None):
    """The example with some of its instruments."""
    project = yaml.safe_load(EXAMPLE.read_text())
    project["robot"]["urdf"] = str(EXAMPLE.parent / project["robot"]["urdf"])
    kept = {k: v for k, v in project["instruments"].items() if k in instruments}
    kept.update(extra or {})
    project["instruments"] = kept
    if not kept:
        del project["instruments"]
        del project["contact"]["plate_column"]
    if not plates:
        del project["contact"]["plates"]
        del project["contact"]["plate_column"]
    file = folder / "project.yaml"
    folder.mkdir(parents=True, exist_ok=True)
    file.write_text(yaml.safe_dump(project, sort_keys=False))
    return file


def design(arguments, project, count):
    file = project.parent / "postures.yaml"
    run(arguments, "design", project, "--count", count, "-o", file)
    return file


def simulate(arguments, project, folder, seed, robot, *words):
    run(arguments, "simulate", project, "-o", folder, "--seed", seed, "--robot-seed", robot, *words)
    tables = [folder / "observations.csv"]
    if (folder / "corners.csv").exists():
        tables.append(folder / "corners.csv")
    return tables


def calibrate(arguments, project, tables, folder):
    run(arguments, "calibrate", project, "--recording", *tables, "--kfold", 0, "-o", folder,
        may_fail=True)
    return json.loads((folder / "summary.json").read_text())


def validate(arguments, project, folder, tables, *words):
    file = folder / "held_out.json"
    run(arguments, "validate", project, "--calibration", folder, "--recording", *tables, "--json",
        file, *words, may_fail=True)
    return json.loads(file.read_text())["contact"]


def rms(values):
    return math.sqrt(sum(v * v for v in values) / len(values))


def student(freedom):
    """97.5 % quantile of Student's t, from that of the normal distribution."""
    z = 1.959964
    return z + (z**3 + z) / (4 * freedom) + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * freedom**2)


def touches(arguments, work):
    project = write_project(work)
    postures = design(arguments, project, 30)
    print("robot  height mm: nominal calibrated  gain   tilt deg: nominal calibrated  gain")
    before, after = [], []
    for robot in arguments.seeds:
        seen = simulate(arguments, project, work / "a", robot, robot, "--postures", postures)
        other = simulate(arguments, project, work / "b", 1000 + robot, robot, "--count", 15)
        calibrate(arguments, project, seen, work / "out")
        held = validate(arguments, project, work / "out", other)
        before.append((held["uncalibrated"]["height_mm"], held["uncalibrated"]["tilt_deg"]))
        after.append((held["height_mm"], held["tilt_deg"]))
        (h0, t0), (h1, t1) = before[-1], after[-1]
        print(f"{robot:5} {h0:18.2f} {h1:10.2f} {h0 / h1:5.1f} {t0:19.3f} {t1:10.3f} {t0 / t1:5.1f}",
              flush=True)
    h0, h1 = rms([b[0] for b in before]), rms([a[0] for a in after])
    t0, t1 = rms([b[1] for b in before]), rms([a[1] for a in after])
    print(f"  all {h0:18.2f} {h1:10.2f} {h0 / h1:5.1f} {t0:19.3f} {t1:10.3f} {t0 / t1:5.1f}")


def offsets(arguments, work):
    project = write_project(work)
    postures = design(arguments, project, 30)
    inside, count, squares = 0, 0, 0.0
    for robot in arguments.seeds:
        seen = simulate(arguments, project, work / "a", robot, robot, "--postures", postures,
                        "--length-mm", 0, "--angle-deg", 0)
        summary = calibrate(arguments, project, seen, work / "out")
        truth = yaml.safe_load((work / "a" / "truth.yaml").read_text())["joints"]
        freedom = max(1.0, summary["equations"] - summary["effective_parameters"])
        here = 0
        for parameter in summary["parameters"]:
            joint, kind = parameter["name"].rsplit(".", 1)
            if kind != "theta" or joint not in truth or not parameter["sd"]:
                continue
            error = parameter["value"] - math.radians(float(truth[joint]["offset_deg"]))
            here += abs(error) <= student(freedom) * parameter["sd"]
            squares += (error / parameter["sd"])**2
            count += 1
        inside += here
        print(f"robot {robot}: {here} inside; so far {100 * inside / count:.1f} % of {count}, "
              f"rms error {math.sqrt(squares / count):.2f} sds", flush=True)


def sds(summary):
    """Standard deviations of the zero offsets of legs, trunk and arms, degrees."""
    groups = {"leg": [], "torso": [], "arm": []}
    for parameter in summary["parameters"]:
        joint, kind = parameter["name"].rsplit(".", 1)
        for group, of in groups.items():
            if kind == "theta" and joint.startswith(group) and parameter["sd"]:
                of.append(math.degrees(parameter["sd"]))
    return {group: rms(of) if of else math.nan for group, of in groups.items()}


def kinds(arguments, work):
    both = write_project(work / "both", ("inertial_units",))
    postures = yaml.safe_load(design(arguments, both, 60).read_text())
    touching = [c for c in postures["chains"] if c["name"] != "instruments"]
    looking = [c for c in postures["chains"] if c["name"] == "instruments"]
    print(f"{sum(len(c['postures']) for c in touching)} touches, "
          f"{sum(len(c['postures']) for c in looking)} other postures")
    print("what                     numbers determined   sds of offsets: legs  trunk   arms (deg)")
    totals = {}
    for robot in arguments.seeds:
        seen = simulate(arguments, both, work / "a", robot, robot, "--postures",
                        work / "both" / "postures.yaml")
        variants = {"touches": write_project(work / "touches"),
                    "inertial units": write_project(work / "units", ("inertial_units",), False),
                    "both": both}
        for name, project in variants.items():
            table = work / f"{name.split()[0]}.csv"
            table.write_text(columns(seen[0].read_text(), name))
            summary = calibrate(arguments, project, [table], work / "out")
            totals.setdefault(name, []).append((summary["effective_parameters"], sds(summary)))
    for name, found in totals.items():
        mean = {g: rms([s[g] for _, s in found]) for g in ("leg", "torso", "arm")}
        print(f"{name:24} {sum(n for n, _ in found) / len(found):10.1f} {mean['leg']:27.3f} "
              f"{mean['torso']:6.3f} {mean['arm']:6.3f}", flush=True)


def columns(text, name):
    """The rows and columns of a table that a project with fewer instruments has."""
    rows = [line.split(",") for line in text.splitlines()]
    header = rows[0]
    plate = header.index("touches")
    imu = [i for i, column in enumerate(header) if "imu_" in column]
    dropped = {"touches": [plate, *imu], "inertial units": [plate], "both": []}[name]
    kept = [r for r in rows if name != "touches" or r is header or r[plate]]
    return "".join(",".join(c for i, c in enumerate(row) if i not in dropped) + "\n" for row in kept)


def camera(arguments, work):
    project = write_project(work, ("cameras", "tags"), plates=False)
    postures = design(arguments, project, 40)
    print("robot  corners px: nominal calibrated  gain   camera off by sds (chi-squared of 6)")
    before, after, chi = [], [], []
    for robot in arguments.seeds:
        seen = simulate(arguments, project, work / "a", robot, robot, "--postures", postures)
        other = simulate(arguments, project, work / "b", 1000 + robot, robot, "--count", 30,
                         "--pixel-noise", 0, "--pixel-blur", 0)
        summary = calibrate(arguments, project, seen, work / "out")
        held = validate(arguments, project, work / "out", other)
        pixels = lambda figures: rms([i["pixel_px"] for i in figures["instruments"]])
        before.append(pixels(held["uncalibrated"]))
        after.append(pixels(held))
        truth = yaml.safe_load((work / "a" / "truth.yaml").read_text())["quantities"]
        mounting = next(q for q in summary["contact"]["quantities"] if q["name"] == "head.mounting")
        errors = [(float(t) - v) / s for t, v, s in zip(
            truth["head.mounting"]["values"], mounting["values"], mounting["sds"])]
        chi.append(errors)
        print(f"{robot:5} {before[-1]:19.2f} {after[-1]:10.2f} {before[-1] / after[-1]:5.1f}   "
              + " ".join(f"{e:5.2f}" for e in errors), flush=True)
    b, a = rms(before), rms(after)
    flat = [abs(e) for errors in chi for e in errors]
    print(f"  all {b:19.2f} {a:10.2f} {b / a:5.1f}   inside 95 %: "
          f"{100 * sum(e < 1.96 for e in flat) / len(flat):.0f} % of {len(flat)}")


def mixed(arguments, work):
    marker = lambda name, link, p: {"name": name, "link": link, "tracker": "cameras", "point_mm": p,
                                    "mounting_sd_mm": 5}
    extra = {"trackers": [{"name": "cameras"}],
             "positions": [marker(f"{side[0]}{i}", f"gripper_{side}_base_link", p)
                           for side in ("left", "right")
                           for i, p in enumerate([[45, 30, -15], [45, -20, -60], [-20, 60, -40]])]}
    both = write_project(work / "both", (), True, extra)
    markers = write_project(work / "markers", (), False, copy.deepcopy(extra))
    only = write_project(work / "touches")
    touched = design(arguments, only, 20)
    looked = design(arguments, markers, 8)
    print("robot  markers mm: nominal, from 8 postures, 20 touches, both")
    found = {"nominal": [], "markers": [], "touches": [], "both": []}
    for robot in arguments.seeds:
        a = simulate(arguments, markers, work / "a", robot, robot, "--postures", looked)
        b = simulate(arguments, both, work / "b", robot, robot, "--postures", touched)
        b[0].write_text(without_markers(b[0].read_text()))
        other = simulate(arguments, markers, work / "c", 1000 + robot, robot, "--count", 30,
                         "--length-noise-mm", 0)
        for name, tables in {"markers": a, "touches": b, "both": a + b}.items():
            calibrate(arguments, both, tables, work / name)
            held = validate(arguments, both, work / name, other, "--refit", "table")
            found[name].append(rms([i["position_mm"] for i in held["instruments"]]))
            if name == "both":
                found["nominal"].append(
                    rms([i["position_mm"] for i in held["uncalibrated"]["instruments"]]))
        print(f"{robot:5} " + " ".join(f"{found[n][-1]:8.2f}" for n in found), flush=True)
    print("  all " + " ".join(f"{rms(found[n]):8.2f}" for n in found))


def checks(arguments, work):
    """An unchanged robot, and one joint that has moved."""
    print("robot  unchanged: status    moved: joint               status and joints")
    for robot in arguments.seeds:
        folder = work / f"robot_{robot}"
        project = write_project(folder, instruments=("inertial_units", "cameras", "tags"))
        calibrate(arguments, project, simulate(arguments, project, folder / "first", 2 * robot, robot, "--count", 20),
                  folder / "out")
        then = simulate(arguments, project, folder / "then", 2 * robot + 1, robot, "--count", 6)

        draw = random.Random(robot)
        joint = draw.choice([f"arm_{side}_{k}_joint" for side in ("left", "right") for k in range(1, 6)] + ["torso_2_joint"])

        def check(tables):
            file = folder / "check.json"
            run(arguments, "check", project, "--calibration", folder / "out", "--recording", *tables, "--json", file,
                may_fail=True)
            found = json.loads(file.read_text())
            seen = next((math.degrees(j["smallest_seen"]) for j in found["joints"] if j["joint"] == joint), math.nan)
            return found["status"], [j["joint"] for j in found["moved"]] + found["suspects"], f"seen from {seen:.2f} deg on"

        rows = [line.split(",") for line in then[0].read_text().splitlines()]
        column = rows[0].index(joint)
        for row in rows[1:]:
            row[column] = f"{float(row[column]) + math.radians(0.5):.9f}"
        moved = folder / "then" / "moved.csv"
        moved.write_text("".join(",".join(row) + "\n" for row in rows))
        print(f"{robot:5}  {check(then)}  {joint} {check([moved, *then[1:]])}", flush=True)


def without_markers(text):
    rows = [line.split(",") for line in text.splitlines()]
    dropped = {i for i, column in enumerate(rows[0]) if column[:2] in ("l0", "l1", "l2", "r0", "r1", "r2")}
    return "".join(",".join(c for i, c in enumerate(r) if i not in dropped) + "\n" for r in rows)


def main():
    kinds_of_study = {f.__name__: f for f in (touches, offsets, kinds, camera, mixed, checks)}
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kind", choices=kinds_of_study)
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--robots", type=int, default=10)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--work", type=pathlib.Path)
    arguments = parser.parse_args()
    arguments.seeds = range(arguments.first, arguments.first + arguments.robots)
    if arguments.work:
        arguments.work.mkdir(parents=True, exist_ok=True)
        kinds_of_study[arguments.kind](arguments, arguments.work)
        return
    with tempfile.TemporaryDirectory() as folder:
        kinds_of_study[arguments.kind](arguments, pathlib.Path(folder))


if __name__ == "__main__":
    main()
