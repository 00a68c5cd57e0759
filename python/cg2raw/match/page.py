# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The page of a comparison: its plots and sentences, in one file without scripts."""

import os
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from cg2raw.io.atomic_file import write_with_folder
from cg2raw.io.figure import BLACK, BLUE, ORANGE, drawn
from cg2raw.io.figures_page import filled
from cg2raw.match.comparison import Comparison, exposure_words, rows_of
from cg2raw.match.frame import PROBABILITIES, Frame
from cg2raw.match.shift import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PAGE = "match.html"
HEIGHT = 3.2  # inches
CAPTURES, RENDERS, MOVED = BLUE, ORANGE, BLACK
Drawn = tuple[str, str, bytes]  # title, description, PNG


def write_page(found: Comparison, folder: str, noise: bool) -> str:
    """Write match.html into a folder, which is made if it is not there; return the
    page's path. noise : whether the renders have any. Raises ValueError if Jinja2 or
    Pillow is missing, OSError."""
    path = os.path.join(folder, PAGE)
    write_with_folder(path, page(found, noise).encode())
    return path


def page(found: Comparison, noise: bool) -> str:
    """Return the page. Raises ValueError if Jinja2 or Pillow is missing."""
    return filled(
        "cg2raw.match",
        "match.html.jinja",
        plots(found),
        sensor=found.sensor,
        captures=len(found.captures),
        renders=len(found.renders),
        exposure=exposure_words(found.exposure),
        rows=rows_of(found, noise),
        notes=found.notes,
    )


def plots(found: Comparison) -> Iterator[Drawn]:
    """Yield each plot."""
    yield levels(found)
    yield luminance(found)
    yield exposure(found)
    yield (
        "Clipped and black samples",
        "Share of samples of each frame, in order of the frames",
        drawn(HEIGHT, lambda figure: draw_shares(figure, found)),
    )
    yield colour(found)
    for title, unit, quantity, words in (
        ("Contrast", "stops", lambda f: f.contrast, "Between the quarters of a frame"),
        ("Sharpness", "ratio", lambda f: f.sharpness,
         "Gradient over one repeat of the CFA to that over eight"),
        ("Noise where flat", "of the square root of the signal", lambda f: f.noise,
         "Standard deviation in the flattest tenth of a frame"),
    ):  # fmt: skip
        ours, theirs = known(found.captures, quantity), known(found.renders, quantity)
        if len(ours) and len(theirs):
            yield title, words, histograms(f"{title.lower()}, {unit}", ours, theirs)


def known(frames: Sequence[Frame], quantity: Callable[[Frame], float]) -> Array:
    """Return a quantity of the frames that show it."""
    values: Array = np.array([quantity(frame) for frame in frames])
    return values[np.isfinite(values)]


def levels(found: Comparison) -> Drawn:
    """Return the histograms of levels, and of the renders' with the exposure."""
    ours, theirs = (
        known(frames, lambda f: f.level) for frames in (found.captures, found.renders)
    )
    shift = found.exposure
    stops = np.interp(
        np.linspace(0.01, 0.99, 50), *np.transpose(np.array(shift.quantiles))
    )
    moved = (theirs[:, None] + stops).ravel()
    png = histograms("median luminance, stops from white", ours, theirs, moved)
    words = "Each frame's median luminance; the line is renders with drawn ones"
    return "Levels", words, png


def histograms(
    label: str, ours: Array, theirs: Array, moved: Array | None = None
) -> bytes:
    """Return the PNG of captures' and renders' histograms on one axis."""
    both = np.concatenate([ours, theirs, *([] if moved is None else [moved])])
    low, high = np.percentile(both, (0.5, 99.5))
    room = max(0.05 * (high - low), 1e-3)
    edges = np.linspace(low - room, high + room, 26)

    def draw(figure: "Figure") -> None:
        axes = figure.subplots()
        for values, color, name in (
            (ours, CAPTURES, "captures"),
            (theirs, RENDERS, "renders"),
        ):
            counts = np.histogram(values, edges)[0]
            share = 100 * counts / len(values)
            axes.stairs(share, edges, fill=True, color=color, alpha=0.45, label=name)
        if moved is not None:
            share = 100 * np.histogram(moved, edges)[0] / len(moved)
            axes.stairs(share, edges, color=MOVED, label="renders, exposed")
        axes.set(xlabel=label, ylabel="frames, %")
        axes.legend(frameon=False, loc="lower center", bbox_to_anchor=(0.5, 1), ncols=3)

    return drawn(HEIGHT, draw)


