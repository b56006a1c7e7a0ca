#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How often the true value of a parameter lies in its 95 % interval, on virtual humanoids.

    coverage.py PROGRAM PROJECT [--robots 50] [--first 1] [--motions] [--displaced] [--work DIR]

Each robot (`simulate`) has springs in all joints and links, friction, wrong masses, wrong torque
sensors and imperfect cameras, which the estimator models in part; its axes are where the URDF has
them, and its zero offsets are not. So the truth of every parameter of a joint is known: offsets from
truth.yaml, all lengths and other angles zero. The recording is calibrated with the default settings.
Prints, for each robot and in all, the share of intervals with the truth in them and the root mean
square of errors in standard deviations; then, by axis, how many intervals of the legs' stiffness hold
that of the simulator (for a known wrench on the waist). `--motions` also calibrates from the sine trials,
whose moments share their model error with their neighbours in time. Everything follows from the seeds. PyYAML is needed.

With `--displaced` every axis is displaced and turned in six dimensions. Several sets of parameters then
describe the same robot. The robot without springs, friction and noise, seen by perfect sensors in other
and more postures, is calibrated too, which must explain its markers within 2 um (files round to 1 um).
Of all sets that do, this gives the one that the prior makes most likely, as in the other estimate. The
parameters that the data tell there (status `estimated`) are compared; the prior decides on the others.
"""

import argparse
import collections
import json
import math
import pathlib
import tempfile

import yaml

from compare_pairs import DESIGN, run

# All trials. Those for validation are as short as possible, except the sines.
WITH_SINES = ["--random-postures", "1", "--repetitions", "1", *DESIGN[2:]]
# A rigid robot with perfect cameras and sensors.
EXACT = ["--trials", "calibration", "--head-postures", "20", "--arm-postures", "50", "--leg-postures", "40",
         *DESIGN[8:]]
for name in ("upper-elasticity-scale", "leg-elasticity-scale", "friction-share", "marker-noise-mm",
             "gaps-per-minute", "outlier-share", "swaps-per-minute", "encoder-bits", "torque-noise-nm",
             "torque-bias-nm", "torque-gain-share", "drift-ppm", "mass-share", "com-mm"):
    EXACT += ["--" + name, "0"]
LIMBS = {"leg": "legs", "arm": "arms"}


def kind_of(name):
    joint, parameter = name.rsplit(".", 1)
    limb = LIMBS.get(joint.split("_")[0], "trunk and head")
    if parameter == "theta":
        return f"offsets, {limb}"
    return f"{'lengths' if parameter in ('a', 'b', 'd', 'r') else 'other angles'}, {limb}"


def stiffness_of_legs(summary, truth):
    """Axis of each stiffness, and 'inside', 'outside' or 'unknown'. Files have N/mm and N/m."""
    found = []
    for leg in summary["legs"]:
        for i, axis in enumerate(("x", "y", "z", "rx", "ry", "rz")):
            true = truth[leg["name"]]["stiffness"][i] * (1e-3 if i < 3 else 1.0)
            least, most = (math.nan if end is None else end for end in leg["interval_95"][i])
            outside = true < least or true > most
            found.append((axis, "outside" if outside else "inside" if leg["known"][i] else "unknown"))
    return found


def calibrate_from_motions(folder):
    """Makes the sine trials trials for the estimate, and leaves out other trials for validation."""
    file = folder / "experiment.yaml"
    experiment = yaml.safe_load(file.read_text())
    trials = [trial for trial in experiment["trials"] if trial["kind"] in ("calibration", "sine")]
    for trial in trials:
        if trial["kind"] == "sine":
            trial.update(kind="calibration", samples="motion")
    file.write_text(yaml.safe_dump({**experiment, "trials": trials}))


def true_parameters(arguments, seed, work, joints):
    """Parameters of the simulated robot by name, rad and m; zero if they are not displaced."""
    if not arguments.displaced:
        offsets = {f"{name}.theta": math.radians(float(joint["offset_deg"])) for name, joint in joints.items()}
        return collections.defaultdict(float, offsets)
    folder = work / f"exact_{seed}"
    run(arguments.program, "simulate", arguments.project, "-o", folder, "--robot-seed", seed,
        "--seed", seed + 100000, *EXACT)
    for name, joint in yaml.safe_load((folder / "truth.yaml").read_text())["joints"].items():
        for key in ("offset_deg", "shift_mm", "turn_deg"):
            assert joint[key] == joints[name][key], (name, key)
    run(arguments.program, "calibrate", arguments.project, "--recording", folder, "--kfold", 0, "-o",
        work / f"exact_{seed}_out", may_fail=True)
    summary = json.loads((work / f"exact_{seed}_out" / "summary.json").read_text())
    assert summary["rmse_3d_mm"]["full"] < 2e-3, summary["rmse_3d_mm"]
    return {parameter["name"]: parameter["value"] for parameter in summary["parameters"]}


def errors(arguments, seed, work, stiffness):
    """Kind, error in sds and interval factor of each geometric parameter; None if refused."""
    folder = work / f"robot_{seed}"
    run(arguments.program, "simulate", arguments.project, "-o", folder, "--threads", 1, "--seed", seed,
        *([] if arguments.displaced else ["--length-mm", 0, "--angle-deg", 0]),
        *(WITH_SINES if arguments.motions else DESIGN))
    if arguments.motions:
        calibrate_from_motions(folder)
    run(arguments.program, "calibrate", arguments.project, "--recording", folder, "--kfold", 0, "-o",
        work / "out", may_fail=True)
    if not (work / "out" / "calibration.yaml").exists():
        return None
    summary = json.loads((work / "out" / "summary.json").read_text())
    calibration = yaml.safe_load((work / "out" / "calibration.yaml").read_text())
    factor = float(calibration["interval_95_in_sd"])
    truth = yaml.safe_load((folder / "truth.yaml").read_text())
    stiffness.update(stiffness_of_legs(summary, truth["legs"]))
    joints = truth["joints"]
    truth = true_parameters(arguments, seed, work, joints)
    found = []
    for parameter in summary["parameters"]:
        joint, _, name = parameter["name"].rpartition(".")
        if joint not in joints or name.startswith("compliance") or not parameter["sd"]:
            continue
        if arguments.displaced and parameter["status"] != "estimated":
            continue
        true = truth[parameter["name"]]
        found.append((kind_of(parameter["name"]), (parameter["value"] - true) / parameter["sd"], factor))
    return found


def line(title, found):
    inside = sum(abs(error) <= factor for _, error, factor in found)
    rms = math.sqrt(sum(error**2 for _, error, _ in found) / len(found))
    return f"{title:24} {inside:5} of {len(found):5} inside, {100 * inside / len(found):5.1f} %, rms {rms:.2f} sds"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("project", type=pathlib.Path)
    parser.add_argument("--robots", type=int, default=50)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--motions", action="store_true")
    parser.add_argument("--displaced", action="store_true")
    parser.add_argument("--work", type=pathlib.Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        work = arguments.work or pathlib.Path(scratch)
        work.mkdir(parents=True, exist_ok=True)
        found, stiffness = [], collections.Counter()
        for seed in range(arguments.first, arguments.first + arguments.robots):
            here = errors(arguments, seed, work, stiffness)
            found += here or []
            print(line(f"robot {seed}", here) if here else f"robot {seed}: REFUSED", flush=True)
    for kind in sorted({kind for kind, _, _ in found}):
        print(line(kind, [entry for entry in found if entry[0] == kind]))
    print(line("all", found))
    for (axis, state), count in sorted(stiffness.items()):
        print(f"stiffness of legs, {axis:2} {state:8} {count:4}")


if __name__ == "__main__":
    main()
