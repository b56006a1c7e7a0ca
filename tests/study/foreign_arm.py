#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""An arm that shares no code with the program: its kinematics, statics and noise are these lines, with tables of markers and
of a laser tracker. foreign_tables.py, foreign_causes.py, foreign_checks.py, cause_sizes.py and updated_arm.py use it. Needs
NumPy.
"""

import csv
import json
import subprocess
import xml.etree.ElementTree as xml

import numpy as np

H = np.pi / 2
# Joint, link, place (m), turn (rpy), axis, largest position (or both limits), effort, mass (kg),
# centre of mass in the link. "prismatic" may follow.
JOINTS = [
    ("shoulder_pan", "link1", (0, 0, 0.20), (0, 0, 0), (0, 0, 1), 2.8, 180, 6.5, (0.01, 0, 0.09)),
    ("shoulder_lift", "link2", (0.03, 0, 0.16), (-H, 0, 0), (0, 0, 1), 1.9, 180, 7.2, (0, -0.11, 0.02)),
    ("upper_roll", "link3", (0, -0.22, 0), (H, 0, 0), (0, 0, 1), 2.8, 120, 5.1, (0.02, 0, 0.12)),
    ("elbow", "link4", (0.06, 0, 0.21), (H, 0, 0), (0, 0, 1), 2.2, 120, 4.2, (-0.02, 0.1, 0.01)),
    ("fore_roll", "link5", (-0.06, 0.19, 0), (-H, 0, 0), (0, 0, 1), 2.8, 60, 3.1, (0, 0.01, 0.12)),
    ("wrist_pitch", "link6", (0, 0, 0.21), (0, 0, 0), (0, 1, 0), 1.9, 60, 2.0, (0.03, 0, 0.05)),
    ("wrist_roll", "link7", (0.08, 0, 0.09), (0, 0, 0), (0, 0, 1), 2.8, 40, 1.5, (0, 0, 0.06)),
]
NAMES = [joint[0] for joint in JOINTS]
CLUSTERS = {
    "HAND": (6, [(0.06, 0.01, 0.05), (-0.05, 0.055, 0.07), (0, -0.065, 0.035)]),
    "FORE": (4, [(0.07, 0.01, 0.12), (-0.06, 0.05, 0.13), (0.01, -0.07, 0.05)]),
    "UPPER": (2, [(0.08, 0.02, 0.10), (-0.06, 0.06, 0.16), (-0.02, -0.07, 0.06)]),
}
MARKERS = [f"{cluster}_{k + 1}" for cluster in CLUSTERS for k in range(3)]
BODY = [body for body, places in CLUSTERS.values() for _ in places]
PLACES = np.array([place for _, places in CLUSTERS.values() for place in places], float)


def about(axis, angle):
    """Rotation matrix (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], float)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def turned(vector):
    angle = np.linalg.norm(vector)
    return np.eye(3) if angle < 1e-15 else about(vector / angle, angle)


def from_rpy(rpy):
    return about((0, 0, 1), rpy[2]) @ about((0, 1, 0), rpy[1]) @ about((1, 0, 0), rpy[0])


