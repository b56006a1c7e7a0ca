# SPDX-License-Identifier: Apache-2.0
"""Invented robots with errors and springs, and what cameras and encoders record of them.

Nothing here is the program's: the URDFs are written and the true robots move by this file's own kinematics. Units are
metres, radians and newtons.
"""

import math
import xml.etree.ElementTree as ET
import zlib

import numpy as np

import own_kinematics

DEGREE = math.pi / 180
#         joint       link      from     origin (xyz)        rpy             axis     lower  upper effort mass centre of mass
CRANE = [("rise",     "mast",   "stand", (0, 0, 0.40),      (0, 0, 0),      (0, 0, 1), 0.0, 0.35, 900, 9.0, (0, 0, 0.1)),
         ("swivel",   "ring",   "mast",  (0, 0, 0.22),      (0, 0, 0),      (0, 0, 1), -2.8, 2.8, 120, 3.5, (0, 0, 0.05)),
         ("lift",     "boom",   "ring",  (0.09, 0, 0.07),   (-1.57, 0, 0),  (0, 0, 1), -1.9, 0.9, 160, 4.2, (0.2, 0, 0)),
         ("bend",     "arm",    "boom",  (0.41, 0, 0),      (0, 0, 0),      (0, 0, 1), -0.4, 2.4, 90, 2.6, (0.15, 0.02, 0)),
         ("roll",     "wrist",  "arm",   (0.11, 0.05, 0),   (0, 1.57, 0),   (0, 0, 1), -2.7, 2.7, 25, 1.1, (0, 0, 0.1)),
         ("nod",      "palm",   "wrist", (0, 0, 0.29),      (0, -1.57, 0),  (0, 0, 1), -1.7, 1.7, 20, 0.8, (0.05, 0, 0)),
         ("spin",     "tool",   "palm",  (0.10, 0, 0),      (0, 1.57, 0),   (0, 0, 1), -3.0, 3.0, 10, 0.5, (0.02, 0, 0.04))]
TWIG = [("a1", "p1", "foot", (0, 0, 0.08),      (0, 0, 0),     (0, 0, 1), -2.6, 2.6, 18, 0.7, (0.01, 0, 0.03)),
        ("a2", "p2", "p1",   (0.015, 0, 0.05),  (1.57, 0, 0),  (0, 0, 1), -0.5, 2.5, 18, 0.6, (0.06, 0, 0.01)),
        ("a3", "p3", "p2",   (0.135, 0, 0),     (0, 0, 0),     (0, 0, 1), -2.3, 0.7, 12, 0.5, (0.05, 0.01, 0)),
        ("a4", "p4", "p3",   (0.125, 0.01, 0),  (0, 0, 0),     (0, 0, 1), -1.8, 1.8, 7, 0.3, (0.02, 0, 0.02)),
        ("a5", "p5", "p4",   (0.02, 0, 0.03),   (-1.57, 0, 0), (0, 0, 1), -1.9, 1.9, 5, 0.25, (0, 0.02, 0)),
        ("a6", "p6", "p5",   (0, 0.06, 0),      (1.57, 0, 0),  (0, 0, 1), -2.9, 2.9, 3, 0.2, (0.01, 0, 0.03))]
SNAKE = [("s1", "n1", "plate", (0, 0, 0.13),    (0, 0, 0),     (0, 0, 1), -2.9, 2.9, 70, 2.4, (0, 0, 0.06)),
         ("s2", "n2", "n1",    (0, 0, 0.15),    (-1.57, 0, 0), (0, 0, 1), -1.9, 1.9, 70, 2.0, (0, -0.09, 0)),
         ("s3", "n3", "n2",    (0, -0.21, 0),   (1.57, 0, 0),  (0, 0, 1), -2.9, 2.9, 45, 1.7, (0.01, 0, 0.08)),
         ("s4", "n4", "n3",    (0.04, 0, 0.17), (-1.57, 0, 0), (0, 0, 1), -2.3, 2.3, 45, 1.4, (0, -0.07, 0)),
         ("s5", "n5", "n4",    (-0.04, -0.19, 0), (1.57, 0, 0), (0, 0, 1), -2.9, 2.9, 20, 1.0, (0, 0, 0.06)),
         ("s6", "n6", "n5",    (0, 0, 0.16),    (-1.57, 0, 0), (0, 0, 1), -2.0, 2.0, 20, 0.7, (0, -0.04, 0)),
         ("s7", "n7", "n6",    (0, -0.09, 0),   (1.57, 0, 0),  (0, 0, 1), -2.9, 2.9, 10, 0.4, (0.02, 0, 0.03))]


