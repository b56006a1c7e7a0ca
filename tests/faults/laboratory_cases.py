# SPDX-License-Identifier: Apache-2.0
"""A laboratory's recording that can be changed, and the faults that laboratory_faults.py puts into it.

A fault is (kind, description, words that name it, function that changes a Recording).
"""

import csv
import math
import os
import pathlib
import tempfile
import xml.etree.ElementTree as ET

import yaml

DEGREE = math.pi / 180.0


class Recording:
    """A copy of the recording, whose files are the originals until they are changed."""

    def __init__(self, source, folder):
        self.folder = folder
        folder.mkdir()
        for path in source.iterdir():
            if path.is_file():
                os.link(path, folder / path.name)
        self.experiment = yaml.safe_load((folder / "experiment.yaml").read_text())
        self.trials = {trial["name"]: trial for trial in self.experiment["trials"]}

    def write(self, name, text):
        path = self.folder / name
        path.unlink()
        path.write_text(text)

    def write_experiment(self):
        self.write("experiment.yaml", yaml.safe_dump(self.experiment, sort_keys=False))

    def log(self, trial):
        with open(self.folder / self.trials[trial]["joints"], newline="") as file:
            rows = list(csv.reader(file))
        return rows[0], [[float(cell) if cell else math.nan for cell in row] for row in rows[1:]]

    def write_log(self, trial, header, rows):
        lines = [",".join(header)]
        lines += [",".join("" if math.isnan(x) else repr(x) for x in row) for row in rows]
        self.write(self.trials[trial]["joints"], "\n".join(lines) + "\n")

    def change_log(self, trials, change):
        """`change(header, rows)` of each of the trials."""
        for trial in trials:
            header, rows = self.log(trial)
            rows = change(header, rows) or rows
            self.write_log(trial, header, rows)

    def change_column(self, trials, column, change):
        """`change(value, share of the trial gone by)`, with a state of its own for each trial."""
        def all_rows(header, rows):
            at = header.index(column)
            new = change() if not isinstance(change, float) else lambda value, share: change * value
            for i, row in enumerate(rows):
                row[at] = new(row[at], i / len(rows))
        self.change_log([t for t in trials if column in self.log(t)[0]], all_rows)

    def change_markers(self, trials, change):
        """`change(names, positions, share of the trial gone by)` of every frame; positions are lists
        of three texts, and may be changed in place."""
        for trial in trials:
            name = self.trials[trial]["markers"]
            lines = (self.folder / name).read_text().split("\n")
            names = next(line.split("\t")[1:] for line in lines if line.startswith("MARKER_NAMES"))
            frames = [i for i, line in enumerate(lines) if line[:1].isdigit()]
            for k, i in enumerate(frames):
                cells = lines[i].split("\t")
                first = len(cells) - 3 * len(names)
                positions = [cells[first + 3 * m:first + 3 * m + 3] for m in range(len(names))]
                change(names, positions, k / len(frames))
                lines[i] = "\t".join(cells[:first] + [c for p in positions for c in p])
            self.write(name, "\n".join(lines))


