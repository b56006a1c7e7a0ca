#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Robots that many laboratories have, from their URDF to a calibration while they stand: init, design, plan on
three virtual robots, simulate, calibrate, without an edit. Prints a table (Markdown) for docs/robots.md.

  standing_robots.py --program build/release/bin/elastocal --work /tmp/robots [NAME or FILE.urdf...]

Files are taken as they are. For the names, this file writes URDFs from memory after the published joints, limits and
masses, without meshes, and with primitives for the shapes of the makers' files. They represent kinds of robots, not the
makers' files.
"""

import argparse
import json
import pathlib
import shutil
import subprocess
import time


class Urdf:
    """Links and joints of a robot, as text."""

    def __init__(self, name):
        self.name, self.text = name, [f'<robot name="{name}">']

    def link(self, name, mass=0.0, com=(0, 0, 0), inertia=None, shape=""):
        if mass == 0.0:
            self.text.append(f'<link name="{name}">{shape}</link>')
            return
        inertia = inertia or (0.4 * mass * (0.05 if mass < 1 else 0.1) ** 2,) * 3
        self.text.append(
            f'<link name="{name}"><inertial><origin xyz="{com[0]} {com[1]} {com[2]}"/><mass value="{mass}"/>'
            f'<inertia ixx="{inertia[0]}" ixy="0" ixz="0" iyy="{inertia[1]}" iyz="0" izz="{inertia[2]}"/></inertial>'
            f"{shape}</link>")

    def joint(self, parent, child, place, axis, limits, effort, rpy=(0, 0, 0), name=None, mimic=None, kind="revolute"):
        """`limits` is None for a joint without an end; `axis` is None for a fixed joint."""
        text = (f'<joint name="{name or child + "_joint"}" type="{kind if limits else "continuous"}">' if axis else
                f'<joint name="{child}_fixed" type="fixed">')
        text += (f'<parent link="{parent}"/><child link="{child}"/><origin xyz="{place[0]} {place[1]} {place[2]}" '
                 f'rpy="{rpy[0]} {rpy[1]} {rpy[2]}"/>')
        if axis:
            ends = f'lower="{limits[0]}" upper="{limits[1]}" ' if limits else ""
            text += (f'<axis xyz="{axis[0]} {axis[1]} {axis[2]}"/><limit {ends}effort="{effort}" velocity="10"/>')
        self.text.append(text + (f'<mimic joint="{mimic}"/>' if mimic else "") + "</joint>")

    def write(self, folder):
        folder.mkdir(parents=True, exist_ok=True)
        file = folder / f"{self.name}.urdf"
        file.write_text("\n".join(self.text) + "\n</robot>\n")
        return file


def shape(kind, place=(0, 0, 0), rpy=(0, 0, 0), **size):
    words = " ".join(f'{key}="{value}"' for key, value in size.items())
    return (f'<collision><origin xyz="{place[0]} {place[1]} {place[2]}" rpy="{rpy[0]} {rpy[1]} {rpy[2]}"/>'
            f"<geometry><{kind} {words}/></geometry></collision>")


X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
SIDES = (("left", 1), ("right", -1))


def mirrored(limits, axis, side):
    return limits if side > 0 or axis == Y else (-limits[1], -limits[0])


def limb(robot, side, y, parent, rows):
    """Adds a limb: rows of link, place, axis, limits of the left one, effort, mass, centre, inertia, shape, roll."""
    for name, place, axis, limits, effort, mass, com, inertia, form, rpy in rows:
        child = f"{side}_{name}"
        robot.link(child, mass, (com[0], y * com[1], com[2]), inertia, form)
        robot.joint(parent, child, (place[0], y * place[1], place[2]), axis, mirrored(limits, axis, y), effort,
                    (y * rpy[0], rpy[1], y * rpy[2]))
        parent = child


def row(name, place, axis, limits, effort, mass, com=(0, 0, 0), inertia=None, form="", rpy=(0, 0, 0)):
    return name, place, axis, limits, effort, mass, com, inertia, form, rpy


def g1():
    """Unitree G1, 29 joints: narrow feet that stand on four small balls each, ankles that roll by 15 degrees."""
    robot = Urdf("g1")
    robot.link("pelvis", 3.813, (0, 0, -.076), (.01055, .0093, .0079))
    balls = "".join(shape("sphere", p, radius=.005)
                    for p in ((-.05, .025, -.03), (-.05, -.025, -.03), (.12, .03, -.03), (.12, -.03, -.03)))
    thigh = shape("cylinder", (-.06, 0, -.14), (0, .4, 0), radius=.05, length=.18)
    for side, y in SIDES:
        limb(robot, side, y, "pelvis", [
            row("hip_pitch", (0, .064452, -.1027), Y, (-2.5307, 2.8798), 88, 1.35, (.0027, .0478, -.0261), (.0018, .00153, .00122)),
            row("hip_roll", (0, .052, -.030465), X, (-.5236, 2.9671), 88, 1.52, (.0298, -.001, -.0879), (.0025, .0024, .00148), rpy=(0, -.1749, 0)),
            row("hip_yaw", (.025001, 0, -.12412), Z, (-2.7576, 2.7576), 88, 1.702, (-.0577, -.011, -.1508), (.0057, .0076, .0031), thigh),
            row("knee", (-.078273, .0021489, -.17734), Y, (-.087267, 2.8798), 139, 1.932, (.0055, .004, -.1207), (.0113, .0112, .00149), rpy=(0, .1749, 0)),
            row("ankle_pitch", (0, -9.4445e-05, -.30001), Y, (-.87267, .5236), 50, .074, (-.0073, 0, .0111), (8.4e-6, 1.89e-5, 1.26e-5)),
            row("ankle_roll", (0, 0, -.017558), X, (-.2618, .2618), 50, .608, (.0265, 0, -.0164), (.00022, .0016, .00166), balls)])
    robot.link("waist_yaw", .214, (.0035, 0, .014), (.00016, .000107, .00016))
    robot.joint("pelvis", "waist_yaw", (0, 0, 0), Z, (-2.618, 2.618), 88)
    robot.link("waist_roll", .086, (0, .002, 0), (7e-6, 6e-6, 7e-6))
    robot.joint("waist_yaw", "waist_roll", (-.0039635, 0, .035), X, (-.52, .52), 50)
    robot.link("torso", 7.818, (.0009, .0003, .1508), (.0606, .0498, .0279))
    robot.joint("waist_roll", "torso", (0, 0, .019), Y, (-.52, .52), 50)
    robot.link("head", 1.036, (.0053, 0, .4205), (.0041, .0043, .0017))
    robot.joint("torso", "head", (.004, 0, -.054), None, None, 0)
    for side, y in SIDES:
        limb(robot, side, y, "torso", [
            row("shoulder_pitch", (.0039563, .10022, .24778), Y, (-3.0892, 2.6704), 25, .718, (0, .0359, -.0116), (.00043, .00044, .00033),
                shape("cylinder", (0, y * .04, -.01), (0, 1.5708, 0), radius=.03, length=.05), (.27931, 5.4949e-05, -.00019159)),
            row("shoulder_roll", (0, .038, -.013831), X, (-1.5882, 2.2515), 25, .643, (-.0002, .0073, -.0632), (.00062, .00065, .0004),
                shape("cylinder", (-.004, y * .006, -.053), radius=.03, length=.03), (-.27925, 0, 0)),
            row("shoulder_yaw", (0, .00624, -.1032), Z, (-2.618, 2.618), 25, .734, (.0108, -.0029, -.072), (.001, .001, .00041)),
            row("elbow", (.015783, 0, -.080518), Y, (-1.0472, 2.0944), 25, .6, (.065, .0045, -.0101), (.00029, .00066, .00063)),
            row("wrist_roll", (.1, .0018879, -.01), X, (-1.97222, 1.97222), 25, .085, (.0171, .0005, 0), (4.8e-5, 6e-5, 7e-5)),
            row("wrist_pitch", (.038, 0, 0), Y, (-1.61443, 1.61443), 5, .484, (.023, -.001, -.001), (.00016, .00043, .00043)),
            row("wrist_yaw", (.046, 0, 0), Z, (-1.61443, 1.61443), 5, .254, (.0708, .0002, .0016), (.0003, .0006, .0006))])
    return robot


def h1():
    """Unitree H1: legs of five joints, whose feet cannot roll: it cannot stand still on one of them."""
    robot = Urdf("h1")
    robot.link("pelvis", 5.39, (-.0002, 0, -.0452), (.0445, .0083, .0490), shape("sphere", (0, 0, -.05), radius=.05))
    leg = shape("cylinder", (0, 0, -.2), radius=.05, length=.2)
    for side, y in SIDES:
        limb(robot, side, y, "pelvis", [
            row("hip_yaw", (0, .0875, -.1742), Z, (-.43, .43), 200, 2.244, (-.0492, .0001, .0072), (.0025, .0032, .0032), shape("cylinder", (-.05, 0, .01), radius=.06, length=.05)),
            row("hip_roll", (.039468, 0, 0), X, (-.43, .43), 200, 2.232, (-.0058, -.0032, -.0001), (.0020, .0019, .0022)),
            row("hip_pitch", (0, .11536, 0), Y, (-3.14, 2.53), 200, 4.152, (.0075, -.0235, -.0819), (.0829, .0821, .0051), leg),
            row("knee", (0, 0, -.4), Y, (-.26, 2.05), 300, 1.721, (-.0014, -.0051, -.1384), (.0125, .0127, .0019), leg),
            row("ankle", (0, 0, -.4), Y, (-.87, .52), 40, .446, (.0672, .0002, -.045), (.0002, .0011, .0012), shape("box", (.05, 0, -.05), size=".28 .03 .024"))])
    robot.link("torso", 17.789, (.0005, .0028, .2048), (.4873, .4096, .1278), shape("box", (0, 0, .15), size=".08 .16 .1"))
    robot.joint("pelvis", "torso", (0, 0, 0), Z, (-2.35, 2.35), 200)
    for side, y in SIDES:
        limb(robot, side, y, "torso", [
            row("shoulder_pitch", (.0055, .15535, .42999), Y, (-2.87, 2.87), 40, 1.033, (.005, .0534, -.0156), (.0013, .0010, .0012), rpy=(.43633, 0, 0)),
            row("shoulder_roll", (-.0055, .0565, -.0165), X, (-.34, 3.11), 40, .793, (.0007, .0035, -.0692), (.0016, .0017, .0009), rpy=(-.43633, 0, 0)),
            row("shoulder_yaw", (0, 0, -.1343), Z, (-1.3, 4.45), 18, .839, (.0137, -.0023, -.1123), (.0036, .0041, .0012)),
            row("elbow", (.0185, 0, -.198), Y, (-1.25, 2.61), 18, .669, (.165, -.0003, -.0157), (.0004, .006, .006), shape("sphere", (.3, 0, -.015), radius=.04))])
    return robot


def nao():
    """NAO: hips that share a motor, 5 kg."""
    robot = Urdf("nao")
    robot.link("torso", 1.0496, (-.0041, 0, .0434), (.0032, .003, .0016))
    robot.link("neck", .0706, (0, 0, -.0274), (2e-5, 2e-5, 2e-5))
    robot.joint("torso", "neck", (0, 0, .1265), Z, (-2.08567, 2.08567), 1.547)
    robot.link("head", .6053, (-.0011, 0, .0526), (.0026, .0025, .00098))
    robot.joint("neck", "head", (0, 0, 0), Y, (-.671952, .514872), 1.532)
    for side, y in SIDES:
        pelvis = f"{side}_pelvis"
        robot.link(pelvis, .06981, (-.0078, -y * .0111, .0266), (6e-5, 5e-5, 4e-5))
        robot.joint("torso", pelvis, (0, y * .05, -.085), (0, .707106, -y * .707106), (-1.14529, .740718), 3.348,
                    mimic=None if y > 0 else "left_pelvis_joint")
        limb(robot, side, y, pelvis, [
            row("hip", (0, 0, 0), X, (-.379435, .79046), 3.348, .14053, (-.0155, .0003, -.0052), (2.8e-5, 9.9e-5, 8.8e-5)),
            row("thigh", (0, 0, 0), Y, (-1.53589, .48398), 3.022, .38968, (.0014, .0022, -.0537), (.00164, .00159, .0003)),
            row("tibia", (0, 0, -.1), Y, (-.0923279, 2.11255), 3.022, .30142, (.0045, .0023, -.0494), (.00118, .00113, .00019)),
            row("ankle_pitch", (0, 0, -.1029), Y, (-1.1863, .932006), 3.022, .13416, (.0005, .0003, .0069), (3.9e-5, 7.4e-5, 5.5e-5)),
            row("ankle", (0, 0, 0), X, (-.397761, .769001), 3.348, .17184, (.0254, .0033, -.0324), (.00027, .00064, .0006))])
        robot.link(f"{side}_sole")
        robot.joint(f"{side}_ankle", f"{side}_sole", (0, 0, -.04519), None, None, 0)
        limb(robot, side, y, "torso", [
            row("shoulder", (0, .098, .1), Y, (-2.08567, 2.08567), 1.329, .09304, (-.0017, -.0266, .0001), (8.4e-5, 1.4e-5, 8.6e-5)),
            row("bicep", (0, 0, 0), Z, (-.314159, 1.32645), 1.784, .15777, (.0246, .0056, .0033), (9e-5, .00039, .00036)),
            row("elbow", (.105, .015, 0), X, (-2.08567, 2.08567), 1.547, .06483, (-.0274, 0, -.0001), (6e-6, 6e-5, 6e-5)),
            row("forearm", (0, 0, 0), Z, (-1.54462, -.0349066), 1.532, .07761, (.0256, .0028, .0008), (2.5e-5, 9e-5, 8.8e-5)),
            row("wrist", (.05595, 0, 0), X, (-1.82387, 1.82387), .4075, .18533, (.0343, -.0009, .0031), (7e-5, .00035, .00036))])
    return robot


def t1():
    """Booster T1: the root link is the trunk, and a waist joint below it carries both legs."""
    robot = Urdf("t1")
    robot.link("trunk", 11.7, (.05, 0, .1), (.09, .08, .03), shape("box", (.06, 0, .12), size=".15 .2 .3"))
    robot.link("neck", .44, (0, 0, .03), (.001, .001, .0005))
    robot.joint("trunk", "neck", (.0625, 0, .243), Z, (-1.57, 1.57), 7)
    robot.link("head", .63, (0, 0, .09), (.003, .003, .001), shape("sphere", (.01, 0, .11), radius=.08))
    robot.joint("neck", "head", (0, 0, .06185), Y, (-.35, 1.22), 7)
    for side, y in SIDES:
        limb(robot, side, y, "trunk", [
            row("shoulder_pitch", (.0575, .1063, .219), Y, (-3.31, 1.22), 18, .53, (-.001, .01, 0), (.0005, .0005, .0005)),
            row("shoulder_roll", (0, .047, 0), X, (-1.74, 1.57), 18, .16, (0, .03, 0), (.0002, .0002, .0002), shape("cylinder", (0, y * .05, 0), (1.5708, 0, 0), radius=.03, length=.1)),
            row("elbow_pitch", (.00025, .0605, 0), Y, (-2.27, 2.27), 18, 1.02, (0, .085, 0), (.005, .001, .005)),
            row("hand", (0, .1471, 0), Z, (-2.44, 0), 18, .33, (0, .11, 0), (.002, .0005, .002), shape("cylinder", (0, y * .1, 0), (1.5708, 0, 0), radius=.03, length=.12))])
    robot.link("waist", 2.58, (0, 0, .008), (.005, .005, .005), shape("cylinder", (0, 0, -.05), radius=.06, length=.1))
    robot.joint("trunk", "waist", (.0625, 0, -.1155), Z, (-1.57, 1.57), 30)
    for side, y in SIDES:
        limb(robot, side, y, "waist", [
            row("hip_pitch", (0, .106, 0), Y, (-1.8, 1.57), 45, 1.02, (.0005, .015, -.03), (.001, .001, .001)),
            row("hip_roll", (0, 0, -.02), X, (-.2, 1.57), 30, .385, (0, 0, -.02), (.0005, .0005, .0005)),
            row("hip_yaw", (0, 0, -.081854), Z, (-1, 1), 30, 2.17, (0, 0, -.09), (.02, .02, .004), shape("cylinder", (0, 0, -.08), radius=.05, length=.1)),
            row("shank", (-.014, 0, -.134), Y, (0, 2.34), 60, 1.73, (-.006, 0, -.124), (.03, .03, .002), shape("cylinder", (0, 0, -.12), radius=.04, length=.15)),
            row("ankle_cross", (0, 0, -.28), Y, (-.87, .35), 24, .073, (0, 0, 0), (3e-5, 3e-5, 3e-5)),
            row("foot", (0, .00025, -.012), X, (-.44, .44), 15, .685, (0, 0, -.025), (.002, .003, .003), shape("box", (.01, 0, -.015), size=".223 .1 .03"))])
    return robot


def atlas():
    """Atlas (2013): 160 kg, a back of three joints."""
    robot = Urdf("atlas")
    robot.link("pelvis", 9.509, (.0111, 0, .0271), (.1244, .0958, .1167))
    for name, parent, place, axis, limits, effort, mass, com, inertia in (
            ("ltorso", "pelvis", (-.0125, 0, 0), Z, (-.663225, .663225), 106, 2.27, (-.0112, -.0031, .0848), (.0039, .0034, .00174)),
            ("mtorso", "ltorso", (0, 0, .162), Y, (-.219388, .538783), 445, .799, (-.0082, -.0131, .0305), (.000454, .000483, .000444)),
            ("utorso", "mtorso", (0, 0, .05), X, (-.523599, .523599), 300, 84.409, (-.0622, .0023, .3157), (1.577, 1.602, .565)),
            ("head", "utorso", (.2546, 0, .6215), Y, (-.602139, 1.14319), 25, 1.42, (-.0175, 0, .1155), (.0022, .0023, .0027))):
        robot.link(name, mass, com, inertia)
        robot.joint(parent, name, place, axis, limits, effort)
    for side, y in SIDES:
        limb(robot, side, y, "pelvis", [
            row("uglut", (0, .089, 0), Z, (-.174358, .786794), 275, 1.959, (.0053, -.0034, .0031), (.00074, .00069, .00067)),
            row("lglut", (0, 0, 0), X, (-.523599, .523599), 530, .898, (.0133, .017, -.0312), (.00069, .00053, .00052)),
            row("uleg", (.05, .0225, -.066), Y, (-1.61234, .65764), 840, 8.204, (0, 0, -.21), (.09, .09, .02), shape("cylinder", (0, 0, -.2), radius=.09, length=.3)),
            row("lleg", (-.05, 0, -.374), Y, (0, 2.35637), 890, 4.515, (.001, 0, -.187), (.077, .076, .01), shape("cylinder", (.02, 0, -.2), radius=.07, length=.3)),
            row("talus", (0, 0, -.422), Y, (-1, .7), 740, .125, (0, 0, 0), (1e-4, 1e-4, 1e-4)),
            row("foot", (0, 0, 0), X, (-.8, .8), 360, 2.41, (.027, 0, -.067), (.002, .007, .008), shape("box", (.0426, 0, -.07645), size=".26 .124887 .02"))])
        limb(robot, side, y, "utorso", [
            row("clav", (.1406, .2256, .4776), Z, (-1.5708, .785398), 87, 4.466, (0, 0, -.084), (.011, .009, .0126)),
            row("scap", (0, .11, -.245), X, (-1.5708, 1.5708), 99, 3.899, (0, 0, 0), (.00319, .00583, .00583)),
            row("uarm", (0, .187, .016), Y, (0, 3.14159), 63, 4.386, (0, -.065, 0), (.00656, .00358, .00656)),
            row("larm", (0, .119, .0092), X, (0, 2.35619), 112, 3.248, (0, 0, 0), (.00265, .00446, .00446)),
            row("ufarm", (0, .187, -.016), Y, (-3.011, 3.011), 25, 2.4798, (.0002, .083, .0004), (.0127, .0027, .0126)),
            row("lfarm", (0, .119, .00921), X, (-1.7628, 1.7628), 25, .648, (.0002, .0246, .0053), (.00077, .00056, .00077)),
            row("hand", (0, 0, 0), Y, (-2.967, 2.967), 5, .5367, (.0001, .0725, 0), (.00093, .00078, .00113))])
    return robot


def go2():
    """Unitree Go2: four legs of three joints, feet that are balls."""
    robot = Urdf("go2")
    robot.link("base", 6.921, (.0211, 0, -.0054), (.0245, .0981, .107), shape("box", size=".3762 .0935 .114"))
    for end, x in (("front", 1), ("rear", -1)):
        for side, y in SIDES:
            limb(robot, f"{end}_{side}", y, "base", [
                row("hip", (x * .1934, .0465, 0), X, (-1.0472, 1.0472), 23.7, .678, (-.0054 * x, -.0019, 0), (.00048, .000884, .000596), shape("cylinder", (0, y * .08, 0), (1.5708, 0, 0), length=.04, radius=.046)),
                row("thigh", (0, .0955, 0), Y, (-1.5708, 3.4907) if x > 0 else (-.5236, 4.5379), 23.7, 1.152, (-.0037, -.0223, -.0327), (.00584, .0058, .00103), shape("box", (0, 0, -.1065), (0, 1.5708, 0), size=".213 .0245 .034")),
                row("calf", (0, 0, -.213), Y, (-2.7227, -.83776), 45.43, .154, (.0055, -.001, -.115), (.00108, .0011, .0000329), shape("cylinder", (.008, 0, -.06), (0, -.21, 0), length=.12, radius=.012))])
            foot = f"{end}_{side}_foot"
            robot.link(foot, .04, (0, 0, 0), (9.6e-6,) * 3, shape("sphere", (-.002, 0, 0), radius=.022))
            robot.joint(f"{end}_{side}_calf", foot, (0, 0, -.213), None, None, 0)
    return robot


def fetch():
    """Fetch: wheels, a torso that slides, a head, and an arm of seven joints with a gripper."""
    robot = Urdf("fetch")
    robot.link("base", 70.1294, (-.0036, 0, .0014), (1.225, 1.2853, .987))
    for side, y in SIDES:
        robot.link(f"{side}_wheel", 4.3542, (0, 0, 0), (.0045, .0045, .0045))
        robot.joint("base", f"{side}_wheel", (.0012914, y * .18738, .055325), Y, None, 8.85)
    robot.link("torso", 10.7796, (-.0013, -.0009, .2935), (.3354, .3354, .0954))
    robot.joint("base", "torso", (-.086875, 0, .37743), Z, (0, .38615), 450, kind="prismatic")
    parents = {"head_pan": "torso", "shoulder_pan": "torso"}
    last = ""
    for name, place, axis, limits, effort, mass, com, inertia in (
            ("head_pan", (.053125, 0, .60301), Z, (-1.57, 1.57), .32, 2.2556, (.0321, .0161, .039), (.0129, .0095, .0184)),
            ("head_tilt", (.14253, 0, .057999), Y, (-.76, 1.45), .68, .9087, (.0081, .0025, .0113), (.0061, .0014, .0061)),
            ("shoulder_pan", (.119525, 0, .34858), Z, (-1.6056, 1.6056), 33.82, 2.5587, (.0927, -.0056, .0564), (.0043, .0087, .0109)),
            ("shoulder_lift", (.117, 0, .06), Y, (-1.221, 1.518), 131.76, 2.6615, (.1432, .0072, -.0001), (.0028, .0111, .0112)),
            ("upperarm_roll", (.219, 0, 0), X, None, 76.94, 2.3311, (.1165, .0014, 0), (.0019, .0045, .0047)),
            ("elbow_flex", (.133, 0, 0), Y, (-2.251, 2.251), 66.18, 2.1299, (.1279, .0073, 0), (.0024, .0082, .0084)),
            ("forearm_roll", (.197, 0, 0), X, None, 29.35, 1.6563, (.1097, -.0266, 0), (.0016, .003, .0035)),
            ("wrist_flex", (.1245, 0, 0), Y, (-2.16, 2.16), 25.7, 1.725, (.0882, .0009, -.0001), (.0018, .0042, .0042)),
            ("wrist_roll", (.1385, 0, 0), X, None, 7.36, .1354, (.0095, .0004, -.0002), (.0001, .0001, .0001))):
        robot.link(name, mass, com, inertia)
        robot.joint(parents.get(name, last), name, place, axis, limits, effort)
        last = name
    robot.link("gripper", 1.5175, (-.09, -.0001, -.0017), (.0013, .0019, .0024))
    robot.joint(last, "gripper", (.16645, 0, 0), None, None, 0)
    for side, y in SIDES:
        robot.link(f"{side}_finger", .0798, (-.01, 0, 0), (2e-5, 2e-5, 2e-5))
        robot.joint("gripper", f"{side}_finger", (0, y * .015425, 0), (0, y, 0), (0, .05), 60, kind="prismatic")
    return robot


ROBOTS = {build.__name__: build for build in (g1, h1, nao, t1, atlas, go2, fetch)}


def run(program, *words, check=True):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True)
    if check and done.returncode != 0:
        raise RuntimeError(f"{words[0]} ends with {done.returncode}: {done.stderr.splitlines()[-1]}")
    return done


class GivenUrdf:
    """A URDF that is given as a file."""

    def __init__(self, file):
        self.file, self.name = pathlib.Path(file), pathlib.Path(file).stem

    def write(self, _):
        return self.file


def take(program, robot, folder):
    """Takes one robot through all steps and returns its line of the table."""
    begin = time.monotonic()
    shutil.rmtree(folder, ignore_errors=True)
    project = folder / "project.yaml"
    run(program, "init", robot.write(folder.with_name(folder.name + "_urdf")), "-o", folder)
    stands = "\nstanding:" in project.read_text()
    run(program, "design", project, "-o", folder / "postures.yaml")
    words = ["--robots", 3] if stands else []
    planned = run(program, "plan", project, "--postures", folder / "postures.yaml", "-o", folder / "motion.csv",
                  *words, check=False)
    if not (folder / "motion.csv").exists():
        raise RuntimeError(planned.stderr.splitlines()[-1])
    plan = json.loads((folder / "motion_margins.json").read_text())
    visited = sum(len(chain["visits"]) for chain in plan["sets"])
    given = visited + sum(len(chain["left_out"]) for chain in plan["sets"])
    duration = sum(chain["duration_s"] for chain in plan["sets"])
    trials = plan.get("tries") or []
    stood = f"{sum(trial['stood'] for trial in trials)} of {len(trials)}" if trials else "held"
    run(program, "plan", project, "--kind", "random", "--count", 10, "-o", folder / "random.csv")
    run(program, "simulate", project, "--motion", folder / "motion.csv", "-o", folder / "recording")
    run(program, "simulate", project, "--motion", folder / "random.csv", "--kind", "random", "-o", folder / "held_out")
    done = run(program, "calibrate", project, "--recording", folder / "recording", folder / "held_out", "-o",
               folder / "out", check=False)
    error = json.loads((folder / "out" / "summary.json").read_text())["deployed"]
    verdict = "deploy" if done.returncode == 0 else f"exit {done.returncode}"
    return (f"| {robot.name} | {visited} of {given} | {duration:.0f} | {stood} | "
            f"{error['urdf']['uncalibrated']:.2f} | {error['urdf']['rmse_3d_mm']:.2f} | "
            f"{error['compensated']['rmse_3d_mm']:.2f} | {verdict} | {time.monotonic() - begin:.0f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("robots", nargs="*", default=list(ROBOTS), help=", ".join(ROBOTS) + "; or files")
    options = parser.parse_args()
    print("| robot | postures visited | motion, s | virtual robots that stand to the end | nominal, mm | URDF, mm | "
          "with elasticity, mm | verdict | time, s |\n|" + "---|" * 9)
    for name in options.robots:
        try:
            robot = ROBOTS[name]() if name in ROBOTS else GivenUrdf(name)
            print(take(options.program, robot, options.work / robot.name), flush=True)
        except (RuntimeError, OSError) as error:
            print(f"| {name} | {error} |" + " |" * 7, flush=True)


if __name__ == "__main__":
    main()
