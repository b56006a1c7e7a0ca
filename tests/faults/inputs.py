# SPDX-License-Identifier: Apache-2.0
"""Good inputs for a small arm, which bad_input.py then damages, and URDFs that are bad as a whole."""

import json
import os
import pathlib
import re
import shutil
import subprocess

# Options for simulations that end within a second.
SHORT = ["--arm-postures", "2", "--random-postures", "1", "--repetitions", "1"]


class Base:
    """A project, a recording, a posture table, a posture file, a motion and results."""

    def __init__(self, program, source, root):
        self.program, self.root = program, root
        good = root / "good"
        good.mkdir()
        robots = source / "tests" / "robots"
        self.urdf = pathlib.Path(shutil.copy(robots / "arm6.urdf", good))
        self.project = pathlib.Path(shutil.copy(robots / "arm6_project.yaml", good))
        self.recording, self.out = good / "recording", good / "out"
        # The clocks agree, so that rows of the log and frames of the cameras belong together.
        self.run("simulate", self.project, "-o", self.recording, "--arm-postures", "12",
                 "--random-postures", "1", "--repetitions", "1", "--least-lag-s", "0",
                 "--largest-lag-s", "0", "--drift-ppm", "0")
        self.experiment = {"trials": [{
            "name": "arm", "kind": "calibration", "samples": "rests", "chains": ["arm"], "support": [],
            "markers": str(self.recording / "arm.tsv"), "joints": str(self.recording / "arm.csv"),
            "expected_lag_s": 0, "truth": str(self.recording / "arm_waist.csv")}]}
        self.table = good / "table.csv"
        self.table.write_text(self.posture_table())
        self.run("calibrate", self.project, "--recording", self.table, "-o", self.out)
        self.run("validate", self.project, "--recording", self.table, "--calibration", self.out,
                 "-o", self.out)
        self.postures = good / "postures.yaml"
        self.postures.write_text(json.dumps({"robot": "arm6", "chains": [{
            "name": "arm", "support": [], "postures": [
                {"elbow_joint": 0.4 * (k % 5) - 1, "shoulder_joint": 0.3 * (k % 4) - 0.5,
                 "turret_joint": 0.2 * k - 1} for k in range(12)]}]}))
        self.motion = "time,elbow_joint,turret_joint\n" + "".join(
            f"{0.1 * k:.1f},{0.02 * k:.2f},{-0.01 * k:.2f}\n" for k in range(20))
        self.settings = {"marker_noise_mm": 0.1, "arm_postures": 2, "random_postures": 1,
                         "repetitions": 1, "log_rate_hz": 100, "time_step_s": 0.001, "move_s": 2,
                         "rest_s": 1, "lead_in_s": 1, "encoder_bits": 16, "drift_ppm": 10,
                         "pelvis_compliance": [1e-7] * 6, "upper_stiffness_least": 1000,
                         "upper_stiffness_most": 10000, "servo_stiffness": 1e5, "lost_marker": "WRIST",
                         "fault_trial": "arm", "lag_s": 0.5, "knocked_cluster": "TOOL",
                         "knock_mm": 5, "gaps_per_minute": 3, "swaps_per_minute": 1}
        self.full_project = full_project(self.urdf)
        self.design = good / "design.yaml"
        self.design.write_text(json.dumps(  # `plan` does not support joints that rods move
            {key: value for key, value in self.full_project.items() if key != "linkages"}))
        self.run("assess", self.design, "--postures", self.postures)

    def run(self, *words):
        done = subprocess.run([self.program, *map(str, words)], capture_output=True, check=False)
        if done.returncode not in (0, 4):
            raise SystemExit(f"{words}: {done.returncode}\n{done.stderr.decode(errors='replace')}")

    def posture_table(self):
        """The moments at which the arm rests."""
        log = [line.split(",") for line in (self.recording / "arm.csv").read_text().split("\n")[:-1]]
        frames = (self.recording / "arm.tsv").read_text().split("\n")
        names = next(line for line in frames if line.startswith("MARKER_NAMES")).split("\t")[1:]
        frames = [line.split("\t") for line in frames if re.match(r"\d+\t", line)]
        joints = [c for c, name in enumerate(log[0]) if name != "t" and not name.endswith("_torque")]
        rows = [[f"{name}_{axis}" for name in names for axis in "xyz"] + [log[0][c] for c in joints]]
        seen = None
        for k in range(60, min(len(log), len(frames)) - 60, 5):
            position = [float(log[k + 1][c]) for c in joints]
            near = max(abs(float(log[k + d][c]) - q) for d in (-30, 32) for c, q in zip(joints, position))
            if near > 2e-3 or (seen and max(abs(a - b) for a, b in zip(seen, position)) < 0.05):
                continue
            seen = position
            cells = [f"{float(x) / 1000:.6f}" if x.strip() else "" for x in frames[k][2:2 + 3 * len(names)]]
            for m in range(0, len(cells), 3):
                if "" in cells[m:m + 3]:
                    cells[m:m + 3] = ["", "", ""]
            rows.append(cells + [f"{q:.7f}" for q in position])
        return "\n".join(",".join(row) for row in rows) + "\n"

    def project_for(self, urdf):
        """A project file for another URDF, in its folder."""
        path = urdf.parent / "project.yaml"
        path.write_text(self.project.read_text().replace("arm6.urdf", urdf.name))
        return path

    def recording_with(self, file):
        """A folder with the recording's first trial, one file of which is replaced."""
        for name in ["arm.csv", "arm.tsv"]:
            if name != file.name:
                os.symlink(self.recording / name, file.parent / name)
        (file.parent / "experiment.yaml").write_text(
            "trials: [{name: arm, chain: arm, markers: arm.tsv, joints: arm.csv}]\n")
        return file.parent