class Laboratory:
    """What faults can be drawn from."""

    def __init__(self, project, recording, draw):
        self.draw = draw
        self.project = yaml.safe_load(project.read_text())
        urdf = ET.parse(project.parent / self.project["robot"]["urdf"]).getroot()
        self.parents = {j.find("child").get("link"): (j.get("name"), j.find("parent").get("link"))
                        for j in urdf.iter("joint") if j.find("child") is not None}
        with tempfile.TemporaryDirectory() as scratch:
            copy = Recording(recording, pathlib.Path(scratch) / "copy")
            self.trials = list(copy.trials)
            self.calibration = [t for t, trial in copy.trials.items()
                                if trial["kind"] == "calibration"]
            self.experiment = copy.trials
            self.moving = []  # pairs of a joint and a trial that exercises it
            self.loaded = []  # joints with torque sensors that are loaded
            still, loads = {}, {}
            for trial in self.calibration:
                header, rows = copy.log(trial)
                joints = [name for name in header[1:] if not name.endswith("_torque")]
                for joint in joints:
                    values = [row[header.index(joint)] for row in rows]
                    if max(values) - min(values) > 0.3 and self.exercised(joint, trial):
                        self.moving.append((joint, trial))
                    if joint + "_torque" in header:
                        torques = [row[header.index(joint + "_torque")] for row in rows]
                        torques = [x for x in torques if not math.isnan(x)]
                        if torques:
                            loads[joint] = max(loads.get(joint, 0), max(torques) - min(torques))
            # The limit is 30 N.m for a robot of 100 kg. For a small one it is a third of the load
            # of its most loaded joint.
            self.largest_load = max(loads.values(), default=0)
            self.loaded = [joint for joint, spread in loads.items() if spread > min(30, self.largest_load / 3)]
        self.clusters = {cluster["name"]: len(cluster["positions_mm"])
                         for cluster in self.project["markers"]["clusters"]}
        self.links = {cluster["name"]: cluster["link"]
                      for cluster in self.project["markers"]["clusters"]}

    def joints_to(self, link):
        joints = []
        while link in self.parents:
            joint, link = self.parents[link]
            joints.append(joint)
        return joints

    def exercised(self, joint, trial):
        tips = [chain["tip"] for chain in self.project["chains"]
                if chain["name"] in self.experiment[trial]["chains"]]
        return any(joint in self.joints_to(tip) for tip in tips)

    def markers(self, cluster):
        return [f"{cluster}_{i + 1}" for i in range(self.clusters[cluster])]

    def mirrored(self):
        """Pairs of clusters of the left and right."""
        return [(a, "R" + a[1:]) for a in self.clusters
                if a[0] == "L" and "R" + a[1:] in self.clusters]

    def showing(self, cluster):
        """Calibration trials that exercise a joint which moves the cluster."""
        joints = self.joints_to(self.links[cluster])
        return [t for t in self.calibration if any(self.exercised(j, t) for j in joints)]


def frozen_from(begin, end):
    def start():
        kept = []

        def change(value, share):
            if begin <= share < end and not kept:
                kept.append(value)
            return kept[0] if begin <= share < end else value
        return change
    return start


def swap_labels(a, b, begin=0.0, end=1.0):
    def change(names, positions, share):
        if begin <= share < end:
            for x, y in zip(a, b):
                i, j = names.index(x), names.index(y)
                positions[i], positions[j] = positions[j], positions[i]
    return change


def scale_positions(scale):
    def change(names, positions, share):
        for p in positions:
            p[:] = [f"{float(c) * scale:.3f}" if c else c for c in p]
    return change


def exchange_columns(a, b):
    def change(header, rows):
        i, j = header.index(a), header.index(b)
        for row in rows:
            row[i], row[j] = row[j], row[i]
    return change


def time_change(change_time):
    def change(header, rows):
        for i, row in enumerate(rows):
            row[0] = change_time(row[0], i / len(rows))
    return change


def lose_rows(share, rate_hz, draw):
    """Rows are lost, and the logger numbers on: its time does not show it."""
    def change(header, rows):
        begin = rows[0][0]
        step = rows[1][0] - rows[0][0]
        kept = [row for row in rows if draw.random() >= share]
        for i, row in enumerate(kept):
            row[0] = begin + i * step
        return kept
    return change


def joint_faults(lab, draw):
    every = lab.trials
    several = lambda count: draw.sample(lab.moving, min(count, len(lab.moving)))
    for joint, trial in several(6):
        yield "sign", f"{joint}: sign", (joint, "sign"), lambda r, j=joint: r.change_column(every, j, -1.0)
    for joint, trial in several(5):
        gain = 1 + draw.choice([-1, 1]) * draw.choice([0.01, 0.02, 0.05])
        yield ("gain", f"{joint}: gain {gain:.2f}", (joint, "times the true"),
               lambda r, j=joint, g=gain: r.change_column(every, j, g))
    for joint, trial in several(5):
        off = draw.choice([-1, 1]) * draw.choice([1, 2, 5])
        yield ("offset", f"{joint}: {off} deg off in {trial}", (joint, "off by", trial),
               lambda r, j=joint, t=trial, o=off: r.change_column(
                   [t], j, lambda: lambda q, share: q + o * DEGREE))
    for joint, trial in several(5):
        off, begin = draw.choice([-1, 1]) * draw.choice([2, 5]), draw.uniform(0.3, 0.7)
        yield ("offset", f"{joint}: {off} deg off from {begin:.2f} of {trial} on", (joint, "off by", trial),
               lambda r, j=joint, t=trial, o=off, b=begin: r.change_column(
                   [t], j, lambda: lambda q, share: q + (o * DEGREE if share > b else 0)))
    for joint, trial in several(6):
        begin = draw.uniform(0.2, 0.6)
        end = begin + draw.uniform(0.25, 0.4)
        yield ("frozen", f"{joint}: frozen from {begin:.2f} to {end:.2f} of {trial}", (joint, "frozen"),
               lambda r, j=joint, t=trial, b=begin, e=end: r.change_column([t], j, frozen_from(b, e)))
    for joint, trial in several(5):
        other = draw.choice([j for j, t in lab.moving if t == trial and j != joint])
        yield ("exchange", f"{joint} and {other}: columns exchanged", (joint, other, "exchanged"),
               lambda r, a=joint, b=other: r.change_log(every, exchange_columns(a, b)))
    for joint, trial in several(2):
        yield ("degrees", f"{joint}: in degrees", (joint, "degrees"),
               lambda r, j=joint: r.change_column(every, j, 1 / DEGREE))