class Arm:
    """The nominal arm; errors are attributes."""

    def __init__(self, joints=None, bodies=None, markers=None):
        self.joints, self.bodies = joints or JOINTS, bodies or BODY
        self.places = [(from_rpy(joint[3]), np.array(joint[2], float)) for joint in self.joints]
        self.axes = [np.array(joint[4], float) for joint in self.joints]
        self.slides = np.array(["prismatic" in joint for joint in self.joints])
        self.offset, self.compliance = np.zeros(len(self.joints)), np.zeros(len(self.joints))
        self.masses = np.array([joint[7] for joint in self.joints], float)
        self.gravity = np.array([0, 0, -9.81])  # in the base
        self.markers = PLACES if markers is None else markers

    @classmethod
    def real(cls, seed):
        """An arm with offsets of 0.2 to 1.5 degrees, link errors of 1 to 3 mm and 0.15 degrees, springs of 10 to 100 urad/(N.m)."""
        rng, arm = np.random.default_rng(seed), cls()
        arm.offset = np.radians(rng.uniform(0.2, 1.5, 7) * rng.choice([-1, 1], 7))
        places = []
        for turn, place in arm.places:
            shift = rng.normal(size=3)
            shift *= rng.uniform(1e-3, 3e-3) / np.linalg.norm(shift)
            places.append((turned(rng.normal(size=3) * np.radians(0.15)) @ turn, place + shift))
        arm.places = places
        arm.compliance = rng.uniform(10e-6, 100e-6, 7)
        arm.markers = PLACES + rng.uniform(-6e-3, 6e-3, PLACES.shape)
        return arm

    @classmethod
    def of_urdf(cls, file):
        root, arm = xml.parse(file).getroot(), cls()
        origins = {joint.get("name"): joint for joint in root.findall("joint")}
        read = lambda text: [float(x) for x in (text or "0 0 0").split()]
        arm.places, arm.axes = [], []
        for name in NAMES:
            origin = origins[name].find("origin")
            arm.places.append((from_rpy(read(origin.get("rpy"))), np.array(read(origin.get("xyz")))))
            arm.axes.append(np.array(read(origins[name].find("axis").get("xyz"))))
        return arm

    def frames(self, positions):
        turn, place, frames = np.eye(3), np.zeros(3), []
        for (own_turn, own_place), axis, slides, angle in zip(self.places, self.axes, self.slides, positions):
            place = place + turn @ own_place
            turn = turn @ own_turn
            if slides:
                place = place + turn @ axis * angle
            else:
                turn = turn @ about(axis, angle)
            frames.append((turn, place))
        return frames

    def loads(self, frames):
        """Moments of the weights about the axes, N.m; for slides, forces along the axes, N."""
        loads = np.zeros(len(frames))
        for k, (turn, place) in enumerate(frames):
            axis = turn @ self.axes[k]
            for m in range(k, len(frames)):
                weight = self.masses[m] * self.gravity
                centre = frames[m][1] + frames[m][0] @ np.array(self.joints[m][8])
                loads[k] += axis @ (weight if self.slides[k] else np.cross(centre - place, weight))
        return loads

    def stands(self, encoders):
        """Frames of the links, with the deflection of the joints."""
        bent = np.zeros(len(self.joints))
        for _ in range(4):
            bent = self.compliance * self.loads(self.frames(encoders + self.offset + bent))
        return self.frames(encoders + self.offset + bent)

    def seen(self, encoders):
        """Positions of the markers in the base's frame, markers x 3."""
        frames = self.stands(encoders)
        return np.array([frames[b][1] + frames[b][0] @ p for b, p in zip(self.bodies, self.markers)])


def urdf(joints=None):
    text = '<robot name="foreign_arm"><link name="base"/>'
    parent = "base"
    for name, link, place, rpy, axis, most, effort, mass, centre, *kind in joints or JOINTS:
        lower, upper = most if isinstance(most, tuple) else (-most, most)
        moves = kind[0] if kind else "revolute"
        words = lambda numbers: " ".join(f"{x:.9g}" for x in numbers)
        moment = 0.004 * mass
        text += (f'<link name="{link}"><inertial><origin xyz="{words(centre)}"/><mass value="{mass}"/><inertia '
                 f'ixx="{moment}" iyy="{moment}" izz="{0.6 * moment}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
                 f'<joint name="{name}" type="{moves}"><parent link="{parent}"/><child link="{link}"/><origin '
                 f'xyz="{words(place)}" rpy="{words(rpy)}"/><axis xyz="{words(axis)}"/><limit lower="{lower}" '
                 f'upper="{upper}" effort="{effort}" velocity="2"/></joint>')
        parent = link
    return text + "</robot>\n"


def project(up, clusters=None, tip="link7"):
    text = f"robot: {{urdf: arm.urdf}}\nchains: [{{name: arm, tip: {tip}}}]\nrecording: {{up: {up}}}\nmarkers:\n  clusters:\n"
    for cluster, (body, places) in (clusters or CLUSTERS).items():
        at = [[round(1e3 * x, 3) for x in place] for place in places]
        text += f"    - {{name: {cluster}, link: link{body + 1}, positions_mm: {at}}}\n"
    return text


def postures(count, seed):
    rng, arm, found = np.random.default_rng(seed), Arm(), []
    most = np.array([joint[5] for joint in JOINTS])
    while len(found) < count:
        q = most * rng.uniform(-0.9, 0.9, 7)
        if all(frame[1][2] > 0.08 for frame in arm.frames(q)[3:]):
            found.append(q)
    return np.array(found)


UPRIGHT = (turned(np.array([0, 0, 0.7])), np.array([1.2, -0.4, 0.75]))  # the base in the cameras' frame, z up


def measured(arm, q, base=UPRIGHT, seed=1, noise=0.2e-3):
    points = np.array([arm.seen(row) for row in q]) @ base[0].T + base[1]
    return points + np.random.default_rng(seed).normal(size=points.shape) * noise


