# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Colour shading: vignetting of red and blue that differs from that of green."""

from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.effects.lens_shading import MORE_FLATS, SAME_ALL_OVER


class ColorShading(Effect):
    name = "color_shading"
    title = "colour shading"
    where = "with radius, red and blue unlike green"
    step = 2e-3
    told_apart = {
        "lens_shading": "Flats: shading that differs between red, green and blue is "
        "colour shading.",
        **dict.fromkeys(SAME_ALL_OVER, MORE_FLATS),
    }


EFFECT = ColorShading()
