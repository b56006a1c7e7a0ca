#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What ten postures of another day add to a calibration of a hundred, for the arm of foreign_arm.py, seen by cameras.

  /usr/bin/python3 tests/study/updated_arm.py --program build/release/bin/elastocal --work DIR [--arms 10] [--days 1]
      [--drift-deg 0]

The arm is calibrated by 100 postures. After some days, of which `--prior` is told, its zeros have drifted by as much (a
standard deviation), and it takes ten postures: with the markers where they were, and with all fixed anew (2 mm). Prints the
error of each calibration on 60 noise-free postures of that day, waist and markers fitted (mm, rms): the first one, updated,
updated with the markers anew, all 110 together, the ten alone. Everything follows from the seeds. Needs NumPy.
"""

import argparse
import json
import pathlib

import numpy as np

from foreign_arm import Arm, PLACES, Study, measured, postures, write


def errors(study, seed, days, drift):
    name = lambda what: f"{what}_{seed}"
    rng, first = np.random.default_rng(seed), Arm.real(seed)
    later, anew = Arm.real(seed), Arm.real(seed)
    later.offset = anew.offset = first.offset + np.radians(drift) * rng.normal(size=7)
    anew.markers = first.markers + 2e-3 * rng.normal(size=PLACES.shape)
    many, ten, others = (postures(count, 10 * seed + k) for k, count in enumerate((100, 10, 60)))
    seen, today = measured(first, many, seed=seed), measured(later, ten, seed=100 + seed)
    prior = ("--prior", study.work / name("first"), "--days", days)
    study.calibrate(name("first"), many, seen)
    study.calibrate(name("updated"), ten, today, "z", *prior)
    study.calibrate(name("anew"), ten, measured(anew, ten, seed=100 + seed), "z", *prior)
    study.calibrate(name("together"), np.vstack([many, ten]), np.vstack([seen, today]))
    study.calibrate(name("ten"), ten, today)
    table = write(study.work / "others.csv", others, measured(later, others, noise=0))
    row = []
    for what in ("first", "updated", "anew", "together", "ten"):
        file = study.work / "others.json"
        file.unlink(missing_ok=True)
        study.run("validate", study.work / "z.yaml", "--calibration", study.work / name(what), "--recording", table,
                  "--json", file)
        row.append(json.loads(file.read_text())["rmse_3d_mm_all"]["calibrated"])
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--arms", type=int, default=10)
    parser.add_argument("--days", type=float, default=1.0)
    parser.add_argument("--drift-deg", type=float, default=0.0)
    arguments = parser.parse_args()
    study, rows = Study(arguments.program, arguments.work), []
    print("arm: first, updated, updated with markers anew, together, ten alone (mm)")
    for seed in range(1, arguments.arms + 1):
        rows.append(errors(study, seed, arguments.days, arguments.drift_deg))
        print(f"{seed}: " + ", ".join(f"{mm:.4f}" for mm in rows[-1]), flush=True)
    rows = np.array(rows)
    print("mean: " + ", ".join(f"{mm:.4f}" for mm in rows.mean(0)))
    print(f"updated against together: {100 * (rows[:, 1].mean() / rows[:, 3].mean() - 1):.1f} % more on average, "
          f"{100 * (np.max(rows[:, 1] / rows[:, 3]) - 1):.0f} % at most")


if __name__ == "__main__":
    main()
