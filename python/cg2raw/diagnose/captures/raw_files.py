# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""RAW files as captures: the mosaic of the active area, and its masked borders."""

import os
from dataclasses import dataclass
from typing import Any

import numpy as np

from cg2raw import _core
from cg2raw.arrays import RawImage
from cg2raw.cfa import repeat_of
from cg2raw.diagnose.captures.patch_means import PatchMeans
from cg2raw.io import fits_file, libraw, npy_file
from cg2raw.profile.from_files import is_dng
from cg2raw.sensor import Sensor

# Of a masked border are left out: pixels beside the active area, where light leaks in,
# and those at the edge of the read-out, which is disturbed in a real camera's file
# (Canon EOS 550D: column 151 3 DN and row 25 16 DN too bright, row 6 50 DN dark).
INNER_GUARD, OUTER_GUARD = 4, 8
SMALLEST = 8  # px across a border that is used


@dataclass(frozen=True)
class Area:
    """A rectangle of the stored mosaic, px."""

    name: str  # "active", "left", "top", "right", "bottom"
    top: int
    left: int
    height: int
    width: int


@dataclass(frozen=True)
class RawHeader:
    """What a RAW file says of itself; None: it does not say.

    active, borders : a border begins at a whole repeat of the CFA from the active area.
    black_level : DN, one per CFA site, or one. exposure_time : s. temperature : of the
    sensor, degrees Celsius. electrons_per_dn : inverse of the system gain.
    notes : sentences on what was assumed of the file. means : of a table of patches."""

    path: str
    active: Area
    borders: tuple[Area, ...] = ()
    cfa: str | None = None
    bits: int | None = None
    black_level: tuple[float, ...] | None = None
    white_level: float | None = None
    as_shot: tuple[float, ...] | None = None
    iso: float | None = None
    exposure_time: float | None = None
    temperature: float | None = None
    electrons_per_dn: float | None = None
    notes: tuple[str, ...] = ()
    means: PatchMeans | None = None

    @property
    def shape(self) -> tuple[int, int]:
        """(H, W) of the active area."""
        return self.active.height, self.active.width


def read_header(path: str) -> RawHeader:
    """Return what a DNG, another RAW, FITS or .npy says. Raises ValueError, OSError."""
    if fits_file.is_fits(path):
        return fits_header(path)
    if npy_file.is_npy(path):
        height, width = mapped_npy(path).shape
        return RawHeader(path, Area("active", 0, 0, height, width))
    return dng_header(path) if is_dng(path) else other_header(path)


def fits_header(path: str) -> RawHeader:
    """Return the header of a FITS file; all of its image is the active area."""
    header = fits_file.read_header(path)
    notes = header.notes
    if header.pedestal:
        notes = (*notes, f"a PEDESTAL of {header.pedestal:g} DN is taken off")
    return RawHeader(
        path,
        Area("active", 0, 0, *header.shape),
        cfa=header.cfa,
        exposure_time=header.exposure_time,
        temperature=header.temperature,
        electrons_per_dn=header.electrons_per_dn,
        notes=notes,
    )


def dng_header(path: str) -> RawHeader:
    """Return the header of a DNG: our reader's tags, LibRaw's margins."""
    metadata = _core.read_dng_metadata(path)
    with libraw.opened(path) as raw:
        sizes = raw.sizes
    if [sizes.width, sizes.height] != list(metadata.active_area):
        raise ValueError(
            f"{path}: its active area is {metadata.active_area[0]}x"
            f"{metadata.active_area[1]}, LibRaw's {sizes.width}x{sizes.height}: "
            "convert it with Adobe DNG Converter or dnglab"
        )
    side = repeat_of(metadata.cfa)
    return RawHeader(
        path,
        *areas_of(sizes, side),
        cfa=metadata.cfa,
        bits=metadata.bits,
        black_level=tuple(metadata.black_level),
        white_level=metadata.white_level,
        as_shot=tuple(metadata.as_shot_neutral) if metadata.as_shot_neutral else None,
        iso=metadata.shot["iso"] or None,
        exposure_time=metadata.shot["exposure_time"] or None,
        temperature=libraw.camera_temperature(path),
    )


