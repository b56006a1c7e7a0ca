#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the prior of a fleet is worth for new robots of its series, measured with few postures.

  tests/study/series_prior.py PROGRAM PROJECT FOLDER [--share S] [--robots N] [--new N] [--postures N] [--words ...]

`batch` calibrates `--robots` virtual robots of a series, each with a seed of its own, that have the share S of the variance of
every error in common. New robots of the same series are then measured with `--postures` postures and calibrated with the
default prior and with the fleet's. The figures are held-out errors of random postures with compensation
(`deployed.compensated` of summary.json), mm.
"""
import argparse
import json
import math
import pathlib
import statistics
import subprocess

FIRST_NEW = 301  # seed: the fleet has those from 1 on


def run(*words) -> int:
    return subprocess.run(list(map(str, words)), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode


def error_mm(folder: pathlib.Path) -> float:
    """Held-out error, mm; NaN if the recording was refused."""
    if not (folder / "summary.json").exists():
        return math.nan
    error = json.loads((folder / "summary.json").read_text())["deployed"]["compensated"]["rmse_3d_mm"]
    return math.nan if error is None else error


def rms(values: list[float]) -> float:
    return math.sqrt(sum(v * v for v in values) / len(values))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("project", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--share", type=float, default=0.8)
    parser.add_argument("--robots", type=int, default=40)
    parser.add_argument("--new", type=int, default=12)
    parser.add_argument("--postures", type=int, default=12)
    parser.add_argument("--words", default="", help="more words of simulate, with blanks between")
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    words = ["--arm-postures", "12", "--move-s", "1", "--rest-s", "0.6", "--lead-in-s", "2",
             "--series-share", str(args.share), *args.words.split()]
    keys = ", ".join(f"{word[2:]}: {value}" for word, value in zip(words[::2], words[1::2]))
    manifest = args.folder / "fleet.yaml"
    manifest.write_text(f"{{project: {args.project.resolve()}, studies: [{{name: member, robots: {args.robots}, "
                        f"simulate: {{trials: calibration, {keys}}}}}]}}\n")
    run(args.program, "batch", manifest, "-o", args.folder / "fleet", "--workers", "1")
    words[1] = str(args.postures)
    pairs = []
    for seed in range(FIRST_NEW, FIRST_NEW + args.new):
        recording = args.folder / f"new_{seed}"
        run(args.program, "simulate", args.project, "-o", recording, "--seed", seed, "--random-postures", "20", *words)
        pair = []
        for name, prior in (("default", []), ("fleet", ["--prior", args.folder / "fleet/prior", "--days", "0"])):
            out = args.folder / f"{name}_{seed}"
            run(args.program, "calibrate", args.project, "--recording", recording, "-o", out, *prior)
            pair.append(error_mm(out))
        pairs.append(pair)
        print(f"{seed}: {pair[0]:.4f} {pair[1]:.4f}", flush=True)
    both = [pair for pair in pairs if all(map(math.isfinite, pair))]
    print(f"share {args.share}, {args.robots} robots, {args.postures} postures, {len(both)} of {len(pairs)} new robots")
    for name, figure in (("rms", rms), ("median", statistics.median)):
        default, fleet = (figure([pair[i] for pair in both]) for i in range(2))
        print(f"{name:>6}: default {default:.4f}, fleet {fleet:.4f} mm, {100 * (fleet / default - 1):+.1f} %")


if __name__ == "__main__":
    main()
