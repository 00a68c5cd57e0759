# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Pictures of test frames: measured, and the residuals before and after."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cg2raw.diagnose.diagnosis import Picture
from cg2raw.diagnose.report.text import number
from cg2raw.io.map_image import DIVERGING, map_image, png_image
from cg2raw.io.report_page import Image

SIGMAS = 4.0  # a residual map saturates there
SHOWN_AT, BRIGHTEST = 0.9, 99.0  # of the display, for that percentile
MOST_GAIN = 64.0  # six stops: a dark stays dark
BUDGET = 300_000  # bytes of all pictures, so that the page has half a megabyte
REDUCTIONS = (1, 2, 3, 4, 6, 8, 12, 16)

Pixels = NDArray[np.floating]


def frames(pictures: Sequence[Picture]) -> list[tuple[str, Sequence[Image]]]:
    """Return (caption, images) of each, reduced until all of them fit the budget.
    Raises ValueError if Pillow is missing."""
    made: list[tuple[str, Sequence[Image]]] = []
    for side in REDUCTIONS:
        made = [frame(picture, side) for picture in pictures]
        if sum(len(one.png) for _, images in made for one in images) <= BUDGET:
            break
    return made


def frame(picture: Picture, side: int) -> tuple[str, Sequence[Image]]:
    """Return a frame's caption and its three images, of cells of side x side."""
    measured = np.asarray(picture.measured, np.float64) * balance(picture)
    known = measured[np.isfinite(measured)]
    bright = float(np.percentile(known, BRIGHTEST)) if known.size else 1.0
    gain = float(np.clip(SHOWN_AT / max(bright, 1e-9), 0.25, MOST_GAIN))
    maps = [np.asarray(z, np.float64) for z in (picture.z_before, picture.z_after)]
    sizes = [rms(z) for z in maps]
    caption = (
        f"{picture.name}, {picture.kind}: measured (times {number(gain, 2)}), and "
        f"residuals before (rms {sizes[0]} standard deviations) and after ({sizes[1]})"
    )
    shown = ("measured", "residuals before", "residuals after")
    alts = [f"{picture.name}, {one}" for one in shown]
    ends = (-SIGMAS, SIGMAS)
    return caption, [
        png_image(srgb(gain * cells_of(measured, side)), alts[0]),
        *(
            map_image(cells_of(z, side, side), ends, f"{alt}: rms {n}", DIVERGING)
            for z, alt, n in zip(maps, alts[1:], sizes, strict=True)
        ),
    ]


def rms(z: Pixels) -> str:
    """Return the root mean square of what is known, in words."""
    known = z[np.isfinite(z)]
    return number(float(np.sqrt(np.mean(known**2))) if known.size else None, 2)


def balance(picture: Picture) -> Pixels:
    """Return factors of camera RGB, G = 1, by the light's neutral or the mean's."""
    neutral = picture.neutral
    if neutral is None:
        measured = np.asarray(picture.measured, np.float64)
        neutral = [
            float(np.nanmean(c)) if np.isfinite(c).any() else 1.0
            for c in np.moveaxis(measured, -1, 0)
        ]
    each = np.array(neutral, float)
    if not (np.isfinite(each).all() and (each > 0).all()):
        return np.ones(3)
    found: Pixels = np.clip(each[1] / each, 0.25, 4.0)
    return found


def srgb(linear: Pixels) -> NDArray[np.uint8]:
    """Return linear values, 0..1, as sRGB codes. Source: IEC 61966-2-1."""
    x = np.clip(np.nan_to_num(linear), 0, 1)
    encoded = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    codes: Pixels = np.rint(255 * encoded)
    return codes.astype(np.uint8)


def cells_of(values: Pixels, side: int, root: float = 1.0) -> Pixels:
    """Return the means of whole cells of what is known, times a number: for standard
    deviations that of the cells' side, by which their means have less noise."""
    h, w = (max(n // side, 1) for n in values.shape[:2])
    cut = values[: h * side, : w * side]
    cut = cut.reshape(h, -1, w, cut.shape[1] // w, *values.shape[2:])
    count = np.isfinite(cut).sum(axis=(1, 3))
    found: Pixels = np.nansum(cut, axis=(1, 3)) / np.where(count, count, np.nan)
    return found * root
