# SPDX-License-Identifier: Apache-2.0
"""The robots of the studies: projects, URDFs and invented robots, nominal and with true errors."""

import math
import pathlib
import random
import xml.etree.ElementTree as ET

import yaml

from own_kinematics import numbers, Robot, rotation, times

LEVELS = ["0", "1e-9", "1e-6", "1e-4", "5e-3", "rounded"]

# name: joints as (name, type, parent link, xyz, rpy, axis, lower, upper); the child is NAME_link.
H = math.pi / 2
INVENTED = {
    # Consecutive axes that coincide (1-2, 6-7), are parallel (3-4-5) or meet (5-6).
    "coaxial7": [
        ("j1", "revolute", "base", (0, 0, 0.3), (0, 0, 0), (0, 0, 1), -2.5, 2.5),
        ("j2", "revolute", "j1_link", (0, 0, 0.2), (0, 0, 0), (0, 0, 1), -2.5, 2.5),
        ("j3", "revolute", "j2_link", (0.05, 0, 0.1), (-H, 0, 0), (0, 0, 1), -2, 2),
        ("j4", "revolute", "j3_link", (0.3, 0, 0), (0, 0, 0), (0, 0, 1), -2, 2),
        ("j5", "revolute", "j4_link", (0.25, 0, 0.04), (0, 0, 0), (0, 0, 1), -2, 2),
        ("j6", "revolute", "j5_link", (0, 0, 0), (0, H, 0), (0, 0, 1), -2.5, 2.5),
        ("j7", "revolute", "j6_link", (0, 0, 0.12), (0, 0, 0), (0, 0, 1), -2.5, 2.5),
    ],
    # Both legs and the chest are on one waist joint.
    "waist_biped": [
        ("waist", "revolute", "pelvis", (0, 0, -0.05), (0, 0, 0), (0, 0, 1), -1, 1),
        ("chest", "revolute", "pelvis", (0, 0, 0.1), (0, 0, 0), (0, 1, 0), -0.6, 0.6),
    ] + [
        (side + name, "revolute", parent if parent == "waist_link" else side + parent,
         (x, sign * y, z), (0, 0, 0), axis, lower, upper)
        for side, sign in (("l_", 1), ("r_", -1))
        for name, parent, (x, y, z), axis, lower, upper in (
            ("hip_yaw", "waist_link", (0, 0.09, -0.05), (0, 0, 1), -0.8, 0.8),
            ("hip_roll", "hip_yaw_link", (0, 0, 0), (1, 0, 0), -0.6, 0.6),
            ("hip_pitch", "hip_roll_link", (0, 0, 0), (0, 1, 0), -1.4, 0.8),
            ("knee", "hip_pitch_link", (0, 0, -0.3), (0, 1, 0), 0, 2),
            ("ankle_pitch", "knee_link", (0, 0, -0.3), (0, 1, 0), -0.8, 0.8),
            ("ankle_roll", "ankle_pitch_link", (0, 0, 0), (1, 0, 0), -0.5, 0.5))
    ],
    # Two rails at right angles, and a rail that is parallel to a revolute axis.
    "rail_arm": [
        ("rail", "prismatic", "frame", (0, 0, 0.1), (0, 0, 0), (1, 0, 0), 0, 1.5),
        ("lift", "prismatic", "rail_link", (0, 0, 0.1), (0, 0, 0), (0, 0, 1), 0, 0.5),
        ("shoulder", "revolute", "lift_link", (0.1, 0, 0.1), (0, 0, 0), (0, 0, 1), -2, 2),
        ("elbow", "revolute", "shoulder_link", (0.35, 0, 0), (0, 0, 0), (0, 0, 1), -2.3, 2.3),
        ("pitch", "revolute", "elbow_link", (0.3, 0, 0), (H, 0, 0), (0, 0, 1), -1.8, 1.8),
        ("roll", "revolute", "pitch_link", (0.05, 0, 0), (0, H, 0), (0, 0, 1), -2.5, 2.5),
    ],
}


