#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Arms of 0.5 to 1.7 m and a trunk with an arm, which share no code with the program, with one cause of error beyond
geometry and springs, or none: what `diagnose` names, what `calibrate` takes (`extra: auto`), and how well it predicts 60 fresh
postures, with that and without (`extra: none`), and the same robot without the cause. Seen by markers (60 postures, 0.15 mm of noise), a laser tracker (40 poses), or gauges, which show
the heights of three tips over a floor and their distances from two walls (60 postures). Prints a table (Markdown). Needs NumPy.

  /usr/bin/python3 tests/study/foreign_causes.py --program build/release/bin/elastocal --work DIR
      [--seeds 3] [--first 1] [--seen markers|tracker|gauges] [--arms NAME ...] [--causes NAME ...] [--details]
"""

import argparse
import csv
import json
import pathlib
import sys

import numpy as np

sys.dont_write_bytecode = True  # no files in the sources
from foreign_arm import (  # noqa: E402, pylint: disable=wrong-import-position
    JOINTS, UPRIGHT, Arm, Study, project, quaternion, turned, urdf)

H = np.pi / 2
# The columns are those of foreign_arm.py. Three axes are parallel.
SIX = [
    ("base_pan", "l1", (0, 0, 0.16), (0, 0, 0), (0, 0, 1), 3.0, 150, 7.0, (0, 0.02, 0.0)),
    ("shoulder", "l2", (0, 0.14, 0), (0, 0, 0), (0, 1, 0), 2.2, 150, 9.0, (0, 0.02, 0.22)),
    ("elbow", "l3", (0, -0.10, 0.43), (0, 0, 0), (0, 1, 0), 2.5, 100, 4.0, (0, 0, 0.18)),
    ("wrist_1", "l4", (0, 0, 0.39), (0, 0, 0), (0, 1, 0), 2.5, 40, 1.6, (0, 0.08, 0)),
    ("wrist_2", "l5", (0, 0.10, 0), (0, 0, 0), (0, 0, 1), 2.8, 40, 1.6, (0, 0, 0.08)),
    ("wrist_3", "l6", (0, 0, 0.10), (0, 0, 0), (0, 1, 0), 2.8, 40, 0.9, (0.01, 0.06, 0)),
]
# A trunk that yaws and pitches carries the arm. The waist stands still; legs are not modelled.
TRUNK = [
    ("waist_yaw", "t1", (0, 0, 0.05), (0, 0, 0), (0, 0, 1), 1.2, 150, 3.0, (0.01, 0, 0.05)),
    ("waist_pitch", "t2", (0, 0, 0.08), (0, 0, 0), (0, 1, 0), 0.6, 200, 14.0, (0.02, 0, 0.22)),
    ("arm_pitch", "a1", (0, 0.18, 0.36), (0, 0, 0), (0, 1, 0), 2.0, 60, 2.2, (0, 0.05, 0)),
    ("arm_roll", "a2", (0, 0.09, 0), (0, 0, 0), (1, 0, 0), 1.5, 60, 1.8, (0, 0, -0.06)),
    ("arm_yaw", "a3", (0, 0, -0.15), (0, 0, 0), (0, 0, 1), 1.8, 40, 1.6, (0.01, 0, -0.07)),
    ("elbow", "a4", (0.02, 0, -0.13), (0, 0, 0), (0, 1, 0), 1.3, 40, 1.2, (0, 0, -0.08)),
    ("wrist", "a5", (-0.02, 0, -0.24), (0, 0, 0), (0, 0, 1), 2.2, 20, 0.8, (0, 0.01, -0.06)),
]
# The nut of the ball screw with splines turns the tool and lifts it.
SCARA = [
    ("pan", "s1", (0, 0, 0.36), (0, 0, 0), (0, 0, 1), 2.2, 90, 6.0, (0.15, 0, 0)),
    ("elbow", "s2", (0.32, 0, 0.04), (0, 0, 0), (0, 0, 1), 2.3, 60, 4.0, (0.13, 0, 0.03)),
    ("nut", "s3", (0.26, 0, -0.02), (0, 0, 0), (0, 0, -1), 2.8, 20, 0.4, (0, 0, 0.02)),
    ("quill", "s4", (0, 0, 0), (0, 0, 0), (0, 0, -1), (0.0, 0.2), 100, 0.6, (0, 0, -0.1), "prismatic"),
]
# Joints, scale of lengths, factor of compliances.
ARMS = {"desk": (SIX, 0.45, 12.0), "small": (JOINTS, 0.6, 4.0), "cobot": (SIX, 1.0, 1.0), "seven": (JOINTS, 1.0, 1.0),
        "long": (SIX, 1.45, 0.7), "trunk": (TRUNK, 1.0, 1.0),
        "scara": (SCARA, 1.0, 1.0)}
CAUSES = ("none", "eccentricity", "gear", "backlash", "hysteresis", "coupling", "mass", "suspension", "tilt")
SIZES = {"eccentricity": 1.2e-3, "gear": 2e-3, "backlash": 1.5e-3, "hysteresis": 1.5e-3, "coupling": 2e-3, "mass": 0.25,
         "suspension": 1.5e-3, "tilt": np.radians(1.0)}  # suspension: at the largest moment
SLIDE = 0.15  # m for a radian, in sizes and offsets


def scaled(joints, scale):
    by = lambda place: tuple(scale * x for x in place)
    return [(n, l, by(p), r, a, q, e * scale**2, m * scale**2, by(c), *kind) for n, l, p, r, a, q, e, m, c, *kind in joints]


class Robot(Arm):
    """An arm with one cause. Encoders show the joints' positions less the cause's effect."""

    def __init__(self, kind, cause, seed, joint=None):
        table, scale, softness = ARMS[kind]
        joints = scaled(table, scale)
        count, rng = len(joints), np.random.default_rng([seed, list(ARMS).index(kind)])
        bodies = [count - 1] * 3 + [max(1, count - 4)] * 3
        size = 0.06 * scale**0.5
        near = size * np.array([(1, 0.1, 0.8), (-0.8, 0.9, 1.0), (0.1, -1.1, 0.5), (1.2, 0.1, 1.4), (-1, 1.1, 1.6), (0.1, -1.3, 0.7)])
        super().__init__(joints, bodies, near)
        self.kind, self.cause, self.nominal = kind, cause, near
        self.offset = np.radians(rng.uniform(0.1, 1.0, count) * rng.choice([-1, 1], count)) * np.where(self.slides, SLIDE, 1)
        self.places = [(turned(rng.normal(size=3) * np.radians(0.12)) @ turn, place + rng.normal(size=3) * 1e-3)
                       for turn, place in self.places]
        self.compliance = softness * rng.uniform(10e-6, 60e-6, count)
        self.masses = self.masses * (1 + 0.02 * rng.normal(size=count))
        self.markers = near + rng.uniform(-4e-3, 4e-3, near.shape)
        self.joint = int(rng.integers(count))  # the joint with the cause
        if cause == "coupling":
            self.joint = max(1, self.joint)
        if joint is not None:
            self.joint = [j[0] for j in joints].index(joint)
        self.phase, self.sign = rng.uniform(0, 2 * np.pi), rng.choice([-1, 1])
        self.size = self.sign * SIZES.get(cause, 0) * (SLIDE if self.slides[self.joint] and cause != "gear" else 1)
        if cause == "mass":
            self.masses[self.joint] *= 1 + SIZES["mass"]
        if cause == "tilt":
            self.gravity = turned(SIZES["tilt"] * np.array([np.cos(self.phase), np.sin(self.phase), 0])) @ self.gravity
        self.largest_moment = 9.81 * sum(self.masses) * scale * 0.5

    def named(self):
        name, link = self.joints[self.joint][:2]
        return {"none": None, "mass": f"{link}.mass", "suspension": "waist.suspension", "tilt": "gravity.tilt",
                "coupling": f"{name}.coupling_{self.joints[self.joint - 1][0]}"}.get(self.cause, f"{name}.{self.cause}")

    def errors(self, q, before):
        """Positions of the joints minus those of the encoders."""
        k, error = self.joint, np.zeros(len(q))
        if self.cause == "eccentricity":
            error[k] = self.size * np.sin(q[k] + self.phase)
        elif self.cause == "gear":
            error[k] = self.size * q[k]
        elif self.cause == "coupling":
            error[k] = self.size * q[k - 1]
        elif self.cause == "hysteresis":
            error[k] = self.size * np.sign(q[k] - before[k])
        elif self.cause == "backlash":
            load = self.loads(self.frames(q))[k]
            error[k] = abs(self.size) * np.tanh(load / (0.01 * self.joints[k][6]))
        return error

    def links(self, rows):
        """Frames of the links in the base's frame, posture by posture, each reached from the one before."""
        before = rows[0]  # the way to the first posture is unknown: it counts as in the middle of the play
        for q in rows:
            frames = self.stands(q + self.errors(q, before))
            if self.cause == "suspension":
                moment = sum(np.cross(f[1] + f[0] @ np.array(j[8]), m * self.gravity)
                             for f, j, m in zip(frames, self.joints, self.masses))
                turn = turned(SIZES["suspension"] / self.largest_moment * moment * np.array([1, 1, 0]))
                frames = [(turn @ f[0], turn @ f[1]) for f in frames]
            before = q
            yield frames

    def postures(self, count, seed):
        rng, found = np.random.default_rng(seed), []
        limits = np.array([j[5] if isinstance(j[5], tuple) else (-j[5], j[5]) for j in self.joints])
        middle, half, nominal = limits.mean(axis=1), 0.5 * (limits[:, 1] - limits[:, 0]), Arm(self.joints)
        while len(found) < count:
            q = middle + half * rng.uniform(-0.95, 0.95, len(half))
            if nominal.frames(q)[-1][1][2] > 0.03:
                found.append(q)
        return np.array(found)