def upper_body():
    joints = [("twist", "belly", "hip", (0, 0, 0.10), (0, 0, 0), (0, 0, 1), -1.1, 1.1, 130, 4.0, (0, 0, 0.05)),
              ("bow", "chest", "belly", (0, 0, 0.09), (0, 0, 0), (0, 1, 0), -0.3, 0.7, 180, 8.0, (0, 0, 0.17))]
    for side, k in (("left", 1), ("right", -1)):
        for name, parent, xyz, axis, low, high, effort, mass, centre in (
                ("swing", "chest", (0, 0.17 * k, 0.31), (0, 1, 0), -2.1, 1.1, 55, 1.2, (0, 0.04 * k, 0)),
                ("spread", "swing", (0, 0.07 * k, 0), (1, 0, 0), -0.2, 1.8, 55, 1.6, (0, 0, -0.1)),
                ("turn", "spread", (0, 0, -0.24), (0, 0, 1), -1.5, 1.5, 30, 0.8, (0, 0, -0.03)),
                ("elbow", "turn", (0.015, 0, -0.04), (0, 1, 0), -2.1, 0.0, 35, 1.0, (0, 0, -0.1)),
                ("fore", "elbow", (-0.015, 0, -0.12), (0, 0, 1), -1.9, 1.9, 12, 0.4, (0, 0, -0.05)),
                ("hand", "fore", (0, 0, -0.12), (1, 0, 0), -0.9, 0.9, 10, 0.4, (0, 0, -0.06))):
            if name == "spread" and k < 0:
                low, high = -high, -low
            joints.append((f"{side}_{name}", f"{side}_{name}_link", parent if parent == "chest" else f"{side}_{parent}_link",
                           xyz, (0, 0, 0), axis, low, high, effort, mass, centre))
    return joints


#         joints, tips, the reference cluster first: cluster, link, its middle (mm), its size (mm)
ROBOTS = {
    "crane": (CRANE, ["tool"], [("FRAME", "stand", (0, 150, 50), 60), ("MAST", "mast", (0, 90, 40), 50), ("ARM", "arm", (40, 50, 40), 45), ("TOOL", "tool", (0, 0, 70), 45)]),
    "twig": (TWIG, ["p6"], [("FOOT", "foot", (70, 0, 10), 40), ("MID", "p3", (60, 25, 0), 28), ("TIP", "p6", (0, 0, 45), 30)]),
    "snake": (SNAKE, ["n7"], [("PLATE", "plate", (0, -120, 30), 55), ("FORE", "n4", (0, -60, 60), 40), ("END", "n7", (0, 0, 60), 40)]),
    "torso": (upper_body(), ["left_hand_link", "right_hand_link"], [("HIP", "hip", (-110, 0, 20), 60), ("CHEST", "chest", (-100, 0, 200), 60)] + [
        (f"{side[0].upper()}{part.upper()}", f"{side}_{part}_link", (0, 40 if side == "left" else -40, -80), 38)
        for side in ("left", "right") for part in ("spread", "elbow", "hand")])}


def urdf(name):
    joints = ROBOTS[name][0]
    text = lambda numbers: " ".join(str(x) for x in numbers)
    link = lambda n, mass, centre: (f'<link name="{n}"><inertial><origin xyz="{text(centre)}"/><mass value="{mass}"/>'
                                    '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>\n')
    out = f'<?xml version="1.0"?>\n<robot name="{name}">\n' + link(joints[0][2], 12, (0, 0, 0))
    for joint, child, parent, xyz, rpy, axis, low, high, effort, mass, centre in joints:
        kind = "prismatic" if joint == "rise" else "revolute"
        out += link(child, mass, centre) + (
            f'<joint name="{joint}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin xyz="{text(xyz)}" '
            f'rpy="{text(rpy)}"/><axis xyz="{text(axis)}"/><limit lower="{low}" upper="{high}" effort="{effort}" velocity="2"/></joint>\n')
    return out + "</robot>\n"


def turned(vector):
    return np.array(own_kinematics.rotation(list(vector)))


