# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""True densities add up to one; what frames tell of patterns is linear regression."""

import numpy as np
import pytest
from scipy import stats
from scipy.special import logsumexp

from cg2raw.synthetic import charge, memory
from cg2raw.synthetic.camera import camera_of
from cg2raw.synthetic.density import log_density
from cg2raw.synthetic.photons import photon_density
from cg2raw.synthetic.posterior import Observation, posterior
from cg2raw.synthetic.readout import Noise, blended, read_out
from cg2raw.synthetic.sensors import ISO, drawn_sensor, with_noise


def test_what_is_known_of_a_pixel_by_those_before_it():
    """Against the dense covariance of a row; a pixel that is not known tells nothing,
    and those before it no more."""
    rng = np.random.default_rng(5)
    residual, variance = rng.normal(size=(1, 7)), rng.uniform(1, 2, (1, 7))
    shared = np.zeros((1, 7))
    shared[0, 1:] = rng.uniform(-0.5, 0.5, 6)
    residual[0, 3] = np.nan
    mean, less = memory.told_by_before(residual, variance, shared)
    off = np.diag(shared[0, 1:], 1)
    covariance = np.diag(variance[0]) + off + off.T
    for col in range(7):
        known = [n for n in range(col) if n != 3]
        across = covariance[col, known]
        weights = np.linalg.solve(covariance[np.ix_(known, known)], across)
        assert mean[0, col] == pytest.approx(weights @ residual[0, known])
        assert less[0, col] == pytest.approx(weights @ across)


@pytest.mark.parametrize("correlation", [0.0, 0.3, -0.45])
def test_noise_that_remembers_correlates_as_is_stated(correlation):
    """Within four standard errors of 160,000 pixels; those two apart do not."""
    rng = np.random.default_rng(6)
    noise = memory.with_memory(rng, rng.standard_normal((400, 400)), correlation)
    assert noise.var() == pytest.approx(1, abs=4 * 2 / 400)
    for apart, expected in ((1, correlation), (2, 0.0)):
        found = np.mean(noise[:, apart:] * noise[:, :-apart])
        assert found == pytest.approx(expected, abs=4 * 1.5 / 400)


def observed(rng, count, shape=(5, 4)):
    """Return frames of pixels whose patterns are random, one of them clipped in one."""
    frames = []
    for number in range(count):
        usable = np.ones(shape, bool)
        usable[2, 1] = number > 0
        slopes = tuple(rng.uniform(0.5, 2, shape) for _ in range(3))
        frames.append(
            Observation(
                rng.normal(size=shape), rng.uniform(1, 3, shape), usable, slopes
            )
        )
    return frames


def test_patterns_of_a_pixel_are_those_of_linear_regression(camera):
    """Gain and offset, of known variances: (1 / S + sum b b' / v)^-1 sum b r / v."""
    read = float(camera.read_noise.mean())
    hidden = {"prnu": {"sigma": 0.7}, "dsnu": {"read_noises": 1 / read, "shape": 3.0}}
    frames = observed(np.random.default_rng(2), 3)
    truth = charge.Patterns.none((5, 4))
    found = posterior(frames, hidden, camera, truth)
    for at in ((0, 0), (2, 1), (4, 3)):
        seen = [one for one in frames if one.usable[at]]
        b = np.array([[one.slopes[0][at], one.slopes[2][at]] for one in seen])
        v = np.array([one.variance[at] for one in seen])
        r = np.array([one.residual[at] for one in seen])
        expected = np.linalg.inv(np.diag([0.7**-2, 1]) + (b / v[:, None]).T @ b)
        mean = expected @ (b / v[:, None]).T @ r
        assert found.covariance[at][np.ix_([0, 2], [0, 2])] == pytest.approx(expected)
        assert found.covariance[at][1] == pytest.approx(0)  # no leak: it is known
        assert [found.mean.gain[at], found.mean.offset[at]] == pytest.approx(mean)
        slopes = tuple(np.full((5, 4), slope) for slope in (2.0, 5.0, 3.0))
        unsure = np.array([2, 3]) @ expected @ np.array([2, 3])
        assert found.variance(slopes)[at] == pytest.approx(unsure)


