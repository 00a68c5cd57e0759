# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a mixture of Gaussians in a profile is worth beside their one Gaussian."""

import json

import numpy as np
from scipy import stats

import cg2raw
from cg2raw.profile.neutral_mixture import without_neutrals
from studies.illuminants.models import SensorGaussian, is_inside, mass_inside


class SensorMixture:
    """measured:n of a profile that does not list its neutrals, as bundled ones.

    Fitted and drawn by cg2raw; Gaussians that the hull of the neutrals cuts off."""

    def __init__(self, neutrals, camera):
        self.one = SensorGaussian(neutrals, camera)
        profile = json.loads(self.one.sensor.to_json())
        profile["illuminants"] = without_neutrals(self.one.sensor.illuminants)
        self.mixture, self.hull = profile["illuminants"]["mixture"], self.one.hull
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
