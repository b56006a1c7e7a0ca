#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Faults of a laboratory in recordings of real robots (../shared/data): posture tables of a TIAGo, judged by a table of
another day, and of a TALOS arm, judged by every third row. `calibrate` runs with its defaults on the faulty table. What it
deploys is judged by `validate` on the clean rows, against the calibration of the clean table. Prints a table (Markdown).

  tests/study/measured_faults.py PROGRAM FOLDER [--robots tiago talos] [--seed 1] [--only KIND ...] [--list]

A fault is "named" if the first objection has its words, "later" if another sentence has them. A deployed result should
have no more than 1.3 times the clean error.
"""
import argparse
import csv
import json
import math
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import time
import xml.etree.ElementTree as ET

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SHARED = pathlib.Path(os.environ.get("ELASTOCAL_SHARED_DATA", SOURCE.parent / "shared" / "data")).resolve()
DEGREE = math.pi / 180
LIMIT = 1.3  # error over that without a fault


class Table:
    """A posture table whose cells are numbers."""

    def __init__(self, path=None, header=None, rows=None):
        if path:
            with path.open(newline="") as file:
                header, *rows = csv.reader(file)
            rows = [[float(cell) if cell else math.nan for cell in row] for row in rows]
        self.header, self.rows = list(header), [list(row) for row in rows]

    def copy(self):
        return Table(header=self.header, rows=self.rows)

    def write(self, path):
        with path.open("w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(self.header)
            writer.writerows([["" if math.isnan(x) else repr(x) for x in row] for row in self.rows])

    def change(self, columns, change, begin=0.0, end=1.0):
        """Replaces the cells of these columns by `change` of them, in a part of the rows."""
        at = [self.header.index(name) for name in columns]
        count = len(self.rows)
        for row in self.rows[round(begin * count):round(end * count)]:
            for i, value in zip(at, change([row[i] for i in at])):
                row[i] = value


class Robot:
    """What is needed to calibrate a robot: project, clean table and clean rows to judge by."""

    def __init__(self, name, urdf, tip, markers, table, judge, project):
        self.name, self.urdf, self.tip, self.table, self.judge, self.project = name, urdf, tip, table, judge, project
        self.markers = markers  # names of the columns of each marker
        root = ET.parse(urdf).getroot()
        parents = {j.find("child").get("link"): j for j in root.iter("joint") if j.find("child") is not None}
        self.chain = []
        link = tip
        while link in parents:
            joint = parents[link]
            if joint.get("type") != "fixed":
                self.chain.insert(0, joint.get("name"))
            link = joint.find("parent").get("link")
        self.types = {j.get("name"): j.get("type") for j in root.iter("joint")}
        spread = lambda column: max(column) - min(column)
        self.moving = [j for j in self.chain if j in table.header and
                       spread([row[table.header.index(j)] for row in table.rows]) > (
                           0.1 if self.types[j] == "prismatic" else 0.4)]

    def columns(self):
        return [name for marker in self.markers for name in marker]


def tiago():
    folder = SHARED / "tiago_mocap"
    places = {"M1": (0, 70, 130), "M2": (0, -90, 145), "M3": (0, -60, 235), "M4": (0, 50, 235)}  # mm on the hand
    singles = "\n".join(f"    - {{name: {name}, link: arm_7_link, position_mm: {list(at)}}}" for name, at in places.items())
    columns = ", ".join(f"M{k}: [x{k}, y{k}, z{k}]" for k in range(1, 5))
    project = ("robot: {{urdf: {urdf}}}\nchains: [{{name: arm, tip: arm_7_link}}]\nmarkers:\n  single:\n" +
               singles.replace("{", "{{").replace("}", "}}") +
               "\nrecording:\n  ignore: [shipped_row, t_start_robot, t_end_robot, marker_std_mm]\n"
               "  columns: {{markers: {{" + columns + "}}}}\n")
    return Robot("tiago", SHARED.parent / "robots/tiago/tiago_arm.urdf", "arm_7_link",
                 [[f"{axis}{k}" for axis in "xyz"] for k in range(1, 5)], Table(folder / "training.csv"),
                 Table(folder / "validation.csv"), project)


def talos():
    whole = Table(SHARED / "talos_left_arm_mocap/talos_left_arm_02_10_contact.csv")
    part = lambda kept: Table(header=whole.header, rows=[row for i, row in enumerate(whole.rows) if (i % 3 == 2) == kept])
    project = ("robot: {{urdf: {urdf}}}\nchains: [{{name: arm, tip: gripper_left_base_link}}]\nmarkers:\n  single:\n"
               "    - {{name: M1, link: arm_left_7_link, position_mm: [60, 10, -70]}}\n"
               "recording:\n  columns: {{time: t, markers: {{M1: [x1, y1, z1]}}}}\n")
    return Robot("talos", SOURCE / "models/talos/talos.urdf", "gripper_left_base_link", [["x1", "y1", "z1"]], part(False),
                 part(True), project)


def joint_cases(robot, draw):
    joints = robot.moving
    several = lambda count: draw.sample(joints, min(count, len(joints)))
    change = lambda columns, how, *part: lambda case: case.table.change(columns, how, *part)
    sign = lambda j: [j, f"sign:{j}"]
    for j in joints:
        yield "sign", f"sign of {j}", sign(j), change([j], lambda v: [-v[0]])
    for _ in range(5):
        a, b = draw.sample(joints, 2)
        yield "exchange", f"{a} and {b} exchanged", [a, b, "exchange"], change([a, b], lambda v: [v[1], v[0]])
    for size in (1.05, 0.95, 1.01, 0.99):
        for j in several(3):
            yield "gain", f"{j} times {size}", [j, "times the true"], change([j], lambda v, s=size: [s * v[0]])
    for size in (5, -5, 1, -1):
        for j in several(3):
            begin = draw.uniform(0.3, 0.7)
            step = size * (0.01 if robot.types[j] == "prismatic" else DEGREE)
            unit = "cm" if robot.types[j] == "prismatic" else "deg"
            yield ("offset", f"{j} {size:+} {unit} from {begin:.2f} on", [j, "off by|are wrong"],
                   change([j], lambda v, s=step: [v[0] + s], begin))
    for j in several(5):
        begin = draw.choice([0.0, 0.25, 0.5])
        kept = robot.table.rows[round(begin * len(robot.table.rows))][robot.table.header.index(j)]
        yield ("frozen", f"{j} frozen from {begin} to {begin + 0.5}", [j, "frozen|says the same|same in all"],
               change([j], lambda v, k=kept: [k], begin, begin + 0.5))
    for j in several(2):
        unit, factor = ("millimet", 1000) if robot.types[j] == "prismatic" else ("degrees", 1 / DEGREE)
        yield "units", f"{j} in {unit}", [j, unit], change([j], lambda v, f=factor: [f * v[0]])
    yield "units", "all joints in degrees", ["degrees"], lambda case: [
        case.table.change([j], lambda v: [v[0] / DEGREE]) for j in robot.chain
        if j in case.table.header and robot.types[j] != "prismatic"]
    for j in several(3):
        def late(case, j=j):
            at = case.table.header.index(j)
            column = [row[at] for row in case.table.rows]
            for row, value in zip(case.table.rows, [column[0]] + column[:-1]):
                row[at] = value
        yield "late", f"{j} one row late", [j, "row"], late


def marker_cases(robot, draw):
    every = robot.columns()
    change = lambda columns, how, *part: lambda case: case.table.change(columns, how, *part)
    for size in (1.02, 0.98, 1.005, 0.995):
        yield "scale", f"cameras' scale {size}", ["camera", "times the true"], change(
            every, lambda v, s=size: [s * x for x in v])
    by_axis = lambda order, signs: lambda v: [s * v[3 * m + k] for m in range(len(v) // 3) for k, s in zip(order, signs)]
    for axis in range(3):
        signs = [-1 if k == axis else 1 for k in range(3)]
        yield "axes", f"{'xyz'[axis]} of the markers reversed", ["left-handed"], change(every, by_axis((0, 1, 2), signs))
    yield "axes", "x and y of the markers exchanged", ["left-handed"], change(every, by_axis((1, 0, 2), (1, 1, 1)))
    yield "axes", "y and z of the markers exchanged", ["left-handed"], change(every, by_axis((0, 2, 1), (1, 1, 1)))
    yield "up", "y is up (axes turned, z stated)", ["up"], change(every, by_axis((1, 2, 0), (1, 1, 1)))
    yield "units", "all markers in mm", ["mm|1000|unit"], change(every, lambda v: [1000 * x for x in v])
    if len(robot.markers) > 1:
        one = draw.choice(robot.markers)
        yield "units", f"marker of {one[0]} in mm", ["M" + one[0][1:]], change(one, lambda v: [1000 * x for x in v])
        for begin, end in ((0.5, 1.0), (0.0, 0.5), (0.3, 0.5)):
            a, b = draw.sample(robot.markers, 2)
            yield ("labels", f"M{a[0][1:]} and M{b[0][1:]} exchanged from {begin} to {end}",
                   ["M" + a[0][1:], "M" + b[0][1:], "exchange"], change(a + b, lambda v: v[3:] + v[:3], begin, end))
    knocked = draw.choice(robot.markers)
    for size in (0.01, 0.003):
        # Along a direction of the hand it would be a knock; along the room's it is also a push of the cameras.
        yield ("knock", f"M{knocked[0][1:]} moved by {1000 * size:.0f} mm in the hand from 0.5 on", ["M" + knocked[0][1:]],
               lambda case, s=size: case.knock(knocked, s, 0.5))
        yield ("push", f"cameras or base pushed by {1000 * size:.0f} mm from 0.5 on", ["tracker|base|pushed|moved"], change(
            every, lambda v, s=size: [x + (s if k % 3 == 0 else 0) for k, x in enumerate(v)], 0.5))
    for shift in (1, -2):
        def shifted(case, shift=shift):
            at = [case.table.header.index(name) for name in every]
            before = [[row[i] for i in at] for row in case.table.rows]
            for k, row in enumerate(case.table.rows):
                for i, value in zip(at, before[(k + shift) % len(before)]):
                    row[i] = value
        yield "rows", f"markers of row i + {shift}", ["row"], shifted


def urdf_cases(robot, draw):
    def longer(joint, size):
        def put(case):
            tree = ET.parse(robot.urdf)
            origin = next(j for j in tree.iter("joint") if j.get("name") == joint).find("origin")
            xyz = [float(x) for x in origin.get("xyz").split()]
            at = max(range(3), key=lambda k: abs(xyz[k]))
            xyz[at] += size
            origin.set("xyz", " ".join(map(repr, xyz)))
            case.urdf = case.folder / "wrong.urdf"
            tree.write(case.urdf)
        return put
    for j in draw.sample(robot.chain[2:], 4):
        yield "urdf", f"{j} 20 mm further in the URDF", [re.sub("_joint", "", j), "mm|length"], longer(j, 0.02)
    if robot.name == "talos":
        def other_side(case):
            case.table.header = [name.replace("_left_", "_right_") for name in case.table.header]
            case.project = case.project.replace("_left_", "_right_")
        yield "urdf", "the right arm in project and header", ["left-handed|side|other arm|sign"], other_side


class Case:
    """A folder with project and table, to which a fault is done."""

    def __init__(self, robot, folder):
        self.robot, self.folder, self.urdf, self.project = robot, folder, robot.urdf, robot.project
        self.table = robot.table.copy()
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)

    def knock(self, marker, size, begin):
        """Moves a marker away from the hand's centre; a single one along a direction that turns with the hand."""
        at = [self.table.header.index(name) for name in marker]
        others = [m for m in self.robot.markers if m != marker]
        rows = self.table.rows[round(begin * len(self.table.rows)):]
        for row in rows:
            place = [row[i] for i in at]
            centre = [sum(row[self.table.header.index(m[k])] for m in others) / len(others) for k in range(3)] if others else [
                0.0, 0.0, 0.0]
            way = [a - b for a, b in zip(place, centre)]
            length = math.dist(place, centre)
            for i, w in zip(at, way):
                row[i] += size * w / length

    def write(self):
        self.table.write(self.folder / "table.csv")
        (self.folder / "project.yaml").write_text(self.project.format(urdf=self.urdf))

    def run(self, program, *words):
        return subprocess.run([program, *words], capture_output=True, text=True, cwd=self.folder, check=False)

    def calibrate(self, program):
        self.write()
        return self.run(program, "calibrate", "project.yaml", "--recording", "table.csv", "-o", "out")

    def error(self, program):
        """Error on the clean rows with all that was calibrated, mm."""
        judge = Table(header=self.robot.judge.header, rows=self.robot.judge.rows)
        if "_right_" in self.project:
            judge = Table(header=[n.replace("_left_", "_right_") for n in judge.header], rows=judge.rows)
        judge.write(self.folder / "judge.csv")
        done = self.run(program, "validate", "project.yaml", "--calibration", "out", "--recording", "judge.csv", "--json",
                        "judged.json")
        if not (self.folder / "judged.json").exists():
            return math.nan, done
        return json.loads((self.folder / "judged.json").read_text())["rmse_3d_mm_all"]["calibrated"], done

    def told(self, done):
        summary = self.folder / "out/summary.json"
        read = json.loads(summary.read_text()) if summary.exists() else {}
        first = (read.get("objections") or [""])[0]
        if done.returncode in (2, 3) or not first:
            first = next((line for line in done.stderr.split("\n") if "error" in line), "")
        rest = read.get("objections", [])[1:] + read.get("warnings", []) + read.get("remarks", [])
        rest += done.stdout.split("\n") + done.stderr.split("\n")
        return first, rest


