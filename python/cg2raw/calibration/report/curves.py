# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Curves of a calibration: photon transfer, dark current, linearity, noise, bias."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from cg2raw.calibration.darks import HISTOGRAM
from cg2raw.calibration.measurements import Measurements
from cg2raw.calibration.table import told
from cg2raw.io.plot import (
    HEIGHT,
    draw_profile,
    electron_axis,
    figure_of,
    plain_ticks,
    transfer_axes,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Distinct for all common colour vision. Source: Okabe and Ito, Color Universal
# Design, 2008.
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7")
LINE, POINT = "#333333", "#0072b2"
Drawn = tuple[str, str, bytes]  # title, description, PNG


def curves(found: Measurements) -> Iterator[Drawn]:
    """Yield each curve that the frames show."""
    if found.transfer is not None and found.figure("gain") is not None:
        yield photon_transfer(found)
    if found.dark is not None:
        yield dark_current(found)
    if found.linearity is not None:
        yield linearity(found)
    if found.tails is not None:
        yield differences(found)
    if found.structure is not None:
        yield profiles(found)


def photon_transfer(found: Measurements) -> Drawn:
    """Return variance against mean: blocks of the field of each level, and the line."""
    transfer, gain = found.transfer, found.figure("gain")
    assert transfer is not None and gain is not None
    read = [m.value**2 + found.sites.rounding for m in found.each("read noise")]
    dark = float(np.mean(read)) if read else 0.0

    def draw(figure: "Figure") -> None:
        axes = figure.subplots()
        for site in range(min(found.sites.count, len(COLORS))):
            mean = np.concatenate([p.mean[site] for p in transfer.points])
            variance = np.concatenate([p.variance[site] for p in transfer.points])
            axes.plot(mean, variance, ".", color=COLORS[site], markersize=2.5,
                      label=found.sites.names[site] or "flats")  # fmt: skip
        top = max(float(p.mean.max()) for p in transfer.points)
        x = np.geomspace(max(top / 1e4, 0.1), top, 200)
        axes.plot(x, dark + x / gain.value, color=LINE, linewidth=1)
        axes.axhline(dark, color=LINE, linewidth=1, linestyle=":")
        if transfer.saturation is not None:
            axes.axvline(transfer.saturation.value, color="#d55e00", linestyle="--")
        labels = "mean above black, DN", "variance of a frame, DN^2"
        transfer_axes(axes, labels, gain.value)
        axes.legend(frameon=False, markerscale=3)

    words = (
        f"Variance of pixels against their mean, in blocks of the field; the line has "
        f"{told(gain)}, dotted is the variance without light"
    )
    return "Photon transfer", words, figure_of(draw)


def gain_of(found: Measurements) -> float | None:
    """Return electrons per DN, where they were measured."""
    gain = found.figure("gain")
    return None if gain is None else gain.value


def dark_current(found: Measurements) -> Drawn:
    """Return the middles of darks against exposure time, a line per temperature."""
    dark = found.dark
    assert dark is not None
    points = dark.points

    def draw(figure: "Figure") -> None:
        axes = figure.subplots()
        for number in sorted({number for *_, number in points}):
            ours = [(time, above) for time, above, of in points if of == number]
            axes.plot(*zip(*ours, strict=True), "o",
                      color=COLORS[number % len(COLORS)], markersize=4)  # fmt: skip
        times = np.array([0, max(time for time, *_ in points)])
        for temperature, rate in dark.rates:
            at = "" if temperature is None else f" at {temperature:.1f} C"
            axes.plot(times, rate.value * times, linewidth=1,
                      color=LINE, label=f"{told(rate)}{at}")  # fmt: skip
        axes.set(xlabel="exposure time, s", ylabel="median above black, DN")
        electron_axis(axes, gain_of(found), "y")
        axes.legend(frameon=False, handlelength=0)

    words = "The median pixel of darks above the black level, and the lines"
    return "Dark current", words, figure_of(draw)


def linearity(found: Measurements) -> Drawn:
    """Return how flats deviate from a straight line through zero."""
    found_line = found.linearity
    assert found_line is not None

    def draw(figure: "Figure") -> None:
        axes = figure.subplots()
        axes.axhline(0, color=LINE, linewidth=1)
        axes.plot(found_line.levels, found_line.deviations, "o", color=POINT)
        axes.set(xlabel="level above black, DN", ylabel="deviation, %")
        electron_axis(axes, gain_of(found), "x")

    words = f"Level against exposure time: linearity error {told(found_line.error)}"
    return "Linearity", words, figure_of(draw)


def differences(found: Measurements) -> Drawn:
    """Return the histogram of differences of biases against a normal one."""
    noise = found.tails
    assert noise is not None
    middles = (HISTOGRAM[1:] + HISTOGRAM[:-1]) / 2
    width = HISTOGRAM[1] - HISTOGRAM[0]

    def draw(figure: "Figure") -> None:
        axes = figure.subplots()
        density = noise.histogram / noise.histogram.sum() / width
        normal = np.exp(-(middles**2) / 2) / np.sqrt(2 * np.pi)
        floor = 0.3 / noise.histogram.sum() / width
        axes.fill_between(middles, floor, np.maximum(normal, floor), color="#cccccc",
                          label="normal")  # fmt: skip
        axes.stairs(np.maximum(density, floor), HISTOGRAM, color=POINT, baseline=floor,
                    label="measured")  # fmt: skip
        axes.set(yscale="log", xlabel="difference of two darks, standard deviations",
                 ylabel="density")  # fmt: skip
        plain_ticks(axes.yaxis)
        axes.legend(frameon=False)

    words = f"Differences of {noise.frames} darks, in which fixed patterns cancel"
    return "Temporal noise", words, figure_of(draw)


def profiles(found: Measurements) -> Drawn:
    """Return the means of columns and rows of the offsets, with what was fitted."""
    structure = found.structure
    assert structure is not None

    def draw(figure: "Figure") -> None:
        upper, lower = figure.subplots(2, 1)
        for axes, profile, fitted, name in (
            (upper, structure.columns, structure.fitted_columns, "column"),
            (lower, structure.rows, structure.fitted_rows, "row"),
        ):
            draw_profile(axes, [(profile, POINT, 0.6), (fitted, "#d55e00", 1.2)])
            axes.set(xlabel=name, ylabel="DN")
            electron_axis(axes, gain_of(found), "y")

    words = "Means of columns and rows of the bias, less the black level; the line is "
    return "Bias profiles", words + "ramp and edge", figure_of(draw, 1.6 * HEIGHT)