def words(numbers, digits):
    return [f"{x:.{digits}f}" for x in numbers]


def write(file, robot, q, columns, rows):
    with open(file, "w", newline="") as out:
        table = csv.writer(out)
        table.writerow([j[0] for j in robot.joints] + columns)
        table.writerows(words(a, 7) + words(b, 7) for a, b in zip(q, rows))
    return file


TIPS, WALLS = range(3), ("floor", "wall_x", "wall_y")


def seen_by(kind, robot, q, rng):
    """Names of columns, and rows; without noise if rng is None."""
    noise = (lambda size, sd: rng.normal(size=size) * sd) if rng else (lambda size, sd: np.zeros(size))
    turn, place = UPRIGHT
    rows, base = [], robot.markers
    for frames in robot.links(q):
        points = np.array([frames[b][1] + frames[b][0] @ p for b, p in zip(robot.bodies, base)])
        if kind == "markers":
            rows.append((points @ turn.T + place + noise(points.shape, 0.15e-3)).ravel())
        elif kind == "tracker":
            at = turn @ points[0] + place + noise(3, 5e-5)
            rows.append(np.concatenate([at, quaternion(turned(noise(3, 2e-4)) @ turn @ frames[-1][0])]))
        else:
            normals = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
            rows.append((points[:3] @ normals.T + 0.5 + noise((3, 3), 5e-5)).ravel())
    if kind == "markers":
        return [f"M{m + 1}_{axis}" for m in range(6) for axis in "xyz"], rows
    if kind == "tracker":
        return [f"lt_{c}" for c in ("x", "y", "z", "qx", "qy", "qz", "qw")], rows
    return [f"tip{t}_{w}" for t in TIPS for w in WALLS], rows


