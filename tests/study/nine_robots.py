#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Calibrates virtual robots from nominal URDFs that are nearly, but not exactly, aligned.

For each robot and each level, the origins of the nominal URDF are perturbed (or rounded), a true
robot with errors of its own plays random postures, and the program calibrates and validates. The
true robot and its markers are computed here, independently of the program. The exported URDF is
compared with the true robot over held-out postures, after the best choice of what nothing measures:
where the root frame is, and where the markers are on their links.

  nine_robots.py --program build/release/bin/elastocal --work /tmp/study ROBOT...

A ROBOT is a project file, a URDF (it then gets clusters of markers on every third link and at the
ends), or the name of an invented robot: coaxial7, waist_biped, rail_arm. PyYAML is needed.
"""

import argparse
import json
import math
import pathlib
import random
import subprocess
import sys
import xml.etree.ElementTree as ET

import yaml

sys.dont_write_bytecode = True  # no files in the sources
from own_kinematics import (  # noqa: E402, pylint: disable=wrong-import-position
    apply, apply_inverse, cross, IDENTITY, mat_vec, Robot, rotation, times, transpose)
from study_robots import (  # noqa: E402, pylint: disable=wrong-import-position
    LEVELS, load, perturbed, true_robot)

NOISE_MM = 0.1


# --- what the true robot plays and shows ------------------------------------------------------------

def markers_of(project, draw):
    """Link and true position of each marker. Nominal positions are off by some 3 mm."""
    found = {}
    for c in project["markers"].get("clusters", []):
        for i, p in enumerate(c["positions_mm"], 1):
            found[f"{c['name']}_{i}"] = (c["link"], [1e-3 * (x + draw.gauss(0, 3)) for x in p])
    for s in project["markers"].get("single", []):
        found[s["name"]] = (s["link"], [1e-3 * (x + draw.gauss(0, 3)) for x in s["position_mm"]])
    return found


def true_positions(robot, markers, q):
    T = robot.links(robot.positions(q))
    return {name: apply(T[link], p) for name, (link, p) in markers.items()}


def random_postures(robot, count, draw):
    share = 0.05
    return [{j["name"]: draw.uniform(j["lower"] + share * (j["upper"] - j["lower"]),
                                     j["upper"] - share * (j["upper"] - j["lower"]))
             for j in robot.moving()} for _ in range(count)]


def write_table(path, robot, markers, postures, T_ref_root, draw):
    names = [j["name"] for j in robot.moving()]
    header = names + [f"{m}_{c}" for m in markers for c in "xyz"]
    lines = [",".join(header)]
    for q in postures:
        row = [q[n] for n in names]
        for p in true_positions(robot, markers, q).values():
            row += [x + draw.gauss(0, 1e-3 * NOISE_MM) for x in apply(T_ref_root, p)]
        lines.append(",".join(f"{x:.9f}" for x in row))
    path.write_text("\n".join(lines) + "\n")


# --- the exported URDF against the true robot -----------------------------------------------------

def solve(A, b):
    n = len(b)
    M = [row[:] + [x] for row, x in zip(A, b)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda k: abs(M[k][i]))
        M[i], M[pivot] = M[pivot], M[i]
        for k in range(i + 1, n):
            f = M[k][i] / M[i][i]
            M[k] = [x - f * y for x, y in zip(M[k], M[i])]
    x = [0.0] * n
    for i in reversed(range(n)):
        x[i] = (M[i][n] - sum(M[i][k] * x[k] for k in range(i + 1, n))) / M[i][i]
    return x


def urdf_error_mm(exported, truth, markers, postures):
    """Root mean square and largest distance over postures and markers that a joint moves, with
    the best root frame (Gauss-Newton) and the best marker positions on the links."""
    seen = {m: [] for m, (link, _) in markers.items() if link != truth.root}
    for q in postures:
        T = exported.links(exported.positions(q))
        positions = true_positions(truth, markers, q)
        for m in seen:
            seen[m].append((T[markers[m][0]], positions[m]))
    T_root = IDENTITY
    for _ in range(6):
        A, b = [[0.0] * 6 for _ in range(6)], [0.0] * 6
        squares, largest, count = 0.0, 0.0, 0
        for observations in seen.values():
            rows = []  # for each posture: marker in the link's frame, and its derivatives
            for T, p in observations:
                at_root = apply_inverse(T_root, p)
                R = transpose(T[0])
                local = apply_inverse(T, at_root)
                # If the root frame is displaced by v and turned by w, it has the marker at p - v -
                # w x p.
                columns = [[-x for x in mat_vec(R, [1.0 * (i == k) for i in range(3)])]
                           for k in range(3)]
                columns += [mat_vec(R, cross(at_root, [1.0 * (i == k) for i in range(3)]))
                            for k in range(3)]
                rows.append([local] + columns)
            n = len(rows)
            mean = [[sum(r[c][i] for r in rows) / n for i in range(3)] for c in range(7)]
            for r in rows:
                e = [[r[c][i] - mean[c][i] for i in range(3)] for c in range(7)]
                d2 = sum(x * x for x in e[0])
                squares, largest, count = squares + d2, max(largest, d2), count + 1
                for a in range(6):
                    b[a] -= sum(x * y for x, y in zip(e[a + 1], e[0]))
                    for c in range(6):
                        A[a][c] += sum(x * y for x, y in zip(e[a + 1], e[c + 1]))
        for a in range(6):  # a single free axis leaves directions of the root undetermined
            A[a][a] += 1e-9 * count
        x = solve(A, b)
        T_root = times(T_root, (rotation(x[3:]), x[:3]))
    return 1e3 * math.sqrt(squares / count), 1e3 * math.sqrt(largest)


# --- one calibration ------------------------------------------------------------------------------

def run(program, *words):
    done = subprocess.run([program, *map(str, words), "--quiet"], capture_output=True, text=True)
    return done.returncode, done.stderr.strip()


def calibrate(program, folder, xml, project, truth, markers, draw, postures, rigid):
    folder.mkdir(parents=True, exist_ok=True)
    ET.ElementTree(xml).write(folder / "robot.urdf")
    project = dict(project, robot={"urdf": "robot.urdf"})
    if rigid:
        project["elasticity"] = {"torsion": [], "bending": []}
    project.get("recording", {}).pop("not_recorded_mm", None)
    (folder / "project.yaml").write_text(yaml.safe_dump(project))
    T_ref_root = (rotation([draw.uniform(-1, 1) for _ in range(3)]),
                  [draw.uniform(-1, 1) for _ in range(3)])
    train, held_out = (random_postures(truth, n, draw) for n in (postures, postures))
    write_table(folder / "train.csv", truth, markers, train, T_ref_root, draw)
    write_table(folder / "held_out.csv", truth, markers, held_out, T_ref_root, draw)
    out = folder / "out"
    for old in out.glob("*_calibrated.urdf"):
        old.unlink()
    code, text = run(program, "calibrate", folder / "project.yaml", "--recording",
                     folder / "train.csv", "-o", out, "--threads", 1)
    (folder / "stderr.txt").write_text(text)
    result = {"exit": code, "held_out": math.nan, "frozen": math.nan, "urdf": math.nan,
              "worst": math.nan, "before": math.nan, "file": None}
    result["before"] = urdf_error_mm(Robot(xml), truth, markers, held_out)[0]
    exported = list(out.glob("*_calibrated.urdf"))
    if code or not exported:
        return result
    for key, words in (("held_out", []), ("frozen", ["--frozen"])):
        code, text = run(program, "validate", folder / "project.yaml", "--calibration", out,
                         "--recording", folder / "held_out.csv", "--json", folder / f"{key}.json",
                         *words)
        result["exit"] = result["exit"] or code
        if (folder / f"{key}.json").exists():
            found = json.loads((folder / f"{key}.json").read_text())
            result[key] = found["rmse_3d_mm_all"]["calibrated"]
    result["file"] = exported[0]
    result["urdf"], result["worst"] = urdf_error_mm(
        Robot(ET.parse(exported[0]).getroot()), truth, markers, held_out)
    return result


SIMULATION = {"upper_geometry_scale": 1, "leg_geometry_scale": 1, "marker_noise_mm": NOISE_MM,
              "marker_mm": 3, "head_postures": 16, "arm_postures": 24, "leg_postures": 24,
              "random_postures": 10, "repetitions": 1}


def simulate(program, folder, xml, project, seed):
    """Simulates a robot that stands on its feet in the program's own simulator. Returns its truth,
    its markers and its postures in trials for validation."""
    folder.mkdir(parents=True, exist_ok=True)
    ET.ElementTree(xml).write(folder / "robot.urdf")
    (folder / "project.yaml").write_text(
        yaml.safe_dump(dict(project, robot={"urdf": "robot.urdf"})))
    (folder / "settings.yaml").write_text(yaml.safe_dump(SIMULATION))
    code, text = run(program, "simulate", folder / "project.yaml", "-o", folder / "recording",
                     "--nominal", "--settings", folder / "settings.yaml", "--seed", seed)
    if code:
        sys.exit(f"simulate: {text}")
    told = yaml.safe_load((folder / "recording" / "truth.yaml").read_text())
    truth = Robot(xml)
    for j in truth.joints:
        known = told["joints"].get(j["name"])
        j["zero"] = 0.0
        if known is None:
            continue
        j["origin"] = times(j["origin"], (
            rotation([math.radians(x) for x in known["turn_deg"]]),
            [1e-3 * x for x in known["shift_mm"]]))
        j["zero"] = (math.radians(known["offset_deg"]) if "offset_deg" in known
                     else 1e-3 * known["offset_mm"])
    links = {name: link for name, (link, _) in markers_of(project, random.Random(1)).items()}
    markers = {m: (links[m], [1e-3 * x for x in p]) for m, p in told["markers_mm"].items()}
    trials = yaml.safe_load((folder / "recording" / "experiment.yaml").read_text())["trials"]
    postures = []
    for trial in trials:
        if trial["kind"] == "calibration":
            continue
        rows = (folder / "recording" / trial["joints"]).read_text().split()
        header = rows[0].split(",")
        for row in rows[1::max(1, len(rows) // 15)]:
            q = dict(zip(header, map(float, row.split(","))))
            postures.append({j["name"]: q[j["name"]] for j in truth.moving()})
    return truth, markers, postures


def calibrate_standing(program, folder, xml, project, recording, truth, markers, postures):
    folder.mkdir(parents=True, exist_ok=True)
    ET.ElementTree(xml).write(folder / "robot.urdf")
    project = dict(project, robot={"urdf": "robot.urdf"},
                   elasticity={"torsion": [], "bending": []})
    (folder / "project.yaml").write_text(yaml.safe_dump(project))
    out = folder / "out"
    for old in out.glob("*_calibrated.urdf"):
        old.unlink()
    code, text = run(program, "calibrate", folder / "project.yaml", "--recording", recording, "-o",
                     out)
    (folder / "stderr.txt").write_text(text)
    result = {"exit": code, "held_out": math.nan, "frozen": math.nan, "urdf": math.nan,
              "worst": math.nan, "file": None,
              "before": urdf_error_mm(Robot(xml), truth, markers, postures)[0]}
    exported = list(out.glob("*_calibrated.urdf"))
    if code or not exported:
        return result
    result["file"] = exported[0]
    summary = json.loads((out / "summary.json").read_text())
    result["held_out"] = summary["deployed"]["urdf"]["rmse_3d_mm"]
    result["urdf"], result["worst"] = urdf_error_mm(
        Robot(ET.parse(exported[0]).getroot()), truth, markers, postures)
    return result


def verdict(result):
    if result["exit"]:
        return f"FAILS: exit {result['exit']}"
    if not result["held_out"] <= 1.15 * math.sqrt(3) * NOISE_MM:
        return "FAILS: held-out"
    return "ok" if result["urdf"] <= 0.1 else "FAILS: URDF"


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", required=True, type=pathlib.Path)
    parser.add_argument("--postures", type=int, default=80)
    parser.add_argument("--levels", nargs="+", default=LEVELS)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--standing", action="store_true",
                        help="robots stand on their feet, in the program's simulator")
    parser.add_argument("--ends-only", action="store_true", help="of a URDF: clusters at the ends")
    parser.add_argument("--elastic", action="store_true",
                        help="posture tables: the data decide whether joints are elastic")
    parser.add_argument("robots", nargs="+")
    args = parser.parse_args()
    failures = 0
    print(f"{'robot':<17}{'level':<9}{'step':<8}{'exit':>4}{'held-out':>10}{'frozen':>8}{'nominal':>9}"
          f"{'URDF':>8}{'worst':>8}  verdict   (mm; floor {math.sqrt(3) * NOISE_MM:.3f})")
    for argument in args.robots:
        name, xml, project = load(argument, args.ends_only)
        standing = None
        for level in args.levels:
            draw = random.Random(f"{args.seed} {name} {level}")
            markers = markers_of(project, draw)
            folder = args.work / (name + "_standing" * args.standing) / level
            nominal = perturbed(xml, level, draw)
            for step in ("first", "again"):
                # In the second step, the exported URDF is the nominal one, as after repairs.
                if args.standing:
                    recorded = args.work / (name + "_recorded") / step
                    if step == "again":
                        played = simulate(args.program, recorded, nominal, project, args.seed + 1)
                    else:
                        standing = standing or simulate(args.program, recorded, xml, project,
                                                        args.seed)
                        played = standing
                    r = calibrate_standing(args.program, folder / step, nominal, project,
                                           recorded / "recording", *played)
                else:
                    truth = true_robot(xml if step == "first" else nominal, draw)
                    r = calibrate(args.program, folder / step, nominal, project, truth, markers,
                                  draw, args.postures, not args.elastic)
                failures += verdict(r) != "ok"
                print(f"{name:<17}{level:<9}{step:<8}{r['exit']:>4}{r['held_out']:>10.3f}"
                      f"{r['frozen']:>8.3f}{r['before']:>9.2f}{r['urdf']:>8.3f}{r['worst']:>8.3f}"
                      f"  {verdict(r)}", flush=True)
                if r["file"] is None:
                    break
                nominal = ET.parse(r["file"]).getroot()
    print(f"{failures} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
