# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Photon transfer, dark current, fixed patterns: measured, simulated before and after.

Drawn as those of a calibration are, in DN, and in electrons where the gain is known."""

from typing import TYPE_CHECKING

import numpy as np

from cg2raw.diagnose.diagnosis import FixedPattern, Trend
from cg2raw.diagnose.report.plots import AFTER, BEFORE, MEASURED_COLOR, legend
from cg2raw.io.plot import (
    HEIGHT,
    Array,
    draw_profile,
    electron_axis,
    figure_of,
    map_figure,
    span_of,
    transfer_axes,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LEVEL_FLOOR = 1.0  # DN; points of darks are drawn at this level, as the axis has no 0
WIDE = 30.0  # times that level, from where on the axes are logarithmic
VARIANCE_FLOOR = 1e-3  # DN^2 that a logarithmic axis begins with at least
ROOM = 0.1  # DN that the axis of a profile shows beyond 0
MODELS = (("simulated before", BEFORE), ("simulated after", AFTER))
KEY = (("measured", MEASURED_COLOR), *MODELS)


def transfer_figure(transfer: Trend, electrons_per_dn: float | None) -> bytes:
    """Return variance against level, both models' lines and the measured points.

    Logarithmic where levels span decades; darks are then at the left end."""
    known = transfer.x[np.isfinite(transfer.x)]
    is_wide = bool(known.size and known.max() > WIDE * LEVEL_FLOOR)
    least_level, least = (LEVEL_FLOOR, VARIANCE_FLOOR) if is_wide else (-np.inf, 0.0)
    x = np.maximum(transfer.x, least_level)
    order = np.argsort(x, kind="stable")

    def draw(figure: "Figure") -> None:
        axes = figure.subplots()
        for values, (_, color) in zip(
            (transfer.before, transfer.after), MODELS, strict=True
        ):
            y = np.maximum(values[order], least)
            axes.plot(x[order], y, "-", color=color, marker="_", markersize=9)
        measured = np.maximum(transfer.measured, least)
        draw_points(axes, x, measured, transfer.held_out)
        labels = "level above black, DN", "variance from frame to frame, DN^2"
        transfer_axes(axes, labels, electrons_per_dn, is_wide)
        axes.grid()
        legend(figure, KEY)

    return figure_of(draw)


def draw_points(axes: "Axes", x: Array, y: Array, held_out: Array) -> None:
    """Draw what was measured; hollow points are of frames that were fitted or selected
    on."""
    for value, face in ((False, "white"), (True, MEASURED_COLOR)):
        of = held_out == value
        axes.plot(x[of], y[of], "o", markersize=4.5, color=MEASURED_COLOR,
                  markerfacecolor=face)  # fmt: skip


def dark_level_figure(levels: Trend, electrons_per_dn: float | None) -> bytes:
    """Return levels of darks against exposure time, and both models' lines."""

    def draw(figure: "Figure") -> None:
        axes = figure.subplots()
        for values, (_, color) in zip(
            (levels.before, levels.after), MODELS, strict=True
        ):
            times, means = _means_at(levels.x, values)
            axes.plot(times, means, color=color, marker="_", markersize=9)
        draw_points(axes, levels.x, levels.measured, levels.held_out)
        axes.set(xlabel="exposure time, s", ylabel="median of darks, DN")
        axes.grid()
        axes.margins(0.05)
        electron_axis(axes, electrons_per_dn, "y")
        legend(figure, KEY)

    return figure_of(draw)


def _means_at(x: Array, y: Array) -> tuple[Array, Array]:
    """Return the mean of y at each x, in order."""
    places, which = np.unique(x, return_inverse=True)
    return places, np.bincount(which, y) / np.maximum(np.bincount(which), 1)


def pattern_figures(pattern: FixedPattern) -> tuple[bytes, bytes]:
    """Return the maps before and after, on one scale of colours: that of before."""
    low, high = span_of(pattern.before)
    most = max(abs(low), abs(high), 1e-3)
    label = "measured \N{MINUS SIGN} simulated, DN"
    before, after = (
        map_figure(cells, pattern.shape, label, (-most, most), "RdBu_r")
        for cells in (pattern.before, pattern.after)
    )
    return before, after


def profile_figure(pattern: FixedPattern, electrons_per_dn: float | None) -> bytes:
    """Return the means of columns and of rows, before and after."""

    def draw(figure: "Figure") -> None:
        upper, lower = figure.subplots(2, 1)
        draw_both(upper, pattern.columns_before, pattern.columns_after, "column")
        draw_both(lower, pattern.rows_before, pattern.rows_after, "row")
        for axes in (upper, lower):
            electron_axis(axes, electrons_per_dn, "y")
        legend(figure, (("before", BEFORE), ("after", AFTER)))

    return figure_of(draw, 1.6 * HEIGHT)


def draw_both(axes: "Axes", before: Array, after: Array, name: str) -> None:
    """Draw one profile of both models; a dotted line is what a right one gives."""
    draw_profile(axes, [(before, BEFORE, 0.7), (after, AFTER, 0.7)])
    axes.axhline(0, color="#777777", linewidth=1, linestyle=":")
    low, high = axes.get_ylim()
    axes.set(
        xlabel=name, ylabel="residual, DN", ylim=(min(low, -ROOM), max(high, ROOM))
    )