def project_of(kind, robot):
    tip = robot.joints[-1][1]
    mm = lambda p: [round(1e3 * float(x), 3) for x in p]
    if kind == "markers":
        text = f"robot: {{urdf: {robot.kind}.urdf}}\nchains: [{{name: arm, tip: {tip}}}]\nmarkers:\n  single:\n"
        for m, (body, p) in enumerate(zip(robot.bodies, robot.nominal)):
            text += f"    - {{name: M{m + 1}, link: {robot.joints[body][1]}, position_mm: {mm(p)}}}\n"
        return text
    text = f"robot: {{urdf: {robot.kind}.urdf}}\ninstruments:\n"
    if kind == "tracker":
        return text + (f"  trackers: [{{name: laser}}]\n  poses: [{{name: lt, link: {tip}, tracker: laser, "
                       f"xyz_mm: {mm(robot.nominal[0])}}}]\n")
    text += "  planes:\n"
    for wall, normal in zip(WALLS, ("[0, 0, 1]", "[1, 0, 0]", "[0, 1, 0]")):
        text += f"    - {{name: {wall}, normal: {normal}}}\n"
    text += "  distances:\n"
    for t in TIPS:
        for wall in WALLS:
            text += (f"    - {{name: tip{t}_{wall}, link: {tip}, plane: {wall}, point_mm: {mm(robot.nominal[t])}, "
                     f"mounting_sd_mm: 5}}\n")
    return text


