# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The noise table of a profile: interpolated between its ISOs, and not far beyond."""

import numpy as np
import pytest

import cg2raw
from oracles import cameras

NOISE = {"iso": 100, "beta1": [1e-4] * 4, "beta2": [1e-6] * 4}


def load(**fields):
    return cg2raw.Sensor.from_json(cameras.profile_text(**fields), name="inline.json")


def table(isos, beta1, beta2):
    rows = zip(isos, beta1, beta2, strict=True)
    return [{"iso": i, "beta1": [a] * 4, "beta2": [b] * 4} for i, a, b in rows]


def test_noise_is_interpolated_on_log_log_axes():
    sensor = load(
        noise=table([100, 400, 1600], [1e-4, 4e-4, 1.6e-3], [1e-6, 9e-6, 9e-6])
    )
    for iso, beta1, beta2 in [
        (100, 1e-4, 1e-6),
        (200, 2e-4, 3e-6),
        (800, 8e-4, 9e-6),
        (1600, 1.6e-3, 9e-6),
        (50, 5e-5, 1e-6 / 3.0),
        (3200, 3.2e-3, 9e-6),
    ]:
        noise = sensor.noise_at(iso)
        assert noise["iso"] == iso
        assert noise["beta1"] == pytest.approx([beta1] * 4, rel=1e-12)
        assert noise["beta2"] == pytest.approx([beta2] * 4, rel=1e-12)


def shaped(isos, lambdas, sigmas, beta2):
    rows = table(isos, [1e-4] * len(isos), beta2)
    for row, tukey_lambda, sigma in zip(rows, lambdas, sigmas, strict=True):
        row.update(tukey_lambda=tukey_lambda, row_sigma=sigma)
    return rows


def test_the_shape_of_noise_between_isos():
    """row_sigma as beta2 on log-log axes, lambda linear in log ISO, held outside."""
    noise = shaped([100, 400], [-0.2, 0.1], [1e-4, 4e-4], [1e-6, 4e-6])
    sensor = load(noise=noise)
    for iso, tukey_lambda, sigma in [
        (50, -0.2, 5e-5),
        (100, -0.2, 1e-4),
        (200, -0.05, 2e-4),
        (400, 0.1, 4e-4),
        (800, 0.1, 8e-4),
    ]:
        seen = sensor.noise_at(iso)
        assert seen["tukey_lambda"] == pytest.approx(tukey_lambda, rel=1e-12)
        assert seen["row_sigma"] == pytest.approx(sigma, rel=1e-12)
    assert "row_sigma" not in load(noise=[NOISE]).noise_at(100)


@pytest.mark.parametrize(
    ("sigmas", "beta2", "iso"),
    [([1e-4, 1e-3], [1e-6, 1e-6], 800), ([0.0, 1e-3], [1e-9, 1e-6], 200)],
)
def test_noise_of_rows_is_never_more_than_all_the_noise(sigmas, beta2, iso):
    noise = load(noise=shaped([100, 400], [0.1, 0.1], sigmas, beta2)).noise_at(iso)
    assert noise["row_sigma"] == pytest.approx(noise["beta2"][0] ** 0.5, rel=1e-12)


@pytest.mark.parametrize("iso", [49.9, 3201, 0, -100, np.nan, np.inf])
def test_more_than_one_stop_beyond_the_table_is_an_error(iso):
    sensor = load(noise=table([100, 1600], [1e-4, 1.6e-3], [1e-6, 9e-6]))
    with pytest.raises(ValueError, match="50 to 3200.*at: 100, 1600$"):
        sensor.noise_at(iso)


def test_a_sensor_without_noise_says_so():
    with pytest.raises(ValueError, match="test-sensor.*no.*noise"):
        load(noise=None).noise_at(100)


def test_a_measured_zero_stays_finite_between_isos():
    sensor = load(noise=table([100, 400], [1e-4, 4e-4], [0.0, 4e-6]))
    assert 0.0 <= sensor.noise_at(200)["beta2"][0] <= 4e-6
    assert sensor.noise_at(50)["beta2"][0] >= 0.0
