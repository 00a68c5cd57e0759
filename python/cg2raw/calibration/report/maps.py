# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Maps of a calibration: bias, dark current, response, shading."""

from collections.abc import Iterator

import numpy as np
from scipy.ndimage import uniform_filter

from cg2raw.calibration.measurements import Measurements
from cg2raw.calibration.report.curves import Drawn
from cg2raw.calibration.robust import Array
from cg2raw.io.plot import map_figure

WINDOW = 15  # px of one site, across, that the fine response is over
ACROSS = 256  # cells of a map along its longer side


def maps(found: Measurements) -> Iterator[Drawn]:
    """Yield each map that the frames show."""
    if found.offset is not None:
        words = "Offsets of pixels above the black level, DN; means of cells"
        yield "Bias", words, drawn_map(found.offset, found, "DN")
    if found.rate is not None and found.dark is not None:
        words = "Dark current of pixels, DN/s; means of cells, hot pixels cut"
        rate = found.rate + (found.dark.rate.value - np.median(found.rate))
        cut = np.minimum(rate, np.percentile(rate, 99))
        yield "Dark current map", words, drawn_map(cut, found, "DN/s")
    if found.response is not None and found.light is not None:
        fine = np.zeros_like(found.response)
        for plane, out in zip(
            found.sites.of(found.response), found.sites.of(fine), strict=True
        ):
            out[:] = 100 * (plane / uniform_filter(plane, WINDOW) - 1)
        words = (
            f"Response of pixels over {WINDOW} x {WINDOW} of their own, %; means of "
            "cells"
        )
        yield "PRNU", words, drawn_map(fine, found, "%")
        words = (
            "Response in blocks of the field, 1 in the middle of all: light and lens"
        )
        field = drawn_map(found.light.field, found, "relative")
        yield "Shading", words, field


def drawn_map(values: Array, found: Measurements, unit: str) -> bytes:
    """Return the PNG of a map, (h, w), as means of cells."""
    return map_figure(binned(values), found.shape, unit)


def binned(values: Array) -> Array:
    """Return means of square cells, at most ACROSS along a side."""
    step = max(1, -(-max(values.shape) // ACROSS))
    rows, cols = (side // step for side in values.shape)
    cut = values[: rows * step, : cols * step]
    found: Array = cut.reshape(rows, step, cols, step).mean((1, 3), dtype=np.float64)
    return found
