# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Figures of reports; the same numbers give the same bytes."""

import io
from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH = 4.5  # inches
DPI = 150
# Distinct for all common colour vision. Source: Okabe and Ito, Color Universal
# Design, 2008.
BLACK, ORANGE, SKY, GREEN, BLUE, RED = (
    "#000000",
    "#e69f00",
    "#56b4e9",
    "#009e73",
    "#0072b2",
    "#d55e00",
)
STYLE = {
    "text.parse_math": False,  # a dollar sign is a dollar sign
    "font.size": 9.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#777777",
    "axes.labelcolor": "#222222",
    "xtick.color": "#444444",
    "ytick.color": "#444444",
    "grid.color": "#dddddd",
    "grid.linewidth": 0.7,
    "axes.axisbelow": True,
}


def drawn(
    height: float,
    draw: Callable[["Figure"], None],
    width: float = WIDTH,
    colors: int | None = 64,
) -> bytes:
    """Return the PNG of a figure of that size, inches, filled by draw(figure).

    colors : of its palette, at most 256; None keeps all, as photographs need."""
    from matplotlib import style

    with style.context(["default", STYLE]):  # whatever the user's matplotlibrc says
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        figure = Figure(figsize=(width, height), dpi=DPI, layout="constrained")
        FigureCanvasAgg(figure)
        draw(figure)
        png = io.BytesIO()
        figure.savefig(
            png,
            format="png",
            metadata={"Software": None},
            pil_kwargs={"optimize": colors is None},
        )
    return png.getvalue() if colors is None else indexed(png.getvalue(), colors)


def indexed(png: bytes, colors: int) -> bytes:
    """Return a figure's PNG with a palette: a third of the bytes, the same look."""
    from PIL import Image as Pillow

    packed = io.BytesIO()
    with Pillow.open(io.BytesIO(png)) as picture:
        flat = picture.convert("RGB").quantize(colors, dither=Pillow.Dither.NONE)
        flat.save(packed, "PNG", optimize=True)
    return packed.getvalue()
