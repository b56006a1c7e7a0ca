# SPDX-License-Identifier: Apache-2.0
"""Faults in tables and trials of invented robots: what the program says of each, and what it deploys.

Robots, noise and faults are those of foreign_robots.py and this file, which share no code with the program. `--seed` draws other
joints, sizes and rows. A line has the exit code, whether one sentence names the fault ("named"), and the error of the
exported URDF over that of the recording without the fault.
"""

import argparse
import pathlib
import re
import shutil
import subprocess
import time

import numpy as np

from foreign_robots import DEGREE, ROBOTS, Case, Lab, turned, write_table, write_trials

TABLES, TRIALS = {}, {}


def fault(kinds, name):
    def keep(function):
        kinds[name] = function
        return function
    return keep


def exchange(a, b, rows, columns):
    columns[a][rows], columns[b][rows] = columns[b][rows].copy(), columns[a][rows].copy()


def each(case):
    """The dictionaries of joints of a table or of all trials."""
    return [T["Q"] for T in case.trials] if case.trials else [case.Q]


def markers_of(case):
    return [T["M"] for T in case.trials] if case.trials else [case.M]


# --- in tables: each returns what was done, and what a sentence has to say ------------------------

def joint_fault(name, change, words):
    @fault(TABLES, name)
    def _(case):
        a = case.joints[0]
        change(case, case.Q[a])
        return a, f"{a}.*({words})"


def from_row(change):
    return lambda case, q: q.__setitem__(slice(case.row, None), change(q[case.row:]))


joint_fault("sign", lambda case, q: np.negative(q, out=q), "sign")
joint_fault("sign from a row on", from_row(np.negative), "sign")
joint_fault("a row late", lambda case, q: q.__setitem__(slice(None), np.roll(q, 1)), "row before")
joint_fault("a row late from a row on", lambda case, q: q.__setitem__(slice(case.row, None), q[case.row - 1:-1].copy()), "row before")
joint_fault("in degrees", lambda case, q: np.multiply(q, 1 / DEGREE, out=q), "degrees")
joint_fault("jumps by half a turn in rows", lambda case, q: q.__setitem__(case.few, q[case.few] - np.pi * np.sign(q[case.few])), "half a turn|wrong")
joint_fault("0 in rows", lambda case, q: q.__setitem__(case.few, 0.0), "says the same|frozen|wrong|stay")
joint_fault("slips and back", lambda case, q: q.__setitem__(slice(case.row - 10, case.row + 5), q[case.row - 10:case.row + 5] + case.size(1, 2) * DEGREE), "off by")
joint_fault("slips", from_row(lambda q: q + 0.9 * DEGREE), "off by")
joint_fault("drifts by 1.3 deg", lambda case, q: np.add(q, np.linspace(0, 1.3, len(q)) * DEGREE, out=q), "drift")
joint_fault("gain 0.5", lambda case, q: np.multiply(q, 0.5, out=q), "times|gain")
joint_fault("gain 1.02", lambda case, q: np.multiply(q, 1.02, out=q), "times|gain")
joint_fault("6 deg off in rows", lambda case, q: q.__setitem__(case.few, q[case.few] + 6 * DEGREE), "wrong|off|outliers")


def rounded(step):
    return lambda case, q: np.multiply(np.round(q / step), step, out=q)


for degrees in (2, 1, 0.5, 0.1):
    joint_fault(f"rounded to {degrees} deg", rounded(degrees * DEGREE), "steps")
joint_fault("of an encoder of 512 steps", rounded(2 * np.pi / 512), "steps")
joint_fault("to two decimals, rad", rounded(0.01), "steps")


@fault(TABLES, "all joints rounded to 1 deg")
@fault(TRIALS, "all joints rounded to 1 deg")
def _(case):
    for Q in each(case):
        for j in case.lab.turning:
            Q[j] = np.round(Q[j] / DEGREE) * DEGREE
    return "", "steps"


@fault(TABLES, "last joint modulo pi")
@fault(TRIALS, "last joint modulo pi")
def _(case):
    a = case.lab.names[-1] if len(case.lab.tips) == 1 else "right_fore"
    for Q in each(case):
        Q[a] = (Q[a] + np.pi / 2) % np.pi - np.pi / 2
    return a, f"{a}.*(turn|wrap|modulo|wrong)"


