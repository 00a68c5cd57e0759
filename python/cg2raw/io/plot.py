# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Plots of DN that several reports draw: axes in electrons, maps, profiles."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cg2raw.io.figure import drawn

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import XAxis, YAxis
    from matplotlib.figure import Figure

Array = NDArray[Any]
HEIGHT = 3.2  # inches
ALL_COLORS = 256
SHOWN = (0.5, 99.5)  # per cent of the values that a scale spans
WIDTH_OF_MAP = 3.6  # inches of a figure beside its scale
LEAST_SPAN = 0.1  # DN that the axis of a profile spans at least


def figure_of(draw: Callable[["Figure"], None], height: float = HEIGHT) -> bytes:
    """Return the PNG of a figure with all its colours; height in inches."""
    return drawn(height, draw, colors=ALL_COLORS)


def plain_ticks(axis: "XAxis | YAxis") -> None:
    """Write powers of ten on a logarithmic axis as they are: 0.01, 100, 1e+06."""
    from matplotlib.ticker import FuncFormatter, NullFormatter

    axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axis.set_minor_formatter(NullFormatter())


def electron_axis(axes: "Axes", electrons_per_dn: float | None, side: str) -> None:
    """Add an axis in DN again in electrons, where the gain is known and above 0.

    side : "x", then it is on top, or "y", on the right."""
    if electrons_per_dn is None or not 0 < electrons_per_dn < np.inf:
        return
    gain = electrons_per_dn
    both = (lambda dn: dn * gain, lambda electrons: electrons / gain)
    if side == "x":
        top = axes.secondary_xaxis("top", functions=both)
        top.set_xlabel("electrons")
        if axes.get_xscale() == "log":
            plain_ticks(top.xaxis)
    else:
        axes.secondary_yaxis("right", functions=both).set_ylabel("electrons")


def transfer_axes(
    axes: "Axes",
    labels: tuple[str, str],
    electrons_per_dn: float | None,
    logarithmic: bool = True,
) -> None:
    """Make axes those of a photon-transfer curve: electrons on top.

    labels : of level and variance. logarithmic : both axes; needs values above 0."""
    axes.set(xlabel=labels[0], ylabel=labels[1])
    if logarithmic:
        axes.set(xscale="log", yscale="log")
        plain_ticks(axes.xaxis)
        plain_ticks(axes.yaxis)
    electron_axis(axes, electrons_per_dn, "x")


def span_of(values: Array) -> tuple[float, float]:
    """Return the ends of a scale that few values lie beyond; (0, 1) of none."""
    known = values[np.isfinite(values)]
    if not known.size:
        return 0.0, 1.0
    low, high = np.percentile(known, SHOWN)
    return float(low), float(high)


def map_figure(
    cells: Array,
    shape: tuple[int, int],
    unit: str,
    limits: tuple[float, float] | None = None,
    colors: str = "viridis",
) -> bytes:
    """Return the PNG of a map with its scale.

    cells : (h, w) in the unit; NaN where nothing is known. shape : (H, W) px of the
    frame. limits : ends of the scale; None for those that few cells lie beyond."""
    low, high = span_of(cells) if limits is None else limits
    height = WIDTH_OF_MAP * shape[0] / shape[1]

    def draw(figure: "Figure") -> None:
        axes = figure.subplots()
        image = axes.imshow(
            cells,
            cmap=colors,
            vmin=low,
            vmax=high,
            extent=(0, shape[1], shape[0], 0),
            interpolation="nearest",
        )
        figure.colorbar(image, ax=axes, label=unit, extend="both", shrink=0.9)

    return figure_of(draw, min(max(height, 1.5), 6.0))


def draw_profile(axes: "Axes", lines: Sequence[tuple[Array, str, float]]) -> None:
    """Draw profiles, each (values, colour, line width); the few values of each that are
    far off its others do not set the scale."""
    for values, color, width in lines:
        axes.plot(values, color=color, linewidth=width)
    lows, highs = zip(*(span_of(values) for values, _, _ in lines), strict=True)
    room = 0.3 * max(max(highs) - min(lows), LEAST_SPAN)
    axes.set_ylim(min(lows) - room, max(highs) + room)
