# SPDX-License-Identifier: Apache-2.0
"""Kinematics of a URDF in plain Python, independent of the program: the true robots of the studies.

Rotations are three rows, rigid transforms are pairs (R, t); metres and radians.
"""

import math


# --- rotations (three rows) and rigid transforms (R, t) -------------------------------------------

def mat_mul(A, B):
    return [[sum(a * B[k][j] for k, a in enumerate(row)) for j in range(3)] for row in A]


def mat_vec(A, v):
    return [row[0] * v[0] + row[1] * v[1] + row[2] * v[2] for row in A]


def transpose(A):
    return [list(column) for column in zip(*A)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def about(axis, angle):
    n = math.sqrt(sum(x * x for x in axis)) or 1.0
    x, y, z = (a / n for a in axis)
    c, s = math.cos(angle), math.sin(angle)
    C = 1 - c
    return [[c + x * x * C, x * y * C - z * s, x * z * C + y * s],
            [y * x * C + z * s, c + y * y * C, y * z * C - x * s],
            [z * x * C - y * s, z * y * C + x * s, c + z * z * C]]


def rotation(vector):
    return about(vector, math.sqrt(sum(x * x for x in vector)))


def from_rpy(rpy):
    roll, pitch, yaw = rpy
    return mat_mul(about((0, 0, 1), yaw), mat_mul(about((0, 1, 0), pitch), about((1, 0, 0), roll)))


def times(A, B):
    return mat_mul(A[0], B[0]), [x + y for x, y in zip(mat_vec(A[0], B[1]), A[1])]


def apply(T, p):
    return [x + t for x, t in zip(mat_vec(T[0], p), T[1])]


def apply_inverse(T, p):
    return mat_vec(transpose(T[0]), [x - t for x, t in zip(p, T[1])])


IDENTITY = (about((0, 0, 1), 0), [0.0, 0.0, 0.0])


# --- robots ---------------------------------------------------------------------------------------

def numbers(element, name, default):
    text = element.get(name) if element is not None else None
    return [float(x) for x in text.split()] if text else list(default)


class Robot:
    """A URDF as a list of joints, from the root outwards."""

    def __init__(self, xml):
        joints = []
        for e in xml.findall("joint"):
            origin, limit, mimic = e.find("origin"), e.find("limit"), e.find("mimic")
            kind = e.get("type")
            lower, upper = (-math.pi, math.pi) if kind == "continuous" or limit is None else (
                float(limit.get("lower", 0)), float(limit.get("upper", 0)))
            joints.append({
                "name": e.get("name"), "kind": kind,
                "parent": e.find("parent").get("link"), "child": e.find("child").get("link"),
                "origin": (from_rpy(numbers(origin, "rpy", (0, 0, 0))),
                           numbers(origin, "xyz", (0, 0, 0))),
                "axis": numbers(e.find("axis"), "xyz", (1, 0, 0)),
                "moves": kind != "fixed" and mimic is None,
                "mimic": None if mimic is None else (mimic.get("joint"), float(
                    mimic.get("multiplier", 1)), float(mimic.get("offset", 0))),
                "lower": max(lower, -math.pi), "upper": min(upper, math.pi)})
        children = {j["child"] for j in joints}
        self.root = next(l.get("name") for l in xml.findall("link") if l.get("name") not in children)
        self.joints, known = [], {self.root}
        while joints:
            ready = [j for j in joints if j["parent"] in known]
            self.joints += ready
            known |= {j["child"] for j in ready}
            joints = [j for j in joints if j["child"] not in known]

    def moving(self):
        return [j for j in self.joints if j["moves"]]

    def positions(self, encoders):
        """Positions of all joints, including mimic joints. A true robot has zero errors."""
        q = {}
        for j in self.joints:
            if j["moves"]:
                q[j["name"]] = encoders[j["name"]] + j.get("zero", 0.0)
            elif j["mimic"]:
                leader, multiplier, offset = j["mimic"]
                q[j["name"]] = multiplier * encoders[leader] + offset + j.get("zero", 0.0)
        return q

    def links(self, q):
        """Pose of each link in the root's frame."""
        T = {self.root: IDENTITY}
        for j in self.joints:
            X = times(T[j["parent"]], j["origin"])
            if j["moves"] or j["mimic"]:
                n = math.sqrt(sum(a * a for a in j["axis"]))
                value = q[j["name"]]
                if j["kind"] == "prismatic":
                    X = times(X, (IDENTITY[0], [a / n * value for a in j["axis"]]))
                else:
                    X = times(X, (about(j["axis"], value), [0, 0, 0]))
            T[j["child"]] = X
        return T
