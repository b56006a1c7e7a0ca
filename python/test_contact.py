# SPDX-License-Identifier: Apache-2.0
"""Projects with contact or instruments against the command line: a virtual robot, and touches of the real one."""
import json
import math
import os
import pathlib
import subprocess
import unittest

import numpy as np

import elastocal
from scratch_case import ScratchCase

SOURCE = pathlib.Path(__file__).resolve().parent.parent
SHARED = pathlib.Path(os.environ.get("ELASTOCAL_SHARED_DATA", SOURCE.parent / "shared" / "data"))
INSTRUMENTS = f"""robot: {{urdf: {SOURCE}/models/talos/talos.urdf}}
contact:
  feet:
    - {{link: left_sole_link}}
    - {{link: right_sole_link, position_mm: [0, -170, 0]}}
instruments:
  trackers:
    - {{name: cameras}}
  positions:
    - {{name: hand, link: gripper_left_base_link, tracker: cameras, point_mm: [0, 30, -100]}}
  inertial_units:
    - {{name: imu, link: gripper_left_base_link}}
  wires:
    - {{name: wire, link: gripper_right_base_link, point_mm: [0, 0, -50], anchor_mm: [1500, -800, 0]}}
"""
WRONG, BY = "arm_left_4_joint", 0.01  # rad
TABLE = SOURCE / "examples/talos_table/project.yaml"
TOUCHES = [SHARED / f"talos_table_contact/{side}.csv" for side in ("left", "right")]


def program(*words):
    """Its exit code."""
    return subprocess.run([os.environ["ELASTOCAL_PROGRAM"], *map(str, words), "--quiet"]).returncode


class SameAsTheProgram:
    """Calibrates and validates both ways. Derived: `file` of the project, `recordings`, `other` of another day."""

    def test_calibration_has_the_bytes_of_the_program(self):
        written = self.folder / "program"
        self.assertEqual(program("calibrate", self.project.file, "--recording", *self.recordings, "--kfold", 3, "-o",
                                 written), 0)
        for name, text in self.found.files.items():
            self.assertEqual(text, (written / name).read_text(), name)
        self.assertEqual(self.found.summary, json.loads((written / "summary.json").read_text()))
        self.assertEqual(set(self.found.files) | {"report.html", "runs.json", "SHA256SUMS"},
                         {file.name for file in written.iterdir()})

    def test_validation_is_that_of_the_program(self):
        self.found.save(self.folder / "saved")
        there = self.folder / "validation.json"
        for refit, words in ((None, []), ("table", ["--refit", "table"])):
            code = program("validate", self.project.file, "--calibration", self.folder / "saved", "--recording",
                           *self.other, *words, "--json", there)
            here = elastocal.validate(self.project, self.folder / "saved", self.other, refit=refit)
            self.assertEqual(here, json.loads(there.read_text()))
            self.assertEqual(here["status"], "better" if code == 0 else "not better")
            self.assertEqual(here["contact"]["table"], "refitted" if refit else "as calibrated")
            self.assertEqual(here["status"], "better")

    def test_check_is_that_of_the_program(self):
        self.found.save(self.folder / "saved")
        there = self.folder / "check.json"
        code = program("check", self.project.file, "--calibration", self.folder / "saved", "--recording", *self.other,
                       "--json", there)
        here = elastocal.check(self.project, self.folder / "saved", self.other)
        self.assertEqual(here, json.loads(there.read_text()))
        self.assertEqual((here["status"], code), ("unchanged", 0))

    def test_update_has_the_bytes_of_the_program(self):
        self.found.save(self.folder / "saved")
        written = self.folder / "updated"
        self.assertEqual(program("calibrate", self.project.file, "--recording", *self.other, "--kfold", 0, "--prior",
                                 self.folder / "saved", "--days", 30, "-o", written), 0)
        updated = elastocal.calibrate(self.project, self.other, folds=0, prior=self.folder / "saved", days=30)
        self.assertEqual(updated.files["calibration.yaml"], (written / "calibration.yaml").read_text())
        self.assertNotEqual(updated.files["calibration.yaml"], self.found.files["calibration.yaml"])

    def test_arrays_and_names(self):
        found = self.found
        self.assertTrue(found.deployable, found.objections)
        self.assertEqual(found.status, "converged")
        self.assertEqual(found.values.shape, (len(found.parameters),))
        self.assertEqual(found.sd.shape, found.values.shape)
        self.assertTrue(math.isnan(found.urdf_rmse_mm))  # no marker was measured
        for parameter, name, value in zip(found.summary["parameters"], found.parameters, found.values):
            self.assertEqual((parameter["name"], parameter["value"]), (name, value))


def make_table(project, file, seed, count):
    """What the instruments show of a robot whose left elbow is wrong: 0.3 mm and 0.01 m/s^2 of noise. Arms and trunk are
    anywhere; the legs stand as at zero, where the feet are as the project says."""
    robot, random = project.robot, np.random.default_rng(seed)
    moving = [name.startswith(("torso", "arm")) for name in robot.joints]
    q = np.where(moving, random.uniform(robot.lower, robot.upper, (count, len(moving))), 0.0)
    offset = BY * np.array([name == WRONG for name in robot.joints])
    rows = [",".join(robot.joints) + ",hand_x,hand_y,hand_z,imu_ax,imu_ay,imu_az,wire"]
    for posture in q:
        links = robot.poses(posture + offset)
        foot = np.linalg.inv(links["left_sole_link"])
        hand, other = foot @ links["gripper_left_base_link"], foot @ links["gripper_right_base_link"]
        point = (hand @ [0.0, 0.03, -0.1, 1.0])[:3] + [0.5, 0.2, 0.1]  # the tracker stands somewhere
        felt = hand[:3, :3].T @ [0.0, 0.0, 9.81]
        length = np.linalg.norm((other @ [0.0, 0.0, -0.05, 1.0])[:3] - [1.5, -0.8, 0.0])
        seen = [*point + random.normal(0, 3e-4, 3), *felt + random.normal(0, 0.01, 3), length + random.normal(0, 3e-4)]
        rows.append(",".join(map(repr, map(float, [*posture, *seen]))))
    file.write_text("\n".join(rows) + "\n")