def full_project(urdf):
    """Every key of a project file (docs/formats.md), with values that are fine."""
    cluster = lambda name, link: {"name": name, "link": link,
                                  "positions_mm": [[48, 70, -10], [-20, 130, 21], [10, 200, -64]]}
    return {
        "robot": {"urdf": str(urdf)},
        "linkages": [{"name": "elbow", "joints": ["elbow_joint"], "assembled_deg": [0], "rods": [
            {"motor": "elbow_motor", "from": "upper_arm", "to": "forearm", "centre_mm": [0, -30, 100],
             "axis": [0, 1, 0], "pin_mm": [60, -30, 100], "anchor_mm": [52.7, 28.8, 0],
             "length_mm": 300,
             "uncertain": {"length_mm": 1, "zero_deg": 0.5, "radius_mm": 1, "anchor_mm": 1,
                           "centre_mm": [1, 1, 0]}}]}],
        "chains": [{"name": "arm", "from": "pedestal", "tip": "tool"}],
        "markers": {"reference": "PEDESTAL",
                    "clusters": [cluster("PEDESTAL", "pedestal"), cluster("FOREARM", "forearm"),
                                 cluster("TOOL", "tool")],
                    "single": [{"name": "WRIST", "link": "wrist", "position_mm": [35, 40, 45]}]},
        "torque_sensors": ["elbow_joint"],
        "force_torque_sensors": [{"name": "hand", "link": "tool"}],
        "recording": {"up": [0, 0, 1], "columns": {"time": "t", "markers": {"WRIST": ["a", "b", "c"]},
                                  "joints": {"elbow_joint": "elbow_joint"}},
                      "ignore": ["comment"], "not_recorded_deg": {"flange_joint": 0},
                      "not_recorded_mm": {"finger_left_joint": 10}},
        "placement": {"parallel_tolerance_deg": 1},
        "measurement": {"cutoff_hz": 5, "filter_order": 4, "longest_gap_s": 0.2, "expected_lag_s": 0,
                        "longest_lag_s": 2, "largest_lag_sd_ms": 5, "largest_rest_lag_sd_ms": 50,
                        "rest_speed_mm_per_s": 10, "hold_s": 0.3, "samples_per_rest": 8,
                        "sine_rate_hz": 5},
        "identifiability": {"postures": 200, "tolerance": 1e-6, "seed": 1, "hold": ["rail_joint.*"]},
        "calibration": {
            "marker_sd_mm": 0, "plausible_marker_sd_mm": 5, "widen_prior": True, "outliers": "remove",
            "outlier_probability": 0.01, "support_threshold": 0.9, "correlation_threshold": 0.9,
            "max_iterations": 100, "support": "nuisance", "load": "torques", "slip_mm": 1, "gauge": "prior",
            "prior": {"theta_deg": 0.5, "gamma_deg": 0.5, "alpha_deg": 0.5, "beta_deg": 0.5, "r_mm": 1,
                      "d_mm": 1, "b_mm": 1, "marker_mm": 1000, "deflection_mrad": 10,
                      "torsion_urad_per_Nm": 50, "bending_urad_per_Nm": 50,
                      "base_force_um_per_N": 10, "base_moment_urad_per_Nm": 50, "torque_bias_Nm": 2}},
        "elasticity": {"torsion": ["*"], "bending": ["elbow_joint"], "base": True,
                       "torque_bias": False},
        "collision": {"margin_mm": 5, "spheres": [
            {"name": "A", "link": "tool", "centre_mm": [50, 0, -42], "radius_mm": 65},
            {"name": "B", "link": "pedestal", "centre_mm": [50, 0, -42], "radius_mm": 65}]},
        "standing": {"soles": [{"link": "tool", "lower_mm": [-105, -65], "upper_mm": [105, 65]}]},
        "design": {"rest_deg": {"elbow_joint": 20}, "limit_margin": 0.02,
                   "range_deg": {"elbow_joint": [-60, 60]}, "effort_share": 1,
                   "motion_effort_share": 1, "dexterity_share": 0.5,
                   "chains": [{"chain": "arm", "support": [], "cone_deg": 60, "floor_mm": -1000,
                               "box_mm": {"lower": [-350, -50, -1080], "upper": [350, 350, -650]},
                               "contacts": [["A", "B"]]}],
                   "cameras_mm": [[3000, 2000, 1500]]},
    }


