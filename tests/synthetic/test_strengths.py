# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Hidden effects are as strong as is stated."""

import numpy as np
import pytest

from cg2raw.synthetic.strengths import KINDS, UNKNOWN_KINDS, _glow, _pdaf, draw_effect


def test_a_glow_is_also_in_corners():
    rng = np.random.default_rng(2)
    drawn = [_glow(rng, 1.0, None) for _ in range(200)]
    places = {(one["down"], one["across"]) for one in drawn}
    assert {(0, 0), (0, 1), (1, 0), (1, 1)} <= places


def test_periods_of_phase_detection_pixels_are_even():
    rng = np.random.default_rng(2)
    periods = {_pdaf(rng, 0.1, None)["period"] for _ in range(200)}
    assert periods == {8, 10, 12, 14, 16}


# How large an effect is by its parameters, in the unit of its strength; of the others
# one parameter is.
SIZES = {
    "exposure": lambda v, unit: abs(np.exp2(v["stops"]) - 1),
    "white_balance": lambda v, unit: np.hypot(
        np.exp2(v["red_stops"]) - 1, np.exp2(v["blue_stops"]) - 1
    ),
    "color_matrix": lambda v, unit: np.linalg.norm(list(v.values())),
    "lateral_chromatic_aberration": lambda v, unit: np.hypot(v["red_px"], v["blue_px"]),
    "color_shading": lambda v, unit: (
        1
        - np.cos(np.radians(v["corner_degrees"]))
        ** max(abs(v["red_power"]), abs(v["blue_power"]))
    ),
    "crosstalk": lambda v, unit: sum(v.values()),
    "bias_structure": lambda v, unit: np.hypot(v["right_dn"], v["down_dn"]) / unit,
}


NOT_ONE = ("black_level",)  # of which each site has another
SIGNED = {
    *("shot_noise", "read_noise", "read_noise_correlation", "lens_distortion"),
    *("gr_gb_imbalance", "amplifier_mismatch"),
}


@pytest.mark.parametrize("name", [*KINDS, *UNKNOWN_KINDS])
def test_an_effect_is_as_strong_as_is_stated(camera, name):
    kind = KINDS.get(name) or UNKNOWN_KINDS[name]
    rng = np.random.default_rng(3)
    unit = float((camera.dn_per_electron * camera.read_noise).mean())
    for strength in np.geomspace(kind.low, kind.high, 9):
        values = draw_effect(name, rng, camera, strength)
        if name in SIZES:
            assert SIZES[name](values, unit) == pytest.approx(strength)
        elif name not in NOT_ONE:
            sizes = [
                one for one in values.values() if abs(one) == pytest.approx(strength)
            ]
            assert sizes and (name in SIGNED or sizes[0] > 0)
    drawn = [kind.random_strength(rng) for _ in range(400)]
    assert kind.low <= min(drawn) <= max(drawn) <= kind.high * (1 + 1e-12)
    middle = np.log(drawn).mean() - np.log(kind.low * kind.high) / 2
    width = np.log(kind.high / kind.low)
    assert abs(middle) <= 4.5 * width / np.sqrt(12 * 400)  # log-uniform
    for strength in (0.0, -1.0, 10.01 * kind.high, np.nan):
        with pytest.raises(ValueError, match=rf"of {name} \(.*\) must be above 0 and"):
            draw_effect(name, rng, camera, strength)


@pytest.mark.parametrize("name", sorted(SIGNED))
def test_either_sign_occurs(camera, name):
    draws = [
        draw_effect(name, np.random.default_rng(n), camera, 0.02) for n in range(20)
    ]
    signs = {
        np.sign(v) for one in draws for v in one.values() if abs(abs(v) - 0.02) < 1e-9
    }
    assert signs == {-1, 1}


def test_former_names_of_effects_are_told_the_new(camera):
    for name, words in (
        ("early_clipping", "'early_clipping' is called 'full_well' now"),
        ("fog", "'fog' is unknown; there are amplifier_glow, "),
    ):
        with pytest.raises(ValueError, match=f"hidden effect {words}"):
            draw_effect(name, np.random.default_rng(0), camera)
