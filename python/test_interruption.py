# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C ends long calls soon, on one thread and on several, and leaves no files behind."""
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import elastocal
from test_contact import measured_project

SOURCE = pathlib.Path(__file__).resolve().parent.parent
TALOS = SOURCE / "models/talos/project.yaml"
LATEST_S = 2.0  # for calls of 5 s and more; the aim is one second on a machine without other work
CHILD = """
import sys, elastocal
project, folder = elastocal.Project(sys.argv[1]), sys.argv[2]
print("ready", flush=True)
{}
print("done", flush=True)
"""


class Interruption(unittest.TestCase):
    def interrupt(self, call, project=TALOS, folder="", after_s=0.7):
        """Runs a call that takes at least several seconds in a child, and ends it."""
        child = subprocess.Popen([sys.executable, "-c", CHILD.format(call), project, folder], bufsize=0,
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.assertEqual(child.stdout.readline(), b"ready\n")
        time.sleep(after_s)
        sent = time.monotonic()
        child.send_signal(signal.SIGINT)
        out, errors = child.communicate(timeout=60)
        self.assertLess(time.monotonic() - sent, LATEST_S, call)
        self.assertEqual(out, b"", "the call was over before")
        self.assertIn(b"KeyboardInterrupt", errors)

    def test_design(self):
        self.interrupt("elastocal.design(project, elastic=True)")

    def test_plan(self):
        self.interrupt("elastocal.plan(project, kind='random', threads=2)")

    def test_simulate(self):
        with tempfile.TemporaryDirectory() as folder:
            simulated = pathlib.Path(folder) / "simulated"
            for options in ("", ", matched=True"):
                self.interrupt(f"elastocal.simulate(project, folder{options})", TALOS, str(simulated), 2.0)
                self.assertFalse(simulated.exists())

    def test_calibrate_validate_and_check(self):
        """On 80 000 postures of an arm."""
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            project = make_recordings(folder)
            elastocal.calibrate(project, folder / "small.csv", folds=0).save(folder / "out")
            for call in ("calibrate(project, folder + '/large.csv', folds=20, threads=2)",
                         "validate(project, folder + '/out', folder + '/large.csv')",
                         "check(project, folder + '/out', folder + '/large.csv')"):
                self.interrupt("elastocal." + call, project.file, name)

    def test_calibrate_and_validate_with_instruments(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            project = measured_project(folder, {"small.csv": 20, "large.csv": 400})
            elastocal.calibrate(project, folder / "small.csv", folds=0).save(folder / "out")
            for call in ("calibrate(project, folder + '/large.csv', folds=100, threads=2)",
                         "validate(project, folder + '/out', folder + '/large.csv', refit='table')"):
                self.interrupt("elastocal." + call, project.file, name)

    def test_other_threads_run_meanwhile(self):
        project, ticks, over = elastocal.Project(TALOS), [], threading.Event()

        def tick():
            while not over.wait(0.01):
                ticks.append(time.monotonic())

        thread = threading.Thread(target=tick)
        thread.start()
        elastocal.design(project, chains=["head_trunk"], count=8)
        over.set()
        thread.join()
        self.assertGreater(len(ticks), 5)


def make_recordings(folder):
    """A project of one arm with one marker, and tables of it: small.csv, and large.csv with the same many times."""
    file = folder / "project.yaml"
    file.write_text(f"robot: {{urdf: {SOURCE}/models/talos/talos.urdf}}\n"
                    "chains:\n  - {name: arm, tip: gripper_left_base_link}\n"
                    "markers:\n  single:\n    - {name: HAND, link: arm_left_7_link, position_mm: [60, 10, -70]}\n")
    project, random = elastocal.Project(file), np.random.default_rng(1)
    robot = project.robot
    moving = [joint.startswith(("torso", "arm_left")) for joint in robot.joints]
    q = np.where(moving, random.uniform(robot.lower, robot.upper, (200, len(moving))), project.rest)
    seen = np.array([(robot.poses(one)["arm_left_7_link"] @ [0.06, 0.01, -0.07, 1.0])[:3] for one in q])
    for name, times in (("small.csv", 1), ("large.csv", 400)):
        noise = random.normal(0.0, 2e-4, (200 * times, 3))
        elastocal.write_table(project, folder / name, np.tile(q, (times, 1)),
                              (np.tile(seen, (times, 1)) + noise)[:, None, :])
    return project


if __name__ == "__main__":
    unittest.main()
