#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A whole calibration from Python: choose postures, plan the motion, record it (here on a virtual robot), calibrate.

  PYTHONPATH=build/release/python python3 examples/experiment.py models/talos/project.yaml FOLDER

Draws figures.png into the folder where matplotlib (python3-matplotlib) is there.
"""
import argparse
import pathlib

import numpy as np

import elastocal


def draw(file, project, design, plan, found):
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 9), layout="constrained")
    (of_design, of_zmp), (of_torque, of_zeros) = figure.subplots(2, 2)

    for chain in design.summary["chains"]:
        if chain["mirror_of"]:
            continue
        of_design.plot(chain["sizes"], chain["indices"], "o-", label=chain["chain"])
    of_design.set(title="Design", xlabel="postures", ylabel="index O1")
    of_design.legend()

    of_zmp.plot(plan.time_s, 1e3 * (plan.zmp - plan.zmp[0]), label=["x", "y"])
    of_zmp.set(title="Zero-moment point of the plan", xlabel="s", ylabel="mm from where it begins")
    of_zmp.legend()

    shares = 100.0 * np.abs(plan.torques) / project.robot.effort
    for joint in shares.max(axis=0).argsort()[-3:]:
        of_torque.plot(plan.time_s, shares[:, joint], label=project.joints[joint])
    of_torque.set(title="Largest torques of the plan", xlabel="s", ylabel="% of the limit")
    of_torque.legend()

    zeros = [i for i, name in enumerate(found.parameters) if name.endswith(".theta") and np.isfinite(found.sd[i])]
    rows = np.arange(len(zeros))
    of_zeros.errorbar(np.rad2deg(found.values[zeros]), rows, xerr=2.0 * np.rad2deg(found.sd[zeros]), fmt="o")
    of_zeros.set_yticks(rows, [found.parameters[i].removesuffix(".theta") for i in zeros])
    of_zeros.set(title="Zeros of the joints, with two standard deviations", xlabel="deg")
    figure.savefig(file)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("project", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--chain", default="arm_left", help="of the section 'design'; the other side comes along")
    parser.add_argument("--postures", type=int, default=16, help="of each side")
    parser.add_argument("--matched", action="store_true", help="no physics: the estimator's own model, 20 times faster")
    args = parser.parse_args()
    project = elastocal.Project(args.project)

    design = elastocal.design(project, chains=[args.chain], count=args.postures)
    design.save(args.folder / "postures.yaml")
    print({chain: q.shape for chain, q in design.postures.items()})

    plan = elastocal.plan(project, design)
    plan.save(args.folder / "motion.csv")
    print(f"{plan.time_s[-1]:.0f} s of motion; left out: {plan.left_out or 'nothing'}")

    recording = args.folder / "recording"
    elastocal.simulate(project, recording, motion=plan, matched=args.matched,
                       progress=lambda done, total: print(f"played {done} of {total} trials"))

    found = elastocal.calibrate(project, recording)
    found.save(args.folder / "out")
    print(f"{found.urdf_rmse_mm:.2f} mm", found.status, *found.objections, sep="; ")
    try:
        draw(args.folder / "figures.png", project, design, plan, found)
    except ModuleNotFoundError as missing:
        print(f"no figures: {missing}")


if __name__ == "__main__":
    main()
