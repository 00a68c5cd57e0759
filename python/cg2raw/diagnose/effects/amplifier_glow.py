# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Amplifier glow: light of the read-out amplifier, at an edge or in a corner."""

from cg2raw.diagnose.effects.base import Effect, Estimates
from cg2raw.diagnose.effects.sizes import of_white, value_of
from cg2raw.sensor import Sensor


class AmplifierGlow(Effect):
    """Charge that fades from a point; what it leaves grows with exposure time."""

    name = "amplifier_glow"
    title = "amplifier glow"
    where = "fades from an edge or a corner, with exposure time, in darks too"
    of_mean = False
    signature = frozenset({"offset"})
    told_apart = {
        "bias_structure": "Darks of two exposure times: what an amplifier's light "
        "leaves grows with time, a bias structure does not.",
        "dark_current": "One long dark: dark current lifts all of it evenly.",
    }

    def size_on(self, values: Estimates, sensor: Sensor) -> str:
        """Return rate, place and extent; the rate in DN."""
        rate = of_white(value_of(values, "per_second"), sensor)
        places = (value_of(values, "row"), value_of(values, "column"))
        down, across = (f"{place:+.2f}" for place in places)
        return (
            f"{rate} per second at row {down}, column {across} (-1 and +1 at the "
            f"edges), less by a factor e every {value_of(values, 'extent'):.3g} half "
            "diagonals"
        )


EFFECT = AmplifierGlow()