def measured_project(folder, tables):
    """A project of this robot in a folder, and tables of so many postures by name."""
    file = folder / "project.yaml"
    file.write_text(INSTRUMENTS)
    project = elastocal.Project(file)
    for seed, (name, count) in enumerate(tables.items()):
        make_table(project, folder / name, seed, count)
    return project


class Instruments(SameAsTheProgram, ScratchCase):
    """A virtual humanoid that a tracker, an inertial unit and a wire measure."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.project = measured_project(cls.folder, {"a.csv": 20, "b.csv": 20, "other.csv": 20})
        cls.recordings, cls.other = [cls.folder / "a.csv", cls.folder / "b.csv"], [cls.folder / "other.csv"]
        cls.steps = []
        cls.found = elastocal.calibrate(cls.project, cls.recordings, folds=3, threads=2,
                                        progress=lambda *at: cls.steps.append(at))

    def test_known_error_is_found(self):
        found = self.found
        i = found.parameters.index(f"{WRONG}.theta")
        self.assertAlmostEqual(found.values[i], BY, delta=4.0 * found.sd[i])  # needs no luck
        self.assertLess(found.sd[i], 0.2 * BY)
        held_out = found.summary["contact"]["kfold"]
        self.assertEqual([one["name"] for one in held_out["instruments"]], ["hand", "imu", "wire"])
        before, after = (of["instruments"][0]["position_mm"] for of in (held_out["uncalibrated"], held_out))
        self.assertLess(after, 0.5 * before)  # 10 mrad at 0.3 m against 0.3 mm
        self.assertEqual(self.steps[0], ("cross-validation", 0, 3))
        self.assertEqual(self.steps[-1], ("cross-validation", 3, 3))

    def test_an_exception_of_progress_ends_it(self):
        def stop(step, done, total):
            raise ZeroDivisionError("enough")

        with self.assertRaisesRegex(ZeroDivisionError, "enough"):
            elastocal.calibrate(self.project, self.recordings, folds=3, progress=stop)

    def test_errors(self):
        with self.assertRaisesRegex(elastocal.InputError, "^fold_by: not with contact or instruments"):
            elastocal.calibrate(self.project, self.recordings, fold_by="trial")
        with self.assertRaisesRegex(elastocal.InputError, "there is no such file"):
            elastocal.calibrate(self.project, self.recordings, prior=self.folder / "none")
        with self.assertRaisesRegex(elastocal.InputError, "accept lag: sign:JOINT, .* was expected"):
            elastocal.calibrate(self.project, self.recordings, accept=["lag"])
        with self.assertRaisesRegex(elastocal.InputError, "folds"):
            elastocal.calibrate(self.project, self.recordings, folds=1)
        with self.assertRaisesRegex(elastocal.InputError, "^frozen: not with contact.*refit='table'"):
            elastocal.validate(self.project, self.folder, self.other, frozen=True)
        with self.assertRaisesRegex(elastocal.InputError, "refit: 'wall'; one of 'table' was expected"):
            elastocal.validate(self.project, self.folder, self.other, refit="wall")
        markers = elastocal.Project(SOURCE / "models/talos/project.yaml")
        with self.assertRaisesRegex(elastocal.InputError, "refit: 'table' is about touches"):
            elastocal.validate(markers, self.folder, self.other[0], refit="table")
        with self.assertRaisesRegex(elastocal.InputError, "recording: 2 files; one was expected"):
            elastocal.validate(markers, self.folder, [self.other[0]] * 2)
        for words in (["--prior", self.folder / "none"], ["--accept", "lag"], ["--fold-by", "trial"]):
            self.assertEqual(program("calibrate", self.project.file, "--recording", *self.recordings, *words, "-o",
                                     self.folder / "no"), 3)
        self.assertFalse((self.folder / "no").exists())


@unittest.skipUnless(TOUCHES[0].exists(), f"there is no {TOUCHES[0]}")
class Table(SameAsTheProgram, ScratchCase):
    """Touches of a table by the real TALOS."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.project = elastocal.Project(TABLE)
        cls.recordings = cls.other = TOUCHES
        cls.found = elastocal.calibrate(cls.project, TOUCHES, folds=3)

    def test_hip_gives_way(self):
        """As /docs/accuracy.md has it: 2.0 degrees per 100 N.m, that is 350 urad/(N.m)."""
        found = self.found
        hip = found.parameters.index("leg_left_3_joint.compliance_z")
        self.assertAlmostEqual(np.degrees(found.values[hip]) * 100.0, 2.01, delta=0.02)
        held_out = found.summary["contact"]["kfold"]
        self.assertLess(held_out["height_mm"], 0.5 * held_out["uncalibrated"]["height_mm"])


if __name__ == "__main__":
    unittest.main()
