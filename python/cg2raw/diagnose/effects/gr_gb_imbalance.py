# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Gr/Gb imbalance: the two greens of a Bayer CFA differ."""

from cg2raw.diagnose.effects.base import Effect


class GrGbImbalance(Effect):
    name = "gr_gb_imbalance"
    title = "Gr/Gb imbalance"
    where = "greens of red rows against greens of blue rows"
    # What both greens have is a white balance: a sensor's differ by some per cent.
    bounds = {"gr": (-0.1, 0.1), "gb": (-0.1, 0.1)}  # on top of what a profile has
    from_means = True
    bayer_only = True
    told_apart = {
        "crosstalk": "Scenes with coloured edges: crosstalk follows the neighbours' "
        "signal, a Gr/Gb imbalance does not.",
    }


EFFECT = GrGbImbalance()
