# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Blur: the lens spreads light over neighbouring pixels."""

import numpy as np

from cg2raw.diagnose.diagnosis import Curve
from cg2raw.diagnose.effects.base import Effect, Estimates, MeasuredRatio, Values
from cg2raw.diagnose.effects.interval_curve import CURVE_POINTS, curve_with_interval
from cg2raw.diagnose.effects.sizes import percent, value_of

COSINES = 10  # cosines of the transfer function


class Blur(Effect):
    name = "blur"
    title = "lens blur"
    where = "along edges, flats are clean"
    step = 5e-3
    bounds = {"ring": (-0.6, 0.6), "red_scale": (-0.6, 0.6), "blue_scale": (-0.6, 0.6)}
    shapes = frozenset({"red_scale", "blue_scale"})
    signature = frozenset({"softener"})
    # Far wings of a point spread function, and what is left along edges. Where no darks
    # tell the black level, wings lift what is dark as it does.
    taken_up_by = {
        "veiling_glare": 0.015,
        "noise_reduction": 0.015,
        "crosstalk": 0.004,
        "black_level": 0.004,
    }

    def size(self, values: Estimates) -> str:
        rings = [value_of(values, f"ring_{n}") for n in range(1, COSINES + 1)]
        half = 1 + sum(a * (np.cos(n * np.pi / 2) - 1) for n, a in enumerate(rings, 1))
        return f"contrast at half the Nyquist frequency is {percent(half)}"

    def curve(
        self, values: Values, estimates: Estimates, measured: MeasuredRatio
    ) -> Curve:
        f = np.linspace(0, 1, CURVE_POINTS)
        design = np.zeros((CURVE_POINTS, len(values)))
        for n in range(1, COSINES + 1):
            design[:, n - 1] = np.cos(n * np.pi * f) - 1
        nothing = np.zeros(0)
        return Curve(
            "Transfer of contrast by the lens",
            "spatial frequency, 1 is Nyquist's",
            "contrast",
            f,
            *curve_with_interval(values, estimates, design),
            nothing,
            nothing,
            self.name,
        )


EFFECT = Blur()
