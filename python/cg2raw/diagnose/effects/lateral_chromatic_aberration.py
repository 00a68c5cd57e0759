# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Lateral chromatic aberration: red and blue are displaced against green."""

from cg2raw.diagnose.effects.base import Effect, Estimates
from cg2raw.diagnose.effects.sizes import total


class LateralChromaticAberration(Effect):
    name = "lateral_chromatic_aberration"
    title = "lateral chromatic aberration"
    where = "along edges, red and blue shifted radially"
    step = 0.02
    affine = False
    # How an image is displaced between pixels.
    taken_up_by = {"blur": 0.01, "noise_reduction": 0.01}
    told_apart = {
        "blur": "Edges near the corners: lateral chromatic aberration moves red and "
        "blue in opposite ways and vanishes at the centre.",
    }

    def size(self, values: Estimates) -> str:
        red = total(values, "red", "red_r2")
        blue = total(values, "blue", "blue_r2")
        return f"red is moved {red:.3g} px and blue {blue:.3g} px at the corner"


EFFECT = LateralChromaticAberration()
