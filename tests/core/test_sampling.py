# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""sample:n of every installed sensor, against another generator's draws."""

import functools
import json

import numpy as np
import pytest

import cg2raw
from oracles import cameras
from tiers import first_fast

stats = pytest.importorskip("scipy.stats", reason="scipy is not installed")
spatial = pytest.importorskip("scipy.spatial", reason="scipy is not installed")

COUNT = 50_000
# Two-sided, of 5 numbers of each sensor: by chance once in 3e5 sensors.
MOST_STANDARD_ERRORS = 5.0
# Of a cross product of numbers below 2: three roundings, 2**-52 of its terms each.
ROUNDING = 2.0**-49


def described(sensor_id):
    """(mean, covariance, hull) as the profile's JSON has them; None without a hull."""
    fields = json.loads(cg2raw.Sensor(sensor_id).to_json()).get("illuminants", {})
    if "neutrals" in fields:
        neutrals = np.unique(np.array(fields["neutrals"]).reshape(-1, 2), axis=0)
        if len(neutrals) < 3:
            return None
        all_of_them = np.array(fields["neutrals"])
        hull = neutrals[spatial.ConvexHull(neutrals).vertices]
        return all_of_them.mean(axis=0), np.cov(all_of_them.T), hull
    if "hull" not in fields:
        return None
    return tuple(np.array(fields[name]) for name in ("mean", "covariance", "hull"))


IDS = cg2raw.installed_profiles()
GAUSSIAN = [name for name in IDS if described(name) is not None]
LOCUS = [name for name in IDS if described(name) is None]


def ratios(sensor, count):
    """(count, 2) R/G and B/G of sample:0 to sample:count - 1."""
    lights = (sensor.illuminant(f"sample:{i}") for i in range(count))
    return np.array([light.neutral for light in lights])[:, [0, 2]]


@functools.cache
def samples_of(sensor_id):
    return ratios(cg2raw.Sensor(sensor_id), COUNT)


def truncated_gaussian(mean, covariance, hull, count):
    """(count, 2) draws inside the hull, by rejection: SFC64, NumPy, Delaunay."""
    rng = np.random.Generator(np.random.SFC64(2023))
    triangles, kept = spatial.Delaunay(hull), []
    while sum(map(len, kept)) < count:
        drawn = rng.multivariate_normal(mean, covariance, count)
        kept.append(drawn[triangles.find_simplex(drawn) >= 0])
    return np.concatenate(kept)[:count]


def moments(points):
    """Mean (2) and covariance (rr, rb, bb) of points, and their standard errors."""
    from_mean = points - points.mean(axis=0)
    squares = np.column_stack(
        [from_mean[:, i] * from_mean[:, j] for i, j in ((0, 0), (0, 1), (1, 1))]
    )
    values = np.concatenate([points.mean(axis=0), squares.mean(axis=0)])
    errors = np.concatenate([points.std(axis=0), squares.std(axis=0)])
    return values, errors / np.sqrt(len(points))


def test_every_installed_sensor_is_tested():
    assert set(GAUSSIAN) | set(LOCUS) == set(IDS) and len(GAUSSIAN) >= 2


@pytest.mark.parametrize("sensor_id", GAUSSIAN)
def test_the_distribution_is_what_the_profile_says(sensor_id):
    mean, covariance, hull = described(sensor_id)
    lights = cg2raw.Sensor(sensor_id).illuminants
    assert lights["mean"] == pytest.approx(mean, abs=1e-12)
    assert np.array(lights["covariance"]) == pytest.approx(covariance, abs=1e-12)
    assert sorted(map(tuple, lights["hull"])) == sorted(map(tuple, hull.tolist()))


@pytest.mark.parametrize("sensor_id", first_fast(GAUSSIAN, 1))
def test_mean_and_covariance_are_those_of_the_truncated_gaussian(sensor_id):
    expected, its_error = moments(
        truncated_gaussian(*described(sensor_id), 4 * COUNT),
    )
    values, error = moments(samples_of(sensor_id))
    standard_errors = np.abs(values - expected) / np.hypot(error, its_error)
    assert standard_errors.max() < MOST_STANDARD_ERRORS