def camera_faults(lab, draw):
    for scale in draw.sample([0.97, 0.98, 0.99, 1.01, 1.02, 1.03], 3):
        trial = draw.choice(lab.calibration)
        yield ("scale of a trial", f"cameras' scale {scale} in {trial}", (trial, "camera"),
               lambda r, t=trial, s=scale: r.change_markers([t], scale_positions(s)))
    for scale in draw.sample([0.98, 0.99, 0.995, 1.005, 1.01, 1.02], 4):
        yield ("scale", f"cameras' scale {scale} in all trials", ("camera", "times the true"),
               lambda r, s=scale: r.change_markers(lab.trials, scale_positions(s)))
    for a, b in draw.sample(lab.mirrored(), min(5, len(lab.mirrored()))):
        trial = draw.choice(lab.showing(a))
        yield ("labels", f"labels of {a} and {b} exchanged in {trial}", (a, b, trial, "exchanged"),
               lambda r, x=a, y=b, t=trial: r.change_markers(
                   [t], swap_labels(lab.markers(x), lab.markers(y))))
    legs = [(c, t) for c in lab.clusters for t in lab.calibration
            if any(w in c for w in ("THIGH", "SHANK", "FOOT", "WAIST")) and "leg" in t]
    for (cluster, trial), end in zip(draw.sample(legs, min(4, len(legs))), (1.0, 1.0, 0.6, 0.6)):
        a, b = draw.sample(lab.markers(cluster), 2)
        yield ("labels", f"labels of {a} and {b} exchanged up to {end} of {trial}", (a, b, "exchanged"),
               lambda r, x=a, y=b, t=trial, e=end: r.change_markers([t], swap_labels([x], [y], 0, e)))


def declared_faults(lab, draw):
    def declare(trial, key, value):
        def put(recording):
            recording.trials[trial][key] = value
            recording.write_experiment()
        return put
    feet = sorted({foot for t in lab.calibration for foot in lab.experiment[t].get("support", [])})
    single = [t for t in lab.calibration if len(lab.experiment[t].get("support", [])) == 1]
    for trial in draw.sample(single, min(2, len(single))):
        foot = lab.experiment[trial]["support"][0]
        other = next(f for f in feet if f != foot)
        yield ("support", f"support of {trial}: {other} declared", (trial, "support"),
               declare(trial, "support", [other]))
        yield ("support", f"support of {trial}: both feet declared", (trial, "support"),
               declare(trial, "support", feet))
    limbs = [t for t in lab.calibration if "head" not in t]
    if all(lab.experiment[t]["chains"] == lab.experiment[limbs[0]]["chains"] for t in limbs):
        limbs = []  # a single arm or a snake
    for trial in draw.sample(limbs, min(2, len(limbs))):
        mine = lab.experiment[trial]["chains"]
        other = draw.choice([lab.experiment[t]["chains"] for t in limbs
                             if lab.experiment[t]["chains"] != mine])
        yield ("chain", f"chain of {trial}: {other[0]} declared", (trial, "chain"),
               declare(trial, "chains", other))

    def up(axis):
        def put(recording):
            recording.experiment["up"] = axis
            recording.write_experiment()
        return put
    for axis in draw.sample(["x", "y", "-x", "-y", "-z"], 2):
        yield "up", f"up: {axis} declared", ("`up`",), up(axis)