def luminance(found: Comparison) -> Drawn:
    """Return the quantiles of luminance: their medians and quarters over frames."""

    def draw(figure: "Figure") -> None:
        axes = figure.subplots()
        for frames, color, name in (
            (found.captures, CAPTURES, "captures"),
            (found.renders, RENDERS, "renders"),
        ):
            low, mid, high = np.percentile(
                [frame.quantiles for frame in frames], (25, 50, 75), axis=0
            )
            share = 100 * np.array(PROBABILITIES)
            axes.fill_betweenx(share, low, high, color=color, alpha=0.25, linewidth=0)
            axes.plot(mid, share, ".-", color=color, label=name)
        axes.set(xlabel="luminance, stops from white", ylabel="of a frame is darker, %")
        axes.legend(frameon=False)

    words = "Quantiles of luminance: the median frame, and the middle half of all"
    return "Luminance", words, drawn(HEIGHT, draw)


def exposure(found: Comparison) -> Drawn:
    """Return the distribution of exposure, with the interval of its median."""
    shift = found.exposure
    shares, stops = np.transpose(np.array(shift.quantiles))

    def draw(figure: "Figure") -> None:
        axes = figure.subplots()
        axes.axvspan(*shift.median_range, color=BLUE, alpha=0.2, linewidth=0,
                     label="its median, 99 %")  # fmt: skip
        axes.axvline(shift.median, color=BLUE, linewidth=1)
        axes.plot(stops, 100 * shares, color=BLACK, label="exposure")
        axes.set(xlabel="stops added to a render", ylabel="of the renders get less, %")
        axes.legend(frameon=False)

    words = "Exposure that makes the renders' levels the captures'"
    return "Exposure", words, drawn(HEIGHT, draw)


def draw_shares(figure: "Figure", found: Comparison) -> None:
    """Draw shares of clipped and of black samples, frames in order."""
    both = figure.subplots(1, 2, sharey=True)
    for axes, name in zip(both, ("clipped", "black"), strict=True):
        for frames, color, label in (
            (found.captures, CAPTURES, "captures"),
            (found.renders, RENDERS, "renders"),
        ):
            values = 100 * np.sort([getattr(frame, name) for frame in frames])
            place = 100 * (np.arange(len(values)) + 0.5) / len(values)
            axes.plot(place, values, color=color, label=label)
        axes.set(xlabel="of the frames, %", title=name, yscale="symlog")
        axes.set_ylim(bottom=0)
        percent_ticks(axes)
    both[0].set_ylabel("samples, %")
    both[0].legend(frameon=False)


def percent_ticks(axes: "Axes") -> None:
    """Label a symmetric logarithmic axis of per cent."""
    axes.set_yticks([0, 1, 10, 100], ["0", "1", "10", "100"])


def colour(found: Comparison) -> Drawn:
    """Return the chromaticity of each frame after white balance."""

    def draw(figure: "Figure") -> None:
        axes = figure.subplots()
        axes.axhline(0, color="#999999", linewidth=0.8)
        axes.axvline(0, color="#999999", linewidth=0.8)
        for frames, color, name in (
            (found.captures, CAPTURES, "captures"),
            (found.renders, RENDERS, "renders"),
        ):
            axes.plot([f.red for f in frames], [f.blue for f in frames], ".",
                      color=color, markersize=4, label=name)  # fmt: skip
        axes.set(xlabel="red over green, stops", ylabel="blue over green, stops")
        axes.locator_params(axis="x", nbins=5)
        axes.legend(frameon=False)

    words = "Median of each frame after its white balance; 0 is grey"
    return "Colour", words, drawn(HEIGHT, draw)
