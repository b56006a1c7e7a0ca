#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Bad input of every kind, tried on the built program.

  bad_input.py PROGRAM SOURCE_DIR [--seed N] [--only KIND] [--table FILE]

Whatever the input, the program must end by itself: with 0 (what was tried is no error after all),
2, 3 or 4, within 10 s and 1 GB. With 2 and 3 it must name the file, key or option. The table says
how often each kind of input was tried and how it ended; --table writes it to the section of
docs/robustness.md that is marked for it.
"""

import argparse
import collections
import concurrent.futures
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

sys.dont_write_bytecode = True  # no files in the sources
import bad_cases  # noqa: E402, pylint: disable=wrong-import-position
import inputs  # noqa: E402, pylint: disable=wrong-import-position

LONGEST_S = 10.0
MOST_BYTES = 1 << 30

Outcome = collections.namedtuple("Outcome", "case code seconds bytes message")


def run(program, case, root):
    """Runs a case; the code is negative for a signal and None for one that did not end."""
    folder = pathlib.Path(tempfile.mkdtemp(dir=root))
    limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (4 * MOST_BYTES, 4 * MOST_BYTES))
    out = open("/dev/full" if case.label == "standard output is full" else folder / "stdout", "wb")
    begin = time.monotonic()
    with out, open(folder / "stderr", "wb") as err:
        child = subprocess.Popen([os.fsencode(program), *case.words], stdout=out, stderr=err,
                                 stdin=subprocess.DEVNULL, cwd=folder, preexec_fn=limit)
        timer = threading.Timer(LONGEST_S, lambda: os.kill(child.pid, signal.SIGKILL))
        timer.start()
        _, status, usage = os.wait4(child.pid, 0)
        timer.cancel()
        child.returncode = 0
    seconds = time.monotonic() - begin
    message = (folder / "stderr").read_bytes()
    shutil.rmtree(folder, ignore_errors=True)
    code = os.waitstatus_to_exitcode(status)
    if code == -signal.SIGKILL and seconds >= LONGEST_S:
        code = None
    return Outcome(case, code, seconds, usage.ru_maxrss << 10, message)


def faults_of(outcome):
    """Describes what is wrong with the end of a case."""
    if outcome.code is None:
        yield f"did not end within {LONGEST_S:.0f} s"
    elif outcome.code not in (0, 2, 3, 4):
        yield f"ended with {outcome.code}"
    if outcome.bytes > MOST_BYTES:
        yield f"took {outcome.bytes >> 20} MiB"
    if re.search(rb"[\x00-\x08\x0b-\x1f\x7f]", outcome.message):
        yield "control characters reached the terminal"
    try:
        outcome.message.decode()
    except UnicodeDecodeError:
        yield "the message is not UTF-8"
    if outcome.code in (2, 3) and not named(outcome):
        yield f"the message names none of {outcome.case.names}"


def named(outcome):
    """Whether the message names the place. Contents of data are named by their trial, faults by their name."""
    names = [*outcome.case.names, "trial arm", "trial 'arm'", "fault: ", "project.yaml:"]
    if outcome.case.kind == "URDF":
        names.append("robot 'arm6'")
    if outcome.case.kind == "results: calibration.yaml":
        names.append("covariance.csv")  # because it no longer belongs to this file
    return any(os.fsencode(name)[:60] in outcome.message for name in names if name)


def table_of(outcomes):
    rows = ["| input | tried | no error | refused (2, 3) | refused result (4) | named | slowest s | most MiB |",
            "|---|---|---|---|---|---|---|---|"]
    kinds = list(dict.fromkeys(outcome.case.kind for outcome in outcomes)) + ["all"]
    for kind in kinds:
        of_kind = [o for o in outcomes if kind in (o.case.kind, "all")]
        refused = [o for o in of_kind if o.code in (2, 3)]
        share = 100 * sum(map(named, refused)) // max(1, len(refused))
        rows.append(f"| {kind} | {len(of_kind)} | {sum(o.code == 0 for o in of_kind)} | {len(refused)} | "
                    f"{sum(o.code == 4 for o in of_kind)} | {share} % | "
                    f"{max(o.seconds for o in of_kind):.0f} | {max(o.bytes for o in of_kind) >> 20} |")
    return "\n".join(rows) + "\n"


def show(outcome):
    print(f"{outcome.case.kind}: {outcome.case.label}: {'; '.join(faults_of(outcome))}")
    words = " ".join(os.fsdecode(word)[:90] for word in outcome.case.words)
    print("   ", words.encode("ascii", "replace").decode())
    print("   ", outcome.message[:300].decode(errors="replace").strip(), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--share", type=float, default=0.5, help="of all tries, drawn by the seed")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", default="", help="kinds that contain this")
    parser.add_argument("--table", type=pathlib.Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="elastocal_faults_") as root:
        base = inputs.Base(arguments.program.resolve(), arguments.source.resolve(), pathlib.Path(root))
        draw = random.Random(arguments.seed)
        cases = [case for case in bad_cases.all_tries(base, arguments.seed)
                 if draw.random() < arguments.share and arguments.only in case.kind]
        with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
            outcomes = []
            for outcome in pool.map(lambda case: run(base.program, case, root), cases):
                outcomes.append(outcome)
                if list(faults_of(outcome)):
                    show(outcome)
    failures = [outcome for outcome in outcomes if list(faults_of(outcome))]
    table = table_of(outcomes)
    print(table)
    if arguments.table:
        text = arguments.table.read_text()
        begin, end = "<!-- bad_input.py -->\n", "<!-- end of bad_input.py -->"
        head, rest = text.split(begin, 1)
        arguments.table.write_text(head + begin + table + end + rest.split(end, 1)[1])
    print(f"{len(outcomes)} tried, {len(failures)} ended badly")
    return 1 if failures or (len(outcomes) < 400 and not arguments.only) else 0


if __name__ == "__main__":
    sys.exit(main())