@pytest.mark.parametrize("sensor_id", first_fast(GAUSSIAN, 1))
def test_all_samples_lie_inside_the_hull_at_six_digits(sensor_id):
    _, _, hull = described(sensor_id)
    corners = hull[spatial.ConvexHull(hull).vertices]  # counter-clockwise
    samples = samples_of(sensor_id)
    edge = np.roll(corners, -1, axis=0) - corners
    offset = samples[:, None, :] - corners[None]
    margin = edge[:, 0] * offset[..., 1] - edge[:, 1] * offset[..., 0]
    assert margin.min() >= -ROUNDING
    assert (samples == np.round(samples * 1e6) / 1e6).all()


@pytest.mark.parametrize("sensor_id", first_fast(GAUSSIAN, 1))
def test_samples_reach_as_far_as_other_draws_and_do_not_repeat(sensor_id):
    samples = samples_of(sensor_id)
    others = truncated_gaussian(*described(sensor_id), COUNT)
    reached = spatial.ConvexHull(samples).volume / spatial.ConvexHull(others).volume
    assert reached == pytest.approx(1.0, abs=0.03)  # by chance: below 0.01
    assert len(np.unique(samples, axis=0)) > 0.99 * COUNT


def test_rounding_takes_no_sample_out_of_a_hull_of_a_few_millionths():
    hull = np.array([[0, 0], [40, 7], [11, 31]])
    stated = {
        "mean": [0.500020, 0.400012],
        "covariance": [[1e-10, 0.0], [0.0, 1e-10]],
        "hull": ((hull + [500000, 400000]) / 1e6).tolist(),
    }
    text = cameras.profile_text(illuminants=stated)
    samples = ratios(cg2raw.Sensor.from_json(text), 5000)
    steps = np.round(samples * 1e6).astype(int) - [500000, 400000]
    edge = np.roll(hull, -1, axis=0) - hull
    offset = steps[:, None, :] - hull
    margin = edge[:, 0] * offset[..., 1] - edge[:, 1] * offset[..., 0]
    assert margin.min() >= 0
    assert len(np.unique(steps, axis=0)) > 400  # of about 590 points of the grid


def planckian_sensor(camera):
    """A real camera's two matrices, and nothing known of its lights."""
    return cg2raw.Sensor.from_json(cameras.profile_of(camera, illuminants=None))


# Of the light sources that raw converters know. Source: DNG specification, chapter 6.
KELVIN = {"A": 2850.0, "tungsten": 2850.0, "D50": 5000.0, "D65": 6500.0}
PLANCKIAN = [cg2raw.Sensor(name) for name in LOCUS] + [
    planckian_sensor(camera) for camera in ("NikonD40", "SonyA57", "Canon600D")
]


@pytest.mark.parametrize("sensor", PLANCKIAN, ids=lambda sensor: sensor.id)
def test_without_neutrals_samples_are_black_bodies_uniform_in_mired(sensor):
    colour = pytest.importorskip("colour", reason="colour-science is not installed")
    calibrations = json.loads(sensor.to_json())
    words = [calibrations[f"calibration_illuminant_{i}"] for i in (1, 2)]
    ends = sorted(KELVIN[word] for word in words)
    lights = [sensor.illuminant(f"sample:{i}") for i in range(500)]
    kelvin = np.linspace(0.99 * ends[0], 1.01 * ends[1], 4000)
    locus = colour.temperature.CCT_to_uv_Planck1900(kelvin)
    uv = np.array([colour.xy_to_UCS_uv(np.array(light.xy)) for light in lights])
    distance, nearest = spatial.cKDTree(locus).query(uv)
    # Robertson's isotherms have five digits and straight lines between them.
    assert distance.max() < 2e-4
    mired = 1e6 / kelvin[nearest]
    assert mired.min() > 1e6 / ends[1] - 1.0 and mired.max() < 1e6 / ends[0] + 1.0
    uniform = stats.uniform(1e6 / ends[1], 1e6 / ends[0] - 1e6 / ends[1])
    assert stats.kstest(mired, uniform.cdf).pvalue > 1e-4
