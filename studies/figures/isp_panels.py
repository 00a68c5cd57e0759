# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""isp.png: pictures by neural ISPs beside the goal, and how far they are from it."""

from typing import TYPE_CHECKING

from cg2raw.io.figure import DPI, drawn
from studies.figures.isp_examples import Examples
from studies.figures.tiles import GAP, SCALE, place, tile

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TITLES, MEANS, APART = 36, 26, 14  # pixels: above pictures, maps, and the next frame
BAR = 14  # pixels: the height of the maps' scale
MOST = 10.0  # CIEDE2000 that is the brightest
MAP = {"cmap": "viridis", "vmin": 0.0, "vmax": MOST}


def isp_panels(found: Examples) -> bytes:
    """Return the PNG: two rows a frame, one column a picture."""
    frames, height, width, _ = next(iter(found.pictures.values())).shape
    down, across = SCALE * height, SCALE * width + GAP
    step = down + MEANS + down + APART
    size = across * len(found.pictures) - GAP, TITLES + frames * step - APART

    def draw(figure: "Figure") -> None:
        figure.set_layout_engine("none")  # tiles have pixels of their own
        for number, name in enumerate(found.pictures):
            for frame in range(frames):
                top = TITLES + frame * step
                draw_pair(figure, found, name, frame, (number * across, top))
        draw_scale(figure, found, across - GAP, TITLES + down + MEANS)

    return drawn(size[1] / DPI, draw, size[0] / DPI, colors=None)


def draw_pair(
    figure: "Figure", found: Examples, name: str, frame: int, at: tuple[int, int]
) -> None:
    """Draw a picture and the map below it; at : left and top, pixels."""
    picture = found.pictures[name][frame]
    left, top = at
    axes = tile(figure, picture, left, top)
    if frame == 0:
        axes.set_title(name, fontsize=10)
    if name in found.differences:
        values = found.differences[name][frame]
        below = top + SCALE * len(picture) + MEANS
        axes = tile(figure, values, left, below, **MAP)
        axes.set_title(f"mean {values.mean():.1f}", fontsize=9, pad=4)


def draw_scale(figure: "Figure", found: Examples, width: int, top: int) -> None:
    """Draw the maps' scale where the goal's map would be."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    values = ScalarMappable(Normalize(0.0, MOST), "viridis")
    bar = place(figure, 0.08 * width, top + BAR, 0.84 * width, BAR)
    label = f"CIEDE2000 to the goal\n{found.camera}"
    figure.colorbar(values, cax=bar, orientation="horizontal", label=label)