def rms_fresh(study, kind, file, folder, fresh):
    """Error (mm) in fresh postures without noise; frozen, or with the surroundings registered anew."""
    out = study.work / "validation.json"
    done = study.run("validate", file, "--calibration", folder, "--recording", fresh, "--json", out,
                     *(["--frozen"] if kind == "markers" else ["--refit", "table"]))
    if done.returncode not in (0, 4) or not out.exists():
        return float("nan")
    figures = json.loads(out.read_text())
    if kind == "markers":
        return figures["rmse_3d_mm"]["calibrated"]
    of = figures["contact"]["instruments"]
    return float(np.sqrt(np.mean([i["position_mm" if kind == "tracker" else "height_mm"]**2 for i in of])))


def calibrated(study, kind, robot, seed, extra=""):
    """Exit code, folder, error of fresh postures."""
    count = 40 if kind == "tracker" else 60
    q, fresh = robot.postures(count, 10 + seed), robot.postures(60, 5000 + seed)
    name = f"{robot.kind}_{robot.cause}_{seed}{'_none' if extra else ''}"
    file = study.work / f"{kind}_{robot.kind}{'_none' if extra else ''}.yaml"
    file.write_text(project_of(kind, robot) + extra)
    (study.work / f"{robot.kind}.urdf").write_text(urdf(robot.joints))
    table = write(study.work / f"{name}.csv", robot, q, *seen_by(kind, robot, q, np.random.default_rng(seed)))
    done = study.run("calibrate", file, "--recording", table, "-o", study.work / name)
    judge = write(study.work / "fresh.csv", robot, fresh, *seen_by(kind, robot, fresh, None))
    return done, study.work / name, rms_fresh(study, kind, file, study.work / name, judge)


def diagnosed(study, folder):
    """The chosen causes, and all that are significant alone."""
    out = folder / "diagnosis.json"
    out.unlink(missing_ok=True)
    done = study.run("diagnose", folder, "--json", out)
    if not out.exists():
        return [done.stderr.strip()[:150]], []
    found = json.loads(out.read_text())
    chosen = [c["name"] for c in found["chosen"]] if found["accepted"] else []
    return chosen, [c["name"] for c in found["candidates"] if c["p_adjusted"] < 0.05]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--seen", choices=("markers", "tracker", "gauges"), default="markers")
    parser.add_argument("--arms", nargs="+", choices=list(ARMS), default=list(ARMS))
    parser.add_argument("--causes", nargs="+", choices=CAUSES, default=CAUSES)
    parser.add_argument("--joint", help="that the cause is in; default: drawn")
    parser.add_argument("--details", action="store_true", help="a line for each robot")
    options = parser.parse_args()
    study, kind, clean = Study(options.program, options.work), options.seen, {}
    print("| cause | named first | among those chosen | significant | nothing named | taken by calibrate | nothing taken | "
          "fresh postures, mm: without it | with it | `extra: none` |\n|---|---|---|---|---|---|---|---|---|---|")
    for cause in options.causes:
        counts, errors = np.zeros(7, int), []
        for arm in options.arms:
            for seed in range(options.first, options.first + options.seeds):
                robot = Robot(arm, cause, seed, options.joint)
                done, folder, error = calibrated(study, kind, robot, seed)
                chosen, listed = diagnosed(study, folder)
                taken = json.loads((folder / "summary.json").read_text()).get("extra", [])
                if (arm, seed) not in clean:
                    clean[arm, seed] = error if cause == "none" else calibrated(study, kind, Robot(arm, "none", seed), seed)[2]
                row = [clean[arm, seed], error,
                       calibrated(study, kind, robot, seed, "calibration: {extra: none}\n")[2]]
                want = robot.named()
                counts += [bool(chosen) and chosen[0] == want, want in chosen, want in listed, not chosen, want in taken, not taken, 1]
                errors.append(row)
                if options.details:
                    print(f"    {arm} {seed} exit {done.returncode} {want}: {chosen} | {listed[:4]} | {taken} | "
                          + " ".join(words(row, 3)), flush=True)
        means = words(np.sqrt(np.nanmean(np.square(errors), axis=0)), 3)
        print(f"| {cause} | " + " | ".join(f"{c} of {counts[-1]}" for c in counts[:-1]) + " | " + " | ".join(means) + " |", flush=True)


if __name__ == "__main__":
    main()
