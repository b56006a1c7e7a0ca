#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Whether ten folds of a measured table of markers leave more than noise.

  smooth  For each fold, a smooth function of the joints' positions is fitted to the residuals of the training postures and
          predicts those of the others: Gaussian processes over all joints or one, of many widths and sizes. Prints the
          held-out error without it, with the likeliest one in each fold, and with those that do best on the held-out ones.
  noise   The calibrated robot takes the recorded postures. Its markers get noise of the sizes that the calibration found,
          and each such table is calibrated like the measured one. Prints the held-out errors of the measured table and of
          these tables, which have no other errors than noise.

  PYTHONPATH=build/release/python /usr/bin/python3 tests/study/what_is_left.py PART PROJECT TABLE --work DIR
      --columns x1 y1 z1 [--tables 40] [--first 1] [--fold-seeds 1 2 11]

--columns: those of the markers (in m), in the project's order of markers. --first: seed of the first table of noise, or of the
deal of the folds. Folds are the program's own in the part noise (--fold-seeds).
"""

import argparse
import csv
import pathlib

import elastocal
import numpy as np


def positions(project, rows):
    """Positions of the joints, (rows, joints). Joints without a column are at rest."""
    rest = dict(zip(project.joints, project.rest))
    return np.array([[float(row.get(joint, rest[joint])) for joint in project.joints] for row in rows])


def markers_of(found, project, folder, q):
    """Markers of the calibrated robot in the frame of its root link, (rows, markers, 3)."""
    value = dict(zip(found.parameters, found.values))
    places = {}
    for line in (folder / "calibration.yaml").read_text().splitlines():
        if line.strip().startswith("- {name:") and "link:" in line and "xyz_m:" in line:
            name, link = line.split("name: ")[1].split(",")[0], line.split("link: ")[1].split(",")[0]
            nominal = [float(x) for x in line.split("xyz_m: [")[1].split("]")[0].split(",")]
            places[name] = (link, np.array(nominal) + [value.get(f"marker.{name}.{axis}", 0.0) for axis in "xyz"])
    runtime, points = elastocal.Runtime(folder), []  # one model for all rows, since it follows the way of each joint
    for row in q:
        poses = runtime.forward(dict(zip(project.joints, row)))["links"]
        points.append([(poses[link] @ [*place, 1.0])[:3] for link, place in (places[name] for name in project.markers)])
    return np.array(points)


def write(file, rows, columns, points):
    """Writes the measured table with other positions of the markers."""
    with open(file, "w", newline="") as out:
        table = csv.DictWriter(out, rows[0].keys())
        table.writeheader()
        table.writerows({**row, **dict(zip(columns, map(repr, map(float, place.ravel()))))} for row, place in zip(rows, points))


def held_out(project, table, seed):
    found = elastocal.calibrate(project, [table], folds=10, seed=seed)
    return found, found.summary["kfold"]["rmse_3d_mm"]["full"]


def registered(points, seen):
    """The rotation and displacement that put the first onto the second."""
    a, b = points.reshape(-1, 3), seen.reshape(-1, 3)
    u, _, v = np.linalg.svd((a - a.mean(0)).T @ (b - b.mean(0)))
    turn = v.T @ np.diag([1, 1, np.linalg.det(v.T @ u.T)]) @ u.T
    return turn, b.mean(0) - turn @ a.mean(0)


def rms(errors):
    return 1e3 * np.sqrt(np.mean(np.sum(np.square(errors).reshape(-1, 3), axis=1)))


def smooth(project, rows, options):
    q = positions(project, rows)
    seen = np.array([[float(row[c]) for c in options.columns] for row in rows])
    moved = [k for k in range(q.shape[1]) if np.ptp(q[:, k]) > 0.02]
    scaled = q[:, moved] / q[:, moved].std(0)
    drivers = {"all joints": list(range(len(moved))), **{project.joints[k]: [i] for i, k in enumerate(moved)}}
    tried = [(name, width, size) for name in drivers for width in (0.25, 0.5, 1, 2, 4) for size in (0.1, 0.3, 1, 3)]
    fold = np.empty(len(rows), int)
    fold[np.random.default_rng(options.first).permutation(len(rows))] = np.arange(len(rows)) % 10
    without, left, evidence = np.zeros(seen.shape), np.zeros((len(tried), *seen.shape)), np.zeros((10, len(tried)))
    for n in range(10):
        known = fold != n
        write(options.work / "fold.csv", [row for row, k in zip(rows, known) if k], options.columns, seen[known])
        found = elastocal.calibrate(project, [options.work / "fold.csv"], folds=0)
        found.save(options.work / "fold")
        points = markers_of(found, project, options.work / "fold", q)
        turn, place = registered(points[known], seen[known])
        error = seen - (points @ turn.T + place).reshape(seen.shape)
        without[~known] = error[~known]
        variance = np.mean(error[known] ** 2)
        for i, (name, width, size) in enumerate(tried):
            x = scaled[:, drivers[name]] / width
            like = size * np.exp(-0.5 * np.sum((x[:, None] - x[None]) ** 2, axis=-1))
            whole = like[np.ix_(known, known)] + np.eye(known.sum())
            weights = np.linalg.solve(whole, error[known])
            left[i][~known] = error[~known] - like[np.ix_(~known, known)] @ weights
            share = np.sum(error[known] * weights) / variance / seen.shape[1]
            evidence[n, i] = -0.5 * seen.shape[1] * (np.linalg.slogdet(whole)[1] + known.sum() * np.log(share))
    likeliest = np.array([left[np.argmax(evidence[n])][m] for m, n in enumerate(fold)])
    print(f"ten folds without {rms(without):.3f} mm, with the likeliest of {len(tried)} smooth functions {rms(likeliest):.3f} mm")
    best = sorted((rms(errors), *what) for errors, what in zip(left, tried))
    for name in drivers:
        error, _, width, size = next(b for b in best if b[1] == name)
        print(f"  of {name}, width and size picked by what was left out ({width:g} sd, {size:g} of the noise): {error:.3f} mm")


def noise(project, rows, options):
    measured = [held_out(project, options.table, seed) for seed in options.fold_seeds]
    found = measured[0][0]
    found.save(options.work / "measured")
    q = positions(project, rows)
    points = markers_of(found, project, options.work / "measured", q)
    sizes = found.summary["noise"][0]
    print(f"measured: fit {found.summary['rmse_3d_mm']['full']:.3f} mm, ten folds "
          + ", ".join(f"{error:.3f}" for _, error in measured)
          + f" mm; noise {sizes['marker_sd_mm']:.3f} mm of a coordinate, {sizes['body_position_sd_mm']:.3f} mm of a body", flush=True)

    # With one marker, the noise of the body has the size of that marker's noise and is a part of
    # it.
    body = sizes["body_position_sd_mm"] if points.shape[1] > 1 else 0.0
    fits, errors = [], []
    for seed in range(options.first, options.first + options.tables):
        rng = np.random.default_rng(seed)
        moved = points + 1e-3 * sizes["marker_sd_mm"] * rng.standard_normal(points.shape)
        moved += 1e-3 * body * rng.standard_normal((len(points), 1, 3))
        table = options.work / "noise.csv"
        write(table, rows, options.columns, moved)
        again, error = held_out(project, table, options.fold_seeds[0])
        fits.append(again.summary["rmse_3d_mm"]["full"])
        errors.append(error)
        print(f"table {seed}: fit {fits[-1]:.3f} mm, ten folds {error:.3f} mm", flush=True)
    mean = np.mean([error for _, error in measured])
    print(f"{len(errors)} tables of noise: fit {np.mean(fits):.3f} mm, ten folds {np.mean(errors):.3f} +- {np.std(errors, ddof=1):.3f} mm, "
          f"{sum(e > mean for e in errors)} of them above the measured {mean:.3f} mm")


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("part", choices=("smooth", "noise"))
    options.add_argument("project", type=pathlib.Path)
    options.add_argument("table", type=pathlib.Path)
    options.add_argument("--work", type=pathlib.Path, required=True)
    options.add_argument("--columns", nargs="+", required=True)
    options.add_argument("--tables", type=int, default=40)
    options.add_argument("--first", type=int, default=1)
    options.add_argument("--fold-seeds", type=int, nargs="+", default=[1, 2, 11])
    options = options.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    project = elastocal.Project(options.project)

    rows = list(csv.DictReader(options.table.open()))
    {"smooth": smooth, "noise": noise}[options.part](project, rows, options)


if __name__ == "__main__":
    main()
