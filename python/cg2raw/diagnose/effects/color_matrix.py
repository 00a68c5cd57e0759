# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Colour matrix: channels mix in another way than the profile says."""

from cg2raw.diagnose.effects.base import Effect


class ColorMatrix(Effect):
    """Of a uniform frame a matrix makes what a white balance makes: it needs images."""

    name = "color_matrix"
    title = "colour matrix"
    where = "grows with chroma, none on greys"
    signature = frozenset({"mixer"})
    told_apart = dict.fromkeys(
        ("exposure", "nonlinearity"),
        "Flats of grey light: a colour matrix leaves greys as they are.",
    )


EFFECT = ColorMatrix()
