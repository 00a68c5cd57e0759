# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""DSNU: pixels of unequal offset."""

from cg2raw.diagnose.effects.fixed_pattern import FixedPattern


class Dsnu(FixedPattern):
    name = "dsnu"
    title = "DSNU"
    where = "the same pixels in all frames, whatever the light"
    told_apart = {
        "prnu": "Darks and flats: DSNU is there without light, PRNU is in proportion "
        "to it.",
    }


EFFECT = Dsnu()