@fault(TABLES, "two joints exchanged from a row on")
def _(case):
    a, b = case.joints[:2]
    exchange(a, b, slice(case.row, None), case.Q)
    return f"{a}, {b}", f"({a}.*{b}|{b}.*{a}).*exchanged"


@fault(TABLES, "three columns went round")
def _(case):
    a, b, c = case.joints[:3]
    case.Q[a], case.Q[b], case.Q[c] = case.Q[b], case.Q[c], case.Q[a]
    return f"{a}, {b}, {c}", "(exchanged|went round|each other|columns of)"


@fault(TABLES, "two signs")
def _(case):
    for a in case.joints[:2]:
        case.Q[a] *= -1
    return ", ".join(case.joints[:2]), f"{case.joints[0]}.*sign|{case.joints[1]}.*sign"


@fault(TABLES, "two joints slip")
def _(case):
    for a, row in zip(case.joints, (case.row, case.row + 8)):
        case.Q[a][row:] += case.size(0.6, 1.2) * DEGREE
    return ", ".join(case.joints[:2]), f"{case.joints[0]}.*{case.joints[1]}|{case.joints[1]}.*{case.joints[0]}"


@fault(TABLES, "a gain beside a slip")
def _(case):
    case.Q[case.joints[0]] *= 1 + case.size(0.015, 0.03)
    case.Q[case.joints[1]][case.row:] += case.size(0.6, 1.2) * DEGREE
    return ", ".join(case.joints[:2]), f"{case.joints[0]}.*{case.joints[1]}|{case.joints[1]}.*{case.joints[0]}"


@fault(TABLES, "markers of the row before in rows")
def _(case):
    for x in case.M.values():
        x[case.few] = x[case.few - 1]
    return "", "another row|row before|rows? .*before"


@fault(TABLES, "clusters exchanged in rows")
def _(case):
    for a, b in zip(case.last(1), case.last(2)):
        exchange(a, b, case.few, case.M)
    return f"{case.lab.clusters[-1][0]}, {case.lab.clusters[-2][0]}", "labels|exchanged"


@fault(TABLES, "a marker glued on again")
def _(case):
    m = case.last()[-1]
    case.again(moved={m: case.lab.places[m] + np.outer(np.arange(case.count) >= case.row, [0.006, -0.004, 0.003])})
    return m, f"{m}.*(elsewhere|glued|place)"


@fault(TABLES, "a cluster knocked")
def _(case):
    case.again(moved=knocked(case, np.arange(case.count) >= case.row))
    return case.lab.clusters[-1][0], f"{case.lab.clusters[-1][0]}.*(elsewhere|knocked)"


def knocked(case, when):
    R, p, places = turned([0.05, 0.03, -0.04]), np.array([0.006, -0.005, 0.004]), case.lab.places
    return {m: np.where(np.atleast_1d(when)[:, None], R @ places[m] + p, places[m]) for m in case.last()}


@fault(TABLES, "cameras moved")
def _(case):
    for x in case.M.values():
        x[case.row:] = x[case.row:] @ turned([0.001, -0.002, 0.004]).T + [0.003, -0.002, 0.004]
    return "", "cameras|root link|stand"


@fault(TABLES, "mirrored")
def _(case):
    for x in case.M.values():
        x[:, 1] *= -1
    return "", "left-handed|mirror"


@fault(TABLES, "another robot from a row on")
def _(case):
    other = Lab(case.lab.name, case.seed + 500)
    other.places, other.cameras = case.lab.places, case.lab.cameras
    for m, x in other.table(case.count, case.seed)["M"].items():
        case.M[m][case.row:] = x[case.row:]
    return "", "another robot"


@fault(TABLES, "markers swing at rest")
def _(case):
    swing = case.rng.normal(0, 1.5e-3, (case.count, 3))
    for m, x in case.M.items():
        if case.lab.link_of[m] != case.lab.nominal.root:
            x += swing * np.linalg.norm(x - case.lab.cameras[1], axis=1)[:, None]
    return "", "noise|rest"


def late(n, size):
    return lambda j, q, tau: 0 if j == "rise" else size * np.interp(np.arange(len(q[j])) - n, np.arange(len(q[j])), q[j]) - size * q[j]