def test_offsets_of_columns_are_weighted_means(camera):
    read = float(camera.read_noise.mean())
    hidden = {"column_fixed_pattern": {"read_noises": 0.8 / read}}
    frames = observed(np.random.default_rng(3), 2)
    found = posterior(frames, hidden, camera, charge.Patterns.none((5, 4)))
    weight = sum(one.usable * one.slopes[2] ** 2 / one.variance for one in frames)
    pull = sum(
        one.usable * one.slopes[2] * one.residual / one.variance for one in frames
    )
    variance = 1 / (0.8**-2 + weight.sum(0))
    assert found.column == pytest.approx(variance)
    assert found.mean.column == pytest.approx(variance * pull.sum(0))
    slopes = tuple(np.full((5, 4), 2.0) for _ in range(3))
    assert found.variance(slopes) == pytest.approx(np.tile(4 * variance, (5, 1)))


def test_densities_of_few_levels_add_up_to_one(camera):
    black = camera.black[0, 0]
    levels = (black + np.arange(-60, 340)).astype(np.uint16)[None]
    shape = levels.shape
    foot = camera.over(camera.black, shape)
    gain = camera.dn_per_electron[0, 0]
    for noise in (
        Noise(),
        Noise(poisson=True),
        Noise(weights=(0.9, 0.1), variances=(0.6, 4.6)),
    ):
        charges = np.full(shape, 30 / gain)
        total = np.exp(log_density(levels, charges, foot, noise, camera)).sum()
        assert total == pytest.approx(1, abs=2e-3)