class Model:
    """A tree of joints that moves many postures at once."""

    def __init__(self, text):
        tree = own_kinematics.Robot(ET.fromstring(text))
        self.root, self.joints = tree.root, []
        for j in tree.joints:
            self.joints.append({**j, "R": np.array(j["origin"][0]), "p": np.array(j["origin"][1]), "axis": np.array(j["axis"])})

    def links(self, q):
        n = len(next(iter(q.values())))
        poses, self.axes = {self.root: (np.tile(np.eye(3), (n, 1, 1)), np.zeros((n, 3)))}, {}
        for j in self.joints:
            R, p = poses[j["parent"]]
            R, p = R @ j["R"], p + R @ j["p"]
            if j["moves"]:
                x, y, z = a = j["axis"]
                value = q[j["name"]]
                self.axes[j["name"]] = (R @ a, p)
                if j["kind"] == "prismatic":
                    p = p + (R @ a) * value[:, None]
                else:
                    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
                    R = R @ (np.eye(3) + np.sin(value)[:, None, None] * K + (1 - np.cos(value))[:, None, None] * (K @ K))
            poses[j["child"]] = (R, p)
        return poses


class Lab:
    """One true robot of a kind: `seed` draws its errors, springs and where its markers really are."""

    def __init__(self, name, seed):
        rng = np.random.default_rng(seed)
        self.name, (self.rows, self.tips, self.clusters) = name, ROBOTS[name]
        self.nominal, self.true = Model(urdf(name)), Model(urdf(name))
        self.limits = {r[0]: (r[6], r[7]) for r in self.rows}
        self.effort, self.mass = {r[0]: r[8] for r in self.rows}, {r[1]: (r[9], np.array(r[10])) for r in self.rows}
        self.names = [r[0] for r in self.rows]
        self.turning = [j for j in self.names if j != "rise"]
        self.springs = {j: 0.0 if j == "rise" else abs(rng.normal(4e-3, 1.3e-3)) / self.effort[j] for j in self.names}
        for j in self.true.joints:
            j["p"] = j["p"] + rng.normal(0, 8e-4, 3)
            j["R"] = turned(rng.normal(0, 3e-3, 3)) @ j["R"] @ turned(j["axis"] * rng.normal(0, 8e-3) * (j["kind"] != "prismatic"))
        self.nominal_places, self.places, self.link_of = {}, {}, {}
        for cluster, link, (x, y, z), s in self.clusters:
            for k, at in enumerate(((x + s, y, z), (x, y + 0.8 * s, z + 9), (x - 0.7 * s, y - 0.5 * s, z + 22), (x - 4, y + 7, z - 0.6 * s))):
                marker = f"{cluster}_{k + 1}"
                self.link_of[marker], self.nominal_places[marker] = link, np.array(at) / 1e3
                self.places[marker] = np.array(at) / 1e3 + rng.normal(0, 3e-3, 3)
        self.cameras = turned([0, 0, rng.uniform(-3, 3)]), np.array([1.1, -0.6, 0.3])

    def chain(self, tip):
        parents, found = {r[1]: r for r in self.rows}, []
        while tip in parents:
            found.append(parents[tip][0])
            tip = parents[tip][2]
        return found[::-1]

    def project(self, folder, text=None):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "robot.urdf").write_text(text or urdf(self.name))
        out = "robot: {urdf: robot.urdf}\nchains:\n" + "".join(f"  - {{name: chain_{k}, tip: {t}}}\n" for k, t in enumerate(self.tips))
        out += f"markers:\n  reference: {self.clusters[0][0]}\n  clusters:\n"
        for cluster, link, _, _ in self.clusters:
            at = [[round(1e3 * float(x), 2) for x in self.nominal_places[f"{cluster}_{k}"]] for k in (1, 2, 3, 4)]
            out += f"    - {{name: {cluster}, link: {link}, positions_mm: {at}}}\n"
        (folder / "project.yaml").write_text(out)

    def draw(self, n, rng, share=0.9):
        return {j: rng.uniform((a + b) / 2 - share * (b - a) / 2, (a + b) / 2 + share * (b - a) / 2, n) for j, (a, b) in self.limits.items()}

    def loads(self, q, payload=None):
        """Torque of gravity about each axis. `payload` (kg, m) is on the last tip."""
        poses, down = self.true.links(q), np.array([0, 0, -9.81])
        weight = {l: (m, m * (poses[l][1] + poses[l][0] @ c)) for l, (m, c) in self.mass.items()}
        if payload:
            m, R, p = payload[0], *poses[self.tips[-1]]
            weight[self.tips[-1]] = (weight[self.tips[-1]][0] + m, weight[self.tips[-1]][1] + m * (p + R @ np.array([0, 0, payload[1]])))
        tau = {}
        for j in reversed(self.true.joints):
            m, moment = weight[j["child"]]
            z, p = self.true.axes[j["name"]]
            tau[j["name"]] = np.sum(z * np.cross(moment - m * p, down), axis=1) * (j["kind"] != "prismatic")
            if j["parent"] in weight:
                weight[j["parent"]] = (weight[j["parent"]][0] + m, weight[j["parent"]][1] + moment)
        return tau

    def seen(self, q, rng, payload=None, bend=None, moved=None, noise=1.5e-4):
        """Markers in the cameras' frame. `bend(joint, q, tau)` is added to a joint; `moved` has other places of markers."""
        tau = self.loads(q, payload)
        real = {j: v + self.springs[j] * tau[j] + (bend(j, q, tau) if bend else 0) for j, v in q.items()}
        poses, out, bias = self.true.links(real), {}, {}
        for m, link in self.link_of.items():
            R, p = poses[link]
            at = np.broadcast_to((moved or {}).get(m, self.places[m]), p.shape)
            at = (np.einsum("nij,nj->ni", R, at) + p) @ self.cameras[0].T + self.cameras[1]
            if link not in bias:  # varies slowly in space and is the same for a whole body
                bias[link] = 1.2e-4 * np.sin(5 * at @ rng.normal(0, 1, (3, 3)))
            out[m] = at + bias[link] + rng.normal(0, noise, at.shape)
        return out

    def encoders(self, q, rng):
        return {j: v + rng.normal(0, 2e-5 if j == "rise" else 1e-4, len(v)) for j, v in q.items()}

    def table(self, n, seed, **world):
        rng = np.random.default_rng(seed)
        q = self.draw(n, rng)
        return {"M": self.seen(q, rng, **world), "Q": self.encoders(q, rng)}

    def motion(self, kind, moving, n, rng):
        """A motion from rest to rest at 100 Hz, or of sines. Joints that are not on the trial's chains stand still."""
        goals = self.draw(n, rng, 0.8)
        if kind == "sine":
            t, q = np.arange(2400) / 100, {}
            ramp = np.clip(np.minimum((t - 1.5) / 2, (22.5 - t) / 2), 0, 1)
            for j, (a, b) in self.limits.items():
                f = rng.uniform(0.05, 0.15)
                q[j] = (a + b) / 2 + min(0.3 * (b - a), 0.1 / f) * np.sin(2 * math.pi * f * t + rng.uniform(0, 6)) * ramp * (j in moving)
            return t, q
        t, q = np.arange(int(100 * (2 + 2.3 * n))) / 100, {}
        for j in self.names:
            q[j] = np.full(len(t), goals[j][0])
            for i in range(1, n if j in moving else 0):
                u = np.clip((t - 2 - 2.3 * (i - 1) - 0.8) / 1.5, 0, 1)
                q[j] += (goals[j][i] - goals[j][i - 1]) * u ** 3 * (10 - 15 * u + 6 * u * u)
        return t, q

    def trials(self, seed, n=14, world=None):
        rng, out = np.random.default_rng(seed), []
        both = list(range(len(self.tips)))
        parts = ([0], [1], [0, 1]) if len(both) == 2 else ([0], [0], [0])
        for name, kind, chains in [(f"part_{k}", "calibration", c) for k, c in enumerate(parts)] + [("sweep", "sine", both), ("mixed", "random", both)]:
            t, q = self.motion(kind, {j for c in chains for j in self.chain(self.tips[c])}, n if kind == "calibration" else max(6, n // 2), rng)
            M = self.seen(q, rng, **(world(name, len(t)) if world else {}))
            logged, lag = self.encoders(q, rng), rng.uniform(-1, 1.5)
            out.append({"name": name, "kind": kind, "chains": chains, "M": M, "t": t[30:-20] + 1000 + lag, "Q": {j: v[30:-20] for j, v in logged.items()}})
        return out

    def error(self, text, seed=99, n=120):
        """rms error (mm) of places on the measured links by another URDF without loads, whose root and places are fitted."""
        model, q = Model(text), self.draw(n, np.random.default_rng(seed))
        truth, other = self.true.links(q), model.links(q)
        links = sorted({l for l in self.link_of.values()} - {self.nominal.root})
        spots = [(l, np.array(p)) for l in links for p in ((0, 0, 0), (0.08, 0, 0), (0, 0.08, 0))]
        R, t, own = np.eye(3), np.zeros(3), [p.copy() for _, p in spots]
        for _ in range(6):
            size = 6 + 3 * len(spots)
            H, g, squares = np.zeros((size, size)), np.zeros(size), 0.0
            for k, (l, p) in enumerate(spots):
                lever = (other[l][0] @ own[k] + other[l][1]) @ R.T
                left = truth[l][0] @ p + truth[l][1] - lever - t
                x, y, z = lever.T
                zero = np.zeros(n)
                turn = np.array([[zero, z, -y], [-z, zero, x], [y, -x, zero]]).transpose(2, 0, 1)
                J = np.concatenate([turn, np.tile(np.eye(3), (n, 1, 1)), R @ other[l][0]], axis=2).reshape(-1, 9)
                at = list(range(6)) + [6 + 3 * k + i for i in range(3)]
                H[np.ix_(at, at)] += J.T @ J
                g[at] += J.T @ left.ravel()
                squares += np.sum(left ** 2)
            step = np.linalg.lstsq(H + 1e-9 * np.eye(size), g, rcond=None)[0]
            R, t = turned(step[:3]) @ R, t + step[3:6]
            own = [p + step[6 + 3 * k:9 + 3 * k] for k, p in enumerate(own)]
        return 1e3 * math.sqrt(squares / (n * len(spots)))


class Case:
    """A recording that a fault may change, and what draws the fault."""

    def __init__(self, lab, seed, count, trials, name):
        self.lab, self.seed, self.count = lab, seed, count
        self.rng = np.random.default_rng([seed, zlib.crc32(name.encode())])
        self.joints = list(self.rng.permutation(lab.turning))
        self.row = int(count * self.rng.uniform(0.3, 0.65))  # the fault begins here
        self.few = np.sort(self.rng.choice(np.arange(1, count), 7, replace=False))
        self.trials = lab.trials(seed) if trials else None
        if not trials:
            self.again()
        if trials:
            self.first, self.second = self.trials[0], self.trials[1]
            moving = [[j for j in lab.turning if np.ptp(T["Q"][j]) > 0.3] for T in (self.first, self.second)]
            self.in_first, self.in_second = (list(self.rng.permutation(m)) for m in moving)
            self.in_both = [j for j in self.in_first if j in moving[1]]

    def again(self, **world):
        data = self.lab.table(self.count, self.seed, **world)
        self.M, self.Q = data["M"], data["Q"]

    def anew(self, world):
        self.trials = self.lab.trials(self.seed, world=world)

    def last(self, k=1):
        """The markers of the k-th cluster from the end."""
        return [f"{self.lab.clusters[-k][0]}_{i}" for i in (1, 2, 3, 4)]

    def size(self, low, high):
        return self.rng.uniform(low, high) * self.rng.choice([-1, 1])


def write_table(file, data):
    columns = [f"{m}_{c}" for m in data["M"] for c in "xyz"] + list(data["Q"])
    values = np.column_stack(list(data["M"].values()) + list(data["Q"].values()))
    np.savetxt(file, values, fmt="%.6f", delimiter=",", header=",".join(columns), comments="")


def write_trials(folder, trials):
    folder.mkdir(parents=True, exist_ok=True)
    listed = "up: z\ntrials:\n"
    for T in trials:
        name, n = T["name"], len(next(iter(T["M"].values())))
        chains = ", ".join(f"chain_{c}" for c in T["chains"])
        listed += f"  - {{name: {name}, kind: {T['kind']}, chains: [{chains}], markers: {name}.tsv, joints: {name}.csv}}\n"
        head = f"NO_OF_FRAMES\t{n}\nNO_OF_MARKERS\t{len(T['M'])}\nFREQUENCY\t100\nDATA_INCLUDED\t3D\nMARKER_NAMES\t" + "\t".join(T["M"])
        head += "\nFrame\tTime\t" + "\t".join(f"{m} {c}" for m in T["M"] for c in "XYZ")
        values = np.column_stack([np.arange(1, n + 1), np.arange(n) / 100] + [1e3 * x for x in T["M"].values()])
        np.savetxt(folder / f"{name}.tsv", values, fmt=["%d", "%.5f"] + ["%.3f"] * (values.shape[1] - 2), delimiter="\t", header=head, comments="")
        np.savetxt(folder / f"{name}.csv", np.column_stack([T["t"]] + list(T["Q"].values())), fmt="%.6f", delimiter=",",
                   header="t," + ",".join(T["Q"]), comments="")
    (folder / "experiment.yaml").write_text(listed)
