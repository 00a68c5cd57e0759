# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Mains flicker: bands of light down the rows, of another phase in every frame."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cg2raw.diagnose.effects.base import Effect, Estimates
from cg2raw.diagnose.effects.registry import listed_values
from cg2raw.diagnose.effects.sizes import percent, value_of
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.sensor import Sensor


class MainsFlicker(Effect):
    """Its phase is no parameter: it is even over a turn, which a Gaussian wave of the
    same variance is nearly, and that is integrated out."""

    name = "mains_flicker"
    title = "mains flicker"
    where = "bands down the rows, in proportion to light, anew in every frame"
    of_mean = False
    whitens_variance = True
    signature = frozenset({"noise"})
    told_apart = {
        "row_noise": "Darks beside flats: flicker is in proportion to light and has a "
        "period, row noise is in darks as well and differs from each row to the next.",
        "lens_shading": "Repeated flats: what a lens shades stays where it is, and "
        "flicker moves from frame to frame.",
    }

    def waves(self, values: Sequence[float] | Array, rows: Array) -> list[Array]:
        """Return waves of light at image rows, relative to it, of independent normal
        numbers of variance 1."""
        amplitude, period = values
        turns = 2 * np.pi * rows / period
        return [amplitude / np.sqrt(2) * wave(turns) for wave in (np.cos, np.sin)]

    def profile_values(
        self, sensor: Sensor, row: Mapping[str, Any], read_noise: float
    ) -> tuple[float, ...] | None:
        return listed_values(sensor, self.name)

    def size(self, values: Estimates) -> str:
        return (
            f"amplitude {percent(value_of(values, 'amplitude'))} of the light, one "
            f"wave in {value_of(values, 'period'):.4g} rows"
        )


EFFECT = MainsFlicker()
