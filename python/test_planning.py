# SPDX-License-Identifier: Apache-2.0
"""design, plan and simulate of the module against the command line, on the humanoid of the repository."""
import json
import os
import pathlib
import subprocess
import unittest

import numpy as np

import elastocal
from scratch_case import ScratchCase

SOURCE = pathlib.Path(__file__).resolve().parent.parent
TALOS = SOURCE / "models/talos/project.yaml"
QUICK = {"marker_noise_mm": 0.4, "lead_in_s": 1}  # settings of simulate, not the defaults


class Planning(ScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.project = elastocal.Project(TALOS)
        cls.design = elastocal.design(cls.project, chains=["head_trunk"], count=6, seed=3)
        cls.plan = elastocal.plan(cls.project, cls.design, move_s=3.0)
        cls.short = elastocal.plan(cls.project, {"head_trunk": cls.design.postures["head_trunk"][:2]})
        cls.short.save(cls.folder / "short/motion.csv", per_chain=cls.folder / "short")
        cls.design.save(cls.folder / "python/postures.yaml")
        cls.plan.save(cls.folder / "python/motion.csv", trajectory=cls.folder / "python/ros.yaml",
                      per_chain=cls.folder / "python")

    def program(self, *words):
        subprocess.run([os.environ["ELASTOCAL_PROGRAM"], *map(str, words), "--quiet"], check=True)

    def assert_same_bytes(self, *names):
        for name in names:
            self.assertEqual((self.folder / "python" / name).read_bytes(),
                             (self.folder / "program" / name).read_bytes(), name)

    def test_design_has_the_bytes_of_the_program(self):
        there = self.folder / "program/postures.yaml"
        self.program("design", TALOS, "--chains", "head_trunk", "--count", 6, "--seed", 3, "-o", there,
                     "--json", self.folder / "design.json")
        self.assert_same_bytes("postures.yaml", "postures_curves.csv", "postures_curves.svg")
        self.assertEqual(self.design.text, there.read_text())
        summaries = [self.design.summary, json.loads((self.folder / "design.json").read_text())]
        for summary in summaries:
            for chain in summary["chains"]:
                chain.pop("time_s")
        self.assertEqual(*summaries)

    def test_plan_has_the_bytes_of_the_program(self):
        folder = self.folder / "program"
        self.program("plan", TALOS, "--postures", self.folder / "python/postures.yaml", "--move-s", 3, "-o", folder / "motion.csv", "--trajectory",
                     folder / "ros.yaml", "--per-chain", folder, "--json", self.folder / "plan.json")
        self.assert_same_bytes("motion.csv", "ros.yaml", "head_trunk_motion.csv")
        summary, there = self.plan.summary, json.loads((self.folder / "plan.json").read_text())
        summary.pop("planning_s"), there.pop("planning_s")
        self.assertEqual(summary, there)

    def test_simulate_has_the_bytes_of_the_program(self):
        self.folder.joinpath("settings.yaml").write_text("".join(f"{k}: {v}\n" for k, v in QUICK.items()))
        motion = self.folder / "short/head_trunk_motion.csv"
        self.program("simulate", TALOS, "--motion", motion, "--settings", self.folder / "settings.yaml",
                     "--seed", 7, "--robot-seed", 8, "-o", self.folder / "program/sim", "--json",
                     self.folder / "simulate.json")
        summary = elastocal.simulate(self.project, self.folder / "python/sim", motion=motion, settings=QUICK,
                                     seed=7, robot_seed=8)
        names = sorted(file.name for file in (self.folder / "program/sim").iterdir())
        self.assertEqual(names, sorted(file.name for file in (self.folder / "python/sim").iterdir()))
        self.assertIn("head_trunk.tsv", names)
        self.assert_same_bytes(*(f"sim/{name}" for name in names))
        summary.pop("warnings")
        self.assertEqual(summary, json.loads((self.folder / "simulate.json").read_text()))

    def test_what_is_in_memory_is_what_is_in_the_file(self):
        """A design, its dict and its file give one plan; a plan, its dict and its file one recording."""
        by_names = {"head_trunk": [dict(zip(self.project.joints, q)) for q in self.design.postures["head_trunk"]]}
        for postures in (self.folder / "python/postures.yaml", self.design.postures, by_names):
            again = elastocal.plan(self.project, postures, move_s=3.0)
            np.testing.assert_array_equal(again.positions, self.plan.positions)
        as_dict = {"time_s": self.short.time_s, "positions": self.short.positions, "support": self.short.support}
        recordings = []
        for i, motion in enumerate([self.short, as_dict, str(self.folder / "short/motion.csv")]):
            folder = self.folder / f"simulated_{i}"
            elastocal.simulate(self.project, folder, motion=motion, matched=True, nominal=True, settings=QUICK)
            recordings.append({file.name: file.read_bytes() for file in folder.iterdir()})
        self.assertIn("motion.tsv", recordings[0])
        self.assertEqual(recordings[0], recordings[1])
        self.assertEqual(recordings[0], recordings[2])

    def test_arrays(self):
        plan, joints = self.plan, len(self.project.joints)
        self.assertEqual(self.design.postures["head_trunk"].shape, (6, joints))
        self.assertEqual(self.design.support, {"head_trunk": ["left_sole_link", "right_sole_link"]})
        samples = len(plan.time_s)
        self.assertEqual(plan.positions.shape, (samples, joints))
        self.assertEqual(plan.torques.shape, (samples, joints))
        self.assertEqual(plan.zmp.shape, (samples, 2))
        self.assertEqual(len(plan.support), samples)
        self.assertEqual(plan.broken, [])
        robot = self.project.robot
        self.assertTrue((plan.positions > robot.lower - 1e-9).all() and (plan.positions < robot.upper + 1e-9).all())
        speeds = np.abs(np.diff(plan.positions, axis=0) / np.diff(plan.time_s)[:, None])
        self.assertTrue((speeds <= robot.velocity).all())
        self.assertTrue((np.abs(plan.torques) <= robot.effort).all())

    def test_robot(self):
        robot = self.project.robot
        self.assertEqual(robot.joints, self.project.joints)
        zero = robot.poses(np.zeros(len(robot.joints)))
        self.assertEqual(list(zero), robot.links)
        np.testing.assert_array_equal(zero[robot.links[0]], np.eye(4))
        # The elbow moves only what is beyond it, about its axis.
        bent = robot.poses({"arm_left_4_joint": -0.5})
        turn = zero["arm_left_4_link"][:3, :3].T @ bent["arm_left_4_link"][:3, :3]
        self.assertAlmostEqual(np.trace(turn), 1.0 + 2.0 * np.cos(0.5), 12)
        np.testing.assert_array_equal(zero["arm_left_3_link"], bent["arm_left_3_link"])
        with self.assertRaisesRegex(elastocal.InputError, "did you mean.*arm_left_4_joint"):
            robot.poses({"arm_left_4_jont": 0.1})

    def test_progress_and_its_exceptions(self):
        seen = []
        elastocal.design(self.project, chains=["head_trunk"], count=4, progress=lambda *at: seen.append(at))
        self.assertEqual(seen, [(0, 1), (1, 1)])

        def stop(done, total):
            raise ZeroDivisionError("enough")

        with self.assertRaisesRegex(ZeroDivisionError, "enough"):
            elastocal.plan(self.project, self.design, progress=stop)

    def test_errors(self):
        with self.assertRaisesRegex(elastocal.InputError, "algorithm: 'best'.*'nocp'"):
            elastocal.design(self.project, algorithm="best")
        with self.assertRaisesRegex(elastocal.InputError, "no chain 'head'"):
            elastocal.design(self.project, chains=["head"])
        with self.assertRaisesRegex(elastocal.InputError, "count: 0; a whole number from 1"):
            elastocal.design(self.project, count=0)
        with self.assertRaisesRegex(elastocal.InputError, "move_s: -1; a number from 0.1"):
            elastocal.plan(self.project, self.design, move_s=-1)
        with self.assertRaisesRegex(elastocal.InputError, "one of them was expected"):
            elastocal.plan(self.project)
        with self.assertRaisesRegex(elastocal.InputError, "postures of head_trunk: 3 positions"):
            elastocal.plan(self.project, {"head_trunk": np.zeros((2, 3))})
        with self.assertRaisesRegex(elastocal.InputError, "arm_left_2_joint.*within the joint's limits"):
            elastocal.plan(self.project, {"head_trunk": [{"arm_left_2_joint": 9.0}]})
        with self.assertRaisesRegex(elastocal.InputError, "did you mean 'marker_noise_mm'"):
            elastocal.simulate(self.project, self.folder / "no", settings={"marker_noise": 1})
        with self.assertRaisesRegex(elastocal.InputError, "motion: positions of"):
            elastocal.simulate(self.project, self.folder / "no", motion={"time_s": [0, 1], "positions": [[1]]})
        with self.assertRaisesRegex(elastocal.InfeasibleError, "no motion: chain 'head_trunk' has no posture"):
            elastocal.plan(self.project, self.design, torque_share=0.02)
        self.assertFalse((self.folder / "no").exists())
        self.assertIn("marker_noise_mm", elastocal.simulation_settings())


if __name__ == "__main__":
    unittest.main()