@fault(TABLES, "table before rest: 1.5 % of each move is missing")
def _(case):
    case.again(bend=late(1, 0.015))
    return "", "of each move"


@fault(TABLES, "commanded: a dead band of 2 mrad")
def _(case):
    dead = np.random.default_rng([case.seed, 1])  # the generator of the seed alone drew the postures
    case.again(bend=lambda j, q, tau: 0 if j == "rise" else dead.uniform(-2e-3, 2e-3, len(tau[j])))
    return "", "noise|commanded"


@fault(TABLES, "backlash of 3 mrad")
def _(case):
    a = case.joints[0]
    case.again(bend=lambda j, q, tau: 1.5e-3 * np.sign(tau[j]) * (j == a))
    return a, f"{a}.*(backlash|hysteresis)"


# --- cameras and joints of tables and trials alike -------------------------------------------------

def cameras(name, change, words="cameras|camera positions"):
    @fault(TABLES, name)
    @fault(TRIALS, name)
    def _(case):
        for M in markers_of(case):
            for m in M:
                M[m] = change(M[m], case.lab.cameras[1])
        return "", words


cameras("cameras: z 1.01 times", lambda x, at: x * [1, 1, 1.01])
cameras("cameras: 1.01 times", lambda x, at: x * 1.01)
cameras("cameras: x sheared by 1 % of y", lambda x, at: x + 0.01 * x[:, [1]] * [1, 0, 0])
cameras("cameras: y sheared by 0.5 % of z", lambda x, at: x + 0.005 * x[:, [2]] * [0, 1, 0])
cameras("cameras: radial, 1 % at 1 m", lambda x, at: x + 0.01 * (x - at) * np.sum((x - at) ** 2, axis=1)[:, None])
cameras("cameras: radial from 2 m off", lambda x, at: x + 0.004 * (x - at - 1.2) * np.sum((x - at - 1.2) ** 2, axis=1)[:, None])


# --- in trials --------------------------------------------------------------------------------------

@fault(TRIALS, "two joints exchanged in one trial")
def _(case):
    a, b = case.in_second[:2]
    exchange(a, b, slice(None), case.second["Q"])
    return f"{a}, {b}", f"({a}.*{b}|{b}.*{a})"


@fault(TRIALS, "two joints exchanged from the second trial on")
def _(case):
    a, b = case.in_second[:2]
    for T in case.trials[1:]:
        exchange(a, b, slice(None), T["Q"])
    return f"{a}, {b}", f"({a}.*{b}|{b}.*{a})"


def lag(seconds):
    def delay(case):
        a = case.in_first[0]
        for T in case.trials:
            T["Q"][a] = np.interp(T["t"] - seconds, T["t"], T["Q"][a])
        return a, f"{a}.*(late|lag|clock|behind)"
    return delay


fault(TRIALS, "a joint 0.09 s late")(lag(0.09))
fault(TRIALS, "a joint 1.2 s late")(lag(1.2))


@fault(TRIALS, "slips from the second trial on")
def _(case):
    a = case.in_both[0]
    for T in case.trials[1:]:
        T["Q"][a] += 1.1 * DEGREE
    return a, f"{a}.*off by"


