# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measured lenses and read noise in place of the generator's own."""

import numpy as np
import pytest
from scipy.stats import tukeylambda

from cg2raw.synthetic.captures import simulate_captures
from cg2raw.synthetic.measured import (
    Measured,
    ReadNoise,
    gain_map_transmission,
    polynomial_transmission,
)
from cg2raw.synthetic.sensors import drawn_sensor

SHAPE = (96, 128)


def gain_map(site, gains, origin=(0.0, 0.0)):
    """Return a map as read_dng_metadata does, its points evenly over the frame."""
    gains = np.array(gains, float)
    spacing = tuple(1 / (n - 1) for n in gains.shape)
    return {"sites": [site], "spacing": spacing, "origin": origin, "gains": gains}


def test_a_gain_map_is_undone_site_by_site():
    maps = [gain_map(site, [[1, 2, 1]] * 3) for site in range(3)]
    maps.append(gain_map(3, [[1, 1, 1], [2, 2, 2], [4, 4, 4]]))
    field = gain_map_transmission(maps, 4, (40, 80))
    # Column 19 is at (19 + 0.5) / 80, nearly half way to the point of gain 2.
    assert field[0, 19] == pytest.approx(1 / (1 + 2 * 19.5 / 80))
    assert field[1, 18] == pytest.approx(1 / (1 + 2 * 18.5 / 80))
    assert field[39, 1] == pytest.approx(1 / (2 + 2 * (2 * 39.5 / 40 - 1)))
    np.testing.assert_allclose(field[1::2, 1], field[1::2, 79])


def test_beyond_a_gain_maps_points_its_nearest_counts():
    field = gain_map_transmission([gain_map(0, [[2, 1]] * 2, (0.0, 0.5))], 1, (8, 8))
    np.testing.assert_array_equal(field[:, :4], 0.5)
    assert (np.diff(field[0, 4:]) > 0).all() and field[0, 7] < 1


def test_a_polynomial_is_1_in_the_middle_and_its_sum_in_the_corner():
    field = polynomial_transmission((-0.5, 0.2, -0.1), (300, 401))
    assert field[149:151, 200] == pytest.approx(1, abs=1e-4)
    assert field[0, 0] == pytest.approx(0.6, abs=4e-3)
    np.testing.assert_allclose(field, field[::-1, ::-1])


@pytest.mark.parametrize("shape", [0.14, 0.0, -0.15])
def test_read_noise_is_a_tukey_lambda_with_rows(shape):
    drawn = ReadNoise(shape, 0.9, 0.4).draw(np.random.default_rng(4), (400, 500))
    rows = drawn.mean(1)
    assert rows.std() == pytest.approx(0.4, rel=0.15)
    pixels = drawn - rows[:, None]
    assert pixels.std() == pytest.approx(0.9, rel=0.02)
    share = np.mean(np.abs(pixels) > 2.7)  # beyond three of their deviations
    spread = np.sqrt(tukeylambda.var(shape))
    assert share == pytest.approx(2 * tukeylambda.sf(3 * spread, shape), rel=0.1)


def test_a_transmission_multiplies_the_light_alone():
    sensor = drawn_sensor(3)
    field = np.linspace(0.2, 1, SHAPE[1]) * np.ones(SHAPE)
    clean, dim = (
        simulate_captures(sensor, {}, seed=3, shape=SHAPE, measured=measured).captures
        for measured in (None, Measured(transmission=field))
    )
    for one, other in zip(clean, dim, strict=True):
        a, b = (np.asarray(sensor.signal_from_raw(c.raw())) for c in (one, other))
        expected = a * field if one.kind == "flat" else a
        if one.kind != "scene":
            columns = (expected - b).mean(0) / (b.std() + 1e-9)
            assert abs(columns).max() < 0.5


@pytest.mark.parametrize("field", [np.ones((8, 8)), np.full(SHAPE, -0.1)])
def test_a_transmission_must_fit(field):
    with pytest.raises(ValueError, match="must have the frames' shape"):
        simulate_captures(
            drawn_sensor(3), {}, seed=3, shape=SHAPE, measured=Measured(field)
        )
