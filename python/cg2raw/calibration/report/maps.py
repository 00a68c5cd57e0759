# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Maps of a calibration: bias, dark current, response, shading."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from cg2raw.calibration.measurements import Measurements
from cg2raw.calibration.report.curves import Drawn, figure_of
from cg2raw.calibration.robust import Array

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ACROSS = 256  # cells of a map along its longer side
SHOWN = (0.5, 99.5)  # per cent of the cells that the scale spans
WIDTH_OF_MAP = 3.6  # inches of a figure beside its scale


def maps(found: Measurements) -> Iterator[Drawn]:
    """Yield each map that the frames show."""
    if found.maps is not None and found.black_level is not None:
        level = found.sites.spread(found.black, found.shape)
        words = "Offsets of pixels above the black level, DN; means of cells"
        yield "Bias", words, map_figure(found.maps.offset - level, found, "DN")
        if found.maps.rate is not None:
            words = "Dark current of pixels, DN/s; means of cells, hot pixels cut"
            most = np.percentile(found.maps.rate, 99)
            cut = np.minimum(found.maps.rate, most)
            yield "Dark current map", words, map_figure(cut, found, "DN/s")
    if found.light is not None:
        fine = 100 * (found.light.fine - 1)
        words = "Response of pixels after a high-pass, %; means of cells"
        yield "PRNU", words, map_figure(fine, found, "%")
        words = (
            "Response in blocks of the field, 1 in the middle of all: light and lens"
        )
        field = map_figure(found.light.field, found, "relative")
        yield "Shading", words, field


def map_figure(values: Array, found: Measurements, unit: str) -> bytes:
    """Return the PNG of a map, cells of pixels, with its scale."""
    cells = binned(values)
    low, high = np.percentile(cells, SHOWN)
    height = WIDTH_OF_MAP * found.shape[0] / found.shape[1]

    def draw(figure: "Figure") -> None:
        axes = figure.subplots()
        image = axes.imshow(
            cells,
            cmap="viridis",
            vmin=float(low),
            vmax=float(high),
            extent=(0, found.shape[1], found.shape[0], 0),
            interpolation="nearest",
        )
        figure.colorbar(image, ax=axes, label=unit, extend="both", shrink=0.9)

    return figure_of(draw, min(max(height, 1.5), 6.0))


def binned(values: Array) -> Array:
    """Return means of square cells, at most ACROSS along a side."""
    step = max(1, -(-max(values.shape) // ACROSS))
    rows, cols = (side // step for side in values.shape)
    cut = values[: rows * step, : cols * step]
    found: Array = cut.reshape(rows, step, cols, step).mean((1, 3), dtype=np.float64)
    return found