def other_header(path: str) -> RawHeader:
    """Return the header of a RAW file that is no DNG: LibRaw's and Exif's."""
    with libraw.opened(path) as raw:
        fields, sizes = libraw.fields_of(raw, path), raw.sizes
    neutral = fields["neutral"]
    iso, exposure_time = exif_numbers(path)
    return RawHeader(
        path,
        *areas_of(sizes, repeat_of(fields["cfa"])),
        cfa=fields["cfa"],
        bits=max(8, fields["white_level"].bit_length()),
        black_level=fields["black_level"],
        white_level=fields["white_level"],
        as_shot=(neutral[0], 1.0, neutral[1]) if neutral else None,
        iso=iso,
        exposure_time=exposure_time,
        temperature=libraw.camera_temperature(path),
    )


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


def read_raw(path: str, area: Area) -> RawImage:
    """Return (height, width) uint16 DN of an area. Raises ValueError, OSError."""
    rows = slice(area.top, area.top + area.height)
    cols = slice(area.left, area.left + area.width)
    if fits_file.is_fits(path):
        return fits_file.read_pixels(path)[rows, cols].copy()
    if npy_file.is_npy(path):
        return np.array(mapped_npy(path)[rows, cols])
    with libraw.opened(path) as raw:
        if raw.raw_type.name != "Flat":
            raise ValueError(f"{path}: holds no mosaic; take a camera's RAW")
        plane: RawImage = raw.raw_image[rows, cols].copy()
    if plane.shape != (area.height, area.width):
        raise ValueError(f"{path}: was changed while it was read; start again")
    return plane


def mapped_npy(path: str) -> RawImage:
    """Return an .npy's DN, mapped from the file. Raises ValueError, OSError."""
    plane = npy_file.mapped(path)
    if plane.ndim != 2 or plane.dtype != np.uint16:
        raise ValueError(
            f"{path}: is {plane.shape} {plane.dtype}; must be (H, W) uint16 DN, the "
            "mosaic of the active area"
        )
    return plane


def exif_numbers(path: str) -> tuple[float | None, float | None]:
    """Return (ISO, exposure time in s) of a file's Exif; None where it does not say."""
    tags = libraw.exif_tags(path)
    found: list[float | None] = []
    for name in ("EXIF ISOSpeedRatings", "EXIF ExposureTime"):
        values = getattr(tags.get(name), "values", None) or [0]
        try:
            found.append(float(values[0]) or None)
        except (TypeError, ValueError, ZeroDivisionError):
            found.append(None)
    return found[0], found[1]


def check_sensor(header: RawHeader, sensor: Sensor) -> list[str]:
    """Return notes on levels that differ a little from a sensor's, without the file.

    Raises ValueError for another CFA, bit depth or scale of DN, saying both."""
    name = os.path.basename(header.path)
    for what, ours, theirs in (
        ("CFA", header.cfa, sensor.cfa),
        ("bit depth", header.bits, sensor.bits),
    ):
        if ours is not None and ours != theirs:
            raise ValueError(
                f"{name}: its {what} is {ours}, that of {sensor.id} {theirs}; give "
                "frames of this sensor, or the sensor of these frames"
            )
    notes = list(header.notes)
    if header.white_level is None or header.black_level is None:
        return notes
    black = float(np.mean(sensor.black_level))
    span = sensor.white_level - black
    for what, read, model, most in (
        ("black level", float(np.mean(header.black_level)), black, 0.02),
        ("white level", header.white_level, sensor.white_level, 0.05),
    ):
        words = f"tags say {what} {read:g} DN, {sensor.id} {model:g} DN"
        if abs(read - model) > most * span:
            raise ValueError(
                f"{name}: {words}; they differ by more than {most:.0%} of the range: "
                "give the sensor of these frames"
            )
        if abs(read - model) > 1e-6 * span:
            notes.append(f"{words}; the profile's is used, since it is what is tested")
    return notes