@pytest.mark.parametrize(
    "noise",
    [
        Noise(excess=1.7),
        Noise(excess=1.7, poisson=True),
        Noise(well=25 / 5000),
        Noise(well=60 / 5000, weights=(0.9, 0.1), variances=(0.6, 4.6)),
        Noise(row=3.0),
        Noise(row=3.0, poisson=True),
    ],
    ids=str,
)
def test_densities_of_other_noise_add_up_to_one_too(noise):
    """Each pixel is a row of its own, whose offset is unknown; a full well may be near
    30 electrons. Levels far below black are unlikely, and no more."""
    camera = camera_of(with_noise(drawn_sensor(3), 5000, 2.0, ISO), "D65", ISO)
    gain, black = camera.dn_per_electron[0, 0], camera.black[0, 0]
    dn = np.arange(int(-90 * gain), int(90 * gain))
    levels = (black + dn).astype(np.uint16)[:, None]
    foot = camera.over(camera.black, levels.shape)
    charges = np.full(levels.shape, 30.0)
    found = log_density(levels, charges, foot, noise, camera)
    assert np.exp(found).sum() == pytest.approx(1, abs=2e-3)
    assert found.max() < -1 and (np.diff(found[:, 0], axis=0)[: len(dn) // 2] > 0).all()


@pytest.mark.parametrize(
    "noise",
    [Noise(correlation=0.4), Noise(row=2.0, correlation=0.4)],
    ids=str,
)
def test_densities_of_two_pixels_of_a_row_add_up_to_one(noise):
    """And are those of a normal pair: their levels vary together as their read noise
    does, and as a row's offset does, by its range squared over 12."""
    camera = camera_of(with_noise(drawn_sensor(3), 5000, 1.5, ISO), "D65", ISO)
    gain, black, charge = camera.dn_per_electron[0, 0], camera.black[0, 0], 2.0
    read = gain * camera.read_noise[0, 0]
    reach = np.arange(-8.0, 12.0)
    pairs = np.stack(np.meshgrid(reach, reach), -1).reshape(-1, 2)
    pairs = pairs[: len(pairs) // 2 * 2]
    foot = camera.over(camera.black, pairs.shape)
    levels = (black + pairs).astype(np.uint16)
    found = log_density(levels, np.full(pairs.shape, charge), foot, noise, camera)
    weights = np.exp(found.astype(float).sum(1))
    assert weights.sum() == pytest.approx(1, abs=2e-3)
    offset = (2 * noise.row * read) ** 2 / 12
    mean = gain * charge
    assert weights @ pairs == pytest.approx([mean, mean], abs=0.02)
    together = weights @ ((pairs[:, 0] - mean) * (pairs[:, 1] - mean))
    assert together == pytest.approx(noise.correlation * read**2 + offset, rel=0.03)
    alone = read**2 + gain**2 * charge + offset + 1 / 12
    assert weights @ (pairs - mean) ** 2 == pytest.approx([alone, alone], rel=0.03)


@pytest.mark.parametrize("excess", [1.0, 1.7])
@pytest.mark.parametrize(
    ("charge", "read"),
    [(0.0, 1), (0.5, 1), (30.0, 1), (149.0, 1), (400.0, 1), (0.5, 0), (30.0, 0)],
)
def test_the_density_of_photons_is_that_of_all_their_numbers(charge, read, excess):
    """From 150 photons on by a saddle point, whose next term is below 1e-3 there."""
    gain, around = np.array([0.7, 0.9, 1.1]), read * np.array([1.0, 4.0, 9.0])
    sd = np.sqrt(excess * charge + 4)
    level = 64 + gain * (charge + np.linspace(-4, 4, 9)[:, None] * sd)
    plane = np.ones_like(level)
    found = photon_density(
        level, charge * plane, 64 * plane, gain * plane, around * plane, excess
    )
    k = np.arange(1000)[:, None, None]
    seen = 64 + gain * (charge + np.sqrt(excess) * (k - charge))
    exact = logsumexp(
        stats.poisson.logpmf(k, max(charge, 1e-12))
        + stats.norm.logpdf(level, seen, np.sqrt(around + 1 / 12)),
        axis=0,
    )
    assert found == pytest.approx(exact, abs=2e-3 if charge >= 150 else 1e-6)


def test_densities_of_many_photons_add_up_to_one_too(camera):
    """Beyond what is summed one by one; the third term of the saddle point is 1 / 12 of
    a photon's share, 5e-4 here."""
    gain, black = camera.dn_per_electron[0, 0], camera.black[0, 0]
    sigma = np.sqrt(160 + camera.read_noise[0, 0] ** 2)
    near = black + gain * np.array([160 - 7 * sigma, 160 + 7 * sigma])
    levels = np.arange(*near.round()).astype(np.uint16)[None]
    foot, charges = (
        camera.over(camera.black, levels.shape),
        np.full(levels.shape, 160.0),
    )
    found = log_density(levels, charges, foot, Noise(poisson=True), camera)
    assert np.exp(found).sum() == pytest.approx(1, abs=1e-4)


def test_blend_is_undone(camera):
    plane = np.random.default_rng(0).standard_normal((20, 30))
    again = blended(blended(plane, 0.4), 0.4, inverse=True)
    np.testing.assert_allclose(again, plane, atol=1e-12)
    assert blended(np.ones((20, 30)), 0.4) == pytest.approx(1)


def test_density_of_blended_noise_is_the_entropy_of_its_spectrum(camera):
    shape, blend = (200, 200), 0.35
    charges = np.full(shape, 800.0)
    foot = camera.over(camera.black, shape)
    noise = Noise(blend=blend)
    raw = read_out(np.random.default_rng(5), charges, foot, noise, camera)
    gain, read = camera.dn_per_electron[0, 0], camera.read_noise[0, 0]
    u = np.cos(np.pi * np.arange(100) / 100)
    v = u[:, None]
    response = 1 - blend + blend / 4 * (u + v + 2 * u * v)
    power = gain**2 * (800 + read**2) * response**2 + 1 / 12
    entropy = 0.5 * np.mean(np.log(2 * np.pi * np.e * power))
    measured = -log_density(raw, charges, foot, noise, camera).mean()
    assert measured == pytest.approx(entropy, abs=4.5 * np.sqrt(0.5 / raw.size))
