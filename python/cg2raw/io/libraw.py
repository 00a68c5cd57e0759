# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Camera RAW files: DNGs by our reader, others by LibRaw, and Exif of both."""

import contextlib
import logging
import os
import re
import tempfile
import threading
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from cg2raw import _core
from cg2raw.arrays import RawImage
from cg2raw.cfa import repeat_of
from cg2raw.interrupts import said_to
from cg2raw.io.atomic_file import FilePath
from cg2raw.io.raw_header import Area, RawFile, RawHeader
from cg2raw.system import check_readable

CANON_TEMPERATURE = "MakerNote CameraTemperature"
CANON_UNKNOWN = -128.0  # degrees Celsius: a camera that records none writes 0 for it

_stderr = threading.Lock()  # the process has one; guards _silence


class Silence:
    """Standard error led away from what libraries print, while threads read files."""

    readers = 0
    undo = contextlib.ExitStack()


_silence = Silence()


# Read by our own reader; anything else goes through LibRaw.
DNG_ENDINGS = (".dng", ".gpr", ".tif", ".tiff", "")
# Of a masked border are left out: pixels beside the active area, where light leaks in,
# and those at the edge of the read-out, which is disturbed in a real camera's file
# (Canon EOS 550D: column 151 3 DN and row 25 16 DN too bright, row 6 50 DN dark).
INNER_GUARD, OUTER_GUARD = 4, 8
SMALLEST = 8  # px across a border that is used


def is_dng(path: FilePath) -> bool:
    """Return whether @path is to be read as a DNG, by its name."""
    return os.path.splitext(path)[1].lower() in DNG_ENDINGS


def dng(path: str, image: str | None = None) -> list[RawFile]:
    """Return the frame of a DNG: our reader's tags, LibRaw's margins and pixels."""
    refuse_image(path, image)
    metadata = _core.read_dng_metadata(path)
    with opened(path) as raw:
        sizes = raw.sizes
    if [sizes.width, sizes.height] != list(metadata.active_area):
        raise ValueError(
            f"{path}: its active area is {metadata.active_area[0]}x"
            f"{metadata.active_area[1]}, LibRaw's {sizes.width}x{sizes.height}: "
            "convert it with Adobe DNG Converter or dnglab"
        )
    header = RawHeader(
        path,
        *areas_of(sizes, repeat_of(metadata.cfa)),
        make=metadata.make,
        model=metadata.model,
        cfa=metadata.cfa,
        bits=metadata.bits,
        black_level=tuple(metadata.black_level),
        white_level=metadata.white_level,
        as_shot=tuple(metadata.as_shot_neutral) if metadata.as_shot_neutral else None,
        iso=metadata.shot["iso"] or None,
        exposure_time=metadata.shot["exposure_time"] or None,
        temperature=camera_temperature(path),
    )
    return [RawFile(with_settings(header), lambda levels: plane_of(path))]


def camera_raw(path: str, image: str | None = None) -> list[RawFile]:
    """Return the frame of a RAW file that is no DNG: what LibRaw and Exif say."""
    refuse_image(path, image)
    with opened(path) as raw:
        fields, sizes = fields_of(raw, path), raw.sizes
    make, model = exif_names(path)
    iso, exposure_time = exif_numbers(path)
    header = RawHeader(
        path,
        *areas_of(sizes, repeat_of(fields["cfa"])),
        make=make,
        model=model,
        bits=max(8, fields["white_level"].bit_length()),
        iso=iso,
        exposure_time=exposure_time,
        temperature=camera_temperature(path),
        **fields,
    )
    return [RawFile(with_settings(header), lambda levels: plane_of(path))]


def refuse_image(path: str, image: str | None) -> None:
    """Raise ValueError if one of several images is asked of a file that has one."""
    if image is not None:
        raise ValueError(f"{path}: holds one frame, and no image {image}")


def with_settings(header: RawHeader) -> RawHeader:
    """Return a header with the settings that frames of one sensor share."""
    said = {
        "make": header.make,
        "model": header.model,
        "serial number": f"{exif_tags(header.path).get('EXIF BodySerialNumber', '')}",
        "white level": f"{header.white_level} DN",
    }
    return replace(header, settings={k: v for k, v in said.items() if v})


def plane_of(path: str) -> RawImage:
    """Return (H, W) uint16 DN of all that is stored. Raises ValueError, OSError."""
    with opened(path) as raw:
        if raw.raw_type.name != "Flat":
            raise ValueError(f"{path}: holds no mosaic; take a camera's RAW")
        plane: RawImage = raw.raw_image.copy()
    return plane


