# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""RAW frames in FITS files, as astronomical and industrial cameras write them.

Standard: FITS 4.0, IAU FITS Working Group, 2018. What cameras add to it (CCD-TEMP,
EGAIN, PEDESTAL): SBIG, SBFITSEXT 1.0, 2003, and Diffraction Limited, MaxIm DL, "FITS
File Header Definitions"; ROWORDER and BAYERPAT: Siril's documentation.
"""

import math
import os
import re
import threading
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.arrays import RawImage
from cg2raw.io.raw_header import Area, RawFile, RawHeader
from cg2raw.system import check_readable

MISSING = "astropy, which reads FITS files, is missing: pip install 'cg2raw[fits]'"
ENDINGS = (".fits", ".fit", ".fts", ".fits.gz", ".fit.gz", ".fts.gz", ".fits.fz")
MOST_DN = 65535
EXPOSURES = ("EXPTIME", "EXPOSURE")  # s; the first that is there counts
TEMPERATURES = ("CCD-TEMP", "SET-TEMP")  # degrees Celsius; measured before wanted
ROW_ORDERS = ("TOP-DOWN", "BOTTOM-UP")
# A comment by which GAIN, else a setting of the camera, is in electrons.
IN_ELECTRONS = re.compile(r"\be(lectrons?|-)?\s*(/|per)", re.IGNORECASE)

_warnings = threading.Lock()  # the process has one list of filters of warnings


@dataclass(frozen=True)
class FitsHeader:
    """What the header of a FITS file says of its frame; None: it does not say.

    shape : (H, W). exposure_time : s. temperature : of the sensor, degrees Celsius.
    electrons_per_dn : system gain, inverse. pedestal : DN, that the camera or a program
    added to all pixels. bottom_up : the last row of the picture is stored first.
    cfa : letters of the sites, phase of the top left pixel. notes : what was ignored.
    """

    shape: tuple[int, int]
    exposure_time: float | None
    temperature: float | None
    electrons_per_dn: float | None
    pedestal: float
    bottom_up: bool
    cfa: str | None
    notes: tuple[str, ...] = ()


def is_fits(path: str) -> bool:
    """Return whether a file is a FITS file, by its name."""
    return path.lower().endswith(ENDINGS)


def read_header(path: str) -> FitsHeader:
    """Return what the header of the first image says.

    Raises ValueError for a file that holds no frame, or is cut off; OSError."""
    with _images(path) as images:
        header = images[0].header
        pedestal = _number(path, header, ("PEDESTAL",))
        order = str(header.get("ROWORDER", ROW_ORDERS[0])).strip().upper()
        if order not in ROW_ORDERS:
            raise ValueError(
                f'{path}: ROWORDER is "{order}"; must be {" or ".join(ROW_ORDERS)}'
            )
        notes = []
        if len(images) > 1:
            notes.append(f"holds {len(images)} images; the first is used")
        return FitsHeader(
            shape=_shape(path, images[0]),
            exposure_time=_number(path, header, EXPOSURES, least=0.0),
            temperature=_number(path, header, TEMPERATURES, least=-273.15),
            electrons_per_dn=_electrons_per_dn(path, header),
            pedestal=abs(pedestal or 0.0),
            bottom_up=order == ROW_ORDERS[1],
            cfa=_cfa(header, order),
            notes=tuple(notes),
        )


def read_pixels(path: str) -> RawImage:
    """Return (H, W) uint16 DN, top row first, without the pedestal.

    Raises ValueError for pixels that are no whole DN of 0 to 65535; OSError."""
    header = read_header(path)
    with _images(path) as images:
        try:
            stored = images[0].data
        except (ValueError, TypeError, EOFError, OSError) as error:
            raise ValueError(f"{path}: its image cannot be read: {error}") from None
        plane = np.asarray(stored).reshape(header.shape)
        dn = _whole_dn(path, plane, header.pedestal)
    return np.ascontiguousarray(dn[::-1] if header.bottom_up else dn)


def frames(path: str, image: str | None = None) -> list[RawFile]:
    """Return the frame of a FITS file. Raises ValueError, OSError."""
    header = read_header(path)
    notes = header.notes
    if header.pedestal:
        notes = (*notes, f"a PEDESTAL of {header.pedestal:g} DN is taken off")
    found = RawHeader(
        path,
        Area("active", 0, 0, *header.shape),
        cfa=header.cfa,
        exposure_time=header.exposure_time,
        temperature=header.temperature,
        electrons_per_dn=header.electrons_per_dn,
        notes=notes,
    )
    return [RawFile(found, lambda levels: read_pixels(path))]


@contextmanager
def _images(path: str) -> Iterator[list[Any]]:
    """Yield the HDUs of a file that have pixels, at least one. Raises ValueError."""
    try:
        fits: Any = import_module("astropy.io.fits")
    except ImportError:
        raise ValueError(f"{path}: {MISSING}") from None
    check_readable(path)  # of a missing file, the error that all readers raise
    with _warnings, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # each that matters is an error here
        try:
            file = fits.open(path, memmap=False, lazy_load_hdus=False)
        except (ValueError, TypeError, KeyError, IndexError, EOFError, OSError) as why:
            text = " ".join(str(why).split())
            raise ValueError(f"{path}: is no FITS file, or cut off: {text}") from None
        with file:
            images = [hdu for hdu in file if hdu.is_image and hdu.shape]
            if not images:
                raise ValueError(
                    f"{path}: holds no image; give the file of one RAW frame"
                )
            _check_length(path, images[0])
            yield images


def _check_length(path: str, image: Any) -> None:
    """Raise ValueError if a file ends before its image does."""
    place = image.fileinfo()
    if place is None or path.lower().endswith(".gz"):
        return
    missing = place["datLoc"] + image.size - os.path.getsize(path)
    if image.name != "COMPRESSED_IMAGE" and missing > 0:
        raise ValueError(
            f"{path}: is cut off: {missing} bytes of its image are missing; copy it "
            "again"
        )


def _shape(path: str, image: Any) -> tuple[int, int]:
    """Return (H, W) of an image with one plane. Raises ValueError."""
    *planes, height, width = (1, *image.shape) if len(image.shape) > 1 else (0, 0, 0)
    count = math.prod(planes)
    if count != 1 or min(height, width) < 1:
        size = "x".join(str(n) for n in reversed(image.shape))
        what = f"{count} frames of {width}x{height}" if count > 1 else "no picture"
        raise ValueError(
            f"{path}: its image is {size}, {what}; must be one frame: save each as a "
            "file of its own"
        )
    return height, width


def _number(
    path: str, header: Any, names: Sequence[str], least: float = -math.inf
) -> float | None:
    """Return the first of some keywords, None if there is none. Raises ValueError."""
    for name in names:
        value = header.get(name)
        if value is None or isinstance(value, str) and not value.strip():
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


def _electrons_per_dn(path: str, header: Any) -> float | None:
    """Return EGAIN, or a GAIN whose comment says that it is in electrons."""
    names = ["EGAIN"]
    if "GAIN" in header and IN_ELECTRONS.search(str(header.comments["GAIN"])):
        names.append("GAIN")
    return _number(path, header, names, least=0.0) or None


def _cfa(header: Any, order: str) -> str | None:
    """Return the CFA at the top left; None where programs do not agree what the header
    means, which is so for pictures that are stored bottom up."""
    pattern = str(header.get("BAYERPAT", "")).strip().upper()
    if order != ROW_ORDERS[0] or sorted(pattern) != sorted("RGGB"):
        return None
    try:
        down, right = (int(header.get(f"{axis}BAYROFF", 0)) % 2 for axis in "YX")
    except (TypeError, ValueError):
        return None
    rows = pattern[:2], pattern[2:]
    return "".join(
        rows[(row + down) % 2][(col + right) % 2] for row in (0, 1) for col in (0, 1)
    )


def _whole_dn(path: str, plane: NDArray[Any], pedestal: float) -> RawImage:
    """Return uint16 of pixels, less a pedestal. Raises ValueError for the first that
    is none."""
    without = plane.astype(np.float64) - pedestal
    with np.errstate(invalid="ignore"):
        wrong = ~((without >= 0) & (without <= MOST_DN) & (without == np.rint(without)))
    if wrong.any():
        row, col = np.argwhere(wrong)[0]
        less = f" without its PEDESTAL of {pedestal:g} DN" if pedestal else ""
        raise ValueError(
            f"{path}: {np.count_nonzero(wrong)} pixels are no DN, the first in stored "
            f"row {row}, column {col}: {without[row, col]:g}{less}; must be whole "
            f"numbers, 0 to {MOST_DN}: give the frame as the camera took it, not "
            "calibrated"
        )
    return without.astype(np.uint16)
