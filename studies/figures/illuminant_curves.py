# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""illuminant.png: which share of test frames has an angular error below each."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from cg2raw.io.figure import drawn
from studies.figures.styles import styles
from studies.tasks.paired import Kept

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Errors = Mapping[str, Kept]  # source: of (draws, frames), degrees
PANEL, HEIGHT, LEGEND = 3.4, 3.0, 0.22  # inches: width, height, a line of the legend
ENTRY, LEAST = 2.4, 4.8  # inches: an entry of the legend; the least width
SHARES = np.linspace(0.0, 1.0, 201)
SHOWN = 0.97  # share of each source's frames that the axes reach


def illuminant_curves(found: Mapping[str, Errors]) -> bytes:
    """Return the PNG of {camera: errors}: one panel a camera, one line a source.

    Of each frame, the mean over draws."""
    names = list(next(iter(found.values())))
    width = max(PANEL * len(found), LEAST)
    columns = min(int(width / ENTRY), 3)
    lines = -(-len(names) // columns)

    def draw(figure: "Figure") -> None:
        panels = figure.subplots(
            1, len(found), sharex=True, sharey=True, squeeze=False
        )[0]
        for axes, (camera, errors) in zip(panels, found.items(), strict=True):
            draw_camera(axes, camera, errors)
        panels[0].set_xlim(0.0, furthest(found))
        panels[0].set_ylabel("share of test frames")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(
            handles,
            labels,
            loc="outside lower center",
            ncols=columns,
            frameon=False,
            handlelength=3.0,
        )

    return drawn(HEIGHT + LEGEND * lines, draw, width, colors=256)


def furthest(found: Mapping[str, Errors]) -> float:
    """Return the degrees that the axes reach."""
    every = [kept for errors in found.values() for kept in errors.values()]
    return max(float(np.quantile(kept["frames"], SHOWN)) for kept in every)


def draw_camera(axes: "Axes", camera: str, errors: Errors) -> None:
    """Draw one panel."""
    for name, (color, dashes) in styles(errors).items():
        values = np.quantile(errors[name]["frames"], SHARES)
        axes.plot(values, SHARES, ls=dashes, color=color, linewidth=1.3, label=name)
    axes.set(title=camera, xlabel="angular error, degrees", ylim=(0, 1))
    axes.grid(True)
