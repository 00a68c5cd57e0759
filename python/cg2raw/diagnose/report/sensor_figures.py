# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The figures that the report opens with, with words for those who cannot see them."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from cg2raw.diagnose.diagnosis import Characteristics, FixedPattern, Trend
from cg2raw.diagnose.report import sensor_plots
from cg2raw.diagnose.report import text as words
from cg2raw.diagnose.report.frame_images import Image
from cg2raw.io.plot import Array

# (name, png, alternative text) -> the image
Made = Callable[[str, bytes, str], Image]


@dataclass(frozen=True)
class Panel:
    """Images under one title, with a sentence on them."""

    title: str
    caption: str
    images: Sequence[Image]


def panels(found: Characteristics | None, made: Made) -> Iterator[Panel]:
    """Yield what is to be drawn of a sensor's characteristics, none of None."""
    if found is None:
        return
    gain = found.electrons_per_dn if words.is_known(found.electrons_per_dn) else None
    if found.transfer is not None:
        yield transfer_panel(found.transfer, gain, made)
    if found.dark_levels is not None:
        yield dark_level_panel(found.dark_levels, gain, made)
    for pattern in found.patterns:
        yield pattern_panel(pattern, made)
        yield profile_panel(pattern, gain, made)


def transfer_panel(transfer: Trend, gain: float | None, made: Made) -> Panel:
    """Return the photon-transfer curve."""
    png = sensor_plots.transfer_figure(transfer, gain)
    alt = f"Variance against level: {course(transfer, 'DN^2', 'DN')}"
    caption = (
        "Half the variance of differences of two held-out frames, in which all that is "
        "fixed cancels; what lies 4 sigma off is left out. On a logarithmic axis darks "
        "are at 1 DN."
    )
    if gain is not None:
        caption += f" By the profile that was found, a DN is {words.number(gain)} e-."
    image = made("photon_transfer.png", png, alt)
    return Panel("Photon transfer", caption, [image])


def dark_level_panel(levels: Trend, gain: float | None, made: Made) -> Panel:
    """Return the dark-current line."""
    png = sensor_plots.dark_level_figure(levels, gain)
    alt = f"Level of darks against exposure time: {course(levels, 'DN', 's')}"
    caption = (
        "Median of darks above the profile's black level. Filled points are held-out "
        "frames; the slope is the dark current."
    )
    return Panel("Dark current", caption, [made("dark_levels.png", png, alt)])


def pattern_panel(pattern: FixedPattern, made: Made) -> Panel:
    """Return the maps of a kind of frames."""
    pngs = sensor_plots.pattern_figures(pattern)
    cells = pattern.before, pattern.after
    images = [
        made(f"pattern_{pattern.kind}_{when}.png", png,
             f"Mean residual of {pattern.kind}s {when}: {spread(values)}")
        for when, png, values in zip(("before", "after"), pngs, cells, strict=True)
    ]  # fmt: skip
    caption = (
        f"Mean of {frames_of(pattern)} less the simulation before (first) and after, "
        "in cells, on the scale of before. Without a gap only noise is left."
    )
    return Panel(f"Fixed pattern of {pattern.kind}s", caption, images)


def profile_panel(pattern: FixedPattern, gain: float | None, made: Made) -> Panel:
    """Return the profiles along rows and columns."""
    png = sensor_plots.profile_figure(pattern, gain)
    alt = "; ".join(
        f"{name}: {spread(values)}"
        for name, values in (
            ("means of columns before", pattern.columns_before),
            ("after", pattern.columns_after),
            ("means of rows before", pattern.rows_before),
            ("after", pattern.rows_after),
        )
    )
    caption = (
        f"Means of the columns and of the rows of {frames_of(pattern)}, less the "
        "simulation. A pixel counts at most 10 standard deviations."
    )
    image = made(f"profiles_{pattern.kind}.png", png, alt)
    return Panel(f"Columns and rows of {pattern.kind}s", caption, [image])


def frames_of(pattern: FixedPattern) -> str:
    """Return how many frames a pattern is the mean of."""
    return words.counted(pattern.frames, f"held-out {pattern.kind}")


def spread(values: Array) -> str:
    """Return mean and standard deviation of what is known, DN."""
    known = values[np.isfinite(values)]
    if not known.size:
        return words.NOT_KNOWN
    mean, deviation = (
        words.number(float(known.mean())),
        words.number(float(known.std())),
    )
    return f"mean {mean} DN, standard deviation {deviation} DN"


def course(trend: Trend, unit: str, x_unit: str) -> str:
    """Return measured, before and after at both ends."""
    parts = []
    for end in dict.fromkeys((int(np.argmin(trend.x)), int(np.argmax(trend.x)))):
        x, *values = (
            words.number(float(series[end]))
            for series in (trend.x, trend.measured, trend.before, trend.after)
        )
        parts.append(
            f"at {x} {x_unit} measured {values[0]} {unit}, simulated {values[1]} "
            f"before and {values[2]} after"
        )
    return f"{'; '.join(parts)}; {words.counted(len(trend.x), 'point')}"
