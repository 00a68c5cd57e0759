# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Amplifier mismatch: halves of the frame that are read by amplifiers of their own."""

from cg2raw.diagnose.effects.base import Effect, Estimates
from cg2raw.diagnose.effects.sizes import of_white, percent
from cg2raw.sensor import Sensor

HALVES = {
    "horizontal": "right half less the left",
    "vertical": "lower half less the upper",
}


class AmplifierMismatch(Effect):
    name = "amplifier_mismatch"
    title = "amplifier mismatch"
    where = "a step in the middle of the frame, across or down"
    of_images = False
    signature = frozenset({"offset", "gain"})
    told_apart = {
        "bias_structure": "More darks: their mean tells a step in the middle, of two "
        "amplifiers, from a ramp along the whole frame.",
        "lens_shading": "More flats: their mean tells a step in the middle, of two "
        "amplifiers, from light that falls off smoothly.",
    }

    def size_on(self, values: Estimates, sensor: Sensor) -> str:
        """Return each step, of black levels in DN."""
        parts = []
        for way, halves in HALVES.items():
            steps = [
                f"{of_white(one.value, sensor)} of black level"
                if parameter.endswith("offset")
                else f"{percent(one.value)} of response"
                for parameter, one in values.items()
                if parameter.startswith(way)
            ]
            if steps:
                parts.append(f"{halves}: {' and '.join(steps)}")
        return "; ".join(parts)


EFFECT = AmplifierMismatch()
