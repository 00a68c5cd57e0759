# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The oracles themselves, against published values."""

import numpy as np
import pytest

from oracles import adobe, cameras, de2000, highlights, philox, robertson


@pytest.mark.parametrize(("counter", "key", "words"), philox.KNOWN_ANSWERS)
def test_philox_known_answers(counter, key, words):
    assert philox.words(counter, key) == words


# L*a*b* pairs and their difference. Source: Sharma, Wu and Dalal 2005, table 1; those
# pairs that tell the hue's special cases apart.
SHARMA = [
    ((50.0, 2.6772, -79.7751), (50.0, 0.0, -82.7485), 2.0425),
    ((50.0, -1.3802, -84.2814), (50.0, 0.0, -82.7485), 1.0000),
    ((50.0, 0.0, 0.0), (50.0, -1.0, 2.0), 2.3669),
    ((50.0, 2.4900, -0.0010), (50.0, -2.4900, 0.0009), 7.1792),
    ((50.0, 2.4900, -0.0010), (50.0, -2.4900, 0.0011), 7.2195),
    ((50.0, -0.0010, 2.4900), (50.0, 0.0009, -2.4900), 4.8045),
    ((50.0, -0.0010, 2.4900), (50.0, 0.0011, -2.4900), 4.7461),
    ((50.0, 2.5, 0.0), (73.0, 25.0, -18.0), 27.1492),
    ((50.0, 2.5, 0.0), (61.0, -5.0, 29.0), 22.8977),
    ((60.2574, -34.0099, 36.2677), (60.4626, -34.1751, 39.4387), 1.2644),
    ((22.7233, 20.0904, -46.6940), (23.0331, 14.9730, -42.5619), 2.0373),
    ((90.8027, -2.0831, 1.4410), (91.1528, -1.6435, 0.0447), 1.4441),
    ((2.0776, 0.0795, -1.1350), (0.9033, -0.0636, -0.5514), 0.9082),
]


@pytest.mark.parametrize(("one", "other", "difference"), SHARMA)
def test_de2000_matches_published_pairs(one, other, difference):
    assert de2000.de2000(one, other) == pytest.approx(difference, abs=5e-5)
    assert de2000.de2000(other, one) == pytest.approx(difference, abs=5e-5)


def test_white_is_lab_100():
    lab = de2000.lab_from_linear_srgb([1.0, 1.0, 1.0])
    assert lab == pytest.approx([100.0, 0.0, 0.0], abs=1e-9)


# The published matrix. Source: IEC 61966-2-1, rounded there to 4 digits.
IEC_XYZ_FROM_SRGB = [
    [0.4124, 0.3576, 0.1805],
    [0.2126, 0.7152, 0.0722],
    [0.0193, 0.1192, 0.9505],
]


def test_xyz_from_srgb_is_that_of_the_standard():
    assert adobe.xyz_d65_from_srgb() == pytest.approx(
        np.array(IEC_XYZ_FROM_SRGB), abs=6e-5
    )


# Black bodies. Source: Planck's law and the CIE 1931 observer, as Wyszecki & Stiles,
# table 1(3.11), and CIE 015 (illuminant A) print them.
PLANCKIAN = [
    (2000.0, (0.5267, 0.4133)),
    (2855.5, (0.44757, 0.40745)),
    (4000.0, (0.3805, 0.3768)),
    (5000.0, (0.3451, 0.3516)),
    (6500.0, (0.3135, 0.3237)),
    (10000.0, (0.2807, 0.2884)),
]


@pytest.mark.parametrize(("kelvin", "xy"), PLANCKIAN)
def test_robertson_gives_black_bodies_their_temperature(kelvin, xy):
    cct, duv = robertson.temperature(xy, "corrected")
    assert cct == pytest.approx(kelvin, rel=3e-3)  # xy has 4 digits
    assert abs(duv) < 2e-4


def test_robertson_has_a_misprint_in_one_row_only():
    differing = robertson.table("adobe") != robertson.table("corrected")
    assert np.argwhere(differing).tolist() == [[19, 1]]


def test_robertson_and_colour_science_agree():
    colour = pytest.importorskip("colour", reason="colour-science is not installed")
    module = colour.temperature.robertson1968
    table = np.array(module.DATA_ISOTEMPERATURE_LINES_ROBERTSON1968)
    assert table[:, 1:] == pytest.approx(robertson.ISOTHERMS[:, 1:], abs=0)
    for xy in [(0.4476, 0.4074), (0.3127, 0.3290), (0.28, 0.29), (0.5, 0.41)]:
        uv = colour.xy_to_UCS_uv(np.array(xy))
        expected = colour.temperature.uv_to_CCT_Robertson1968(uv)
        assert robertson.temperature(xy, "corrected") == pytest.approx(
            expected, rel=1e-9
        )


def test_highlights_leave_white_white_and_mid_grey_alone():
    gains = np.array([0.5, 1.0, 0.7])
    assert highlights.unbalanced(np.ones(3), gains) == pytest.approx(1.0)
    assert highlights.unbalanced(np.full(3, 0.9), gains) == pytest.approx(0.9 * gains)


def test_colorchecker_is_what_it_looks_like():
    rgb = cameras.colorchecker()
    assert rgb.shape == (24, 3)
    assert np.argmax(rgb[14]) == 0 and np.argmax(rgb[13]) == 1  # red, green
    assert np.ptp(rgb[18:], axis=1).max() < 0.03  # the greys are grey
