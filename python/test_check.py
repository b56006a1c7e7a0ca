# SPDX-License-Identifier: Apache-2.0
"""check on an arm of which one joint has moved: postures that cannot tell which, and those that it proposes."""
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import numpy as np

import elastocal

SOURCE = pathlib.Path(__file__).resolve().parent.parent
MARKER = [0.06, 0.01, -0.07, 1.0]  # m, in the frame of its link
PROJECT = f"""robot: {{urdf: {SOURCE}/models/talos/talos.urdf}}
chains:
  - {{name: arm, tip: gripper_left_base_link}}
markers:
  single:
    - {{name: HAND, link: arm_left_7_link, position_mm: [60, 10, -70]}}
"""
DESIGN = """design:
  chains:
    - {chain: arm, box_mm: {lower: [150, -100, -100], upper: [650, 550, 600]}, cone_deg: 60}
"""
MOVED, BY = "arm_left_4_joint", 0.005  # rad


class Check(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        (self.folder / "project.yaml").write_text(PROJECT + DESIGN)
        self.project = elastocal.Project(self.folder / "project.yaml")
        self.random = np.random.default_rng(1)
        elastocal.calibrate(self.project, self.record("first.csv", self.draw(60), 0.0), folds=0).save(self.folder / "out")

    def draw(self, count, elbow_to_hand=None):
        """Random postures of torso and arm; those of the joints from the elbow on within so many rad of the middle."""
        robot = self.project.robot
        moving = [name.startswith(("torso", "arm_left")) for name in robot.joints]
        q = np.where(moving, self.random.uniform(robot.lower, robot.upper, (count, len(moving))), self.project.rest)
        if elbow_to_hand is None:
            return q
        far = [bool(re.match("arm_left_[3-7]", name)) for name in robot.joints]
        near_middle = 0.5 * (robot.lower + robot.upper) + self.random.uniform(-elbow_to_hand, elbow_to_hand, q.shape)
        return np.where(far, near_middle, q)

    def record(self, name, postures, error):
        offset = error * np.array([joint == MOVED for joint in self.project.joints])
        seen = np.array([(self.project.robot.poses(q + offset)["arm_left_7_link"] @ MARKER)[:3] for q in postures])
        noise = self.random.normal(0.0, 2e-4, seen.shape)
        elastocal.write_table(self.project, self.folder / name, postures, (seen + noise)[:, None, :])
        return self.folder / name

    def program(self, *words):
        done = subprocess.run([os.environ["ELASTOCAL_PROGRAM"], "check", *map(str, words)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 4, done.stderr)  # something has changed
        return done.stdout

    def test_proposes_the_postures_that_tell_which_joint(self):
        few = self.draw(20, elbow_to_hand=0.2)
        today = self.record("today.csv", few, BY)
        found = elastocal.check(self.project, self.folder / "out", today)
        self.assertEqual(found["status"], "changed")
        self.assertIn(MOVED, found["suspects"])
        self.assertGreater(len(found["suspects"]), 1)
        (proposed,) = found["next_postures"]
        self.assertEqual((proposed["chain"], len(proposed["postures"])), ("arm", 5))
        # The postures are those of `design --after --check`.
        same = elastocal.design_after(self.project, self.folder / "out", check=True, count=5,
                                      joints=found["suspects"]).postures["arm"]
        more = np.array([[q[joint] for joint in self.project.joints] for q in proposed["postures"]])
        np.testing.assert_array_equal(more, same)

        found = elastocal.check(self.project, self.folder / "out",
                                self.record("both.csv", np.vstack([few, more]), BY))
        self.assertEqual([joint["joint"] for joint in found["moved"]], [MOVED])
        self.assertEqual(found["next_postures"], [])

    def test_program_writes_them(self):
        words = ["--calibration", self.folder / "out", "--recording",
                 self.record("today.csv", self.draw(20, elbow_to_hand=0.2), BY), "--json", self.folder / "check.json"]
        file = self.folder / "next.yaml"
        said = self.program(self.project.file, *words, "-o", file)
        self.assertEqual(said.count("\n  arm: torso_1_joint "), 5)
        found = json.loads((self.folder / "check.json").read_text())
        self.assertEqual(found, elastocal.check(self.project, self.folder / "out", self.folder / "today.csv"))
        written = elastocal.plan(self.project, file, balanced=False).summary["sets"][0]
        self.assertEqual(len(written["visits"]) + len(written["left_out"]), 5)
        # Without a section `design`, nothing limits the postures.
        (self.folder / "project.yaml").write_text(PROJECT)
        said = self.program(self.project.file, *words, "-o", file)
        self.assertIn("No postures that tell which: the project has no section 'design'", said)
        self.assertFalse(file.exists())  # a file would belong to another check


if __name__ == "__main__":
    unittest.main()