def areas_of(sizes: Any, side: int) -> tuple[Area, tuple[Area, ...]]:
    """Return the active area, and the borders that are wide enough to be of use."""
    top, left, height, width = (
        *(sizes.top_margin, sizes.left_margin),
        *(sizes.height, sizes.width),
    )
    below, beyond = top + height, left + width
    candidates = (
        ("left", top, below, OUTER_GUARD, left - INNER_GUARD),
        ("right", top, below, beyond + INNER_GUARD, sizes.raw_width - OUTER_GUARD),
        ("top", OUTER_GUARD, top - INNER_GUARD, left, beyond),
        ("bottom", below + INNER_GUARD, sizes.raw_height - OUTER_GUARD, left, beyond),
    )
    borders = []
    for name, first_row, last_row, first_col, last_col in candidates:
        first_row += (top - first_row) % side
        first_col += (left - first_col) % side
        rows = (last_row - first_row) // side * side
        cols = (last_col - first_col) // side * side
        if min(rows, cols) >= SMALLEST:
            borders.append(Area(name, first_row, first_col, rows, cols))
    return Area("active", top, left, height, width), tuple(borders)


def fields_of(raw: Any, path: FilePath) -> dict[str, Any]:
    """Return the fields of RawHeader that an open rawpy.RawPy knows."""
    if raw.raw_type.name != "Flat" or raw.raw_pattern is None or raw.num_colors != 3:
        raise ValueError(f"{path}: holds no mosaic of R, G and B; take a camera's RAW")
    matrix = raw.rgb_xyz_matrix[:3]
    sites = corner_of(raw)
    black = raw.black_level_per_channel
    known = tuple(float(f"{v:.6g}") for v in matrix.ravel())
    return {
        "cfa": "".join(chr(raw.color_desc[site]) for site in sites),
        "black_level": tuple(float(black[site]) for site in sites),
        "white_level": int(raw.white_level),
        "camera_from_xyz": known if matrix.any() else None,
        "as_shot": neutral_of(raw.camera_whitebalance),
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


def neutral_of(gains: Sequence[float]) -> tuple[float, float, float] | None:
    """Return (R/G, 1, B/G) of white balance gains (R, G, B, ...), None if not recorded.

    LibRaw has 0, or 1 for each channel, where it found no white balance."""
    red, green, blue = gains[:3]
    if min(red, green, blue) <= 0 or red == green == blue:
        return None
    return round(green / red, 6), 1.0, round(green / blue, 6)


@contextlib.contextmanager
def opened(path: FilePath) -> Iterator[Any]:
    """Yield the rawpy.RawPy of a file; threads may have one each.

    Raises ValueError with LibRaw's reason, OSError."""
    import rawpy

    check_readable(path)  # LibRaw's own message names no reason
    try:
        with no_words_of_libraries(), rawpy.imread(os.fspath(path)) as raw:
            yield raw
    except rawpy.LibRawError as error:
        why = error.args[0] if error.args else "unknown error"
        why = why.decode(errors="replace") if isinstance(why, bytes) else why
        hint = "; is it cut off?" if "Input/output" in why else ""
        raise ValueError(f"{path}: LibRaw cannot read it: {why}{hint}") from None


@contextlib.contextmanager
def no_words_of_libraries() -> Iterator[None]:
    """Keep what LibRaw prints to stderr by itself, while any thread is in the block;
    its errors arrive as exceptions."""
    with _stderr:
        if not _silence.readers:
            _silence.undo = led_away()
        _silence.readers += 1
    try:
        yield
    finally:
        with _stderr:
            _silence.readers -= 1
            if not _silence.readers:
                _silence.undo.close()


def led_away() -> contextlib.ExitStack:
    """Lead standard error to a file that nobody reads; return what undoes it."""
    with contextlib.ExitStack() as end:
        words = end.enter_context(tempfile.TemporaryFile())
        kept = os.dup(2)
        end.callback(os.close, kept)
        end.enter_context(said_to(kept))
        os.dup2(words.fileno(), 2)
        end.callback(os.dup2, kept, 2)
        return end.pop_all()


def exif_names(path: FilePath) -> tuple[str, str]:
    """Return (make, model) of a file's Exif; empty where it has none."""
    tags = exif_tags(path)
    make, model = (
        str(tags.get(f"Image {name}", "")).strip(" \0") for name in ("Make", "Model")
    )
    return make, model


def exif_numbers(path: str) -> tuple[float | None, float | None]:
    """Return (ISO, exposure time in s) of a file's Exif; None where it does not say."""
    tags = exif_tags(path)
    found: list[float | None] = []
    for name in ("EXIF ISOSpeedRatings", "EXIF ExposureTime"):
        values = getattr(tags.get(name), "values", None) or [0]
        try:
            found.append(float(values[0]) or None)
        except (TypeError, ValueError, ZeroDivisionError):
            found.append(None)
    return found[0], found[1]


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