def has(words, sentence):
    return all(any(re.search(rf"(?<!\w){re.escape(one)}", sentence) for one in word.split("|")) for word in words)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--robots", nargs="+", default=["tiago", "talos"], choices=["tiago", "talos"])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="+", help="kinds of faults")
    parser.add_argument("--list", action="store_true", help="only say what would be tried")
    args = parser.parse_args()
    args.program = args.program.resolve()
    args.folder = args.folder.resolve()
    for name in args.robots:
        robot = globals()[name]()
        draw = random.Random(args.seed)
        cases = [case for family in (joint_cases, marker_cases, urdf_cases) for case in family(robot, draw)]
        if args.only:
            cases = [case for case in cases if case[0] in args.only]
        if args.list:
            print("\n".join(f"{name}: {kind}: {what}" for kind, what, _, _ in cases))
            continue
        clean = Case(robot, args.folder / name / "clean")
        done = clean.calibrate(args.program)
        sound, _ = clean.error(args.program)
        print(f"{name}: clean exit {done.returncode}, {sound:.3f} mm; {clean.told(done)[0]}\n")
        print("| fault | exit | named | error / clean | s | said |\n|---|---|---|---|---|---|")
        named = bad = 0
        for k, (kind, what, words, put) in enumerate(cases):
            case = Case(robot, args.folder / name / f"{k}_{kind}")
            put(case)
            begin = time.monotonic()
            done = case.calibrate(args.program)
            spent = time.monotonic() - begin
            first, rest = case.told(done)
            how = "yes" if has(words, first) else "later" if any(has(words, one) for one in rest) else "no"
            named += how != "no"
            ratio = ""
            if done.returncode == 0:
                error = case.error(args.program)[0] / sound
                ratio = f"{error:.2f}"
                bad += not error <= LIMIT
            said = first or next((one for one in rest if has(words, one)), "")
            print(f"| {what} | {done.returncode} | {how} | {ratio} | {spent:.0f} | {said[:160].replace('|', '/')} |", flush=True)
        print(f"| **{len(cases)} faults** | | **{named}** | **{bad} above {LIMIT}** | | |\n")


if __name__ == "__main__":
    sys.exit(main())
