# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""color.h: temperatures and black bodies, against the oracle and published values."""

import numpy as np
import pytest

import cg2raw
from oracles import adobe, robertson

TABLES = ("adobe", "corrected")
# Bluer than the table, along the locus and off it, redder than the table.
GRID = [
    (x, y)
    for x in np.linspace(0.20, 0.60, 21)
    for y in np.linspace(0.20, 0.50, 16)
    if x + y < 1.0
]


@pytest.mark.parametrize("table", TABLES)
def test_temperature_equals_the_oracle(table):
    for xy in GRID:
        cct, duv = cg2raw.temperature_from_xy(xy, table=table)
        expected_cct, expected_duv = robertson.temperature(xy, table)
        assert cct == pytest.approx(expected_cct, rel=1e-9), xy
        assert duv == pytest.approx(expected_duv, abs=1e-9), xy


def test_tables_differ_only_around_325_mired():
    near, far = adobe.chromaticity([1.05, 1.0, 0.45]), adobe.D65
    near_cct = [cg2raw.temperature_from_xy(tuple(near), table=t)[0] for t in TABLES]
    far_cct = [cg2raw.temperature_from_xy(far, table=t)[0] for t in TABLES]
    assert 2857.0 < near_cct[1] < 3333.0 and near_cct[0] != near_cct[1]
    assert far_cct[0] == far_cct[1]


# Source: CIE 015:2018, chromaticities to 5 digits and the temperatures that go with
# them; Robertson's method is good to about 0.1 %.
STANDARD_LIGHTS = [
    ((0.44757, 0.40745), 2855.5),
    ((0.34567, 0.35850), 5003.0),
    ((0.33243, 0.34744), 5503.0),
    ((0.31272, 0.32903), 6504.0),
    ((0.29903, 0.31488), 7504.0),
]


@pytest.mark.parametrize(("xy", "kelvin"), STANDARD_LIGHTS)
def test_standard_lights_have_their_temperature(xy, kelvin):
    cct, _ = cg2raw.temperature_from_xy(xy, table="corrected")
    assert cct == pytest.approx(kelvin, rel=1e-3)


def test_duv_is_positive_above_the_locus():
    x, y = cg2raw.planckian_xy(5000.0)
    assert cg2raw.temperature_from_xy((x, y + 0.01), table="corrected")[1] > 0.0
    assert cg2raw.temperature_from_xy((x, y - 0.01), table="corrected")[1] < 0.0


@pytest.mark.parametrize(
    "kelvin", [1667.0, 2000.0, 2856.0, 3200.0, 4000.0, 5000.0, 9e3]
)
def test_planckian_xy_is_the_inverse_of_temperature(kelvin):
    cct, duv = cg2raw.temperature_from_xy(
        cg2raw.planckian_xy(kelvin), table="corrected"
    )
    assert cct == pytest.approx(kelvin, rel=2e-4)  # a chord between two isotherms
    assert abs(duv) < 1e-9


# Source: CIE 015, illuminant A; Wyszecki & Stiles, table 1(3.11).
@pytest.mark.parametrize(
    ("kelvin", "xy"),
    [
        (2000.0, (0.5267, 0.4133)),
        (2855.5, (0.44757, 0.40745)),
        (5000.0, (0.3451, 0.3516)),
        (10000.0, (0.2807, 0.2884)),
    ],
)
def test_planckian_xy_is_a_black_body(kelvin, xy):
    assert cg2raw.planckian_xy(kelvin) == pytest.approx(xy, abs=2e-4)


@pytest.mark.parametrize("kelvin", [1666.9, 25000.1, 0.0, -3000.0, np.nan, np.inf])
def test_black_bodies_outside_the_table_are_errors(kelvin):
    with pytest.raises(ValueError, match="1667.*25000"):
        cg2raw.planckian_xy(kelvin)


def test_unknown_table_is_an_error():
    with pytest.raises(ValueError, match="adobe.*corrected"):
        cg2raw.temperature_from_xy((0.3127, 0.3290), table="robertson")