def torque_faults(lab, draw):
    if len(lab.loaded) < 3:  # the robot has no torque sensors
        return
    every = lab.trials
    one = lambda: draw.choice(lab.loaded)

    def all_columns(change):
        def put(recording):
            def rows_of(header, rows):
                for row in rows:
                    for i, name in enumerate(header):
                        if name.endswith("_torque"):
                            row[i] = change(row[i])
            recording.change_log(every, rows_of)
        return put

    def column(joint, change):
        return lambda r: r.change_column(every, joint + "_torque", lambda: change)
    for joint in draw.sample(lab.loaded, 3):
        yield "torque", f"{joint}: sign of its torque", (joint, "torque"), column(joint, lambda x, s: -x)
    joint = one()
    yield "torque", f"{joint}: torque doubled", (joint, "torque"), column(joint, lambda x, s: 2 * x)
    for joint in draw.sample(lab.loaded, 2):
        bias = draw.choice([-1, 1]) * draw.choice([20, 40])
        if lab.largest_load < 90:
            bias = round(bias * lab.largest_load / 90, 1)
        yield ("torque", f"{joint}: torque biased by {bias} N.m", (joint, "torque"),
               column(joint, lambda x, s, b=bias: x + b))
    joint = one()
    yield ("torque", f"{joint}: torque is noise", (joint, "torque"),
           column(joint, lambda x, s: draw.gauss(0, 2)))
    for _ in range(3):
        a, b = draw.sample(lab.loaded, 2)
        yield ("torque", f"torques of {a} and {b} exchanged", (a, b, "torque"),
               lambda r, x=a, y=b: r.change_log(every, exchange_columns(x + "_torque", y + "_torque")))
    yield "torque", "all torques: sign", ("torque sensors contradict",), all_columns(lambda x: -x)
    yield "torque", "all torques in mN.m", ("torque sensors contradict",), all_columns(lambda x: 1e3 * x)
    yield "torque", "all torques doubled", ("torque sensors contradict",), all_columns(lambda x: 2 * x)


def clock_faults(lab, draw):
    for trial in draw.sample(lab.calibration, min(2, len(lab.calibration))):
        jump = draw.choice([0.3, 0.5, 1.0])
        yield ("clock", f"clock of {trial} jumps by {jump} s", (trial, "clock"),
               lambda r, t=trial, j=jump: r.change_log(
                   [t], time_change(lambda s, share: s + (j if share > 0.5 else 0))))
    for trial in draw.sample(lab.calibration, min(2, len(lab.calibration))):
        drift = draw.choice([-1, 1]) * draw.choice([2e-3, 1e-2])
        yield ("clock", f"clock of {trial} drifts by {1e6 * drift:.0f} ppm", (trial, "clock"),
               lambda r, t=trial, d=drift: r.change_log([t], time_change(lambda s, share: s * (1 + d))))
    for trial in draw.sample(lab.calibration, min(2, len(lab.calibration))):
        yield ("clock", f"5 % of the rows of {trial} lost, unnumbered", (trial, "clock"),
               lambda r, t=trial: r.change_log([t], lose_rows(0.05, 0, draw)))


def marker_faults(lab, draw):
    """Labels of two markers of any cluster, or of two clusters of one trial, the distances of which may be alike."""
    shown = [(c, t) for c in lab.clusters if lab.clusters[c] > 1 for t in lab.showing(c)]
    for (cluster, trial), begin in zip(draw.sample(shown, min(6, len(shown))), (0.0, 0.5, 0.0, 0.4, 0.0, 0.6)):
        a, b = draw.sample(lab.markers(cluster), 2)
        yield ("labels of markers", f"labels of {a} and {b} exchanged from {begin} of {trial} on", (a, b, "exchanged"),
               lambda r, x=a, y=b, t=trial, e=begin: r.change_markers([t], swap_labels([x], [y], e, 1.0)))
    for cluster, trial in draw.sample(shown, min(3, len(shown))):
        others = [c for c, t in shown if t == trial and c != cluster]
        if not others:
            continue
        a, b = draw.choice(lab.markers(cluster)), draw.choice(lab.markers(draw.choice(others)))
        yield ("labels of markers", f"labels of {a} and {b} exchanged in {trial}", (a, b, "exchanged"),
               lambda r, x=a, y=b, t=trial: r.change_markers([t], swap_labels([x], [y])))


def all_faults(lab, draw):
    return [case for family in (joint_faults, camera_faults, declared_faults, torque_faults,
                                clock_faults, marker_faults) for case in family(lab, draw)]