def invented_urdf(name):
    joints = INVENTED[name]
    xml = ET.Element("robot", name=name)
    for link in [joints[0][2]] + [j[0] + "_link" for j in joints]:
        ET.SubElement(xml, "link", name=link)
    for joint, kind, parent, xyz, rpy, axis, lower, upper in joints:
        e = ET.SubElement(xml, "joint", name=joint, type=kind)
        words = lambda v: " ".join(repr(float(x)) for x in v)
        ET.SubElement(e, "origin", xyz=words(xyz), rpy=words(rpy))
        ET.SubElement(e, "parent", link=parent)
        ET.SubElement(e, "child", link=joint + "_link")
        ET.SubElement(e, "axis", xyz=words(axis))
        ET.SubElement(e, "limit", lower=str(lower), upper=str(upper), effort="50", velocity="2")
    return xml


def own_project(robot, ends_only):
    """A project with clusters on the root, at the ends and (unless `ends_only`) on every third link before these."""
    by_child = {j["child"]: j for j in robot.joints}
    moving = robot.moving()

    def carrier(link):  # the moving joint that carries a link
        while link in by_child and not by_child[link]["moves"]:
            link = by_child[link]["parent"]
        return by_child.get(link)

    above = {j["name"]: carrier(j["parent"]) for j in moving}
    ends = [j for j in moving if not any(a is j for a in above.values())]
    links = [robot.root]
    for joint in ends:
        while joint is not None:
            if joint["child"] not in links:
                links.append(joint["child"])
            if ends_only:
                break
            for _ in range(3):
                joint = above[joint["name"]] if joint is not None else None
    draw = random.Random(5)
    clusters = [{"name": f"C{i}", "link": link, "positions_mm": [
        [x + draw.uniform(-8, 8), y + draw.uniform(-8, 8), z + draw.uniform(-8, 8)]
        for x, y, z in ((60, 0, 10), (0, 60, 10), (0, 0, 70))]} for i, link in enumerate(links)]
    return {"markers": {"reference": "C0", "clusters": clusters}}


def load(argument, ends_only):
    """The robot's name, its URDF and its project."""
    if argument in INVENTED:
        xml = invented_urdf(argument)
        return argument, xml, own_project(Robot(xml), ends_only)
    path = pathlib.Path(argument)
    if path.suffix == ".urdf":
        xml = ET.parse(path).getroot()
        return path.stem, xml, own_project(Robot(xml), ends_only)
    project = yaml.safe_load(path.read_text())
    urdf = path.parent / project["robot"]["urdf"]
    return urdf.stem, ET.parse(urdf).getroot(), project


def perturbed(xml, level, draw):
    """The URDF with origins moved by `level` in each component, or rounded to four digits."""
    xml = ET.fromstring(ET.tostring(xml))
    for e in xml.findall("joint"):
        origin = e.find("origin")
        if origin is None:
            origin = ET.SubElement(e, "origin")
        for key in ("xyz", "rpy"):
            values = numbers(origin, key, (0, 0, 0))
            if level == "rounded":
                values = [round(x, 4) for x in values]
            else:
                values = [x + draw.choice((-1, 1)) * float(level) for x in values]
            origin.set(key, " ".join(repr(x) for x in values))
        axis = e.find("axis")
        if axis is not None and level == "rounded":
            axis.set("xyz", " ".join(repr(round(x, 4)) for x in numbers(axis, "xyz", (1, 0, 0))))
    return xml


def true_robot(xml, draw):
    """A robot with origins off by 1 mm and 0.3 degrees and zeros by 0.5 degrees or 0.5 mm (standard deviations)."""
    robot = Robot(xml)
    for j in robot.joints:
        if j["kind"] == "fixed":
            continue
        shift = [draw.gauss(0, 1e-3) for _ in range(3)]
        turn = [draw.gauss(0, math.radians(0.3)) for _ in range(3)]
        j["origin"] = times(j["origin"], (rotation(turn), shift))
        j["zero"] = draw.gauss(0, 0.5e-3 if j["kind"] == "prismatic" else math.radians(0.5))
    return robot


# --- recordings -----------------------------------------------------------------------------------
