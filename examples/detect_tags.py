#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Finds AprilTags in a folder of images, and writes the table of corners that `elastocal calibrate` reads.

  examples/detect_tags.py IMAGES -o corners.csv [--family tag36h11] [--tags 7 9] [--camera NAME]

Needs the package libapriltag3. It reads PNM and baseline JPEG itself; other images are read by Pillow, where that is installed.
`frame` is the name of the image without its ending: the column `frame` of the table of observations says which row it belongs to.
Pixels count from the upper left corner of the image, so that the centre of the first pixel is at 0.5; images of a camera's own
calibration by other tools may have it at 0 (half a pixel of centre_px).

Corners of sharp images are off by 0.1 px, with noise and lenses that bend as well. Of tags with a covered corner, or that are
blurred by half a cell, the few that are found at all are off by 1 px: take these images out.
"""

import argparse
import ctypes
import pathlib
import sys

FAMILIES = ("tag36h11", "tag25h9", "tag16h5", "tagStandard41h12", "tagStandard52h13", "tagCircle21h7", "tagCircle49h12")
JPEG, PNM = (".jpg", ".jpeg"), (".pgm", ".ppm", ".pnm")
MOST_WRONG_BITS = 1  # with more, it is often no tag


class Image(ctypes.Structure):
    _fields_ = [("width", ctypes.c_int32), ("height", ctypes.c_int32), ("stride", ctypes.c_int32),
                ("buf", ctypes.POINTER(ctypes.c_uint8))]


class Array(ctypes.Structure):
    _fields_ = [("element_size", ctypes.c_size_t), ("size", ctypes.c_int), ("room", ctypes.c_int),
                ("data", ctypes.POINTER(ctypes.c_void_p))]


class Detection(ctypes.Structure):
    _fields_ = [("family", ctypes.c_void_p), ("id", ctypes.c_int), ("wrong_bits", ctypes.c_int), ("margin", ctypes.c_float),
                ("homography", ctypes.c_void_p), ("centre", ctypes.c_double * 2), ("corners", ctypes.c_double * 2 * 4)]


class DetectorHead(ctypes.Structure):
    """The first fields of a detector."""
    _fields_ = [("threads", ctypes.c_int), ("decimate", ctypes.c_float)]


class Detector:
    def __init__(self, family):
        try:
            self.files = ctypes.CDLL("libapriltag-utils.so.3", mode=ctypes.RTLD_GLOBAL)
            self.library = library = ctypes.CDLL("libapriltag.so.3")
        except OSError as error:
            raise SystemExit(f"{error}: the package libapriltag3 was expected") from error
        self.files.image_u8_create.restype = self.files.image_u8_create_from_pnm.restype = ctypes.POINTER(Image)
        self.files.pjpeg_create_from_file.restype = ctypes.c_void_p
        self.files.pjpeg_to_u8_baseline.restype = ctypes.POINTER(Image)
        getattr(library, family + "_create").restype = ctypes.c_void_p
        library.apriltag_detector_create.restype = ctypes.POINTER(DetectorHead)
        library.apriltag_detector_detect.restype = ctypes.POINTER(Array)
        self.detector = library.apriltag_detector_create()
        self.detector.contents.decimate = 1.0  # use all pixels for corners
        library.apriltag_detector_add_family_bits(self.detector, ctypes.c_void_p(getattr(library, family + "_create")()),
                                                  MOST_WRONG_BITS)

    def read(self, file):
        image = None
        if file.suffix.lower() in PNM:
            image = self.files.image_u8_create_from_pnm(str(file).encode())
        elif file.suffix.lower() in JPEG:
            error = ctypes.c_int(0)
            jpeg = self.files.pjpeg_create_from_file(str(file).encode(), 0, ctypes.byref(error))
            image = self.files.pjpeg_to_u8_baseline(ctypes.c_void_p(jpeg)) if jpeg and error.value == 0 else None
        return image or self.read_by_pillow(file)

    def read_by_pillow(self, file):
        try:
            import PIL.Image  # pylint: disable=import-outside-toplevel
        except ImportError as error:
            raise SystemExit(f"{file}: is neither PNM nor baseline JPEG; other images need Pillow (package python3-pil)") from error
        grey = PIL.Image.open(file).convert("L")
        image = self.files.image_u8_create(*grey.size)
        pixels, stride = grey.tobytes(), image.contents.stride
        for row in range(grey.height):
            ctypes.memmove(ctypes.addressof(image.contents.buf.contents) + row * stride,
                           pixels[row * grey.width:(row + 1) * grey.width], grey.width)
        return image

    def tags(self, file):
        """By tag its four corners (u, v), from below left of the upright tag counterclockwise; and the tags that are there
        twice, which tell nothing and are left out."""
        image = self.read(file)
        found = self.library.apriltag_detector_detect(self.detector, image)
        tags, twice = {}, set()
        for i in range(found.contents.size):
            one = ctypes.cast(found.contents.data[i], ctypes.POINTER(Detection)).contents
            if one.id in tags:
                twice.add(one.id)
            tags[one.id] = [tuple(corner) for corner in one.corners]
        self.library.apriltag_detections_destroy(found)
        self.files.image_u8_destroy(image)
        return {tag: corners for tag, corners in tags.items() if tag not in twice}, twice


def named(files):
    return ", ".join(file.name for file in files[:5]) + (f" and {len(files) - 5} more" if len(files) > 5 else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("images", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--family", choices=FAMILIES, default="tag36h11")
    parser.add_argument("--tags", type=int, nargs="+", help="the others are passed over")
    parser.add_argument("--camera", help="its name in the project, where that has several")
    arguments = parser.parse_args()
    detector = Detector(arguments.family)
    files = sorted(file for file in arguments.images.glob("*") if file.is_file() and not file.name.startswith("."))
    if not files:
        sys.exit(f"{arguments.images}: there are no images in this folder")
    rows, seen, without, doubled = [], set(), [], {}
    for file in files:
        if any(file.stem == other.stem for other in files if other is not file):
            sys.exit(f"{file}: another image has the same name but for its ending")
        tags, twice = detector.tags(file)
        wanted = {tag for tag in tags if not arguments.tags or tag in arguments.tags}
        for tag in twice:
            doubled.setdefault(tag, []).append(file)
        if not wanted:
            without.append(file)
        for tag, corners in sorted(tags.items()):
            if tag not in wanted:
                continue
            seen.add(tag)
            for k, (u, v) in enumerate(corners):
                rows.append([file.stem, str(tag), str(k), f"{u:.4f}", f"{v:.4f}"] + ([arguments.camera] if arguments.camera else []))
    header = ["frame", "tag", "corner", "u", "v"] + (["camera"] if arguments.camera else [])
    arguments.output.write_text("".join(",".join(row) + "\n" for row in [header, *rows]))
    print(f"{len(rows) // 4} tags in {len(files)} images" + (f"; tags {', '.join(map(str, sorted(seen)))}" if seen else ""))
    for tag, of in sorted(doubled.items()):
        print(f"tag {tag} is there twice, and left out, in {len(of)} images: {named(of)}", file=sys.stderr)
    if without:
        print(f"no tag{' of these' if arguments.tags else ''} in {len(without)} images: {named(without)} (another family, "
              "covered at its rim or across, less than 2 pixels a cell, or blurred by half a cell?)", file=sys.stderr)


if __name__ == "__main__":
    main()
