# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""RAW frames in FITS files, as astronomical and industrial cameras write them.

Standard: FITS 4.0, IAU FITS Working Group, 2018. What cameras add to it (CCD-TEMP,
EGAIN, PEDESTAL, ISOSPEED, READOUTM): SBIG, SBFITSEXT 1.0, 2003, and Diffraction
Limited, MaxIm DL, "FITS File Header Definitions"; OFFSET, CAMERAID: N.I.N.A.'s manual;
BLKLEVEL, BITDEPTH: SharpCap's; ROWORDER and BAYERPAT: Siril's documentation.
"""

import math
import os
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.arrays import RawImage
from cg2raw.io.fits_images import (
    Cards,
    check_length,
    chosen_images,
    name_of,
    opened,
)
from cg2raw.io.fits_sections import (
    Part,
    joined,
    parts_of,
    placed_on_sensor,
    size_of,
)
from cg2raw.io.raw_header import Area, Levels, RawFile, RawHeader, whole_dn

ENDINGS = (".fits", ".fit", ".fts", ".fits.gz", ".fit.gz", ".fts.gz", ".fits.fz")
EXPOSURES = ("EXPTIME", "EXPOSURE")  # s; the first that is there counts
TEMPERATURES = ("CCD-TEMP", "SET-TEMP")  # degrees Celsius; measured before wanted
ISOS = ("ISOSPEED", "ISO")
# What changes the numbers of a frame: gain, offset, read-out, binning, camera.
SETTINGS = (
    *("EGAIN", "GAIN", *ISOS, "OFFSET", "BLKLEVEL", "READOUTM", "BITDEPTH"),
    *("XBINNING", "YBINNING", "CCDSUM", "INSTRUME", "CAMERAID", "SERIAL"),
)
ROW_ORDERS = ("TOP-DOWN", "BOTTOM-UP")
COLOURS = 3  # planes of a picture in colour, which no keyword tells from three frames
# A comment by which GAIN, else a setting of the camera, is in electrons.
IN_ELECTRONS = re.compile(r"\be(lectrons?|-)?\s*(/|per)", re.IGNORECASE)


def is_fits(path: str) -> bool:
    """Return whether a file is a FITS file, by its name."""
    return path.lower().endswith(ENDINGS)


def frames(path: str, image: str | None = None) -> list[RawFile]:
    """Return the frames of a FITS file: of one image, or of those that make a picture.

    image : EXTNAME, or EXTNAME,EXTVER, or the number of an image, 0 the primary one;
    "all" for those that amplifiers read, put together by DETSEC.
    Raises ValueError for a file that holds no frame, is cut off, or has several images
    of which it is not clear which is the frame; OSError."""
    parts: list[Part] = []
    with opened(path) as file:
        chosen, others = chosen_images(path, file, image)
        notes = [others] if others else []
        counts = set()
        for number in chosen:
            hdu, cards = file[number], Cards(file[number], file[0])
            check_length(path, hdu)
            count, shape = _shape(path, hdu)
            found, more = parts_of(path, number, name_of(number, hdu), cards, shape)
            if len(chosen) > 1:
                found = [placed_on_sensor(path, part, cards, shape) for part in found]
            parts += found
            notes += [note for note in more if note not in notes]
            counts.add(count)
        if len(counts) > 1:
            raise ValueError(f"{path}: its images have different numbers of frames")
        cards_of = {n: Cards(file[n], file[0]) for n in chosen}
        header = _header(path, list(cards_of.values()), parts, notes)
    if count == 1:
        return [RawFile(header, _reader(path, parts, 0, cards_of))]
    base = os.path.basename(path)
    return [
        RawFile(
            replace(header, frame=f"{base}[{index}]"),
            _reader(path, parts, index, cards_of),
        )
        for index in range(count)
    ]


def _header(
    path: str, all_cards: Sequence[Cards], parts: Sequence[Part], notes: list[str]
) -> RawHeader:
    """Return what the headers of the images that make a frame say."""
    cards = all_cards[0]
    if pedestal := _pedestal(path, cards):
        notes.append(f"a PEDESTAL of {pedestal:g} DN is taken off")
    if overscan := [p.overscan.keyword for p in parts if p.overscan]:
        notes.append(
            f"the mean of the overscan ({', '.join(dict.fromkeys(overscan))}) is its "
            "bias, and moved to the profile's black level, by whole DN"
        )
    gains = {_electrons_per_dn(path, each) for each in all_cards}
    if len(parts) > 1:
        names = ", ".join(part.name for part in parts)
        words = ", ".join(f"{gain:g}" for gain in sorted(filter(None, gains)))
        stated = f", though headers say {words} electrons per DN"
        notes.append(
            f"is put together of {names}, as if they had one gain"
            + (stated if len(gains) > 1 else "")
        )
    depth, iso = _number(path, cards, ("BITDEPTH",), 1.0), _number(path, cards, ISOS)
    settings = {
        name: ", ".join(dict.fromkeys(_text(each.get(name)) for each in all_cards))
        for name in SETTINGS
        if name in cards
    }
    return RawHeader(
        path,
        Area("active", 0, 0, *size_of(path, parts)),
        model=str(cards.get("INSTRUME", "")),
        cfa=_cfa(cards, _order(path, cards), parts),
        depth=None if depth is None else int(depth),
        iso=iso or None,
        exposure_time=_number(path, cards, EXPOSURES, least=0.0),
        temperature=_number(path, cards, TEMPERATURES, least=-273.15),
        electrons_per_dn=gains.pop() if len(gains) == 1 else None,
        settings=settings,
        notes=tuple(notes),
    )


def _reader(
    path: str, parts: Sequence[Part], index: int, cards_of: dict[int, Cards]
) -> Callable[[Levels | None], RawImage]:
    """Return what reads one frame: (levels) -> (H, W) uint16, top row first."""
    first = next(iter(cards_of.values()))
    bottom_up = _order(path, first) == ROW_ORDERS[1]
    pedestal = _pedestal(path, first)

    def read(levels: Levels | None) -> RawImage:
        with opened(path) as file:
            planes = {n: _plane(path, file[n], index, pedestal) for n in cards_of}
        dn = joined(path, parts, lambda part: planes[part.hdu], levels)
        return np.ascontiguousarray(dn[::-1] if bottom_up else dn, np.uint16)

    return read


def _plane(path: str, hdu: Any, index: int, pedestal: float) -> NDArray[np.float64]:
    """Return (H, W) whole DN of one frame of an image, as it is stored."""
    try:
        if len(hdu.shape) == 3 and hdu.shape[0] > 1:
            stored = np.asarray(hdu.section[index])
        else:
            stored = np.asarray(hdu.data).reshape(-1, *hdu.shape[-2:])[index]
    except (ValueError, TypeError, EOFError, OSError) as error:
        raise ValueError(f"{path}: its image cannot be read: {error}") from None
    return whole_dn(path, stored, pedestal)


def _shape(path: str, image: Any) -> tuple[int, tuple[int, int]]:
    """Return (frames, (H, W)) of an image. Raises ValueError."""
    *planes, height, width = (1, *image.shape) if len(image.shape) > 1 else (0, 0, 0)
    count = math.prod(planes)
    if count in (0, COLOURS) or min(height, width) < 1:
        size = "x".join(str(n) for n in reversed(image.shape))
        what = f"{count} frames of {width}x{height}" if count > 1 else "no picture"
        raise ValueError(
            f"{path}: its image is {size}, {what}; must be one frame: save each as a "
            "file of its own"
        )
    return count, (height, width)


def _order(path: str, cards: Cards) -> str:
    """Return which row of a picture is stored first. Raises ValueError."""
    order = str(cards.get("ROWORDER", ROW_ORDERS[0])).strip().upper()
    if order not in ROW_ORDERS:
        raise ValueError(
            f'{path}: ROWORDER is "{order}"; must be {" or ".join(ROW_ORDERS)}'
        )
    return order


def _pedestal(path: str, cards: Cards) -> float:
    """Return what the camera or a program added to all pixels, DN."""
    return abs(_number(path, cards, ("PEDESTAL",)) or 0.0)


def _text(value: Any) -> str:
    """Return a value as messages have it: 1.0 and 1 are the same setting."""
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return f"{value:g}" if is_number else str(value).strip()


def _number(
    path: str, cards: Cards, names: Sequence[str], least: float = -math.inf
) -> float | None:
    """Return the first of some keywords, None if there is none. Raises ValueError."""
    for name in names:
        value = cards.get(name)
        if value is None:
            continue
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = math.nan
        if isinstance(value, bool) or not (math.isfinite(number) and number >= least):
            bound = f", at least {least:g}" if math.isfinite(least) else ""
            raise ValueError(f"{path}: {name} is {value!r}; must be a number{bound}")
        return number
    return None


def _electrons_per_dn(path: str, cards: Cards) -> float | None:
    """Return EGAIN, or a GAIN whose comment says that it is in electrons."""
    names = ["EGAIN"]
    if IN_ELECTRONS.search(cards.comment("GAIN")):
        names.append("GAIN")
    return _number(path, cards, names, least=0.0) or None


def _cfa(cards: Cards, order: str, parts: Sequence[Part]) -> str | None:
    """Return the CFA at the top left; None where programs do not agree what the header
    means, which is so for pictures that are stored bottom up."""
    pattern = str(cards.get("BAYERPAT", "")).strip().upper()
    if order != ROW_ORDERS[0] or sorted(pattern) != sorted("RGGB") or len(parts) > 1:
        return None
    try:
        down, right = (int(cards.get(f"{axis}BAYROFF", 0)) for axis in "YX")
    except (TypeError, ValueError):
        return None
    down, right = down + parts[0].picture.top, right + parts[0].picture.left
    rows = pattern[:2], pattern[2:]
    return "".join(
        rows[(row + down) % 2][(col + right) % 2] for row in (0, 1) for col in (0, 1)
    )
