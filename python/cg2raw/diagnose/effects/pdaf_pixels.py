# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""PDAF pixels: a regular grid of pixels has another sensitivity."""

from cg2raw.diagnose.effects.base import Effect, Estimates
from cg2raw.diagnose.effects.sizes import percent, value_of


class PdafPixels(Effect):
    of_mean = False
    name = "pdaf_pixels"
    title = "phase-detection pixels"
    where = "pixels of a regular grid, in proportion to light"
    signature = frozenset({"gain", "map"})
    told_apart = {
        "prnu": "Flats: phase-detection pixels stand on a regular grid and all lack "
        "the same share, PRNU has no order.",
        "hot_pixels": "Darks beside flats: a hot pixel is bright in darks, a "
        "phase-detection pixel shows in light alone.",
        "gr_gb_imbalance": "Flats: an imbalance is that of all greens of a row, "
        "phase-detection pixels are few.",
    }

    def size(self, values: Estimates) -> str:
        gain, pitch = value_of(values, "gain"), value_of(values, "pitch")
        verb = "lack" if gain < 0 else "have"
        more = "" if gain < 0 else " more"
        row, column = value_of(values, "row"), value_of(values, "column")
        return (
            f"one pixel in {pitch:.0f} x {pitch:.0f}, from row {row:.0f} and column "
            f"{column:.0f} on, {verb} {percent(abs(gain))}{more} of the light"
        )


EFFECT = PdafPixels()
