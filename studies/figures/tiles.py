# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Pictures in a figure, each pixel a whole number of the figure's: sharp, and small."""

from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SCALE = 2  # pixels of the figure, each side, for one of a picture
GAP = 8  # pixels between pictures


def place(
    figure: "Figure", left: float, top: float, width: float, height: float
) -> "Axes":
    """Return new axes at pixels of a figure, from its upper left corner."""
    across, down = figure.get_size_inches() * figure.dpi
    return figure.add_axes(
        (left / across, 1.0 - (top + height) / down, width / across, height / down)
    )


def tile(
    figure: "Figure", picture: NDArray[Any], left: int, top: int, **drawing: Any
) -> "Axes":
    """Return new axes with a picture (H, W) or (H, W, 3).

    drawing : of Axes.imshow."""
    height, width = (SCALE * size for size in picture.shape[:2])
    axes = place(figure, left, top, width, height)
    axes.imshow(picture, interpolation="nearest", aspect="auto", **drawing)
    axes.set(xticks=[], yticks=[])
    axes.spines[:].set_visible(False)
    return axes
