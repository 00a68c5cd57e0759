# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A few Gaussians in place of a camera's neutrals, for profiles that are passed on.

Source: A. P. Dempster et al., Maximum Likelihood from Incomplete Data via the EM
Algorithm, J. R. Stat. Soc. B 39, 1977; G. Schwarz, Estimating the Dimension of a Model,
Ann. Stat. 6, 1978."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
MOST = 6  # Gaussians
NUMBERS = 6  # of a Gaussian: weight, mean, covariance
STARTS = 8  # of each count
ROUNDS = 500  # of EM, at most
STILL = 1e-7  # of the mean log-likelihood: EM ends
FLOOR = 0.02  # sd of a Gaussian, of all neutrals' along each axis: none is a point's


def mixture_of(neutrals: Array) -> list[dict[str, Any]]:
    """Return the Gaussians {weight, mean, covariance} of neutrals, heaviest first.

    neutrals : (N, 2) ratios R/G and B/G; with fewer than 3, or with all on one line
    along an axis, there are none.
    As many as the Bayesian information criterion asks for, each of at least as many
    neutrals as it has numbers; same neutrals, same numbers, rounded as profiles have
    them."""
    if len(neutrals) < 3 or not neutrals.std(axis=0).all():
        return []
    scale = neutrals.std(axis=0)
    centre = neutrals.mean(axis=0)
    points = (neutrals - centre) / scale
    counts = range(1, min(MOST, len(points)) + 1)
    fits = [best_of_starts(points, count) for count in counts]
    fits = [
        fit for fit in fits if fit[1].min() * len(points) >= NUMBERS or fit is fits[0]
    ]
    _, weights, means, covariances = min(fits, key=lambda fit: criterion(points, fit))
    order = np.argsort(-weights, kind="stable")
    return [
        {
            "weight": round(float(weights[k]), 6),
            "mean": (means[k] * scale + centre).round(6).tolist(),
            "covariance": (covariances[k] * np.outer(scale, scale)).round(9).tolist(),
        }
        for k in order
    ]


def without_neutrals(lights: Mapping[str, Any]) -> dict[str, Any]:
    """Return a profile's illuminants that stand for neutrals which it may not list.

    lights : illuminants of a sensor whose profile lists them."""
    return {
        "mean": lights["mean"],
        "covariance": lights["covariance"].tolist(),
        "hull": lights["hull"],
        "mixture": mixture_of(np.asarray(lights["neutrals"])),
    }


Fit = tuple[float, Array, Array, Array]  # log-likelihood, weights, means, covariances


def criterion(points: Array, fit: Fit) -> float:
    """Return the Bayesian information criterion of a fit."""
    numbers = NUMBERS * len(fit[1]) - 1
    return numbers * float(np.log(len(points))) - 2.0 * fit[0]


def best_of_starts(points: Array, count: int) -> Fit:
    """Return the likeliest fit of so many Gaussians."""
    fits = [expectation_maximisation(points, count, seed) for seed in range(STARTS)]
    return max(fits, key=lambda fit: fit[0])


def expectation_maximisation(points: Array, count: int, seed: int) -> Fit:
    """Return the fit that EM reaches from the groups around so many of the points."""
    rng = np.random.default_rng([count, seed])
    centres = points[rng.choice(len(points), count, replace=False)]
    apart = np.linalg.norm(points[:, None] - centres, axis=2)
    shares = np.eye(count)[apart.argmin(axis=1)]
    before = -np.inf
    for _ in range(ROUNDS):
        weights, means, covariances = maximised(points, shares)
        logs = log_densities(points, weights, means, covariances)
        whole = np.logaddexp.reduce(logs, axis=1)
        shares = np.exp(logs - whole[:, None])
        if whole.mean() - before < STILL:
            break
        before = float(whole.mean())
    return float(whole.sum()), weights, means, covariances


def maximised(points: Array, shares: Array) -> tuple[Array, Array, Array]:
    """Return weights, means and covariances of points that Gaussians share."""
    counts = shares.sum(axis=0) + 1e-9
    means = shares.T @ points / counts[:, None]
    apart = points[:, None] - means
    covariances = np.einsum("nk,nki,nkj->kij", shares, apart, apart)
    covariances = covariances / counts[:, None, None] + FLOOR**2 * np.eye(2)
    return counts / counts.sum(), means, covariances


def log_densities(
    points: Array, weights: Array, means: Array, covariances: Array
) -> Array:
    """Return (N, K), log of weight times density."""
    apart = points[:, None] - means
    inverses = np.linalg.inv(covariances)
    squares = np.einsum("nki,kij,nkj->nk", apart, inverses, apart)
    logs = np.log(weights) - 0.5 * np.linalg.slogdet(covariances)[1]
    return np.asarray(logs - 0.5 * squares - np.log(2.0 * np.pi))
