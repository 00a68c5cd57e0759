# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Bias structure: a black level that is not the same all over the frame."""

from cg2raw.diagnose.effects.base import Effect


class BiasStructure(Effect):
    """A ramp, and first columns of their own; what single columns have besides is the
    column fixed pattern's, and what single pixels have is DSNU."""

    name = "bias_structure"
    title = "bias structure"
    where = "a ramp over the frame, or its first columns, whatever the light"
    of_images = False
    unfitted = frozenset({"edge", "edge_length"})  # too few columns
    # First columns, and what is like them in few scenes.
    taken_up_by = dict.fromkeys(("black_level", "lens_shading", "color_shading"), 1.0)
    signature = frozenset({"offset"})
    told_apart = {
        "black_level": "One dark: a black level lifts it evenly.",
    }


EFFECT = BiasStructure()
