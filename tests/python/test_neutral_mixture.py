# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw.profile.neutral_mixture: Gaussians that stand for a camera's neutrals."""

import csv

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from cg2raw.profile.neutral_mixture import criterion, log_densities, mixture_of
from oracles import cameras
from tiers import first_fast


def drawn(parts, count, seed=1):
    """Return (count, 2) of Gaussians (share, mean, covariance)."""
    rng = np.random.default_rng(seed)
    rows = [
        rng.multivariate_normal(mean, cov, round(share * count))
        for share, mean, cov in parts
    ]
    return np.concatenate(rows)


DAY = (0.7, [0.45, 0.70], [[4e-4, -1e-4], [-1e-4, 9e-4]])
LAMPS = (0.3, [0.80, 0.35], [[16e-4, -6e-4], [-6e-4, 4e-4]])


NEUTRALS = drawn([DAY, LAMPS], 300)


@pytest.fixture(scope="module")
def found():
    return mixture_of(NEUTRALS)


def test_planted_gaussians_are_found(found):
    assert len(found) == 2
    for part, (share, mean, covariance) in zip(found, (DAY, LAMPS), strict=True):
        assert part["weight"] == pytest.approx(share, abs=0.01)
        assert part["mean"] == pytest.approx(mean, abs=5e-3)
        assert np.array(part["covariance"]) == pytest.approx(
            np.array(covariance), abs=2e-4
        )


def test_one_gaussian_is_one():
    assert len(mixture_of(drawn([(1.0, *DAY[1:])], 50))) == 1


def test_a_mixture_has_the_mean_and_covariance_of_its_neutrals(found):
    """A law of EM, at each of its steps; a Gaussian is as much wider as its floor, 2 %
    of the standard deviation of all. Numbers of profiles have 6 and 9 decimals."""
    weights, means, covariances = (
        np.array([part[name] for part in found])
        for name in ("weight", "mean", "covariance")
    )
    assert weights.sum() == pytest.approx(1, abs=2e-6)
    assert (np.diff(weights) <= 0).all()
    assert weights @ means == pytest.approx(NEUTRALS.mean(axis=0), abs=4e-6)
    apart = means - NEUTRALS.mean(axis=0)
    whole = np.einsum("k,kij->ij", weights, covariances)
    whole += np.einsum("k,ki,kj->ij", weights, apart, apart)
    floor = np.diag((0.02 * NEUTRALS.std(axis=0)) ** 2)
    expected = np.cov(NEUTRALS.T, bias=True) + floor
    assert whole == pytest.approx(expected, abs=1e-6)


def test_densities_are_normal_and_numbers_are_counted():
    """The information criterion: numbers ln n - 2 ln L, of 6 k - 1 numbers."""
    points, weights = drawn([DAY, LAMPS], 40), np.array([0.6, 0.4])
    means, covariances = (np.array([part[n] for part in (DAY, LAMPS)]) for n in (1, 2))
    found = log_densities(points, weights, means, covariances)
    for k in range(2):
        law = multivariate_normal(means[k], covariances[k])
        expected = np.log(weights[k]) + law.logpdf(points)
        assert found[:, k] == pytest.approx(expected, abs=1e-9)
    fit = (-12.5, weights, means, covariances)
    assert criterion(points, fit) == pytest.approx(11 * np.log(40) + 25)


def test_three_neutrals_have_one_gaussian():
    (one,) = mixture_of(np.array([[0.5, 0.6], [0.6, 0.5], [0.7, 0.7]]))
    assert one["weight"] == 1 and one["mean"] == [0.6, 0.6]


def test_the_same_neutrals_give_the_same_numbers():
    neutrals = drawn([DAY, LAMPS], 40)
    assert mixture_of(neutrals) == mixture_of(neutrals.copy())


def test_no_gaussian_is_of_a_few_neutrals():
    """A lone light, listed five times, has no Gaussian of its own."""
    lone = np.tile([1.3, 0.2], (5, 1))
    found = mixture_of(np.concatenate([drawn([DAY], 100), lone]))
    assert min(part["weight"] for part in found) * 75 >= 5.99


@pytest.mark.parametrize(
    "neutrals",
    [
        *([], [[0.5, 0.6]], [[0.5, 0.6]] * 2, [[0.5, 0.6]] * 9),
        [[0.5, 0.6], [0.5, 0.7], [0.5, 0.8], [0.5, 0.9]],
    ],
)
def test_neutrals_without_spread_have_none(neutrals):
    assert mixture_of(np.array(neutrals).reshape(-1, 2)) == []


@pytest.mark.parametrize("camera", first_fast(sorted(cameras.NINE), 3))
def test_real_neutrals_that_were_held_out_are_likelier(camera, camera_data):
    """By 0.3 nats a neutral at least over one Gaussian."""
    path = camera_data / "tables/illuminants/nus9_gt_illuminants.csv"
    with open(path, newline="") as file:
        own = np.array(
            [
                [float(row["r"]) / float(row["g"]), float(row["b"]) / float(row["g"])]
                for row in csv.DictReader(file)
                if row["camera"] == camera
            ]
        )
    fitted, held = own[::2], own[1::2]
    one = multivariate_normal(fitted.mean(axis=0), np.cov(fitted.T)).pdf(held)
    several = sum(
        part["weight"] * multivariate_normal(part["mean"], part["covariance"]).pdf(held)
        for part in mixture_of(fitted)
    )
    logs = [np.log(0.99 * density + 0.01 / 1.95**2) for density in (one, several)]
    assert (logs[1] - logs[0]).mean() > 0.3
