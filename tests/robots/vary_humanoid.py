#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The embedded humanoid in another size or with other legs, for studies and tests:

  vary_humanoid.py OUTPUT.urdf [--scale 0.5] [--legs 5|6|7] [--ankle-deg 30]

Lengths are multiplied by the scale s, masses by s^3, inertias by s^5 and efforts by s^4, as for one material
that carries its own weight. Legs of 5 joints have no joint about the vertical at the hip. Legs of 7 have a
second one in the thigh.
"""

import argparse
import copy
import pathlib
import xml.etree.ElementTree as ElementTree

SOURCE = pathlib.Path(__file__).resolve().parents[2] / "models/talos/talos.urdf"


def multiply(element, attribute, factor):
    if element is not None and attribute in element.attrib:
        words = element.get(attribute).split()
        element.set(attribute, " ".join(f"{factor * float(word):.9g}" for word in words))


def scale_robot(robot, s):
    for origin in robot.iter("origin"):
        multiply(origin, "xyz", s)
    for tag, attributes in (("box", ["size"]), ("cylinder", ["radius", "length"]), ("sphere", ["radius"])):
        for shape in robot.iter(tag):
            for attribute in attributes:
                multiply(shape, attribute, s)
    for mass in robot.iter("mass"):
        multiply(mass, "value", s**3)
    for inertia in robot.iter("inertia"):
        for entry in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"):
            multiply(inertia, entry, s**5)
    for joint in robot.iter("joint"):
        limit = joint.find("limit")
        slides = joint.get("type") == "prismatic"
        multiply(limit, "effort", s**3 if slides else s**4)
        for bound in ("lower", "upper") if slides else ():
            multiply(limit, bound, s)


def named(robot, tag, name):
    return next(element for element in robot.findall(tag) if element.get("name") == name)


def fix_hip_yaw(robot, side):
    joint = named(robot, "joint", f"leg_{side}_1_joint")
    joint.set("type", "fixed")
    for child in ("axis", "limit", "dynamics"):
        if joint.find(child) is not None:
            joint.remove(joint.find(child))


def split_thigh(robot, side):
    """Adds a joint half-way down the thigh that turns its lower part, which gets 0.4 of the mass."""
    knee = named(robot, "joint", f"leg_{side}_4_joint")
    upper = named(robot, "link", knee.find("parent").get("link"))
    height = float(knee.find("origin").get("xyz").split()[2])
    lower = ElementTree.SubElement(robot, "link", name=f"leg_{side}_thigh_link")
    inertial = copy.deepcopy(upper.find("inertial"))
    lower.append(inertial)
    for part, share in ((upper.find("inertial"), 0.6), (inertial, 0.4)):
        multiply(part.find("mass"), "value", share)
        for entry in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"):
            multiply(part.find("inertia"), entry, share)
    inertial.find("origin").set("xyz", f"0 0 {0.25 * height:.9g}")
    turn = ElementTree.SubElement(robot, "joint", name=f"leg_{side}_thigh_joint", type="revolute")
    ElementTree.SubElement(turn, "parent", link=upper.get("name"))
    ElementTree.SubElement(turn, "child", link=lower.get("name"))
    ElementTree.SubElement(turn, "origin", xyz=f"0 0 {0.5 * height:.9g}", rpy="0 0 0")
    ElementTree.SubElement(turn, "axis", xyz="0 0 1")
    yaw = named(robot, "joint", f"leg_{side}_1_joint").find("limit")
    ElementTree.SubElement(turn, "limit", lower="-0.5", upper="0.5", effort=yaw.get("effort"),
                           velocity=yaw.get("velocity"))
    knee.find("parent").set("link", lower.get("name"))
    x, y, z = knee.find("origin").get("xyz").split()
    knee.find("origin").set("xyz", f"{x} {y} {float(z) - 0.5 * height:.9g}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output")
    parser.add_argument("--scale", type=float, default=1.0)
    parser.add_argument("--legs", type=int, choices=(5, 6, 7), default=6)
    parser.add_argument("--ankle-deg", type=float, help="range of the ankles about y to either side")
    options = parser.parse_args()
    tree = ElementTree.parse(SOURCE)
    robot = tree.getroot()
    for side in ("left", "right"):
        if options.legs == 5:
            fix_hip_yaw(robot, side)
        if options.legs == 7:
            split_thigh(robot, side)
        if options.ankle_deg:
            limit = named(robot, "joint", f"leg_{side}_5_joint").find("limit")
            limit.set("lower", f"{-options.ankle_deg * 3.14159265 / 180:.6f}")
            limit.set("upper", f"{options.ankle_deg * 3.14159265 / 180:.6f}")
    scale_robot(robot, options.scale)
    tree.write(options.output, encoding="unicode")


if __name__ == "__main__":
    main()
