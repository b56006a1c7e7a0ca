#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the keys of the JSON files that the program writes with those that docs/formats.md names.

  documented_keys.py --source REPOSITORY --program elastocal --chain DIR WORK

DIR holds what `elastocal demo` left. Files that the demo does not leave are written in WORK by commands that take
fractions of a second. Every key of a file must stand in backticks in one of its sections (SECTIONS), and every key in
the first column of the tables of these sections must be a string of the program's sources.
"""

import argparse
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

# The sections that describe each file. Several commands may write the same keys.
SUMMARY = ["The summary", "Noise", "Frames and places of markers", "Cross-validation", "Keys of a recording folder"]
SECTIONS = {
    "inspect.json": ["Inspection"],
    "init.json": ["Drafted project"],
    "info_markers.json": ["Contents of a recording"],
    "info_joints.json": ["Contents of a recording"],
    "info_table.json": ["Contents of a recording"],
    "simulate.json": ["Simulation"],
    "assess.json": ["Assessed postures"],
    "report.json": ["Report"],
    "compare.json": ["Comparison"],
    "check.json": ["Check"],
    "diagnosis.json": ["Diagnosis", "Plots of causes", "Runs and checksums"],
    "validation.json": ["Validation", "Distances from places", "Runs and checksums"],
    "compensate.json": ["A motion with the calibrated robot"],
    "summary.json": SUMMARY,
    "report_data.json": ["Data of the report"],
    "robot_data.json": ["Report", "Data of the report"],
    "deployment.json": ["A motion with the calibrated robot", "Runs and checksums"],
    "runs.json": ["Runs and checksums"],
    "postures_summary.json": ["Designed postures"],
    "motion_margins.json": ["Planned motion"],
}

# Below these keys are names of the robot or of models, which no document lists. The number is that
# of levels with names.
NAMED = {"dropped_regrouped_into": 2} | dict.fromkeys(
    ["weakest_sd", "stiffness", "by_marker", "posture_rad", "held_out", "counts", "held_out_rmse_3d_mm",
     "waist_error_mm", "predicted", "rmse_3d_mm", "rmse_coordinate_mm", "max_mm", "meshes", "rmse_3d_mm_with_outliers",
     "rmse_3d_mm_without_outliers", "rms_mm", "mean_rmse_3d_mm", "rmse_3d_mm_all"], 1)


def keys_of(value: object, names: int = 0) -> set[str]:
    """All keys of a JSON value except names in its first `names` levels."""
    if isinstance(value, list):
        return set().union(*(keys_of(one, names) for one in value))
    if not isinstance(value, dict):
        return set()
    below = (keys_of(one, names - 1 if names else NAMED.get(key, 0)) for key, one in value.items())
    return (set() if names else set(value)).union(*below)


def sections_of(text: str) -> dict[str, str]:
    """The text below each heading, up to the next one."""
    parts = re.split(r"^#+ (.*)$", text, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2]))


def words(text: str) -> set[str]:
    """The keys in backticks. Of `a.b[].c`, each part is a key."""
    spans = re.findall(r"`([^`\n]+)`", text)
    return set().union(*(set(re.findall(r"\w+", span)) for span in spans))


def first_column(text: str) -> set[str]:
    """The keys in the first column of the tables that begin with the header `key`."""
    keys = set()
    for table in re.findall(r"^\| key[^\n]*\n\|[-|]+\n((?:\|[^\n]*\n)+)", text, re.MULTILINE):
        for row in table.splitlines():
            keys |= words(row.split("|")[1])
    return keys


def write_files(program: str, source: Path, chain: Path, work: Path) -> None:
    """Writes the files of commands that the demo does not run, or whose files it does not keep."""
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    arm, recording = source / "tests/robots/arm6_project.yaml", work / "recording"

    def run(*command: object, expected: tuple[int, ...] = (0,)) -> None:
        done = subprocess.run([program, *map(str, command), "--quiet"], cwd=work, capture_output=True, text=True)
        if done.returncode not in expected:
            raise RuntimeError(f"{' '.join(map(str, command))}: {done.returncode}\n{done.stderr}")

    run("inspect", source / "tests/robots/linked_biped_project.yaml", "--json", "inspect.json")
    run("init", source / "tests/robots/arm6.urdf", "-o", "draft", "--json", "init.json")
    run("simulate", arm, "-o", recording, "--trials", "calibration", "--arm-postures", 12, "--move-s", 1, "--rest-s", 0.6,
        "--lead-in-s", 2, "--json", "simulate.json")
    trial = next(recording.glob("*.tsv"))
    run("info", trial, "--json", "info_markers.json")
    run("info", trial.with_suffix(".csv"), "--json", "info_joints.json")
    (work / "table.csv").write_text("time_h,joint\n0,0.1\n2,0.3\n9,0.2\n")
    run("info", "table.csv", "--json", "info_table.json")
    run("calibrate", arm, "--recording", recording, "-o", "out")
    run("validate", arm, "--calibration", "out", "--recording", recording, "--json", "validation.json", expected=(0, 4))
    run("check", arm, "--calibration", "out", "--recording", recording, "--json", "check.json", expected=(0, 4))
    run("compare", "out", "out", "--json", "compare.json")
    run("diagnose", "out", "--json", "diagnosis.json")
    run("report", "out", "--json", "report.json")
    humanoid = source / "models/talos/project.yaml"
    run("assess", humanoid, "--postures", chain / "postures.yaml", "--chains", "head_trunk", "--json", "assess.json")
    beginning = (chain / "sine.csv").read_text().splitlines(keepends=True)[:500]
    (work / "sine.csv").write_text("".join(beginning))
    run("compensate", chain, "--motion", "sine.csv", "-o", "corrected.csv", "--json", "compensate.json", expected=(0, 4))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("source", "chain"):
        parser.add_argument(f"--{name}", required=True, type=Path)
    parser.add_argument("--program", required=True)
    parser.add_argument("work", type=Path)
    args = parser.parse_args()
    args.source, args.chain, args.work = (path.resolve() for path in (args.source, args.chain, args.work))
    write_files(args.program, args.source, args.chain, args.work)

    sections = sections_of((args.source / "docs/formats.md").read_text())
    strings = set()
    for path in (args.source / "src").rglob("*.cpp"):
        strings |= set(re.findall(r'"(\w+)"', path.read_text()))
    errors, compared, documented = [], 0, {}
    for name, headings in SECTIONS.items():
        if unknown := [one for one in headings if one not in sections]:
            errors.append(f"docs/formats.md has no section {', '.join(unknown)}")
            continue
        text = "\n".join(sections[one] for one in headings)
        documented[name] = first_column(text)
        found = [path for path in (args.work / name, args.work / "out" / name, args.chain / name) if path.exists()]
        for path in found:
            written = keys_of(json.loads(path.read_text()), 1 if name == "runs.json" else 0)
            missing = sorted(written - words(text))
            compared += len(written)
            strings |= written  # for keys that are composed of parts
            errors += [f"{path}: {', '.join(headings)} of docs/formats.md lacks the key {key}" for key in missing]
        if not found:
            errors.append(f"{name}: was not written")
    errors += [f"{name}: nothing writes the key {key}, which its section has"
               for name, keys in documented.items() for key in sorted(keys - strings)
               if key.removesuffix("_mm") not in strings]
    print(f"{compared} keys of {len(SECTIONS)} kinds of files")
    print(*errors, sep="\n", file=sys.stderr)
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
