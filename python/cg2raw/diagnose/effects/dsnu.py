# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""DSNU: pixels of unequal offset."""

from collections.abc import Mapping

from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.frames.tiling import Array


class Dsnu(FixedPattern):
    name = "dsnu"
    title = "DSNU"
    where = "the same pixels in all frames, whatever the light"
    told_apart = {
        "prnu": "Darks and flats: DSNU is there without light, PRNU is in proportion "
        "to it.",
    }

    def pattern_variance(
        self, stated: Mapping[str, float], light: Array, seconds: float
    ) -> float:
        return stated["sigma"] ** 2


EFFECT = Dsnu()
