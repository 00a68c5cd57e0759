# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Which part decides each effect: each effect is in one, and named by it alone."""

import math

import pytest

from cg2raw.diagnose.effects.catalogue import names, of_images
from cg2raw.model import dark_levels, flat_levels, lags, selection
from cg2raw.model.shapes import (
    dust,
    heavy_tailed_noise,
    hot_pixels,
    pdaf_pixels,
    random_telegraph_noise,
)
from cg2raw.synthetic.strengths import KINDS
from diagnose.test_darks_and_flats import found
from tiers import first_fast

PARTS = {
    "levels of darks": ("black_level", "dark_current", "black_level_drift"),
    "levels of flats": (
        *("exposure", "white_balance", "crosstalk", "gr_gb_imbalance"),
        "nonlinearity",
    ),
    "variances": (
        *("read_noise", "shot_noise", "row_noise", "mains_flicker"),
        *("dsnu", "column_fixed_pattern", "bias_structure"),
        *("dark_current_nonuniformity", "amplifier_glow"),
        *("prnu", "lens_shading", "color_shading"),
    ),
    "lags": ("read_noise_correlation", "noise_reduction"),
    "shapes": (
        *("hot_pixels", "random_telegraph_noise", "heavy_tailed_noise"),
        *("dust", "pdaf_pixels"),
    ),
    "images": (
        *("color_matrix", "blur", "lateral_chromatic_aberration", "veiling_glare"),
        *("full_well", "poisson_shot_noise", "lens_distortion"),
    ),
}
OF_DARKS_AND_FLATS = [n for part in PARTS if part != "images" for n in PARTS[part]]


def test_each_effect_is_in_one_part():
    every = [name for part in PARTS.values() for name in part]
    assert sorted(every) == sorted(names())


def test_parts_have_their_effects():
    modules = (
        *(hot_pixels, random_telegraph_noise, heavy_tailed_noise),
        *(dust, pdaf_pixels),
    )
    parts = {
        "levels of darks": dark_levels.LEVELS,
        "levels of flats": flat_levels.CHANGES,
        "variances": set(selection.NAMES) - set(dark_levels.LEVELS),
        "lags": lags.NAMES,
        "shapes": {module.__name__.rpartition(".")[2] for module in modules},
    }
    for part, own in parts.items():
        assert set(own) == set(PARTS[part]), part
    of_light = {*PARTS["levels of flats"], "lens_shading", "color_shading"}
    assert of_images() == of_light | set(PARTS["images"])


@pytest.mark.parametrize("name", first_fast(OF_DARKS_AND_FLATS, 1))
def test_each_is_named_alone(name):
    """At the middle of the strengths that the generator hides."""
    strength = math.sqrt(KINDS[name].low * KINDS[name].high)
    diagnosed = found({name: strength}, seed=8)
    assert list(diagnosed.names) == [name]
    assert not diagnosed.unexplained