def write(file, q, points):
    with open(file, "w", newline="") as out:
        rows = csv.writer(out)
        rows.writerow([f"{m}_{axis}" for m in MARKERS for axis in "xyz"] + NAMES)
        for row, at in zip(q, points):
            rows.writerow([f"{x:.6f}" for x in at.ravel()] + [f"{x:.7f}" for x in row])
    return file


def placed_error(fitted, judged, bodies, start, base=UPRIGHT):
    """rms distance (mm) of real points from a model whose base and points the postures `fitted` place. Both lists have,
    for each posture, frames of the model's links and the real points. `start`: points in the links `bodies`."""
    (turn, place), own = base, start.copy()
    for _ in range(12):
        rows, left = [], []
        for links, at in fitted:
            for m, body in enumerate(bodies):
                lever = turn @ (links[body][1] + links[body][0] @ own[m])
                row = np.zeros((3, 6 + 3 * len(bodies)))
                row[:, :3] = -np.array([[0, -lever[2], lever[1]], [lever[2], 0, -lever[0]], [-lever[1], lever[0], 0]])
                row[:, 3:6] = np.eye(3)
                row[:, 6 + 3 * m:9 + 3 * m] = turn @ links[body][0]
                rows.append(row)
                left.append(at[m] - lever - place)
        step = np.linalg.lstsq(np.vstack(rows), np.concatenate(left), rcond=None)[0]
        turn, place, own = turned(step[:3]) @ turn, place + step[3:6], own + step[6:].reshape(-1, 3)
    squares = [np.sum((at[m] - turn @ (links[body][1] + links[body][0] @ own[m]) - place) ** 2)
               for links, at in judged for m, body in enumerate(bodies)]
    return 1e3 * np.sqrt(np.mean(squares))


def error_of(frames_of, arm, fitted, judged):
    """The same for the markers of an arm."""
    pairs = [list(zip([frames_of(q) for q in rows], measured(arm, rows, noise=0))) for rows in (fitted, judged)]
    return placed_error(*pairs, BODY, PLACES)


class Study:
    def __init__(self, program, work):
        self.program, self.work = program, work
        work.mkdir(parents=True, exist_ok=True)
        (work / "arm.urdf").write_text(urdf())
        for up in ("z", "y"):
            (work / f"{up}.yaml").write_text(project(up))

    def run(self, command, *words):
        return subprocess.run([self.program, command, *map(str, words)], capture_output=True, text=True, check=False)

    def calibrate(self, name, q, points, up="z", *words):
        table = write(self.work / f"{name}.csv", q, points)
        return self.run("calibrate", self.work / f"{up}.yaml", "--recording", table, "-o", self.work / name, *words)

    def figures(self, name):
        return json.loads((self.work / name / "summary.json").read_text())

    def urdf_of(self, name):
        """The links of the exported URDF; None if none was exported."""
        file = self.work / name / "arm_calibrated.urdf"
        return Arm.of_urdf(file).frames if file.exists() else None


def first_words(done):
    return next((line for line in done.stdout.splitlines() if line.strip()), done.stderr.strip())[:150]


def quaternion(turn):
    """x, y, z, w of a rotation matrix that is not half a turn."""
    w = 0.5 * np.sqrt(max(1e-12, 1 + np.trace(turn)))
    return np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1], 4 * w * w]) / (4 * w)


def poses_of(arm, q, rng, base=UPRIGHT):
    """Poses of a body on the hand by a laser tracker, with noise of 50 um and 0.2 mrad."""
    body, poses = (turned(np.array([0.1, 0.2, 0.3])), np.array([0.1, 0.02, 0.03])), []
    for row in q:
        hand = arm.stands(row)[6]
        turn = turned(rng.normal(size=3) * 2e-4) @ base[0] @ hand[0] @ body[0]
        at = base[0] @ (hand[1] + hand[0] @ body[1]) + base[1] + rng.normal(size=3) * 5e-5
        poses.append(np.concatenate([at, quaternion(turn)]))
    return np.array(poses)


def write_poses(file, q, poses):
    with open(file, "w", newline="") as out:
        rows = csv.writer(out)
        rows.writerow(NAMES + [f"lt_{c}" for c in ("x", "y", "z", "qx", "qy", "qz", "qw")])
        rows.writerows([f"{x:.8f}" for x in np.concatenate([a, b])] for a, b in zip(q, poses))
    return file


def tracker_project(study):
    file = study.work / "tracker.yaml"
    file.write_text(
        "robot: {urdf: arm.urdf}\ninstruments:\n  trackers: [{name: laser}]\n"
        "  poses: [{name: lt, link: link7, tracker: laser, xyz_mm: [100, 20, 30], rpy_deg: [6, 11, 17]}]\n")
    return file
