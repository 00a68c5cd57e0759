# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The two pictures of docs/spectral-evidence.md: errors by light, and ratios."""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure

from studies.spectra.data import MONOCHROMATIC
from studies.spectra.errors import BEST, METHODS

# Okabe and Ito.
COLOURS = ("#999999", "#0072b2", "#56b4e9", "#f0e442", "#e69f00", "#d55e00")
LIMITS = (0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2)
SPREAD = 0.13  # of a light's column, between two methods


def figure_of(width, height):
    """Return a figure with an Agg canvas, inches."""
    figure = Figure(figsize=(width, height), dpi=100, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def by_light(errors, which):
    """Return the figure: of each light and method the mean, and up to 95 %."""
    kept = [i for i, light in enumerate(errors.lights) if light != MONOCHROMATIC]
    figure = figure_of(12, 7)
    for axes, (values, name) in zip(
        figure.subplots(2, 1, sharex=True),
        ((errors.degrees, "degrees"), (errors.difference, "CIEDE2000")),
        strict=True,
    ):
        for m, (method, colour) in enumerate(zip(METHODS, COLOURS, strict=True)):
            part = values[:, kept, m, errors.sets[which]]
            mean = part.mean(axis=(0, 2), dtype=np.float64)
            high = np.percentile(part, 95, axis=(0, 2))
            at = np.arange(len(kept)) + (m - (len(METHODS) - 1) / 2) * SPREAD
            axes.vlines(at, mean, high, color=colour, linewidth=1.5)
            axes.plot(at, mean, "o", color=colour, markersize=4, label=method)
        axes.set_ylabel(name)
        axes.set_ylim(bottom=0)
        axes.grid(axis="y", alpha=0.3)
        axes.margins(x=0.01)
    axes.set_xticks(range(len(kept)), [errors.lights[i] for i in kept], rotation=90)
    figure.axes[0].legend(ncols=len(METHODS), fontsize=9, loc="upper left")
    title = f"{len(errors.cameras)} cameras, {which}: mean (dot) to 95th percentile"
    figure.suptitle(title, fontsize=11)
    return figure


def ratios(errors, which):
    """Return the figure: mean degrees of spectral over the best matrices', as maps."""
    kept = [i for i, light in enumerate(errors.lights) if light != MONOCHROMATIC]
    figure = figure_of(14, 9)
    for axes, method in zip(figure.subplots(1, 2, sharey=True), BEST, strict=True):
        drawn = axes.imshow(
            errors.ratio(which, method)[:, kept],
            cmap="RdYlBu_r",
            norm=BoundaryNorm(LIMITS, 256),
            aspect="auto",
        )
        axes.set_xticks(range(len(kept)), [errors.lights[i] for i in kept], rotation=90)
        axes.tick_params(axis="x", labelsize=8)
        axes.set_title(f"{which}: mean degrees, spectral / {method}", fontsize=10)
    names = [name.replace("_", " ") for name in errors.cameras]
    figure.axes[0].set_yticks(range(len(names)), names, fontsize=7)
    figure.colorbar(drawn, ax=figure.axes, shrink=0.6, ticks=LIMITS)
    return figure


def draw(errors, which, plot, ratio):
    """Write either figure, where a path is given, as PNG."""
    for path, make in ((plot, by_light), (ratio, ratios)):
        if path:
            make(errors, which).savefig(path, metadata={"Software": None})