def bad_urdfs(text):
    """URDFs that are bad or absurd as a whole, by what is wrong."""
    joint = lambda k, more="": (f'<link name="b{k}"/><joint name="c{k}" type="revolute"><parent link="b{k - 1}"/>'
                                f'<child link="b{k}"/><origin xyz="0 0 0.1"/><axis xyz="0 1 0"/>'
                                f'<limit lower="-1" upper="1" velocity="1" effort="10"/>{more}</joint>')
    chain = lambda n: ('<robot name="r"><link name="b0"/>' + "".join(joint(k) for k in range(1, n + 1)) +
                       "</robot>")
    # The chain is below the tool, so that the names of the project exist.
    serial = lambda n: text.replace("</robot>", '<link name="b0"/><joint name="c0" type="fixed">'
                                    '<parent link="tool"/><child link="b0"/></joint>' +
                                    chain(n).split('<link name="b0"/>')[1])
    zero = re.sub(r'<inertia [^>]*>', '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>', text)
    return {
        "200 000 attributes": text.replace("<link ", "<link " + " ".join(f'a{k}="1"' for k in range(200000)) + " ", 1),
        "1 000 joints in series": serial(1000),
        "200 joints in series": serial(200),
        "20 000 links": text.replace("</robot>", "".join(f'<link name="l{k}"/>' for k in range(20000)) + "</robot>"),
        "nested 100 000 deep": "<robot name='r'>" + "<a>" * 100000 + "</a>" * 100000 + "</robot>",
        "unclosed 100 000 deep": "<robot name='r'>" + "<a>" * 100000,
        "entities": '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]>' + text,
        "mass 1e308": re.sub(r'mass value="[^"]*"', 'mass value="1e308"', text),
        "mass 0": re.sub(r'mass value="[^"]*"', 'mass value="0"', text),
        "mass 1e-300": re.sub(r'mass value="[^"]*"', 'mass value="1e-300"', text),
        "inertia 0": zero,
        "inertia negative": zero.replace('ixx="0"', 'ixx="-1"'),
        "inertia 1e300": zero.replace('ixx="0"', 'ixx="1e300"'),
        "limits 1e8": text.replace('lower="-2.3" upper="2.3"', 'lower="-1e8" upper="1e8"'),
        "limits 1e300": text.replace('lower="-2.3" upper="2.3"', 'lower="-1e300" upper="1e300"'),
        "limits exchanged": text.replace('lower="-2.3" upper="2.3"', 'lower="2.3" upper="-2.3"'),
        "limits equal": text.replace('lower="-2.3" upper="2.3"', 'lower="0" upper="0"'),
        "effort negative": text.replace('effort="120"', 'effort="-120"'),
        "velocity negative": text.replace('velocity="2.2"', 'velocity="-2.2"'),
        "effort and velocity 0": text.replace('effort="120"', 'effort="0"').replace('velocity="2.2"', 'velocity="0"'),
        "a name in Latin-1": text.encode().replace(b"elbow_joint", b"elb\xf6w"),
        "a name of 1 MB": text.replace("elbow_joint", "e" * 1000000),
        "a joint twice": text.replace('"elbow_joint"', '"shoulder_joint"'),
        "a loop": text.replace('<parent link="pedestal"/>', '<parent link="tool"/>', 1),
        "two roots": text.replace("</robot>", '<link name="alone"/></robot>'),
        "axis of zero": text.replace('<axis xyz="0 0 -1"/>', '<axis xyz="0 0 0"/>', 1),
        "origin 1e6 m": text.replace('xyz="0.015 -0.03 0.4"', 'xyz="1e6 0 0"'),
        "mimics itself": text.replace("</joint>", '<mimic joint="elbow_joint"/></joint>'),
    }
