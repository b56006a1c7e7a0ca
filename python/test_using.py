# SPDX-License-Identifier: Apache-2.0
"""export, compensate and batch of the module against the command line, on an arm of seven joints."""
import json
import os
import pathlib
import subprocess
import unittest

import numpy as np

import elastocal
from scratch_case import ScratchCase

ARM = pathlib.Path(__file__).resolve().parent.parent / "tests/robots/arm6_project.yaml"
SHORT = {"arm_postures": 12, "repetitions": 1, "move_s": 1, "rest_s": 0.8}


class Using(ScratchCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.project = elastocal.Project(ARM)
        elastocal.simulate(cls.project, cls.folder / "recording", trials="calibration", settings=SHORT)
        elastocal.calibrate(cls.project, [cls.folder / "recording"]).save(cls.folder / "out")
        time = np.arange(0, 3, 0.01)
        lower, upper = np.clip(cls.project.robot.lower, -2, 2), np.clip(cls.project.robot.upper, -2, 2)
        positions = (lower + upper) / 2 + 0.05 * (upper - lower) * np.sin(time)[:, None]  # as in files
        cls.motion = {"time_s": time, "positions": np.round(positions, 9)}

    def program(self, *words):
        return subprocess.run([os.environ["ELASTOCAL_PROGRAM"], *map(str, words), "--quiet"], capture_output=True,
                              text=True)

    def test_a_saved_calibration_has_the_record_of_the_program(self):
        words = ["calibrate", str(ARM), "--recording", str(self.folder / "recording"), "-o", str(self.folder / "calibrated")]
        self.assertEqual(self.program(*words).returncode, 0)
        here, there = (json.loads((self.folder / name / "runs.json").read_text())["calibrate"] for name in ("out", "calibrated"))
        for key in ("inputs", "folder", "version", "seed", "accept", "prior", "days"):
            self.assertEqual(here[key], there[key], key)
        self.assertEqual(here["command_line"] + " --quiet", there["command_line"].replace("/calibrated ", "/out "))
        self.assertEqual(*({file.name for file in (self.folder / name).iterdir()} for name in ("out", "calibrated")))
        elastocal.compensate(self.folder / "out", self.motion)  # finds the project itself

    def test_exports_have_the_bytes_of_the_program(self):
        for name in ("urdf", "c99", "pal"):
            here, there = self.folder / f"python.{name}", self.folder / f"program.{name}"
            notes = elastocal.export(self.folder / "out", name, here, project=self.project, min_significance=4)
            self.assertEqual(self.program("export", self.folder / "out", "--format", name, "-o", there,
                                          "--min-significance", 4, "--project", ARM).returncode, 0)
            self.assertEqual(here.read_bytes(), there.read_bytes(), name)
            self.assertTrue(any("is nominal" in note for note in notes), notes)
        with self.assertRaisesRegex(elastocal.InputError, "one of c99, .* was expected; did you mean .urdf_rising"):
            elastocal.export(self.folder / "out", "urdf_risin", self.folder / "none", project=ARM)
        self.assertFalse((self.folder / "none").exists())

    def test_a_corrected_motion_has_the_bytes_of_the_program(self):
        corrected = elastocal.compensate(self.folder / "out", self.motion, project=self.project)
        corrected.save(self.folder / "python.csv")
        planned = self.folder / "plan.csv"
        columns = ["time", *self.project.joints]
        rows = np.column_stack([self.motion["time_s"], self.motion["positions"]])
        planned.write_text("\n".join([",".join(columns), *(",".join(repr(float(x)) for x in row) for row in rows)]))
        found = self.program("compensate", self.folder / "out", "--motion", planned, "-o", self.folder / "program.csv",
                             "--json", self.folder / "program.json", "--project", ARM)
        self.assertEqual(found.returncode, 0, found.stderr)
        self.assertEqual((self.folder / "python.csv").read_bytes(), (self.folder / "program.csv").read_bytes())
        self.assertEqual(corrected.summary, json.loads((self.folder / "program.json").read_text()))
        self.assertEqual(corrected.positions.shape, self.motion["positions"].shape)
        self.assertGreater(np.abs(corrected.positions - self.motion["positions"]).max(), 1e-4)
        rigid = elastocal.compensate(self.folder / "out", self.motion, project=ARM, content="geometry")
        self.assertFalse(np.array_equal(rigid.positions, corrected.positions))

    def test_a_batch_has_the_bytes_of_the_program(self):
        manifest = self.folder / "fleet.yaml"
        options = "{" + ", ".join(f"{key.replace('_', '-')}: {value}" for key, value in SHORT.items()) + ", trials: calibration}"
        manifest.write_text(f"project: {ARM}\nstudies: [{{name: arm, robots: 2, simulate: {options}}}]\n")
        fleet = elastocal.batch(manifest, self.folder / "fleet", workers=1)
        self.assertEqual(self.program("batch", manifest, "-o", self.folder / "again").returncode, 0)
        self.assertEqual(fleet, json.loads((self.folder / "fleet/fleet.json").read_text()))
        self.assertEqual((self.folder / "fleet/arm_2/covariance.csv").read_bytes(),
                         (self.folder / "again/arm_2/covariance.csv").read_bytes())
        manifest.write_text(manifest.read_text().replace("repetitions", "repetitons"))
        with self.assertRaisesRegex(elastocal.InputError, "arm_1.*repetitons"):
            elastocal.batch(manifest, self.folder / "other")
        self.assertFalse((self.folder / "other").exists() and list((self.folder / "other").iterdir()))


if __name__ == "__main__":
    unittest.main()
