#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`check` on a real TIAGo (../shared/data/tiago_mocap): `training.csv` is calibrated, and rows of `validation.csv`, measured
four days earlier, represent another day: in parts of ten rows and all together, as they are (nothing is known to have
moved) and with each joint turned in turn. Prints the answers.

  tests/study/tiago_check.py PROGRAM FOLDER [--turned-deg 1] [--parts 10] [-- words of check]
"""
import argparse
import collections
import csv
import json
import math
import os
import pathlib
import subprocess

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SHARED = pathlib.Path(os.environ.get("ELASTOCAL_SHARED_DATA", SOURCE.parent / "shared" / "data"))
MARKERS = {"M1": (0, 70, 130), "M2": (0, -90, 145), "M3": (0, -60, 235), "M4": (0, 50, 235)}  # mm on the hand
JOINTS = [f"arm_{k}_joint" for k in range(1, 8)]


def project_text() -> str:
    markers = "\n".join(f"    - {{name: {name}, link: arm_7_link, position_mm: {list(place)}}}"
                        for name, place in MARKERS.items())
    columns = ", ".join(f"M{k}: [x{k}, y{k}, z{k}]" for k in range(1, 5))
    return (f"robot: {{urdf: {SHARED.parent / 'robots/tiago/tiago_arm.urdf'}}}\n"
            f"chains: [{{name: arm, tip: arm_7_link}}]\nmarkers:\n  single:\n{markers}\n"
            f"recording:\n  ignore: [shipped_row, t_start_robot, t_end_robot, marker_std_mm]\n"
            f"  columns: {{markers: {{{columns}}}}}\n")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--turned-deg", type=float, default=1.0)
    parser.add_argument("--parts", type=int, default=10, help="rows of a part")
    parser.add_argument("words", nargs="*", help="more words of check")
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    project = args.folder / "project.yaml"
    project.write_text(project_text())
    out = args.folder / "out"
    subprocess.run([args.program, "calibrate", project, "--recording", SHARED / "tiago_mocap/training.csv", "--kfold", "0",
                    "-o", out], check=True, stdout=subprocess.DEVNULL)
    with (SHARED / "tiago_mocap/validation.csv").open() as file:
        header, *rows = csv.reader(file)

    def check(part: list[list[str]], turned: str | None) -> dict:
        table = args.folder / "rows.csv"
        with table.open("w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(header)
            for row in part:
                row = list(row)
                if turned:
                    at = header.index(turned)
                    row[at] = repr(float(row[at]) + math.radians(args.turned_deg))
                writer.writerow(row)
        words = [args.program, "check", project, "--calibration", out, "--recording", table, "--days", "4", *args.words]
        done = subprocess.run([*words, "--json", "-", "--quiet"], capture_output=True, text=True, check=False)
        return json.loads(done.stdout)

    parts = [rows[first:first + args.parts] for first in range(0, len(rows) - args.parts + 1, args.parts)]
    for name, sets in ((f"{len(parts)} parts of {args.parts} rows", parts), ("all rows", [rows])):
        print(name, flush=True)
        for part in sets:
            said = check(part, None)
            print(f"  as they are: {said['status']}, moved {[joint['joint'] for joint in said['moved']]}, "
                  f"one of {said['suspects']}", flush=True)
        counts: collections.Counter[str] = collections.Counter()
        for part in sets:
            for joint in JOINTS:
                said = check(part, joint)
                moved = [one["joint"] for one in said["moved"]]
                kind = ("named alone" if moved == [joint] else "named with others" if joint in moved else
                        "among suspects" if joint in said["suspects"] else
                        "another named" if moved else "unchanged" if said["status"] == "unchanged" else said["status"])
                counts[kind] += 1
        print(f"  each joint turned by {args.turned_deg} degrees: "
              + ", ".join(f"{kind} {count}" for kind, count in counts.most_common()), flush=True)


if __name__ == "__main__":
    main()
