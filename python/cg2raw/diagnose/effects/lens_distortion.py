# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Lens distortion: all colours are displaced radially, by more than a scale."""

from cg2raw.diagnose.effects.base import Effect, Estimates
from cg2raw.diagnose.effects.sizes import total


class LensDistortion(Effect):
    name = "lens_distortion"
    title = "lens distortion"
    where = "along edges, all channels shifted radially"
    step = 0.02
    affine = False
    # How an image is displaced between pixels.
    taken_up_by = {"blur": 0.01, "noise_reduction": 0.01}
    told_apart = {
        "lateral_chromatic_aberration": "Coloured edges near the corners: distortion "
        "moves all colours alike, lateral chromatic aberration red and blue alone.",
    }

    def size(self, values: Estimates) -> str:
        moved = total(values, "r2", "r4")
        kind = "barrel" if moved > 0 else "pincushion"
        return f"light is moved {abs(moved):.3g} px at the corner, as by a {kind}"


EFFECT = LensDistortion()
