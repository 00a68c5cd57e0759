# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Read noise that correlates along rows: of which noise, how far, and whose it is."""

import numpy as np
import pytest

import cg2raw
from oracles import cameras

SHAPE = (400, 600)
PIXELS = SHAPE[0] * SHAPE[1]
READ = [4e-6, 9e-6, 1.6e-5, 4e-6]  # variance at the CFA's sites
ROW = {"iso": 100, "beta1": [2e-4] * 4, "beta2": READ}
OUTLIERS = {"outlier_fraction": 0.02, "outlier_variance_ratio": 9.0}


def sensor_of(coefficient, row=ROW, drawn=None):
    setting = {
        "name": "read_noise_correlation",
        "parameters": {"coefficient": coefficient},
    }
    fields = {"noise": [row], "noise_effects": drawn, "effects": [setting]}
    return cg2raw.Sensor.from_json(cameras.profile_text(**fields))


def residuals(sensor, level=0.0):
    """Return what is drawn less what is predicted, in predicted deviations."""
    rgb = np.full((*SHAPE, 3), level, np.float32)
    run = {"illuminant": "D50", "iso": 100, "camera_input": True}
    mean, variance = (np.asarray(x, float) for x in sensor.predict(rgb, **run))
    seen = np.asarray(sensor.signal(rgb, seed=3, **run), float)
    return (seen - mean) / np.sqrt(variance)


def correlation(z, down, right):
    height, width = z.shape
    return float(np.mean(z[down:, right:] * z[: height - down, : width - right]))


@pytest.mark.parametrize("coefficient", [-0.5, -0.07, 0.02, 0.3])
def test_it_is_an_autoregressive_process_along_rows(coefficient):
    """Of sites of unlike noise, too; five standard errors of a mean of products."""
    z = residuals(sensor_of(coefficient))
    error = 5 / np.sqrt(PIXELS) / (1 - abs(coefficient))
    assert z.var() == pytest.approx(1.0, abs=2 * error)
    for lag in range(1, 6):
        assert correlation(z, 0, lag) == pytest.approx(coefficient**lag, abs=error)
    for down, right in ((1, 0), (1, 1), (2, 0)):
        assert correlation(z, down, right) == pytest.approx(0.0, abs=error)


def test_its_first_column_is_as_noisy_as_the_others():
    """Of 10,000 rows, whose variance is known to 1.4 %; without what lies before the
    row it would lack 25 %."""
    rgb = np.zeros((10000, 3, 3), np.float32)
    run = {"illuminant": "D50", "iso": 100}
    seen = np.asarray(sensor_of(0.5).signal(rgb, seed=5, **run), float)
    predicted = np.asarray(sensor_of(0.5).predict(rgb, **run)[1], float)
    assert np.mean(seen**2 / predicted, axis=0) == pytest.approx(np.ones(3), abs=0.06)


@pytest.mark.parametrize("level", [0.02, 0.2])
def test_shot_noise_does_not_correlate(level):
    """The neighbours' correlation is that of the read noise times its share."""
    rgb = np.full((*SHAPE, 3), level, np.float32)
    run = {"illuminant": "D50", "iso": 100, "camera_input": True}
    variance, dark = (
        np.asarray(sensor_of(0.4).predict(x * rgb, **run)[1], float) for x in (1, 0)
    )
    share = np.sqrt(dark / variance)
    expected = 0.4 * np.mean(share[:, 1:] * share[:, :-1])
    assert expected < 0.3
    seen = correlation(residuals(sensor_of(0.4), level), 0, 1)
    assert seen == pytest.approx(expected, abs=5 / np.sqrt(PIXELS))


def test_the_variance_is_as_without_it():
    rgb = np.full((8, 8, 3), 0.1, np.float32)
    run = {"illuminant": "D50", "iso": 100}
    with_it, without = (sensor_of(c).predict(rgb, **run)[1] for c in (0.3, 0.0))
    assert (np.asarray(with_it) == np.asarray(without)).all()


def test_it_correlates_the_normals_that_outliers_are_made_of():
    """Each pixel's width is its own, which costs of the correlation what their mean is
    less than their root mean square: (0.98 + 0.02 x 3)^2 / (0.98 + 0.02 x 9)."""
    row = {**ROW, "tukey_lambda": 0.14, "row_sigma": 0.0, **OUTLIERS}
    z = residuals(sensor_of(-0.4, row, ["shot_noise", "heavy_tailed_noise"]))
    kept = (0.98 + 0.02 * 3) ** 2 / (0.98 + 0.02 * 9)
    assert z.var() == pytest.approx(1.0, abs=0.02)
    assert correlation(z, 0, 1) == pytest.approx(-0.4 * kept, abs=0.01)


def test_noise_that_is_not_made_of_normals_is_refused():
    row = {**ROW, "tukey_lambda": -0.1, "row_sigma": 0.0}
    says = "read_noise_correlation does not combine.*tukey_lambda -0.1.*noise gaussian"
    with pytest.raises(ValueError, match=says):
        residuals(sensor_of(0.1, row, ["shot_noise", "heavy_tailed_noise"]))
    gaussian = residuals(sensor_of(0.1, row, ["shot_noise", "read_noise"]))
    assert correlation(gaussian, 0, 1) == pytest.approx(0.1, abs=0.012)


def test_noise_of_an_array_has_none_of_a_profiles_effects():
    """add_noise adds the noise of the ISO, and nothing else."""
    clean = np.zeros((100, 200), np.float32)
    z = np.asarray(sensor_of(0.5).add_noise(clean, iso=100, seed=1), float)
    assert abs(correlation(z, 0, 1)) < 5 * z.var() / np.sqrt(z.size)
