#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Causes of error beyond geometry and springs on a Panda, a TIAGo with its lift, trunk and left arm of a simple humanoid,
and an invented gantry with two slides, seen by instruments: poses of a tracker, gauges on three tips, a reflector with an
inertial unit, or three wires with one. The true robots share no code with the program; they are rigid, or have springs of
about 30 or 80 urad/(N.m). 50 postures, 40 of a tracker. Prints tables (Markdown). Needs NumPy and the Python module.

  clean       nothing injected: what `calibrate` takes and `diagnose` names
  sizes       eccentricity, gear, hysteresis or coupling of one joint, drawn by the seed and named in
              `calibration.extra`: how often the truth is in its interval of 95 %
  suspension  10 urad/(N.m) of the base: error of the exported model in 80 fresh postures, registered anew
  hysteresis  1.5 mrad of one joint: whether it is taken, and the same error, also where each posture is the first
              one that the model sees, so that it does not know the way, and of the URDF
  tiago       a real TIAGo (../shared/data/tiago_mocap), calibrated by one session: the model at run time on the rows
              of both, base and markers placed by the same rows; and again where each is the first

  /usr/bin/python3 tests/study/cause_sizes.py --program build/release/bin/elastocal --work DIR [--only PART ...]
      [--robots NAME ...] [--seen KIND ...] [--springs 0 30 80] [--seeds 1] [--first 1] [--details]

