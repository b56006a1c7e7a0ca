#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How long calls of the Python module take to end after Ctrl-C.

  PYTHONPATH=build/release/python tests/study/interruption.py --recording DIR --calibration DIR [--tries N]

Each call runs in a process of its own, which gets SIGINT at times spread over the whole call. `--recording`: a recording
folder of models/talos, as `elastocal simulate` writes it; `--calibration`: what `elastocal calibrate` made of it. The
figures are seconds from the signal to the end of the process, which has to end by KeyboardInterrupt.
"""
import argparse
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "python"))
from test_contact import elastocal, measured_project
CALLS = {
    "project": "elastocal.Project(talos)",
    "design": "elastocal.design(project, elastic=True)",
    "design_after": "elastocal.design_after(project, calibration, check=True)",
    "plan": "elastocal.plan(project, kind='random', robots=2)",
    "simulate": "elastocal.simulate(project, scratch)",
    "simulate matched": "elastocal.simulate(project, scratch, matched=True)",
    "simulate instruments": "elastocal.simulate(instruments, scratch)",
    "design instruments": "elastocal.design(instruments)",
    "calibrate": "elastocal.calibrate(project, recording)",
    "calibrate folds": "elastocal.calibrate(project, recording, folds=10, threads=2)",
    "validate": "elastocal.validate(project, calibration, recording)",
    "check": "elastocal.check(project, calibration, recording)",
    "calibrate instruments": "elastocal.calibrate(measured, table, folds=20, threads=2)",
    "validate instruments": "elastocal.validate(measured, scratch + '_measured/out', table, refit='table')",
    "compare": "elastocal.compare(calibration, calibration)",
    "read": "elastocal.read(pathlib.Path(recording) / 'leg_left.tsv')",
    "runtime": "elastocal.Runtime(calibration, talos)",
}
CHILD = """
import pathlib, sys, time
import elastocal
talos, recording, calibration, scratch, other = sys.argv[1:6]
project, instruments = elastocal.Project(talos), elastocal.Project(other)
measured, table = elastocal.Project(scratch + "_measured/project.yaml"), scratch + "_measured/large.csv"
print("ready", flush=True)
begin = time.monotonic()
{call}
print(time.monotonic() - begin, flush=True)
"""


def start(call: str, words: list[str]) -> subprocess.Popen:
    child = subprocess.Popen([sys.executable, "-c", CHILD.format(call=call), *words], bufsize=0,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    child.stdout.readline()
    return child


def seconds_to_end(call: str, words: list[str], after: float) -> float:
    """Seconds from the signal to the end; negative if the call was over before."""
    child = start(call, words)
    time.sleep(after)
    sent = time.monotonic()
    child.send_signal(signal.SIGINT)
    out, errors = child.communicate()
    taken = time.monotonic() - sent
    if out:
        return -1.0
    if b"KeyboardInterrupt" not in errors:
        raise SystemExit(f"{call}: ended otherwise:\n{errors.decode()}")
    return taken


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--recording", required=True)
    parser.add_argument("--calibration", required=True)
    parser.add_argument("--tries", type=int, default=20)
    parser.add_argument("--calls", nargs="+", default=list(CALLS))
    parser.add_argument("--longest", type=float, default=60.0, help="part of a call that is looked at, s")
    args = parser.parse_args()
    print(f"{'call':22} {'takes s':>8} {'signals':>8} {'median s':>9} {'worst s':>8} {'at s':>7}")
    for name in args.calls:
        with tempfile.TemporaryDirectory() as scratch:
            words = [str(SOURCE / "models/talos/project.yaml"), args.recording, args.calibration,
                     str(pathlib.Path(scratch) / "simulated"),
                     str(SOURCE / "examples/talos_touch/project.yaml")]
            measured = pathlib.Path(words[3] + "_measured")
            measured.mkdir()
            project = measured_project(measured, {"small.csv": 20, "large.csv": 400})
            elastocal.calibrate(project, measured / "small.csv", folds=0).save(measured / "out")
            child = start(CALLS[name], words)
            try:
                out, errors = child.communicate(timeout=args.longest)
                takes = float(out)
            except subprocess.TimeoutExpired:
                child.kill()
                child.communicate()
                takes = args.longest
            ends = []
            for i in range(args.tries):
                after = takes * (i + 0.5) / args.tries
                ends.append((seconds_to_end(CALLS[name], words, after), after))
            ends = sorted(end for end in ends if end[0] >= 0)
            if not ends:
                print(f"{name:22} {takes:8.2f} {0:8}")
                continue
            print(f"{name:22} {takes:8.2f} {len(ends):8} {ends[len(ends) // 2][0]:9.2f} {ends[-1][0]:8.2f} "
                  f"{ends[-1][1]:7.2f}", flush=True)


if __name__ == "__main__":
    main()