@fault(TRIALS, "slips twice in the first trial")
def _(case):
    a, n = case.in_first[0], len(case.first["t"])
    case.first["Q"][a][n // 3:] += 0.8 * DEGREE
    case.first["Q"][a][2 * n // 3:] += 0.7 * DEGREE
    return a, f"{a}.*off by"


@fault(TRIALS, "gain 1.03")
def _(case):
    for Q in each(case):
        Q[case.in_first[0]] *= 1.03
    return case.in_first[0], f"{case.in_first[0]}.*times"


@fault(TRIALS, "a marker glued on again after the first trial")
def _(case):
    m = case.last()[-1]
    case.anew(lambda name, n: {} if name == "part_0" else {"moved": {m: case.lab.places[m] + np.array([0.006, -0.004, 0.003])}})
    return m, f"{m}|{m[:-2]}"


@fault(TRIALS, "a cluster knocked in the second trial")
def _(case):
    case.anew(lambda name, n: {"moved": knocked(case, True)} if name == "part_1" else {})
    return case.lab.clusters[-1][0], case.lab.clusters[-1][0]


@fault(TRIALS, "clusters exchanged for validation")
def _(case):
    for T in case.trials[3:]:
        for a, b in zip(case.last(1), case.last(2)):
            exchange(a, b, slice(None), T["M"])
    return "", "labels.*exchanged"


@fault(TRIALS, "cameras knocked amid a trial")
def _(case):
    n = len(case.second["M"][case.last()[0]])
    for x in case.second["M"].values():
        x[n // 2:] = x[n // 2:] @ turned([0.001, -0.002, 0.01]).T + [0.005, 0.003, 0.002]
    return "", "part_1"


@fault(TRIALS, "another robot in one trial")
def _(case):
    other = Lab(case.lab.name, case.seed + 500)
    other.places, other.cameras = case.lab.places, case.lab.cameras
    case.trials[1] = other.trials(case.seed)[1]
    return "", "another robot|several joints"


@fault(TRIALS, "logs of two trials exchanged")
def _(case):
    for key in ("Q", "t"):
        case.first[key], case.second[key] = case.second[key], case.first[key]
    return "", "part_0|part_1"


@fault(TRIALS, "validation is a copy")
def _(case):
    case.trials[4].update({k: case.first[k] for k in "MtQ"})
    return "", "same recording|mixed"


# --- the study --------------------------------------------------------------------------------------

def calibrate(program, case, folder):
    case.lab.project(folder)
    recording = folder / ("trials" if case.trials else "table.csv")
    write_trials(recording, case.trials) if case.trials else write_table(recording, {"M": case.M, "Q": case.Q})
    shutil.rmtree(folder / "out", ignore_errors=True)
    start = time.time()
    done = subprocess.run([program, "calibrate", folder / "project.yaml", "--recording", recording, "-o", folder / "out"], capture_output=True, text=True, check=False)
    said = done.stdout + done.stderr
    (folder / "said").write_text(said)
    if case.trials:
        shutil.rmtree(recording)
    found = list((folder / "out").glob("*calibrated.urdf")) if done.returncode == 0 else []
    return done.returncode, said, case.lab.error(found[0].read_text()) if found else None, time.time() - start


def sentences(said):
    """The sentences without those of every run on its sizes and on axes that are no longer parallel."""
    lines = [l for l in said.replace("\r", "\n").splitlines() if re.match(r"Verdict|Not used|elastocal: (warning|error)", l)]
    return [l for l in lines if "inverse kinematics" not in l and "furthest from nominal" not in l and "is written" not in l]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--robots", nargs="+", choices=list(ROBOTS), default=list(ROBOTS))
    parser.add_argument("--kinds", nargs="+", choices=["table", "trials"], default=["table", "trials"])
    parser.add_argument("--only", default="", help="a regular expression of faults")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--clean", type=int, default=0, help="so many clean recordings of each robot and kind, without faults")
    options = parser.parse_args()
    print("| recording | fault | exit | named | error / clean | s | said |\n|---|---|---|---|---|---|---|")
    for robot in options.robots:
        for kind in options.kinds:
            clean = None
            cases = TABLES if kind == "table" else TRIALS
            names = [f"clean {k}" for k in range(max(1, options.clean))] + [n for n in cases if not options.clean and re.search(options.only, n)]
            for name in names:
                seed = options.seed + (int(name[6:]) if name.startswith("clean ") else 0)
                case = Case(Lab(robot, seed), seed, 50, kind == "trials", name)
                what, words = cases[name](case) if name in cases else ("", "")
                code, said, error, seconds = calibrate(options.program, case, options.work / f"{robot}_{kind}_{re.sub('[^a-z0-9]+', '_', name.lower())}")
                lines = sentences(said)
                named = any(re.search(words, l) for l in lines if not re.match("Verdict: (deploy|from)", l)) if words else False
                clean = error if name == "clean 0" else clean
                ratio = "" if error is None else f"{error:.3f} mm" if not words else f"{error / clean:.2f}" if clean else f"{error:.3f} mm"
                worst = next((l for l in lines if "error:" in l), " // ".join(lines[1:]) or (lines[0] if lines else said[-200:]))
                print(f"| {robot}, {kind} | {name}: {what} | {code} | {('yes' if named else 'no') if words else ''} | {ratio} | {seconds:.1f} | "
                      f"{worst[:230].replace('elastocal: ', '')} |", flush=True)


if __name__ == "__main__":
    main()
