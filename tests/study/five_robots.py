#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Five kinds of robots end to end, as docs/howto/five_robots.md describes them: init, the corrections of the drafted
project, design, plan, a virtual laboratory, calibrate. Prints the table of that page.

  five_robots.py --program build/release/bin/elastocal --work /tmp/five [NAME...]

URDFs of others are looked for in ../shared/robots; a robot that is not there is left out.
"""

import argparse
import json
import pathlib
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHARED = ROOT.parent / "shared/robots"


def torque_sensors(text, joints):
    return text + f"\ntorque_sensors: [{', '.join(joints)}]\n"


def linkages_of(project):
    """The section `linkages` of a project file: the numbers of the drawing."""
    return re.search(r"^linkages:\n(?:[ #].*\n|\n)*", (ROOT / project).read_text(), re.MULTILINE).group(0)


ROBOTS = {
    "small_humanoid": {
        "vary": ["--scale", "0.5", "--legs", "5"],
        "correct": lambda text: text,
    },
    "parallel_ankles": {
        "urdf": ROOT / "tests/robots/linked_biped.urdf",
        "correct": lambda text: text + "\n" + linkages_of("tests/robots/linked_biped_project.yaml"),
    },
    "quadruped": {"urdf": SHARED / "solo12/solo12.urdf", "srdf": SHARED / "solo12/solo.srdf", "correct": lambda text: text},
    "fixed_arm": {
        "urdf": SHARED / "panda/panda.urdf", "srdf": SHARED / "panda/panda.srdf",
        "correct": lambda text: torque_sensors(text, [f"panda_joint{k}" for k in range(1, 8)]),
    },
    "mobile_manipulator": {
        "urdf": SHARED / "tiago/tiago_arm.urdf",
        "correct": lambda text: text + "\nrecording: {root: free}\n",
    },
}


def run(program, *words):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"elastocal {' '.join(map(str, words))}: exit code {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


def held_out(folder):
    deployed = json.loads((folder / "summary.json").read_text())["deployed"]
    return [deployed["urdf"]["uncalibrated"], deployed["urdf"]["rmse_3d_mm"], deployed["compensated"]["rmse_3d_mm"]]


def end_to_end(program, name, robot, work):
    folder = work / name
    folder.mkdir(parents=True, exist_ok=True)
    urdf = robot.get("urdf")
    if urdf is None:
        urdf = folder / f"{name}.urdf"
        subprocess.run([sys.executable, ROOT / "tests/robots/vary_humanoid.py", *robot["vary"], urdf], check=True)
    srdf = ["--srdf", robot["srdf"]] if "srdf" in robot else []
    run(program, "init", urdf, *srdf, "-o", folder / "project", "--force")
    project = folder / "project/project.yaml"
    project.write_text(robot["correct"](project.read_text()))
    run(program, "inspect", project)
    postures = folder / "postures.yaml"
    run(program, "design", project, "-o", postures)
    recordings = []
    for kind in ("", "random"):
        motion = folder / f"motion{kind}.csv"
        chosen = ["--kind", kind, "--count", "10"] if kind else ["--postures", postures]
        run(program, "plan", project, *chosen, "-o", motion)
        recordings.append(folder / f"recording{kind}")
        run(program, "simulate", project, "--motion", motion, *(["--kind", kind] if kind else []), "-o", recordings[-1])
    run(program, "calibrate", project, "--recording", *recordings, "-o", folder / "out")
    count = postures.read_text().count("\n      - {")
    return count, held_out(folder / "out")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("names", nargs="*", default=list(ROBOTS))
    options = parser.parse_args()
    print("| robot | postures | nominal, mm | calibrated URDF, mm | with elasticity, mm | s |\n|---|---|---|---|---|---|")
    for name in options.names:
        robot = ROBOTS[name]
        if "urdf" in robot and not robot["urdf"].exists():
            print(f"| {name} | left out: {robot['urdf'].name} is not there | | | | |")
            continue
        begin = time.monotonic()
        postures, errors = end_to_end(options.program, name, robot, options.work)
        cells = " | ".join(f"{error:.2f}" for error in errors)
        print(f"| {name} | {postures} | {cells} | {time.monotonic() - begin:.0f} |", flush=True)


if __name__ == "__main__":
    main()
