#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""examples/detect_tags.py finds the corners of a tag that is drawn in perspective, in the order of the table of corners.
Skipped (77) where libapriltag3 or NumPy is not installed."""
import ctypes
import pathlib
import subprocess
import sys
import tempfile

SCRIPT = pathlib.Path(__file__).resolve().parents[1] / "examples" / "detect_tags.py"
try:
    import numpy as np
    UTILS = ctypes.CDLL("libapriltag-utils.so.3", mode=ctypes.RTLD_GLOBAL)
    LIBRARY = ctypes.CDLL("libapriltag.so.3")
except (ImportError, OSError) as error:
    print(f"skipped: {error}")
    sys.exit(77)
sys.path.insert(0, str(SCRIPT.parent))
from detect_tags import Image  # noqa: E402, pylint: disable=wrong-import-position

WIDTH, HEIGHT = 640, 480
TO_PIXELS = np.array([[24.0, 4.0, 200.0], [-3.0, 26.0, 120.0], [0.01, 0.004, 1.0]])  # from cells of the tag, y down


def cells(tag):
    LIBRARY.tag36h11_create.restype = ctypes.c_void_p
    LIBRARY.apriltag_to_image.restype = ctypes.POINTER(Image)
    image = LIBRARY.apriltag_to_image(ctypes.c_void_p(LIBRARY.tag36h11_create()), tag).contents
    return np.array([[image.buf[y * image.stride + x] for x in range(image.width)] for y in range(image.height)])


def drawn(tag):
    grey, parts = np.zeros((HEIGHT, WIDTH)), (0.25, 0.75)
    for dx in parts:
        for dy in parts:
            u, v = np.meshgrid(np.arange(WIDTH) + dx, np.arange(HEIGHT) + dy)
            at = np.linalg.solve(TO_PIXELS, np.stack([u.ravel(), v.ravel(), np.ones(u.size)]))
            x, y = np.floor(at[:2] / at[2]).astype(int)
            of = cells(tag)
            inside = (x >= 0) & (x < of.shape[1]) & (y >= 0) & (y < of.shape[0])
            grey += np.where(inside, of[y.clip(0, 9), x.clip(0, 9)], 140.0).reshape(grey.shape)
    return (grey / 4).astype(np.uint8)


with tempfile.TemporaryDirectory() as folder:
    images = pathlib.Path(folder) / "images"
    images.mkdir()
    (images / "f1.pgm").write_bytes(b"P5\n%d %d\n255\n" % (WIDTH, HEIGHT) + drawn(7).tobytes())
    table = pathlib.Path(folder) / "corners.csv"
    subprocess.run([sys.executable, SCRIPT, images, "-o", table], check=True)
    lines = table.read_text().splitlines()
    assert lines[0] == "frame,tag,corner,u,v" and len(lines) == 5, lines
    for k, (x, y) in enumerate([(1, 9), (9, 9), (9, 1), (1, 1)]):  # counterclockwise from below left
        place = TO_PIXELS @ [x, y, 1.0]
        frame, name, corner, *pixels = lines[1 + k].split(",")
        assert (frame, name, corner) == ("f1", "7", str(k)), lines[1 + k]
        off = np.hypot(*(np.array(pixels, float) - place[:2] / place[2]))
        assert off < 0.15, (lines[1 + k], off)  # px; at such edges, a tenth is usual
    said = subprocess.run([sys.executable, SCRIPT, images, "-o", table, "--tags", "8"], check=True, capture_output=True, text=True)
    assert len(table.read_text().splitlines()) == 1
    assert said.stderr.startswith("no tag of these in 1 images: f1.pgm"), said.stderr
    # Two prints of one tag are ambiguous. A bar across a tag hides it.
    grey = drawn(7)
    half = grey[::2, ::2]
    (images / "f2.pgm").write_bytes(b"P5\n%d %d\n255\n" % (WIDTH, HEIGHT // 2) + np.hstack([half, half]).tobytes())
    bar = grey.copy()
    bar[:, 320:345] = 90
    (images / "f3.pgm").write_bytes(b"P5\n%d %d\n255\n" % (WIDTH, HEIGHT) + bar.tobytes())
    said = subprocess.run([sys.executable, SCRIPT, images, "-o", table], check=True, capture_output=True, text=True)
    assert len(table.read_text().splitlines()) == 5
    assert said.stdout.startswith("1 tags in 3 images; tags 7"), said.stdout
    assert "tag 7 is there twice, and left out, in 1 images: f2.pgm\n" in said.stderr, said.stderr
    assert "no tag in 2 images: f2.pgm, f3.pgm" in said.stderr, said.stderr
print("corners found")
