# SPDX-License-Identifier: Apache-2.0
"""The module against the command line, on the measured arm and on files of the repository."""
import ast
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

import elastocal
from scratch_case import ScratchCase

SOURCE = pathlib.Path(__file__).resolve().parent.parent
SHARED = pathlib.Path(os.environ.get("ELASTOCAL_SHARED_DATA", SOURCE.parent / "shared" / "data"))
ARM = SOURCE / "examples/talos_left_arm/project.yaml"
STUB = SOURCE / "python/elastocal.pyi"
TABLE = SHARED / "talos_left_arm_mocap/talos_left_arm_02_10_contact.csv"


@unittest.skipUnless(TABLE.exists(), f"there is no {TABLE}")
class LeftArm(ScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.program([*"calibrate --kfold 0 --quiet".split(), ARM, "--recording", TABLE, "-o",
                     cls.folder / "cli"])
        cls.project = elastocal.Project(ARM)
        cls.found = elastocal.calibrate(cls.project, [TABLE], folds=0)

    @classmethod
    def program(cls, words):
        subprocess.run([os.environ["ELASTOCAL_PROGRAM"], *map(str, words)], check=True)

    def test_five_lines(self):
        project = elastocal.Project(ARM)
        found = elastocal.calibrate(project, TABLE, folds=0)
        self.assertTrue(found.deployable)
        self.assertEqual(f"{found.urdf_rmse_mm:.2f} mm", "0.57 mm")

    def test_errors_of_the_fit_and_of_what_was_held_out(self):
        self.assertTrue(np.isnan(self.found.held_out_rmse_mm))
        folded = elastocal.calibrate(self.project, TABLE, folds=3)
        self.assertEqual(folded.urdf_rmse_mm, self.found.urdf_rmse_mm)
        self.assertEqual(folded.summary["deployed"]["judged_on"], "held-out postures")
        self.assertAlmostEqual(folded.held_out_rmse_mm, folded.summary["deployed"]["urdf"]["rmse_3d_mm"], places=9)
        self.assertGreater(folded.held_out_rmse_mm, folded.urdf_rmse_mm)
        with self.assertRaisesRegex(elastocal.InputError, "folds: -1; a whole number from 0 "):
            elastocal.calibrate(self.project, TABLE, folds=-1)

    def test_bits_of_the_command_line(self):
        written = self.folder / "cli"
        for name, text in self.found.files.items():
            if name in ("summary.json", "report_data.json"):
                continue  # contains the time of the solver
            self.assertEqual(text, (written / name).read_text(), name)
        self.assertIn("calibration.yaml", self.found.files)
        there = json.loads((written / "summary.json").read_text())
        self.assertEqual(self.found.summary["parameters"], there["parameters"])
        self.assertEqual(self.found.summary["rmse_3d_mm"], there["rmse_3d_mm"])

    def test_arrays_and_names(self):
        self.assertEqual(self.found.values.shape, (len(self.found.parameters),))
        self.assertEqual(self.found.sd.shape, self.found.values.shape)
        by_name = {p["name"]: p["value"] for p in self.found.summary["parameters"]}
        i = self.found.parameters.index("arm_left_1_joint.theta")
        self.assertAlmostEqual(self.found.values[i], by_name["arm_left_1_joint.theta"], 6)
        self.assertIn("arm_left_1_joint", self.project.joints)

    def test_saved_calibration_is_used(self):
        self.found.save(self.folder / "saved")
        verdict = elastocal.validate(self.project, self.folder / "saved", TABLE)
        self.assertEqual(verdict["status"], "better")
        checked = elastocal.check(self.project, self.folder / "cli", TABLE)
        self.assertEqual(checked["status"], "unchanged")
        self.assertEqual(checked["moved"], [])
        unchanged = elastocal.compare(self.folder / "cli", self.folder / "saved")
        self.assertFalse(unchanged["changed"])
        self.assertEqual(unchanged["moved"], [])

    def test_measured_marker_places_are_known(self):
        def place(found):
            of = {p["name"]: p for p in found.summary["parameters"]}
            return [of[f"marker.LGRIPPER.{axis}"] for axis in "xyz"]
        table = self.folder / "places.csv"
        table.write_text("marker,x_mm,y_mm,z_mm,sd_mm\nLGRIPPER,60,10,-70,0.5\n")
        known = elastocal.calibrate(self.project, TABLE, folds=0, marker_places=table)
        self.assertTrue(all(p["sd"] < 1e-3 for p in place(known)))
        self.assertTrue(any(p["sd"] > 1e-3 for p in place(self.found)))
        with self.assertRaisesRegex(elastocal.InputError, "places.csv:2.*LGRIPPPER"):
            table.write_text("marker,x_mm,y_mm,z_mm,sd_mm\nLGRIPPPER,60,10,-70,0.5\n")
            elastocal.calibrate(self.project, TABLE, marker_places=table)

    def test_runtime(self):
        nominal = elastocal.Runtime(self.folder / "cli", ARM, "nominal")
        real = elastocal.Runtime(self.folder / "cli", self.project)  # from its file
        bent = {"arm_left_1_joint": 0.3, "arm_left_2_joint": 0.4, "arm_left_4_joint": -1.2,
                "leg_left_4_joint": 0.6, "leg_right_4_joint": 0.6}  # within the limits
        q = np.array([bent.get(name, 0.1 if "arm_right_2" not in name else -0.4)
                      for name in real.joints])
        tip = "gripper_left_base_link"
        at = [r.forward(q)["links"][tip][:3, 3] for r in (nominal, real)]
        self.assertGreater(np.linalg.norm(at[0] - at[1]), 1e-4)
        # The command brings the real hand to where the nominal one is at q.
        again = real.forward(real.command(q))["links"][tip][:3, 3]
        self.assertLess(np.linalg.norm(again - at[0]), 1e-5)
        self.assertLess(real.residual_m, 1e-5)
        self.assertLess(real.residual_rad, 1e-4)
        self.assertEqual(real.stopped, [])
        real.correct(q)
        self.assertEqual(real.root_displacement.shape, (6,))
        # Joints are given by name, with the others at zero. The project is the one that the
        # calibration names.
        again = elastocal.Runtime(self.folder / "cli").forward(bent)["links"][tip]
        every = real.forward(np.array([bent.get(name, 0.0) for name in real.joints]))["links"][tip]
        np.testing.assert_array_equal(again, every)
        # Without calibration, it is the project's robot.
        nominal_at = nominal.forward(bent)["links"][tip]
        np.testing.assert_allclose(nominal_at, self.project.robot.poses(bent)[tip], atol=1e-9)
        with self.assertRaises(elastocal.InputError):
            real.forward(np.zeros(3))
        # A motion begins where the drives are, and goes on within the limits.
        real.limit_changes(np.full(len(real.joints), 2e-3))
        real.start_from(q)
        self.assertLessEqual(np.abs(real.command(q) - q).max(), 2e-3 + 1e-12)
        real.limit_changes([])
        real.forget()
        self.assertGreater(np.abs(real.command(q) - q).max(), 4e-3)
        real.ease_changes(10)
        with self.assertRaisesRegex(elastocal.InputError, "most: 3 limits; none or"):
            real.limit_changes(np.zeros(3))
        with self.assertRaisesRegex(elastocal.InputError, "command: finite positions"):
            real.start_from(np.full(len(real.joints), np.nan))
        for wrong in ("x", [[1, 2], [3]], object()):
            with self.assertRaisesRegex(TypeError, "q: an array of .* positions, or a dict of joints was expected"):
                real.forward(wrong)
        with self.assertRaisesRegex(TypeError, "q: joint 'arm_left_1_joint': a number was expected, found str"):
            real.forward({"arm_left_1_joint": "x"})


class Arrays(unittest.TestCase):
    """A recording that is made of arrays: an arm with an error that is known."""

    def test_known_error_is_found(self):
        error, noise, marker = 0.01, 1e-4, np.array([0.06, 0.01, -0.07])  # rad, m, m
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "project.yaml"
            file.write_text(f"robot: {{urdf: {SOURCE}/models/talos/talos.urdf}}\n"
                            "chains:\n  - {name: arm, tip: gripper_left_base_link}\n"
                            "markers:\n  single:\n"
                            f"    - {{name: HAND, link: arm_left_7_link, position_mm: {list(1e3 * marker)}}}\n")
            project = elastocal.Project(file)
            robot, random = project.robot, np.random.default_rng(1)
            moving = [name.startswith(("torso", "arm_left")) for name in robot.joints]
            postures = np.where(moving, random.uniform(robot.lower, robot.upper, (60, len(moving))), project.rest)
            offset = error * np.array([name == "arm_left_4_joint" for name in robot.joints])
            seen = [(robot.poses(q + offset)["arm_left_7_link"] @ [*marker, 1.0])[:3] for q in postures]
            table = pathlib.Path(folder) / "recording.csv"
            elastocal.write_table(project, table, postures,
                                  np.array(seen)[:, None, :] + random.normal(0.0, noise, (60, 1, 3)))
            found = elastocal.calibrate(project, table, folds=0)
            i = found.parameters.index("arm_left_4_joint.theta")
            self.assertAlmostEqual(found.values[i], error, delta=4.0 * found.sd[i])  # needs no luck
            self.assertLess(found.sd[i], 2e-3)
            self.assertLess(found.urdf_rmse_mm, 2e3 * noise)  # for three coordinates
            steps = []
            elastocal.calibrate(project, [table], folds=2, progress=lambda *at: steps.append(at))
            self.assertIn(("cross-validation", 2, 2), steps)
            with self.assertRaisesRegex(elastocal.InputError, r"markers: an array of \(60, 1, 3\)"):
                elastocal.write_table(project, table, postures, np.zeros((60, 3)))
            bad = postures.copy()
            bad[3, robot.joints.index("arm_left_4_joint")] = np.nan
            with self.assertRaisesRegex(elastocal.InputError, "positions: nan of joint 'arm_left_4_joint' in posture 3;"):
                elastocal.write_table(project, table, bad, np.zeros((60, 1, 3)))
            half = np.zeros((60, 1, 3))
            half[7, 0, 1] = np.nan
            with self.assertRaisesRegex(elastocal.InputError, "markers: 'HAND' in posture 7; three numbers"):
                elastocal.write_table(project, table, postures, half)
            for call in (lambda: elastocal.calibrate(file), lambda: elastocal.validate(file, folder),
                         lambda: elastocal.check(file, folder)):
                with self.assertRaisesRegex(TypeError, "missing argument 'recordings?': the file or folder of a recording"):
                    call()
            self.assertEqual(elastocal.info(table)["postures"]["markers"], [{"name": "HAND", "seen": 60}])
            with self.assertRaisesRegex(elastocal.InputError, "this is a posture table"):
                elastocal.read(table)


class Files(unittest.TestCase):
    def test_recordings_are_arrays(self):
        bag = elastocal.read(SOURCE / "tests/recordings/bag_lz4.mcap")
        self.assertEqual(bag["format"], "MCAP")
        self.assertEqual(bag["markers"]["positions"].shape, (20, 4, 3))
        self.assertTrue(np.isnan(bag["markers"]["positions"][7]).all())
        self.assertAlmostEqual(bag["markers"]["positions"][3, 0, 0], 1.03, 12)
        np.testing.assert_array_equal(bag["joints"]["positions"][:, 0], 0.25 * np.arange(10))
        self.assertEqual(bag["joints"]["torques"].shape, (10, 2))
        self.assertIsNone(bag["markers"]["up"])
        moved = elastocal.read(SOURCE / "tests/recordings/tf.mcap", tf_frame="cameras", tf_bodies=["cameras/LHAND"])
        np.testing.assert_array_equal(moved["markers"]["positions"], bag["markers"]["positions"])
        self.assertIsNone(elastocal.info(SOURCE / "tests/recordings/tf.mcap", tf_frame="camera")["markers"])
        log = SOURCE / "tests/recordings/joints_matrix.npz"
        np.testing.assert_array_equal(elastocal.read(log)["joints"]["positions"], np.load(log)["q"])
        self.assertEqual(elastocal.info(log)["joints"]["samples"], 6)

    def test_docstrings(self):
        """Everything has one, and help() says what the stub file says."""
        def check(name, thing, node):
            # pybind11 writes the signature of a function before its docstring.
            said = " ".join((thing.__doc__ or "").split())
            stub = " ".join((ast.get_docstring(node) or "").split())
            self.assertTrue(stub and said.endswith(stub), f"{name}: {stub!r} in the stub, {said!r} in the module")

        for node in ast.parse(STUB.read_text()).body:
            thing = getattr(elastocal, getattr(node, "name", ""), None)
            if thing is None:
                continue
            check(node.name, thing, node)
            for member in getattr(node, "body", []):
                if isinstance(thing, type) and isinstance(member, ast.FunctionDef):
                    check(f"{node.name}.{member.name}", getattr(thing, member.name), member)

    def test_errors(self):
        with self.assertRaisesRegex(elastocal.InputError, "no such file"):
            elastocal.Project("nowhere.yaml")
        with self.assertRaisesRegex(ValueError, "no known format|no recording"):
            elastocal.read(SOURCE / "README.md")
        with self.assertRaises(TypeError):
            elastocal.Project(3)


if __name__ == "__main__":
    unittest.main()
