# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Dust: soft dark spots at places of the sensor."""

from cg2raw.diagnose.effects.base import Estimates
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.effects.sizes import percent, value_of
from cg2raw.sensor import Sensor


class Dust(FixedPattern):
    name = "dust"
    title = "dust"
    where = "soft dark spots, the same in all frames, in proportion to light"
    told_apart = {
        "lens_shading": "Flats at another aperture: shadows of dust get smaller and "
        "darker and stay where they are, vignetting is that of the whole frame.",
        "prnu": "Flats: dust shades pixels that lie side by side alike, PRNU differs "
        "from each to the next.",
    }

    def size_in(self, values: Estimates, sensor: Sensor) -> str:
        depth, radius = (value_of(values, name) for name in ("depth", "radius"))
        return (
            f"{value_of(values, 'density'):.3g} spots per megapixel take "
            f"{percent(depth)} of the light, of a radius of {radius:.3g} px"
        )


EFFECT = Dust()
