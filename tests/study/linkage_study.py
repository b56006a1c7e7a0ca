#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Do the intervals of rods hold, and what do rods in error cost?

  linkage_study.py --program build/release/bin/elastocal --seeds 10 --work /tmp/linkages

For each seed the invented pair of legs (tests/robots/linked_biped_project.yaml), with knees by actuators and
ankles by two rods, is simulated twice. With --matched, the truth has the form of the model, and the program counts how
often the 95 % intervals of estimated parameters hold. On MuJoCo's robot, errors on held-out motions are compared: not
calibrated, calibrated with exact rods, and with the rods. PyYAML is needed.
"""

import argparse
import json
import pathlib
import subprocess

import yaml

ROBOT = pathlib.Path(__file__).resolve().parent.parent / "robots" / "linked_biped_project.yaml"


def run(program, *words):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 4):
        raise SystemExit(f"{' '.join(map(str, words))}: {done.returncode}\n{done.stderr}")


def project_with(exact, work):
    """The project, with exact rods if asked for."""
    document = yaml.safe_load(ROBOT.read_text())
    document["robot"]["urdf"] = str(ROBOT.parent / document["robot"]["urdf"])
    # The simulated lags are 2 to 4 s. A lag by one period of a motion would look alike.
    document["measurement"] = {"longest_lag_s": 4.5}
    for linkage in document["linkages"]:
        for rod in linkage["rods"]:
            if exact:
                rod["uncertain"] = {}
    path = work / ("exact.yaml" if exact else "project.yaml")
    path.write_text(yaml.safe_dump(document))
    return path


def motors(project):
    linkages = yaml.safe_load(project.read_text())["linkages"]
    return {rod["motor"] for linkage in linkages for rod in linkage["rods"]}


def intervals(out, truth, of_motors, counts):
    """Adds the number of intervals of estimated parameters that hold the truth."""
    calibration = yaml.safe_load((out / "calibration.yaml").read_text())
    factor = calibration["interval_95_in_sd"]
    for parameter in calibration["parameters"]:
        name = parameter["name"]
        owner = name.split(".")[0]
        if parameter["status"] != "estimated" or owner in ("waist", "marker"):
            continue
        kind = "rods" if owner in of_motors else "tree"
        true = truth.get(name, {"value": 0.0})["value"]
        held = abs(parameter["value"] - true) <= factor * parameter["sd"]
        counts[kind][0] += held
        counts[kind][1] += 1


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--seeds", type=int, default=10)
    arguments = parser.parse_args()
    work = arguments.work
    work.mkdir(parents=True, exist_ok=True)
    program = arguments.program.resolve()
    project, exact = project_with(False, work), project_with(True, work)
    counts = {"rods": [0, 0], "tree": [0, 0]}
    errors = {"uncalibrated": [], "exact rods": [], "rods": []}
    for seed in range(1, arguments.seeds + 1):
        matched, out = work / f"matched_{seed}", work / f"out_{seed}"
        run(program, "simulate", project, "--matched", "--seed", seed, "-o", matched)
        run(program, "calibrate", project, "--recording", matched, "-o", out)
        truth = yaml.safe_load((matched / "truth.yaml").read_text())["parameters"]
        intervals(out, truth, motors(project), counts)
        physical = work / f"mujoco_{seed}"
        run(program, "simulate", project, "--random-postures", 12, "--seed", seed, "-o", physical)
        for name, with_rods in (("rods", project), ("exact rods", exact)):
            folder = work / f"{name.replace(' ', '_')}_{seed}"
            run(program, "calibrate", with_rods, "--recording", physical, "-o", folder)
            held_out = json.loads((folder / "summary.json").read_text())["held_out_rmse_3d_mm"]
            errors[name].append(held_out["full"])
            if name == "rods":
                errors["uncalibrated"].append(held_out["uncalibrated"])
        print(seed, {kind: f"{held}/{all_of}" for kind, (held, all_of) in counts.items()},
              {name: round(values[-1], 3) for name, values in errors.items()}, flush=True)
    for kind, (held, all_of) in counts.items():
        print(f"95 % intervals of {kind}: {held} of {all_of} hold ({100 * held / max(1, all_of):.1f} %)")
    for name, values in errors.items():
        print(f"held-out, {name}: {sum(values) / len(values):.3f} mm ({min(values):.3f} to {max(values):.3f})")


if __name__ == "__main__":
    main()
