#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Posture tables of the arm of foreign_arm.py, sound and with the mistakes of a laboratory, go through `calibrate`, `check`,
`validate` and `compensate`; what the program says is set against the truth. Prints the tables of docs/robustness.md and
docs/accuracy.md (Markdown). Needs NumPy.

  /usr/bin/python3 tests/study/foreign_tables.py --program build/release/bin/elastocal --work DIR [--only PART ...]

Parts: faults, tracker (mistakes), sound (clean tables of a tracker), days (two of them), few, wall.
"""

import argparse
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from foreign_arm import (  # noqa: E402, pylint: disable=wrong-import-position
    JOINTS, NAMES, UPRIGHT, Arm, Study, error_of, first_words, measured, poses_of, postures, tracker_project, turned, write,
    write_poses)


def faults(study):
    arm, q = Arm.real(5), postures(50, 1)
    sound = measured(arm, q)
    elbow, pitch = NAMES.index("elbow"), NAMES.index("wrist_pitch")
    cases = {"sound": (q, sound)}

    def joints(name, change):
        wrong = q.copy()
        change(wrong)
        cases[name] = (wrong, sound)

    def labels(name, pairs, rows=slice(None)):
        points = sound.copy()
        for a, b in pairs:
            points[rows, a], points[rows, b] = sound[rows, b], sound[rows, a]
        cases[name] = (q, points)

    for k in (0, 3, 6):
        joints(f"sign of {NAMES[k]}", lambda w, k=k: w.__setitem__((slice(None), k), -q[:, k]))
    joints("elbow and wrist_pitch exchanged", lambda w: w.__setitem__((slice(None), [elbow, pitch]), q[:, [pitch, elbow]]))
    joints("elbow frozen in 10 postures", lambda w: w.__setitem__((slice(20, 30), elbow), q[20, elbow]))
    joints("elbow's column 0", lambda w: w.__setitem__((slice(None), elbow), 0.0))
    joints("elbow times 1.03", lambda w: w.__setitem__((slice(None), elbow), 1.03 * q[:, elbow]))
    labels("HAND_1 and FORE_1 exchanged", [(0, 3)])
    labels("HAND and FORE exchanged", [(0, 3), (1, 4), (2, 5)])
    labels("HAND_1 and HAND_2 exchanged in 10 postures", [(0, 1)], slice(20, 30))
    turn = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], float)  # z of the room is y of the cameras
    cases["rows shifted by one"] = (q, np.roll(sound, 1, axis=0))
    cases["y up, z stated"] = (q, sound @ turn.T)
    cases["upside down, z stated"] = (q, sound @ np.diag([1.0, -1.0, -1.0]))
    still = q.copy()
    still[:, 0] = 0.4
    cases["shoulder_pan stood still"] = (still, measured(arm, still))
    print("| table | exit | true error of the URDF, mm | said |\n|---|---|---|---|")
    for name, (positions, points) in cases.items():
        folder = name.replace(" ", "_").replace(",", "")
        done = study.calibrate(folder, positions, points)
        model = study.urdf_of(folder)
        error = f"{error_of(model, arm, q, postures(100, 77)):.2f}" if model else ""
        said = first_words(done)
        if "stood still" in name:
            said = "shoulder_pan stood still in all postures ..."
        print(f"| {name} | {done.returncode} | {error} | {said} |", flush=True)
    few_rows = postures(10, 9)
    at = measured(arm, few_rows, seed=3)
    print("\n| `check` of ten postures | exit | said |\n|---|---|---|")
    slipped = Arm.real(5)
    slipped.offset[elbow] += np.radians(30)
    for name, positions, points in (
            ("sound", few_rows, at), ("sign of elbow", few_rows * np.where(np.arange(7) == elbow, -1, 1), at),
            ("rows shifted by one", few_rows, np.roll(at, 1, axis=0)), ("elbow slipped by 30 degrees", few_rows, measured(slipped, few_rows))):
        table = write(study.work / "check.csv", positions, points)
        done = study.run("check", study.work / "z.yaml", "--calibration", study.work / "sound", "--recording", table)
        print(f"| {name} | {done.returncode} | {first_words(done)} |", flush=True)


def left_out(study, name):
    """Errors (mm) in held-out postures, of the model with compensation and of the URDF alone."""
    contact = study.figures(name)["contact"]
    of = lambda figures: next((i["position_mm"] for i in figures.get("instruments", []) if i["name"] == "lt"), float("nan"))
    return of(contact["kfold"]), of(contact.get("urdf_alone", {}))


def sound(study):
    """Clean tables of 24 arms: none is to be accused."""
    project_file, accused, left = tracker_project(study), 0, []
    for seed in range(1, 25):
        arm, q, rng = Arm.real(100 + seed), postures(40, seed), np.random.default_rng(seed)
        table = write_poses(study.work / f"sound_{seed}.csv", q, poses_of(arm, q, rng))
        done = study.run("calibrate", project_file, "--recording", table, "-o", study.work / f"sound_{seed}")
        accused += done.returncode != 0
        left.append(left_out(study, f"sound_{seed}")[0])
    print("| clean tables | refused | left out, mm: median | largest |\n|---|---|---|---|")
    print(f"| {len(left)} | {accused} | {np.median(left):.3f} | {max(left):.3f} |", flush=True)


def days(study):
    """A table of 25 postures, and one of 15 on another day, with the tracker elsewhere."""
    project_file = tracker_project(study)
    moves = [((0, 0, 0), (0, 0, 0)), ((3e-3, 0, 0), (0, 0, 0)), ((0.02, 0.01, 5e-3), (0.01, 0.02, 0.01)),
             ((0.5, -0.8, 0.1), (0, 0, 1.2)), ((2, 1, 0), (0.1, 0.2, 3.0))]
    print("| tracker moved by m | and rad | exit | left out, mm |\n|---|---|---|---|")
    for k, (shift, turn) in enumerate(moves):
        arm, rng = Arm.real(200 + k), np.random.default_rng(k)
        other = (turned(np.array(turn, float)) @ UPRIGHT[0], UPRIGHT[1] + np.array(shift))
        tables = []
        for day, (count, base) in enumerate(((25, UPRIGHT), (15, other))):
            q = postures(count, k + 50 * day)
            tables.append(write_poses(study.work / f"days_{k}_{day}.csv", q, poses_of(arm, q, rng, base)))
        done = study.run("calibrate", project_file, "--recording", *tables, "-o", study.work / f"days_{k}")
        print(f"| {shift} | {turn} | {done.returncode} | {left_out(study, f'days_{k}')[0]:.3f} |", flush=True)


def tracker(study):
    """A laser tracker sees the pose of a body on the hand; no markers."""
    arm, q = Arm.real(5), postures(50, 1)
    poses, project_file = poses_of(arm, q, np.random.default_rng(3)), tracker_project(study)
    cases = {"sound": (q, poses)}

    def joints(name, change):
        wrong = q.copy()
        change(wrong)
        cases[name] = (wrong, poses)

    for k in range(1, 7):
        joints(f"sign of {NAMES[k]}", lambda w, k=k: w.__setitem__((slice(None), k), -q[:, k]))
    for a, b in ((1, 3), (4, 5), (3, 5)):
        joints(f"{NAMES[a]} and {NAMES[b]} exchanged", lambda w, a=a, b=b: w.__setitem__((slice(None), [a, b]), q[:, [b, a]]))
    cases["rows shifted by one"] = (q, np.roll(poses, 1, axis=0))
    cases["w of the quaternion first"] = (q, poses[:, [0, 1, 2, 6, 3, 4, 5]])
    cases["y with the wrong sign"] = (q, poses * np.array([1, -1, 1, 1, 1, 1, 1]))
    joints("elbow frozen in half the rows", lambda w: w.__setitem__((slice(25, 50), 3), q[25, 3]))
    joints("elbow times 1.03", lambda w: w.__setitem__((slice(None), 3), 1.03 * q[:, 3]))
    joints("elbow off by 2 degrees from the middle on", lambda w: w.__setitem__((slice(25, 50), 3), q[25:, 3] + 0.035))
    joints("sign of elbow from the middle on", lambda w: w.__setitem__((slice(25, 50), 3), -q[25:, 3]))
    joints("shoulder and elbow exchanged from the middle on", lambda w: w.__setitem__((slice(25, 50), [1, 3]), q[25:, [3, 1]]))
    joints("rows shifted by one from the middle on", lambda w: w.__setitem__(slice(26, 50), q[25:49]))
    cases["positions times 1.02"] = (q, poses * np.array([1.02] * 3 + [1] * 4))
    print("| table of poses | exit | true error of the URDF, mm | said |\n|---|---|---|---|")
    for name, (positions, seen) in cases.items():
        folder = "tracker_" + name.replace(" ", "_")
        table = write_poses(study.work / f"{folder}.csv", positions, seen)
        done = study.run("calibrate", project_file, "--recording", table, "-o", study.work / folder)
        model = study.urdf_of(folder)
        error = f"{error_of(model, arm, q, postures(100, 77)):.2f}" if model else ""
        remark = next((line for line in done.stdout.splitlines() if "the noise of" in line), first_words(done))
        print(f"| {name} | {done.returncode} | {error} | {remark[:150]} |", flush=True)


def few(study):
    print("| postures | true error of the URDF, mm | said, mm |\n|---|---|---|")
    for count in (5, 6, 8, 10, 12):
        true, said = [], []
        for seed in range(201, 205):
            arm, q = Arm.real(seed), postures(count, seed + 700)
            name = f"few_{count}_{seed}"
            study.calibrate(name, q, measured(arm, q, seed=seed))
            model = study.urdf_of(name)
            if model is None:
                continue
            true.append(error_of(model, arm, postures(50, seed + 1), postures(100, seed + 900)))
            said.append(study.figures(name)["deployed"]["urdf"]["rmse_3d_mm"])
        text = lambda numbers: ", ".join(f"{x:.1f}" for x in numbers)
        print(f"| {count} | {text(true)} | {text(said)} |", flush=True)


def wall(study):
    """The base hangs on a wall: its x points down in the room."""
    arm, q = Arm.real(5), postures(50, 1)
    arm.gravity = np.array([9.81, 0, 0])
    base = (np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]], float), np.array([0.5, 1.0, 1.2]))
    study.calibrate("wall", q, measured(arm, q, base))
    model = study.urdf_of("wall")
    sys.path.insert(0, str(pathlib.Path(study.program).resolve().parent.parent / "python"))
    import elastocal
    robot = elastocal.Runtime(study.work / "wall")

    def frames(row):
        links = robot.forward(row)["links"]
        return [(np.array(links[joint[1]])[:3, :3], np.array(links[joint[1]])[:3, 3]) for joint in JOINTS]

    judged = postures(100, 77)
    print("| an arm on a wall | error, mm |\n|---|---|")
    print(f"| calibrated URDF | {error_of(model, arm, q, judged):.3f} |")
    print(f"| model at run time | {error_of(frames, arm, q, judged):.3f} |", flush=True)


PARTS = {"faults": faults, "tracker": tracker, "sound": sound, "days": days, "few": few, "wall": wall}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--only", nargs="+", choices=list(PARTS), default=list(PARTS))
    options = parser.parse_args()
    study = Study(options.program, options.work)
    for name in options.only:
        PARTS[name](study)
        print()


if __name__ == "__main__":
    main()
