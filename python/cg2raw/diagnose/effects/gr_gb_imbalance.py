# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Gr/Gb imbalance: the two greens of a Bayer CFA differ."""

from cg2raw.diagnose.effects.base import Effect


class GrGbImbalance(Effect):
    name = "gr_gb_imbalance"
    title = "Gr/Gb imbalance"
    where = "greens of red rows against greens of blue rows"
    from_means = True
    bayer_only = True
    told_apart = {
        "crosstalk": "Scenes with coloured edges: crosstalk follows the neighbours' "
        "signal, a Gr/Gb imbalance does not.",
    }


EFFECT = GrGbImbalance()
