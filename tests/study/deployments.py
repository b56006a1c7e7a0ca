#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Calibrations put to use on several robots: how far hands, feet and waist are from the plan.

Takes the motions of a folder of `elastocal demo`. Each robot (--seed) plays them, is calibrated, and
then executes sine.csv as a robot whose controller is nominal, knows the calibrated URDF, or geometry and
elasticity, with the stabiliser and without. Prints the error of each (rms, mm), and how much better the controller
is that knows all. The motion of a robot that falls counts until then.

Example: tests/study/deployments.py build/release/bin/elastocal models/talos/project.yaml DEMO --robots 5
"""
import argparse
import json
import pathlib
import tempfile

from compare_pairs import run

PLACES = ("hands", "swinging_feet", "waist")


def deploy(arguments, seed, work):
    """Results of one robot in deployment.json, by (as, stabilised)."""
    recordings = []
    measured = ["--marker-places-mm", "0.5", "--marker-places-of", *arguments.places_of] if arguments.places_of else []
    for kind in arguments.kinds:
        recordings.append(work / f"recording_{seed}_{kind}")
        words = [] if kind == "motion" else ["--kind", kind]
        run(arguments.program, "simulate", arguments.project, "--motion", arguments.demo / f"{kind}.csv", *words,
            "-o", recordings[-1], "--seed", seed, *(measured if len(recordings) == 1 else []))
    result = work / f"calibration_{seed}"
    places = ["--marker-places", recordings[0] / "marker_places.csv"] if measured else []
    run(arguments.program, "calibrate", arguments.project, "--recording", *recordings, "-o", result, *places)
    run(arguments.program, "simulate", arguments.project, "--deploy", result, "--motion", arguments.demo / "sine.csv",
        "-o", result, "--seed", seed, *(["--until-s", arguments.until_s] if arguments.until_s else []))
    executions = json.loads((result / "deployment.json").read_text())["executions"]
    return {(one["as"], one["stabilised"]): one for one in executions}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("project", type=pathlib.Path)
    parser.add_argument("demo", type=pathlib.Path)
    parser.add_argument("--robots", type=int, default=5)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--kinds", nargs="+", default=["motion", "sine", "random"], help="motions that are recorded")
    parser.add_argument("--places-of", nargs="*", default=["LHAND", "RHAND", "LFOOT", "RFOOT", "WAIST"],
                        help="clusters whose markers are measured on their links to 0.5 mm, as in the demo")
    parser.add_argument("--until-s", type=float, help="the robots execute the motion until then")
    parser.add_argument("--work", type=pathlib.Path)
    arguments = parser.parse_args()
    print("robot  controller   stabiliser  stood     hands  feet  waist  landing mm, deg  shift mm")
    with tempfile.TemporaryDirectory() as scratch:
        work = arguments.work or pathlib.Path(scratch)
        work.mkdir(parents=True, exist_ok=True)
        for seed in range(arguments.first, arguments.first + arguments.robots):
            found = deploy(arguments, seed, work)
            for (name, stabilised), one in found.items():
                stood = "yes" if one["stood"] else f"{one['time_s']:.0f} s"
                places = "  ".join(f"{one[place]['rms_mm']:5.2f}" for place in PLACES)
                landing = f"{one['landing']['max_mm']:.2f}, {one['landing']['max_deg']:.2f}" if one["landing"]["samples"] else "-"
                print(f"{seed:5}  {name:11}  {'yes' if stabilised else 'no':10}  {stood:8}  {places}  {landing:15}"
                      f"  {one['stabiliser_largest_shift_mm']:.1f}")
            for name in ("nominal", "urdf"):
                for stabilised in (True, False):
                    if any(found[one, stabilised]["refused"] for one in (name, "compensated")):
                        continue
                    ratios = [found[name, stabilised][place]["rms_mm"] / found["compensated", stabilised][place]["rms_mm"]
                              for place in PLACES]
                    print(f"{seed:5}  {name} over compensated, {'with' if stabilised else 'without'} stabiliser: "
                          + ", ".join(f"{place} {ratio:.1f}" for place, ratio in zip(PLACES, ratios)), flush=True)


if __name__ == "__main__":
    main()
