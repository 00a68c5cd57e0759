# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Quantisation: a profile may have it; no diagnosis looks for it."""

from cg2raw.diagnose.effects.base import Effect


class Quantisation(Effect):
    """Steps of the ADC are of the levels of a profile, and known."""

    name = "quantisation"
    title = "quantisation"
    where = "levels in steps"
    nameable = False


EFFECT = Quantisation()
