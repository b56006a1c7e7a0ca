#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Memory that readers need for large files, compared with the size of the file and of the data that are kept.

  /usr/bin/python3 tests/study/reader_memory.py build/release/bin/elastocal [--mb 300]

Files are made in a folder of their own (one at a time, removed at the end) and read by `elastocal info`. Needs NumPy.
"""
import argparse
import os
import pathlib
import subprocess
import tempfile

import numpy as np

MARKERS, JOINTS = [f"M{i:02d}" for i in range(63)], [f"joint_{i:02d}" for i in range(36)]
CELLS = [f"{value:.3f}" for value in np.random.default_rng(1).uniform(-2000, 2000, 3 * len(MARKERS))]
MOST_SAMPLES = 1000000  # largest number of samples of a log that are read
XYZ = [(name, axis) for name in MARKERS for axis in "XYZ"]


def rows(file, head, row, count):
    with file.open("w") as out:
        out.write(head)
        for i in range(count):
            out.write(row(i))


def qualisys(file, n):
    rows(file, f"NO_OF_FRAMES\t{n}\nNO_OF_MARKERS\t{len(MARKERS)}\nFREQUENCY\t100\nDATA_INCLUDED\t3D\n"
         + "\t".join(["MARKER_NAMES", *MARKERS]) + "\n", lambda i: "\t".join(CELLS) + "\n", n)


def vicon(file, n):
    rows(file, "Trajectories\n100\n," + "".join(f",robot:{name},," for name in MARKERS) + "\nFrame,Sub Frame"
         + ",X,Y,Z" * len(MARKERS) + "\n," + ",mm,mm,mm" * len(MARKERS) + "\n",
         lambda i: f"{i + 1},0," + ",".join(CELLS) + "\n", n)


def trc(file, n):
    rows(file, "PathFileType\t4\t(X/Y/Z)\tlarge.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n"
         f"100\t100\t{n}\t{len(MARKERS)}\tmm\nFrame#\tTime" + "".join(f"\t{name}\t\t" for name in MARKERS) + "\n\t"
         + "".join(f"\t{axis}{m + 1}" for m in range(len(MARKERS)) for axis in "XYZ") + "\n\n",
         lambda i: f"{i + 1}\t{i / 100:.5f}\t" + "\t".join(CELLS) + "\n", n)


def motive(file, n):
    def cells(of):
        return ",".join(of(name, axis) for name, axis in XYZ)

    rows(file, "Format Version,1.23,Take Name,large,Export Frame Rate,100.000000,Rotation Type,Quaternion,Length Units,"
         f"Millimeters,Coordinate Space,Global\n\n,Type,{cells(lambda name, axis: 'Marker')}\n"
         f",Name,{cells(lambda name, axis: name)}\n,ID,{cells(lambda name, axis: name[1:])}\n"
         f",,{cells(lambda name, axis: 'Position')}\nFrame,Time (Seconds),{cells(lambda name, axis: axis)}\n",
         lambda i: f"{i},{i / 100:.6f}," + ",".join(CELLS) + "\n", n)


def npz(file, n):
    np.savez(file, time=0.001 * np.arange(n), q=np.random.default_rng(1).random((n, len(JOINTS))), names=np.array(JOINTS))


def joint_log(file, n):
    rows(file, ",".join(["time", *JOINTS]) + "\n",
         lambda i: f"{i / 1000:.4f}," + ",".join(CELLS[: len(JOINTS)]) + "\n", n)


# Name of the file, function that makes it, bytes of a row in it, and numbers that are kept of a
# row.
FORMATS = {
    "Qualisys TSV": ("large.tsv", qualisys, 1 + sum(map(len, CELLS)) + len(CELLS), len(CELLS)),
    "Vicon Nexus CSV": ("large.csv", vicon, 10 + sum(map(len, CELLS)) + len(CELLS), len(CELLS)),
    "TRC": ("large.trc", trc, 16 + sum(map(len, CELLS)) + len(CELLS), len(CELLS)),
    "OptiTrack Motive CSV": ("large.csv", motive, 17 + sum(map(len, CELLS)) + len(CELLS), len(CELLS)),
    "NumPy .npz": ("large.npz", npz, 8 + 8 * len(JOINTS), 1 + 2 * len(JOINTS)),
    "joint log (CSV)": ("large.csv", joint_log, 10 + 9 * len(JOINTS), 1 + 2 * len(JOINTS)),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--mb", type=float, default=300.0, help="size of each file")
    args = parser.parse_args()
    print(f"{'format':22} {'file MB':>8} {'kept MB':>8} {'memory MB':>10}")
    for name, (file_name, make, row, numbers) in FORMATS.items():
        with tempfile.TemporaryDirectory() as folder:
            file, count = pathlib.Path(folder) / file_name, int(1e6 * args.mb / row)
            if numbers != len(CELLS):
                count = min(count, MOST_SAMPLES)
            make(file, count)
            child = subprocess.Popen([args.program.resolve(), "info", file], stdout=subprocess.DEVNULL)
            _, status, usage = os.wait4(child.pid, 0)
            if status != 0:
                raise SystemExit(f"{name}: ended with {status}")
            kept = 8e-6 * numbers * count
            print(f"{name:22} {1e-6 * file.stat().st_size:8.0f} {kept:8.0f} {1e-6 * 1024 * usage.ru_maxrss:10.0f}",
                  flush=True)


if __name__ == "__main__":
    main()
