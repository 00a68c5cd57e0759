# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Colours of lamps: published chromaticities, and laws."""

import pytest

from studies.night_scenes.choices.colour import lamp_rgb, neon_rgb, planckian_xy

LUMINANCE = (0.2126390, 0.7151687, 0.0721923)  # ITU-R BT.709


# CIE 015:2018: illuminant A; black bodies by Planck's law, c2 = 1.4388 cm K.
# The splines are within 0.001 of the locus.
@pytest.mark.parametrize(
    ("kelvin", "xy"),
    [
        (2000, (0.5267, 0.4133)),
        (2856, (0.4476, 0.4074)),
        (4000, (0.3805, 0.3768)),
        (6500, (0.3135, 0.3237)),
    ],
)
def test_black_bodies_have_published_chromaticities(kelvin, xy):
    assert planckian_xy(kelvin) == pytest.approx(xy, abs=1e-3)


@pytest.mark.parametrize("kelvin", [2000, 2700, 4000, 6500])
@pytest.mark.parametrize("duv", [-0.005, 0.0, 0.01])
def test_a_lamp_has_luminance_one(kelvin, duv):
    rgb = lamp_rgb(kelvin, duv)
    # 0.03: what Rec.709 cannot show is cut off, only blue of the warmest.
    luminance = sum(c * weight for c, weight in zip(rgb, LUMINANCE, strict=True))
    assert luminance == pytest.approx(1, abs=0.03)


def test_duv_is_green_above_the_black_body():
    magenta, plain, green = (lamp_rgb(3500, duv) for duv in (-0.01, 0.0, 0.01))
    assert magenta[1] < plain[1] < green[1]


def test_warm_is_red_and_cool_is_blue():
    ratios = [
        lamp_rgb(kelvin)[0] / lamp_rgb(kelvin)[2] for kelvin in (2200, 3000, 6500)
    ]
    assert ratios == sorted(ratios, reverse=True)


def test_a_temperature_out_of_range_is_refused():
    with pytest.raises(ValueError, match="1667"):
        planckian_xy(1500)


def test_hues_go_around_the_circle():
    largest = [max(range(3), key=neon_rgb(k / 3 + 0.05).__getitem__) for k in range(3)]
    assert largest == [0, 1, 2]
    assert neon_rgb(0.25) == neon_rgb(1.25)
