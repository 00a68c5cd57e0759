# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Maps of a calibration: bias, dark current, response, shading."""

from collections.abc import Iterator

import numpy as np

from cg2raw.calibration.measurements import Measurements
from cg2raw.calibration.report.curves import Drawn
from cg2raw.calibration.robust import Array
from cg2raw.io.plot import map_figure

ACROSS = 256  # cells of a map along its longer side


def maps(found: Measurements) -> Iterator[Drawn]:
    """Yield each map that the frames show."""
    if found.maps is not None and found.black_level is not None:
        level = found.sites.spread(found.black, found.shape)
        words = "Offsets of pixels above the black level, DN; means of cells"
        yield "Bias", words, drawn_map(found.maps.offset - level, found, "DN")
        if found.maps.rate is not None:
            words = "Dark current of pixels, DN/s; means of cells, hot pixels cut"
            most = np.percentile(found.maps.rate, 99)
            cut = np.minimum(found.maps.rate, most)
            yield "Dark current map", words, drawn_map(cut, found, "DN/s")
    if found.light is not None:
        fine = 100 * (found.light.fine - 1)
        words = "Response of pixels after a high-pass, %; means of cells"
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
