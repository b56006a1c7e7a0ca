#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Corners that examples/detect_tags.py finds in tags that are drawn with blur, noise, a lens that bends, and covers.

  tests/study/drawn_tags.py [--distance-m 1.2]

Prints for each case how many of eight tags were found, and the errors of their corners. A tag of 80 mm is before a camera of
640 x 480 pixels and 500 pixels of focal length, at 0.5 to 0.9 m (10 to 5.6 pixels a cell) or at the distance that is given."""
import argparse
import ctypes
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "examples" / "detect_tags.py"
sys.path.insert(0, str(SCRIPT.parent))
from detect_tags import Image  # noqa: E402, pylint: disable=wrong-import-position

WIDTH, HEIGHT, FOCAL, SIZE, TAG, FINE = 640, 480, 500.0, 0.08, 7, 4
CENTRE = np.array([320.0, 240.0])
CORNERS = [(-1, 1), (1, 1), (1, -1), (-1, -1)]  # from below left counterclockwise; y down
CASES = {"sharp": {}, "blur of 1 px": {"blur": 1}, "blur of 2 px": {"blur": 2}, "blur of 4 px": {"blur": 4},
         "noise of 8": {"noise": 8}, "noise of 20": {"noise": 20}, "blur of 1.5 px, noise of 8": {"blur": 1.5, "noise": 8},
         "lens: k1 -0.25, k2 0.06": {"lens": (-0.25, 0.06)}, "a third of the contrast": {"contrast": 0.3},
         "a corner covered": {"cover": "corner"}, "the middle of a side covered": {"cover": "side"},
         "a bar across": {"cover": "bar"}}


def cells():
    library = ctypes.CDLL("libapriltag.so.3")
    library.tag36h11_create.restype = ctypes.c_void_p
    library.apriltag_to_image.restype = ctypes.POINTER(Image)
    image = library.apriltag_to_image(ctypes.c_void_p(library.tag36h11_create()), TAG).contents
    return np.array([[image.buf[y * image.stride + x] for x in range(image.width)] for y in range(image.height)], float)


def turned(vector):
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def bent(points, lens):
    square = (points ** 2).sum(0)
    return points * (1 + lens[0] * square + lens[1] * square ** 2)


def straight(points, lens):
    found = points.copy()
    for _ in range(20):
        square = (found ** 2).sum(0)
        found = points / (1 + lens[0] * square + lens[1] * square ** 2)
    return found


def drawn(of, rotation, position, lens):
    grey, parts = np.zeros((HEIGHT, WIDTH)), (np.arange(FINE) + 0.5) / FINE
    for dx in parts:
        for dy in parts:
            pixels = np.stack([p.ravel() for p in np.meshgrid(np.arange(WIDTH) + dx, np.arange(HEIGHT) + dy)])
            rays = np.vstack([straight((pixels - CENTRE[:, None]) / FOCAL, lens), np.ones(pixels.shape[1])])
            reach = (rotation[:, 2] @ position) / (rotation[:, 2] @ rays)
            x, y = np.floor((rotation.T @ (rays * reach - position[:, None]))[:2] / (SIZE / 8) + 5).astype(int)
            inside = (x >= 0) & (x < 10) & (y >= 0) & (y < 10)
            grey += np.where(inside, of[y.clip(0, 9), x.clip(0, 9)], 140.0).reshape(grey.shape)
    return grey / FINE ** 2


def places(rotation, position, lens):
    points = np.array([rotation @ [SIZE / 2 * x, SIZE / 2 * y, 0.0] + position for x, y in CORNERS]).T
    return (FOCAL * bent(points[:2] / points[2], lens)).T + CENTRE


def blurred(grey, sd):
    reach = int(4 * sd) + 1
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sd) ** 2)
    weights /= weights.sum()
    for axis in (0, 1):
        grey = np.apply_along_axis(lambda row: np.convolve(np.pad(row, reach, mode="edge"), weights, "valid"), axis, grey)
    return grey


def covered(grey, corners, what):
    u, v = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    side = np.linalg.norm(corners[0] - corners[1])
    at = {"corner": corners[0], "side": (corners[0] + corners[1]) / 2, "bar": corners.mean(0)}[what]
    near = abs(u - at[0] + v - at[1]) < 0.09 * side if what == "bar" else np.hypot(u - at[0], v - at[1]) < 0.11 * side
    return np.where(near, 90.0, grey)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--distance-m", type=float)
    given = parser.parse_args()
    random, of = np.random.default_rng(4), cells()
    poses = [(turned(random.normal(0, 0.35, 3)), np.array([random.uniform(-0.12, 0.12), random.uniform(-0.09, 0.09),
              given.distance_m or random.uniform(0.5, 0.9)])) for _ in range(8)]
    for name, case in CASES.items():
        lens = case.get("lens", (0.0, 0.0))
        with tempfile.TemporaryDirectory() as folder:
            true = []
            for i, pose in enumerate(poses):
                grey = drawn(of, *pose, lens)
                true.append(places(*pose, lens))
                grey = 140 + case.get("contrast", 1.0) * (grey - 140)
                if "cover" in case:
                    grey = covered(grey, true[-1], case["cover"])
                if "blur" in case:
                    grey = blurred(grey, case["blur"])
                grey = (grey + random.normal(0, case.get("noise", 0), grey.shape)).clip(0, 255).astype(np.uint8)
                (pathlib.Path(folder) / f"{i}.pgm").write_bytes(b"P5\n%d %d\n255\n" % (WIDTH, HEIGHT) + grey.tobytes())
            table = pathlib.Path(folder) / "corners.csv"
            subprocess.run([sys.executable, SCRIPT, folder, "-o", table], check=True, capture_output=True)
            rows = [line.split(",") for line in table.read_text().splitlines()[1:]]
            off = [np.hypot(*(np.array(row[3:5], float) - true[int(row[0])][int(row[2])])) for row in rows]
            wrong = sum(int(row[1]) != TAG for row in rows)
            rms = f"{np.sqrt(np.mean(np.square(off))):.2f} px, {max(off):.2f} at most" if off else "-"
            print(f"{name:30s} {len(rows) // 4} of 8; off by {rms}" + (f"; {wrong} wrong" if wrong else ""), flush=True)


if __name__ == "__main__":
    main()
