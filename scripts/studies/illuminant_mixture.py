# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a mixture of Gaussians in a profile is worth beside their one Gaussian."""

import json

import numpy as np
from scipy import stats

import cg2raw
from cg2raw.profile.neutral_mixture import mixture_of
from illuminant_models import SensorGaussian, halves, is_inside, mass_inside


class SensorMixture:
    """measured:n of a profile that does not list its neutrals, as bundled ones.

    Fitted and drawn by cg2raw; Gaussians that the hull of the neutrals cuts off."""

    def __init__(self, neutrals, camera):
        one = SensorGaussian(neutrals, camera)
        profile = json.loads(one.sensor.to_json())
        lights = one.sensor.illuminants
        self.mixture, self.hull = mixture_of(neutrals), one.hull
        profile["illuminants"] = {
            "mean": lights["mean"],
            "covariance": lights["covariance"].tolist(),
            "hull": lights["hull"],
            "mixture": self.mixture,
        }
        self.sensor = cg2raw.Sensor.from_json(json.dumps(profile), camera)

    def draws(self, count, split):
        """(count, 2) neutrals: other indices of measured:n in each split."""
        indices = range(count * split, count * (split + 1))
        lights = [self.sensor.illuminant(f"measured:{i}") for i in indices]
        return np.array([light.neutral for light in lights])[:, [0, 2]]

    def density(self, points):
        """(N,) per unit of R/G times B/G; 0 outside the hull."""
        whole, mass = np.zeros(len(points)), 0.0
        for part in self.mixture:
            weight, mean, covariance = part.values()
            whole += weight * stats.multivariate_normal(mean, covariance).pdf(points)
            mass += weight * mass_inside(mean, np.array(covariance), self.hull)
        return np.where(is_inside(points, self.hull), whole / mass, 0.0)


def gains(neutrals, camera, number, splits, log_likelihood):
    """(splits, N) nats that the mixture gains a held-out neutral; NaN if fitted."""
    found = np.full((splits, len(neutrals)), np.nan)
    for split in range(splits):
        fitted, held = halves(neutrals, number, split)
        models = (kind(neutrals[fitted], camera) for kind in KINDS)
        one, several = (log_likelihood(m.density(neutrals[held])) for m in models)
        found[split, held] = several - one
    return found


KINDS = (SensorGaussian, SensorMixture)
