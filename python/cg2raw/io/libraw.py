# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Metadata of a RAW file that is no DNG, from LibRaw and Exif."""

import contextlib
import logging
import os
import re
import tempfile
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from cg2raw.interrupts import said_to
from cg2raw.io.atomic_file import FilePath
from cg2raw.system import check_readable

CANON_TEMPERATURE = "MakerNote CameraTemperature"
CANON_UNKNOWN = -128.0  # degrees Celsius: a camera that records none writes 0 for it
REMEDY = "convert it with Adobe DNG Converter or dnglab, then give the DNG"

_stderr = threading.Lock()  # the process has one, and no_words_of_libraries moves it


@dataclass(frozen=True)
class RawFile:
    """One RAW file as LibRaw reads it."""

    path: str
    make: str
    model: str
    cfa: str  # letters of the sites, phase of the visible area's corner
    width: int  # visible area
    height: int
    black_level: tuple[float, ...]  # DN, one per CFA site
    white_level: int  # DN
    camera_from_xyz: tuple[float, ...]  # 9 numbers, row major, for D65
    neutral: tuple[float, float] | None  # (R/G, B/G) as shot; None: not recorded


def read_raw_file(path: FilePath, make: str = "", model: str = "") -> RawFile:
    """Return the RawFile at @path.

    make, model : stand in for those of its Exif.
    Raises ValueError that says what is missing and what to do, OSError."""
    with opened(path) as raw:
        fields = fields_of(raw, path)
    exif_make, exif_model = ("", "") if make and model else exif_names(path)
    make, model = make or exif_make, model or exif_model
    if not (make and model):
        raise ValueError(
            f"{path}: its Exif names no camera: give --make and --model, or {REMEDY}"
        )
    return RawFile(path=os.fspath(path), make=make, model=model, **fields)


def fields_of(raw: Any, path: FilePath) -> dict[str, Any]:
    """Return the fields of RawFile that an open rawpy.RawPy knows."""
    if raw.raw_type.name != "Flat" or raw.raw_pattern is None or raw.num_colors != 3:
        raise ValueError(f"{path}: holds no mosaic of R, G and B; take a camera's RAW")
    matrix = raw.rgb_xyz_matrix[:3]
    if not matrix.any():
        raise ValueError(
            f"{path}: LibRaw has no colour matrix of this camera: {REMEDY}"
        )
    sites = corner_of(raw)
    black = raw.black_level_per_channel
    return {
        "cfa": "".join(chr(raw.color_desc[site]) for site in sites),
        "width": int(raw.sizes.width),
        "height": int(raw.sizes.height),
        "black_level": tuple(float(black[site]) for site in sites),
        "white_level": int(raw.white_level),
        "camera_from_xyz": tuple(float(f"{v:.6g}") for v in matrix.ravel()),
        "neutral": neutral_of(raw.camera_whitebalance),
    }


def corner_of(raw: Any) -> list[int]:
    """Return LibRaw's colour indices of the repeat at the visible area's corner."""
    rows, columns = raw.raw_pattern.shape
    top, left = raw.sizes.top_margin, raw.sizes.left_margin
    return [
        int(raw.raw_color(top + row, left + column))
        for row in range(rows)
        for column in range(columns)
    ]


def neutral_of(gains: Sequence[float]) -> tuple[float, float] | None:
    """Return (R/G, B/G) of white balance gains (R, G, B, ...), None if not recorded.

    LibRaw has 0, or 1 for each channel, where it found no white balance."""
    red, green, blue = gains[:3]
    if min(red, green, blue) <= 0 or red == green == blue:
        return None
    return round(green / red, 6), round(green / blue, 6)


@contextlib.contextmanager
def opened(path: FilePath) -> Iterator[Any]:
    """Yield the rawpy.RawPy of a file, one at a time.

    Raises ValueError with LibRaw's reason, OSError."""
    import rawpy

    check_readable(path)  # LibRaw's own message names no reason
    try:
        with _stderr, no_words_of_libraries(), rawpy.imread(os.fspath(path)) as raw:
            yield raw
    except rawpy.LibRawError as error:
        why = error.args[0] if error.args else "unknown error"
        why = why.decode(errors="replace") if isinstance(why, bytes) else why
        hint = "; is it cut off?" if "Input/output" in why else ""
        raise ValueError(f"{path}: LibRaw cannot read it: {why}{hint}") from None


@contextlib.contextmanager
def no_words_of_libraries() -> Iterator[None]:
    """Keep what LibRaw prints to stderr by itself; its errors arrive as exceptions."""
    with tempfile.TemporaryFile() as words:
        kept = os.dup(2)
        try:
            with said_to(kept):
                os.dup2(words.fileno(), 2)
                yield
        finally:
            os.dup2(kept, 2)
            os.close(kept)


def exif_names(path: FilePath) -> tuple[str, str]:
    """Return (make, model) of a file's Exif; empty where it has none."""
    tags = exif_tags(path)
    make, model = (
        str(tags.get(f"Image {name}", "")).strip(" \0") for name in ("Make", "Model")
    )
    return make, model


def camera_temperature(path: FilePath) -> float | None:
    """Return the temperature inside a Canon, degrees Celsius; None if not recorded.

    Exif's own AmbientTemperature is that of the air, which no sensor has."""
    text = str(exif_tags(path, maker_note=True).get(CANON_TEMPERATURE, ""))
    found = re.fullmatch(r"(-?\d+) C", text)
    degrees = float(found[1]) if found else CANON_UNKNOWN
    return None if degrees == CANON_UNKNOWN else degrees


def exif_tags(path: FilePath, maker_note: bool = False) -> dict[str, Any]:
    """Return {name: tag} of a file's Exif, as ExifRead names them.

    maker_note : also what makers of cameras add in their own way."""
    import exifread

    logging.getLogger("exifread").setLevel(logging.CRITICAL)
    with open(path, "rb") as file:
        try:
            return exifread.process_file(file, details=maker_note)
        except Exception:  # ExifRead lets any exception out on a damaged file
            return {}
