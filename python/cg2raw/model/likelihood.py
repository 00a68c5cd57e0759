# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The likelihood of the statistics of darks and flats, linear in variances."""

from copy import copy

import numpy as np

from cg2raw.model.evaluation import Evaluation, Parameters
from cg2raw.model.levels import LevelLikelihood
from cg2raw.model.mean_images import MeanImageLikelihood
from cg2raw.model.planes import PlaneLikelihood
from cg2raw.statistics.constant import Array, ConstantStatistics


class Likelihood:
    """The likelihood of all planes, as a function of Parameters.

    theta : of a fit before, which tells the offsets that were recorded; without it they
    are those of the codes. earlier : that of the same frames at other parameters, whose
    laws of codes are taken where they hold."""

    def __init__(
        self,
        statistics: ConstantStatistics,
        theta: Array | None = None,
        earlier: "Likelihood | None" = None,
    ) -> None:
        self.parameters = Parameters(len(statistics.planes))
        self.planes: list[PlaneLikelihood] = [
            PlaneLikelihood(
                statistics,
                site,
                self.parameters,
                theta,
                earlier.planes[site].recorders if earlier else (),
            )
            for site in range(len(statistics.planes))
        ]
        self.is_coarse = any(
            recorder.table is not None
            for plane in self.planes
            for recorder in plane.recorders
        )
        self.means = MeanImageLikelihood(self.planes, statistics)
        self.levels = LevelLikelihood(self.planes, statistics, theta)
        self.has_means = True

    def without_means(self) -> "Likelihood":
        """Return that of the levels and of what repeats differ by.

        The noise of mean images says of the charge, too, and so closely that whatever
        their patterns have besides would tell the dark current from the levels."""
        found = copy(self)
        found.has_means = False
        return found

    def __call__(self, theta: Array) -> Evaluation:
        """Return value, slope and information at a vector of parameters."""
        found = Evaluation(len(theta))
        if any((plane.offsets(theta)[0][0] <= 0).any() for plane in self.planes):
            found.value = -np.inf
            return found
        recorded = [plane.records(theta) for plane in self.planes]
        for plane, known in zip(self.planes, recorded, strict=True):
            plane.add_to(found, theta, *known)
            if not np.isfinite(found.value):
                return found
        if self.has_means:
            self.means.add_to(found, theta, recorded)
        self.levels.add_to(found, theta, recorded)
        return found