URDFs of others are looked for in ../shared/robots; a robot that is not there is left out.
"""

import argparse
import csv
import json
import pathlib
import re
import sys
import xml.etree.ElementTree as xml

import numpy as np

sys.dont_write_bytecode = True  # no files in the sources
import foreign_causes as causes  # noqa: E402, pylint: disable=wrong-import-position
from foreign_arm import (  # noqa: E402, pylint: disable=wrong-import-position
    UPRIGHT, Arm, Study, from_rpy, placed_error, turned, urdf)

DATA = pathlib.Path(__file__).resolve().parents[3] / "shared/data/tiago_mocap"
SHARED = pathlib.Path(__file__).resolve().parents[3] / "shared/robots"
H = np.pi / 2
GANTRY = [
    ("rail", "beam", (0, 0, 1.6), (0, 0, 0), (1, 0, 0), (-0.6, 0.6), 900, 22.0, (0, 0.05, 0.02), "prismatic"),
    ("cross", "sledge", (0, 0, -0.1), (0, 0, 0), (0, 1, 0), (-0.4, 0.4), 500, 9.0, (0.02, 0, -0.05), "prismatic"),
    ("turret", "column", (0, 0, -0.15), (0, 0, 0), (0, 0, 1), 2.7, 80, 5.0, (0.04, 0, -0.08)),
    ("shoulder", "upper", (0.06, 0, -0.14), (0, 0, 0), (0, 1, 0), 1.6, 120, 4.0, (0.02, 0.03, -0.16)),
    ("elbow", "fore", (0, 0.03, -0.34), (0, 0, 0), (0, 1, 0), 1.9, 70, 2.2, (0, -0.02, -0.12)),
    ("roll", "wrist", (0, -0.03, -0.25), (0, 0, 0), (0, 0, 1), 2.7, 30, 1.1, (0, 0.01, -0.04)),
    ("nod", "palm", (0, 0, -0.09), (H, 0, 0), (0, 0, 1), 1.8, 20, 0.8, (0.01, -0.05, 0)),
]
URDFS = {"panda": ("panda/panda.urdf", "panda_link7"), "tiago": ("tiago/tiago_arm.urdf", "arm_7_link"),
         "humanoid": ("simple_humanoid/simple_humanoid.urdf", "l_wrist")}
KINDS = ("tracker", "gauges", "reflector", "wires")
SPRING = 10e-6  # of the base, rad/(N.m)


def rpy_of(turn):
    return (np.arctan2(turn[2, 1], turn[2, 2]), -np.arcsin(np.clip(turn[2, 0], -1, 1)), np.arctan2(turn[1, 0], turn[0, 0]))


def chain_of(file, tip):
    """Rows as in foreign_arm.py. Other joints stand at zero, with their links as mass of the link before."""
    root = xml.parse(file).getroot()
    numbers = lambda e, name: np.array([float(x) for x in (e.get(name) if e is not None and e.get(name) else "0 0 0").split()])
    pose = lambda e: (from_rpy(numbers(e, "rpy")), numbers(e, "xyz"))
    above = {j.find("child").get("link"): j for j in root.findall("joint")}
    chain, link = [], tip
    while link in above:
        chain.insert(0, above[link])
        link = above[link].find("parent").get("link")
    moving = [j for j in chain if j.get("type") != "fixed"]
    heads, rows, place = {j.find("child").get("link") for j in moving}, [], (np.eye(3), np.zeros(3))

    def masses(link, at, found):
        element = next(l for l in root.findall("link") if l.get("name") == link).find("inertial")
        if element is not None:
            found.append((float(element.find("mass").get("value")), at[1] + at[0] @ numbers(element.find("origin"), "xyz")))
        for j in root.findall("joint"):
            child = j.find("child").get("link")
            if j.find("parent").get("link") == link and child not in heads:
                own = pose(j.find("origin"))
                masses(child, (at[0] @ own[0], at[1] + at[0] @ own[1]), found)
        return found

    for j in chain:
        own = pose(j.find("origin"))
        place = (place[0] @ own[0], place[1] + place[0] @ own[1])
        if j not in moving:
            continue
        link, limit = j.find("child").get("link"), j.find("limit")
        found = masses(link, (np.eye(3), np.zeros(3)), [])
        mass = sum(m for m, _ in found)
        rows.append((j.get("name"), link, tuple(place[1]), tuple(rpy_of(place[0])), tuple(numbers(j.find("axis"), "xyz")),
                     (float(limit.get("lower")), float(limit.get("upper"))), float(limit.get("effort")), max(mass, 0.05),
                     tuple(sum(m * c for m, c in found) / max(mass, 1e-9)), *(["prismatic"] * (j.get("type") == "prismatic"))))
        place = (np.eye(3), np.zeros(3))
    return rows


class Robot(causes.Robot):
    def __init__(self, kind, cause, seed, spring):
        super().__init__(kind, cause, seed)
        rng, count = np.random.default_rng([seed, spring, causes.CAUSES.index(cause)]), len(self.joints)
        self.offset[self.slides] *= 0.1
        self.compliance = np.where(self.slides, 0, 1e-6 * spring * rng.uniform(0.7, 1.3, count))
        turning = [k for k in range(count) if not self.slides[k] and (cause != "coupling" or (k and not self.slides[k - 1]))]
        self.joint = int(rng.choice(turning))
        self.largest_moment = causes.SIZES["suspension"] / SPRING
        self.anchors = np.array([(1.6, 0.3, 0.1), (-0.7, 1.5, 0.2), (0.2, -1.4, 1.9)])
        self.real_anchors, self.zeros = self.anchors + rng.normal(size=(3, 3)) * 0.05, rng.normal(size=3) * 5e-3
        self.unit, self.bias = turned(rng.uniform(-1, 1, 3)), rng.normal(size=3) * 0.01
        self.scale = 1 + 0.002 * rng.normal(size=3)

    def truth(self):
        """Values of the parameters that the project names."""
        if self.cause == "eccentricity":
            name = self.joints[self.joint][0]
            return {f"{name}.eccentricity_sin": self.size * np.cos(self.phase), f"{name}.eccentricity_cos": self.size * np.sin(self.phase)}
        return {self.named(): self.size}

    def points(self, rows):
        """Three points of the last link, in the base."""
        return [np.array([f[-1][1] + f[-1][0] @ p for p in self.markers[:3]]) for f in self.links(rows)]


def seen_by(kind, robot, q, rng):
    """Like seen_by of foreign_causes.py, with more kinds."""
    if kind in ("tracker", "gauges"):
        return causes.seen_by(kind, robot, q, rng)
    (turn, place), rows = UPRIGHT, []
    for frames in robot.links(q):
        points = [frames[-1][1] + frames[-1][0] @ p for p in robot.markers[:3]]
        up = (frames[-1][0] @ robot.unit).T @ -robot.gravity * robot.scale + robot.bias + rng.normal(size=3) * 3e-3
        lengths = [np.linalg.norm(p - a) + z + rng.normal() * 1e-4 for p, a, z in zip(points, robot.real_anchors, robot.zeros)]
        at = turn @ points[0] + place + rng.normal(size=3) * 5e-5
        rows.append(np.concatenate([at if kind == "reflector" else lengths, up]))
    return (["lt_x", "lt_y", "lt_z"] if kind == "reflector" else ["w0", "w1", "w2"]) + ["imu_ax", "imu_ay", "imu_az"], rows


def project_of(kind, robot):
    if kind in ("tracker", "gauges"):
        return causes.project_of(kind, robot)
    mm = lambda p: [round(1e3 * float(x), 3) for x in p]
    tip, text = robot.joints[-1][1], f"robot: {{urdf: {robot.kind}.urdf}}\ninstruments:\n"
    if kind == "reflector":
        text += (f"  trackers: [{{name: laser}}]\n  positions: [{{name: lt, link: {tip}, tracker: laser, "
                 f"point_mm: {mm(robot.nominal[0])}}}]\n")
    else:
        text += "  wires:\n" + "".join(
            f"    - {{name: w{k}, link: {tip}, point_mm: {mm(robot.nominal[k])}, mounting_sd_mm: 5, anchor_mm: {mm(robot.anchors[k])}}}\n"
            for k in range(3))
    return text + f"  inertial_units: [{{name: imu, link: {tip}}}]\n"


class Bench:
    """Calibrates one robot after another."""

    def __init__(self, options):
        self.study, self.options, self.last = Study(options.program, options.work), options, None
        sys.path.insert(0, str(pathlib.Path(options.program).resolve().parent.parent / "python"))

    def robots(self, cause, seed):
        for name in self.options.robots:
            for kind in self.options.seen:
                for spring in self.options.springs:
                    yield kind, spring, Robot(name, cause, seed, spring)

    def calibrated(self, kind, spring, robot, seed, extra=""):
        q = robot.postures(40 if kind == "tracker" else 50, 10 + seed)
        name, work = f"{robot.kind}_{kind}_{spring}_{robot.cause}_{seed}", self.study.work
        (work / f"{robot.kind}.urdf").write_text(urdf(robot.joints))
        (work / f"{name}.yaml").write_text(project_of(kind, robot) + extra)
        table = causes.write(work / f"{name}.csv", robot, q, *seen_by(kind, robot, q, np.random.default_rng(seed)))
        done = self.study.run("calibrate", work / f"{name}.yaml", "--recording", table, "-o", work / name)
        self.last = work / name
        if done.returncode not in (0, 4):
            sys.exit(f"{name}: {done.stderr[:300]}")
        return done.returncode, json.loads((self.last / "summary.json").read_text()).get("extra", [])

    def details(self, *words):
        if self.options.details:
            print("   ", *words, flush=True)

    def parameters(self):
        """Value and sd by name, and half of a 95 % interval in sds."""
        text = (self.last / "calibration.yaml").read_text()
        found = re.findall(r"name: ([\w.]+), unit: \S+, value: (\S+), sd: ([^\s,}]+)", text)
        return {n: (float(v), float(s)) for n, v, s in found}, float(re.search(r"interval_95_in_sd: (\S+)", text).group(1))

    def error(self, robot, frames_of, seed):
        """Error (mm) of a model in 80 fresh postures of one motion. 40 others place base and points."""
        q = robot.postures(120, 5000 + seed)
        pairs = list(zip([frames_of(row) for row in q], robot.points(q)))
        last = len(robot.joints) - 1
        return placed_error(pairs[:40], pairs[40:], [last] * 3, robot.nominal[:3], (np.eye(3), np.zeros(3)))

    def model(self, joints, anew=False):
        """Frames by the model at run time. `anew`: each posture by a model that has seen no other."""
        import elastocal  # pylint: disable=import-outside-toplevel,import-error
        runtime = elastocal.Runtime(self.last)

        def frames(row):
            posed = (elastocal.Runtime(self.last) if anew else runtime).forward({j[0]: x for j, x in zip(joints, row)})
            links = [np.array(posed["root"]) @ np.array(posed["links"][j[1]]) for j in joints]
            return [(l[:3, :3], l[:3, 3]) for l in links]

        return frames

    def exported(self, robot):
        """The calibrated URDF, whose joints have the axes and order of the nominal one."""
        file = next(self.last.glob("*_calibrated.urdf"), None)
        if file is None:
            return None
        read, arm = chain_of(file, robot.joints[-1][1]), Arm(robot.joints)
        arm.places = [(from_rpy(row[3]), np.array(row[2])) for row in read]
        arm.axes = [np.array(row[4], float) for row in read]
        return arm.frames


def clean(bench, seed):
    taken, named, count = 0, 0, 0
    for kind, spring, robot in bench.robots("none", seed):
        code, extra = bench.calibrated(kind, spring, robot, seed)
        chosen = causes.diagnosed(bench.study, bench.last)[0]
        taken, named, count = taken + bool(extra), named + bool(chosen), count + 1
        bench.details(robot.kind, kind, spring, "exit", code, extra, chosen)
    return f"| clean | {count} | taken in {taken}, named in {named} |"


def sizes(bench, seed):
    lines = []
    for cause in ("eccentricity", "gear", "hysteresis", "coupling"):
        errors = []
        for kind, spring, robot in bench.robots(cause, seed):
            code, _ = bench.calibrated(kind, spring, robot, seed, f"calibration: {{extra: [{robot.named()}]}}\n")
            found, half = bench.parameters()
            for name, true in robot.truth().items():
                value, sd = found[name]
                errors.append(((value - true) / sd, half))
                bench.details(robot.kind, kind, spring, "exit", code, name, f"{1e3 * true:.3f} {1e3 * value:.3f} +- {1e3 * sd:.3f}")
        lines.append((cause, np.array(errors)))
    lines.append(("all", np.vstack([errors for _, errors in lines])))
    return "\n".join(f"| {cause} | {len(e)} | in the interval {100 * np.mean(abs(e[:, 0]) < e[:, 1]):.1f} %, errors "
                     f"{np.sqrt(np.mean(e[:, 0]**2)):.2f} sds |" for cause, e in lines)


def exports(cause):
    def part(bench, seed):
        lines = []
        for kind, spring, robot in bench.robots(cause, seed):
            code, extra = bench.calibrated(kind, spring, robot, seed)
            own = bench.exported(robot)
            model = f"{bench.error(robot, bench.model(robot.joints), seed):.3f} mm"
            if cause == "hysteresis":
                model += f", without the way {bench.error(robot, bench.model(robot.joints, anew=True), seed):.3f} mm"
            text = f"{bench.error(robot, own, seed):.3f}" if own else "none"
            right = "taken" if robot.named() in extra else f"taken: {', '.join(extra) or 'nothing'}"
            lines.append(f"| {cause}, {robot.kind}, {kind}, {spring} | exit {code} | {right}; model {model}, URDF {text} mm |")
        return "\n".join(lines)
    return part


def tiago(bench, _):
    places = np.array([(0, 70, 130), (0, -90, 145), (0, -60, 235), (0, 50, 235)]) / 1e3
    joints, work, lines = causes.ARMS["tiago"][0], bench.study.work, []
    markers = "".join(f"    - {{name: M{m + 1}, link: arm_7_link, position_mm: {(1e3 * p).round().tolist()}}}\n" for m, p in enumerate(places))
    columns = ", ".join(f"M{m}: [x{m}, y{m}, z{m}]" for m in range(1, 5))
    (work / "real.yaml").write_text(
        f"robot: {{urdf: {SHARED / URDFS['tiago'][0]}}}\nchains: [{{name: arm, tip: arm_7_link}}]\nmarkers:\n  single:\n{markers}"
        f"recording:\n  ignore: [shipped_row, t_start_robot, t_end_robot, marker_std_mm]\n  columns: {{markers: {{{columns}}}}}\n")
    bench.last = work / "real"
    bench.study.run("calibrate", work / "real.yaml", "--recording", DATA / "training.csv", "--kfold", "0", "-o", bench.last)
    for session in ("training", "validation"):
        rows = list(csv.DictReader((DATA / f"{session}.csv").open()))
        seen = [np.array([[float(row[f"{c}{m}"]) for c in "xyz"] for m in range(1, 5)]) for row in rows]
        q, errors = [[float(row[j[0]]) for j in joints] for row in rows], []
        for anew in (False, True):
            frames_of = bench.model(joints, anew)
            pairs = list(zip([frames_of(row) for row in q], seen))
            at = np.array([f[-1][1] + f[-1][0] @ places[0] for f, _ in pairs])
            first = np.array([points[0] for points in seen])
            u, _, v = np.linalg.svd((at - at.mean(0)).T @ (first - first.mean(0)))
            turn = v.T @ np.diag([1, 1, np.linalg.det(v.T @ u.T)]) @ u.T
            base = (turn, first.mean(0) - turn @ at.mean(0))
            errors.append(placed_error(pairs, pairs, [len(joints) - 1] * 4, places, base))
        lines.append(f"| real TIAGo, {session} | {len(rows)} rows | model {errors[0]:.3f} mm, without the way {errors[1]:.3f} mm |")
    return "\n".join(lines)


PARTS = {"clean": clean, "sizes": sizes, "suspension": exports("suspension"), "hysteresis": exports("hysteresis"), "tiago": tiago}


def main():
    for name, (file, tip) in URDFS.items():
        if (SHARED / file).exists():
            causes.ARMS[name] = (chain_of(SHARED / file, tip), 1.0, 1.0)
    causes.ARMS["gantry"] = (GANTRY, 1.0, 1.0)
    names = [n for n in (*URDFS, "gantry") if n in causes.ARMS]
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--only", nargs="+", choices=list(PARTS), default=list(PARTS))
    parser.add_argument("--robots", nargs="+", choices=names, default=names)
    parser.add_argument("--seen", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--springs", nargs="+", type=int, default=[0, 30, 80])
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--details", action="store_true", help="a line for each robot")
    options = parser.parse_args()
    bench = Bench(options)
    print("| part, seed | robots or sizes | found |\n|---|---|---|")
    for name in options.only:
        for seed in range(options.first, options.first + options.seeds):
            print(PARTS[name](bench, seed), flush=True)


if __name__ == "__main__":
    main()
