#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The whole way from a robot description alone: init, inspect, design, plan, simulate, calibrate,
validate, without an edit. Prints a table (Markdown) for docs/robots.md: how each step ended, and the
error on held-out motions before and after calibration.

  any_robot.py --program build/release/bin/elastocal --work /tmp/robots [ROBOT.urdf[,ROBOT.srdf]...]

Without robots: models/talos, tests/robots, and what is in ../shared/robots.
"""

import argparse
import json
import pathlib
import subprocess
import time

STEPS = {
    "init": ["init", "{urdf}", "{srdf}", "-o", "{d}", "--force"],
    "inspect": ["inspect", "{d}/project.yaml"],
    "design": ["design", "{d}/project.yaml", "-o", "{d}/design/postures.yaml"],
    "plan": ["plan", "{d}/project.yaml", "--postures", "{d}/design/postures.yaml", "-o",
             "{d}/plan/motion.csv"],
    "simulate": ["simulate", "{d}/project.yaml", "-o", "{d}/experiment"],
    "calibrate": ["calibrate", "{d}/project.yaml", "--recording", "{d}/experiment", "-o", "{d}/out"],
    "validate": ["validate", "{d}/project.yaml", "--calibration", "{d}/out", "--recording",
                 "{d}/experiment", "-o", "{d}/validation"],
}


def run_step(program, step, values, limit_s):
    words = [word.format(**values) for word in STEPS[step]]
    words = [word for word in words if word]
    try:
        done = subprocess.run([program, *words], capture_output=True, text=True, timeout=limit_s)
    except subprocess.TimeoutExpired:
        return -1, f"more than {limit_s} s"
    errors = [line for line in done.stderr.splitlines() if "error" in line or "critical" in line]
    return done.returncode, errors[0].split("error: ")[-1] if errors else ""


def held_out(folder):
    """Root mean square error of held-out motions [mm] over all groups, before and after."""
    summary = folder / "out" / "summary.json"
    if not summary.exists():
        return ""
    error = json.loads(summary.read_text()).get("held_out_rmse_3d_mm") or {}
    if "uncalibrated" not in error:
        return ""
    best = min(error[model] for model in ("rigid", "full") if model in error)
    return f"{error['uncalibrated']:.2f} to {best:.2f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--limit-s", type=int, default=1200, help="of one step")
    parser.add_argument("--steps", default=",".join(STEPS), help="the first ones, with commas between them")
    parser.add_argument("robots", nargs="*")
    options = parser.parse_args()
    steps = [step for step in STEPS if step in options.steps.split(",")]
    root = pathlib.Path(__file__).resolve().parents[2]
    robots = options.robots
    if not robots:
        files = [root / "models/talos/talos.urdf", *sorted((root / "tests/robots").glob("*.urdf")),
                 *sorted((root.parent / "shared/robots").glob("*/*.urdf"))]
        for urdf in files:
            srdf = sorted(urdf.parent.glob("*.srdf"))
            robots.append(",".join([str(urdf)] + [str(file) for file in srdf[:1]]))
    print("| robot | " + " | ".join(steps) + " | held-out motions, mm | s |")
    print("|---|" + "---|" * (len(steps) + 2))
    reasons = []
    for robot in robots:
        urdf, _, srdf = robot.partition(",")
        name = pathlib.Path(urdf).stem
        folder = options.work / name
        values = {"urdf": urdf, "srdf": f"--srdf={srdf}" if srdf else "", "d": str(folder)}
        cells, begin = [], time.monotonic()
        for step in steps:
            code, reason = run_step(options.program, step, values, options.limit_s)
            cells.append("ok" if code == 0 else f"exit {code}")
            if code != 0:
                reasons.append(f"- {name}, {step}: {reason}")
        seconds = time.monotonic() - begin
        print(f"| {name} | " + " | ".join(cells) + f" | {held_out(folder)} | {seconds:.0f} |",
              flush=True)
    print("\n" + "\n".join(reasons))


if __name__ == "__main__":
    main()
