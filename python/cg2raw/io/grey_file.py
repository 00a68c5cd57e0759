# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""RAW frames in grey PNG, TIFF and PGM files, as machine-vision cameras are saved.

Their words are DN as they are stored, whatever curve or colour space a file names.
Sources: TIFF 6.0, Adobe, 1992; netpbm, "pgm", https://netpbm.sourceforge.net/doc/pgm.html.
"""

import math
import os
import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.arrays import RawImage
from cg2raw.io import image_file
from cg2raw.io.libraw import exif_tags
from cg2raw.io.raw_header import Area, RawFile, RawHeader, whole_dn
from cg2raw.oiio.openimageio import one_line
from cg2raw.system import check_readable

ENDINGS = (".png", ".tif", ".tiff", ".pgm")
DNG_VERSION = ("Image Tag 0xC612", "Image DNGVersion")  # as ExifRead names 50706
WORD = 16  # bits; OpenImageIO widens words of 9 to 15 bits to these
BYTE = 8
MIN_IS_WHITE = 0  # PhotometricInterpretation
PGM = re.compile(
    rb"P5(?:\s|#[^\n]*\n)+(\d+)(?:\s|#[^\n]*\n)+(\d+)(?:\s|#[^\n]*\n)+(\d+)\s"
)
LONGEST_HEAD = 4096  # bytes, of a PGM with comments


def is_grey(path: str) -> bool:
    """Return whether a file is a PNG, TIFF or PGM, by its name; no TIFF that is a DNG.

    Raises OSError."""
    ending = os.path.splitext(path)[1].lower()
    if ending in (".tif", ".tiff"):
        check_readable(path)
        return not exif_tags(path).keys() & set(DNG_VERSION)
    return ending in ENDINGS


def frames(path: str, image: str | None = None) -> list[RawFile]:
    """Return the frames of a file: its one picture, or each page of a TIFF.

    image : number of a page, from 0 on. Raises ValueError, OSError."""
    if path.lower().endswith(".pgm"):
        if image not in (None, "0"):
            raise ValueError(f"{path}: holds one frame, and no image {image}")
        return [pgm(path)]
    with image_file.opened(path) as source:
        specs = image_file.specs_of(source)
    pages = chosen_pages(path, specs, image)
    base = os.path.basename(path)
    return [
        page(path, specs[n], n, f"{base}[{n}]" if len(specs) > 1 else "") for n in pages
    ]


def chosen_pages(path: str, specs: list[Any], image: str | None) -> list[int]:
    """Return the numbers of the pages that are frames. Raises ValueError."""
    sizes = [f"{spec.width}x{spec.height}" for spec in specs]
    if image is not None:
        if not image.isdecimal() or int(image) >= len(specs):
            raise ValueError(
                f"{path}: has no page {image}; it has {len(specs)}, from 0 on"
            )
        return [int(image)]
    if len(set(sizes)) > 1:
        raise ValueError(
            f"{path}: its pages are {', '.join(sizes)}; frames have one size: choose "
            "one (--image 0)"
        )
    return list(range(len(specs)))


def page(path: str, spec: Any, number: int, frame: str) -> RawFile:
    """Return one page as a frame. Raises ValueError for a picture in colour."""
    if spec.nchannels != 1:
        raise ValueError(
            f"{path}: has {spec.nchannels} channels ({', '.join(spec.channelnames)}), "
            "or a palette; a frame is grey: one channel of DN, as the camera took it"
        )
    stored = spec.get_int_attribute("oiio:BitsPerSample", 0)
    wider = WORD - stored if str(spec.format) == "uint16" and stored else 0

    def read(levels: object) -> RawImage:
        with image_file.opened(path) as source:
            words = source.read_image(number, 0, 0, 1, spec.format)
            if words is None:
                raise ValueError(f"{path}: {one_line(source.geterror())}")
        plane = np.reshape(words, (spec.height, spec.width))
        if wider:
            plane = plane >> wider
        return as_words(path, plane)

    notes = []
    if spec.get_int_attribute("tiff:PhotometricInterpretation", 1) == MIN_IS_WHITE:
        notes.append("says that 0 is white; its words are taken as they are stored")
    header = RawHeader(
        path,
        Area("active", 0, 0, spec.height, spec.width),
        frame=frame,
        make=spec.get_string_attribute("Make"),
        model=spec.get_string_attribute("Model"),
        bits=BYTE if str(spec.format) == "uint8" else None,
        depth=stored if wider else None,
        iso=stated(spec, "Exif:PhotographicSensitivity"),
        exposure_time=stated(spec, "ExposureTime"),
        notes=tuple(notes),
    )
    return RawFile(header, read)


def as_words(path: str, plane: NDArray[Any]) -> RawImage:
    """Return uint16 of DN. Raises ValueError for what is none."""
    if plane.dtype.kind == "u" and plane.dtype.itemsize <= 2:
        return plane.astype(np.uint16)
    return whole_dn(path, plane).astype(np.uint16)


def stated(spec: Any, name: str) -> float | None:
    """Return a number of Exif, or of a PNG's text, None if there is none."""
    try:
        value = float(spec.getattribute(name))
    except (TypeError, ValueError):
        return None
    return value if math.isfinite(value) and value > 0 else None


def pgm(path: str) -> RawFile:
    """Return the frame of a binary PGM, which OpenImageIO would scale to 16 bits.

    Raises ValueError, OSError."""
    check_readable(path)
    with open(path, "rb") as file:
        found = PGM.match(file.read(LONGEST_HEAD))
    if not found:
        raise ValueError(f"{path}: is no binary PGM (P5): save it as one, or as TIFF")
    width, height, most = map(int, found.groups())
    kind = np.dtype("u1" if most < 1 << BYTE else ">u2")
    if min(width, height) < 1 or not 0 < most < 1 << WORD:
        raise ValueError(f"{path}: is {width}x{height}, its largest word {most}")
    size = found.end() + width * height * kind.itemsize
    if os.path.getsize(path) < size:
        raise ValueError(f"{path}: is cut off: it must have {size} bytes")

    def read(levels: object) -> RawImage:
        plane = np.memmap(path, kind, "r", found.end(), (height, width))
        return plane.astype(np.uint16)

    header = RawHeader(
        path,
        Area("active", 0, 0, height, width),
        bits=BYTE if kind.itemsize == 1 else None,
        depth=most.bit_length(),
    )
    return RawFile(header, read)
