# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Three ways to draw illuminants: each has draws and a density over (R/G, B/G)."""

import json

import numpy as np
from scipy import stats

import cg2raw

# Gains of red and blue, each uniform and independent of the other. Source: Brooks et
# al., Unprocessing Images for Learned Raw Denoising (UPI), CVPR 2019; the ranges are
# those of the implementation that its authors published.
UPI_GAINS = np.array([[1.9, 1.5], [2.4, 1.9]])
MODELS = ("cg2raw", "UPI's gains", "UPI's box")
DRAWS = 50
SEED = 2023


class SensorGaussian:
    """The sensor's own: a Gaussian inside the hull of its neutrals.

    Source: Seo et al., Graphics2RAW, ICCV 2023, eq. 2-3; fitted and drawn by cg2raw."""

    def __init__(self, neutrals, camera):
        # The matrices of the bundled profile decide nothing that is asked for here.
        profile = json.loads(cg2raw.Sensor("nikon-d40").to_json())
        profile["id"] = camera.lower()
        profile["illuminants"] = {"neutrals": neutrals.tolist()}
        self.sensor = cg2raw.Sensor.from_json(json.dumps(profile), camera)
        lights = self.sensor.illuminants
        mean, covariance = lights["mean"], lights["covariance"]
        self.hull = np.array(lights["hull"])
        self.gaussian = stats.multivariate_normal(mean, covariance)
        self.mass = mass_inside(mean, covariance, self.hull)

    def draws(self, count, split):
        """(count, 2) neutrals: other indices of sample:n in each split."""
        indices = range(count * split, count * (split + 1))
        lights = [self.sensor.illuminant(f"sample:{i}") for i in indices]
        return np.array([light.neutral for light in lights])[:, [0, 2]]

    def density(self, points):
        """(N,) per unit of R/G times B/G; 0 outside the hull."""
        inside = is_inside(points, self.hull)
        return np.where(inside, self.gaussian.pdf(points) / self.mass, 0.0)


class UpiGains:
    """UPI with its published ranges of gains, the same for every camera."""

    def __init__(self, seed):
        self.seed = seed

    def draws(self, count, split):
        rng = np.random.default_rng([*self.seed, split, 1])
        return 1.0 / rng.uniform(*UPI_GAINS, (count, 2))

    def density(self, points):
        """Uniform over the gains g = 1 / x, hence g^2 each over x."""
        gains = 1.0 / points
        inside = ((gains >= UPI_GAINS[0]) & (gains <= UPI_GAINS[1])).all(axis=1)
        area = np.prod(UPI_GAINS[1] - UPI_GAINS[0])
        return np.where(inside, np.prod(gains, axis=1) ** 2 / area, 0.0)


class UpiBox:
    """UPI's idea fitted to the sensor: R/G and B/G uniform, each over its own range."""

    def __init__(self, neutrals, seed):
        self.low, self.high = neutrals.min(axis=0), neutrals.max(axis=0)
        self.seed = seed

    def draws(self, count, split):
        rng = np.random.default_rng([*self.seed, split, 2])
        return rng.uniform(self.low, self.high, (count, 2))

    def density(self, points):
        inside = ((points >= self.low) & (points <= self.high)).all(axis=1)
        return inside / np.prod(self.high - self.low)


def is_inside(points, hull):
    """(N,) bool: within a convex, counter-clockwise hull, its edges included."""
    edge = np.roll(hull, -1, axis=0) - hull
    offset = points[:, None, :] - hull[None]
    margin = edge[:, 0] * offset[..., 1] - edge[:, 1] * offset[..., 0]
    return (margin >= 0.0).all(axis=1)


def mass_inside(mean, covariance, hull):
    """Part of a Gaussian inside a convex hull: exact along one axis, then trapezoids.

    Whitened, the hull is a polygon under a standard normal (error below 1e-6)."""
    white = np.linalg.solve(np.linalg.cholesky(covariance), (hull - mean).T).T
    corners = np.roll(white, -white[:, 0].argmin(), axis=0)
    right = corners[:, 0].argmax()
    lower, upper = corners[: right + 1], np.vstack([corners[right:], corners[:1]])[::-1]
    u = np.linspace(corners[0, 0], corners[right, 0], 4001)
    top, bottom = np.interp(u, *upper.T), np.interp(u, *lower.T)
    across = stats.norm.cdf(top) - stats.norm.cdf(bottom)
    return np.trapezoid(stats.norm.pdf(u) * across, u)


def halves(neutrals, number, split):
    """(fitted, held out) indices: a random split of the camera of that number."""
    order = np.random.default_rng([SEED, number, split, 0]).permutation(len(neutrals))
    middle = (len(neutrals) + 1) // 2
    return order[:middle], order[middle:]


def fitted_models(neutrals, camera, number):
    """The three models of one camera, in the order of MODELS."""
    seed = [SEED, number]
    return SensorGaussian(neutrals, camera), UpiGains(seed), UpiBox(neutrals, seed)
