# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The likelihood of the statistics of darks and flats, linear in variances, and how
well a fit describes frames: squares over what is expected, part by part."""

from collections.abc import Iterator
from copy import copy
from typing import Literal, NamedTuple

import numpy as np

from cg2raw.model.evaluation import Evaluation, Parameters
from cg2raw.model.levels import LevelLikelihood
from cg2raw.model.mean_images import Block, MeanImageLikelihood
from cg2raw.model.planes import PlaneLikelihood
from cg2raw.statistics.constant import PARTS, PIXEL, Array, ConstantStatistics


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
        self.is_coarse = any(plane.coarse for plane in self.planes)
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
        if any((plane.noise(theta) <= 0).any() for plane in self.planes):
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


class Misfit(NamedTuple):
    """Of a part of the frames: its squares over their expectation, of given freedom.

    what : "noise", from frame to frame, or "pattern", of mean images. part : of PARTS.
    group : number of the group; of patterns that which misses its own by most."""

    what: Literal["noise", "pattern"]
    part: str
    group: int
    squares: float
    freedom: float

    @property
    def ratio(self) -> float:
        """Squares over their expectation: 1 if the fit is right."""
        return self.squares / self.freedom

    @property
    def nats(self) -> float:
        """What a right variance would gain."""
        return self.freedom / 2 * (self.ratio - 1 - float(np.log(self.ratio)))


def misfits(likelihood: Likelihood, theta: Array) -> Iterator[Misfit]:
    """Yield the misfit of each part: its noise in each group, and its patterns."""
    recorded = [plane.records(theta) for plane in likelihood.planes]
    squares, freedom = (np.zeros_like(likelihood.planes[0].scatter) for _ in range(2))
    for plane, known in zip(likelihood.planes, recorded, strict=True):
        expected, _ = plane.temporal(theta, *known)
        squares = squares + plane.freedom * plane.scatter / expected
        freedom = freedom + plane.freedom
    for g, part in np.argwhere(freedom > 0):
        each = float(squares[g, part]), float(freedom[g, part])
        yield Misfit("noise", PARTS[part], int(g), *each)
    for part, name in enumerate(PARTS):
        total, count, wider = 0.0, 0.0, 0.0
        by_group = np.zeros(len(likelihood.planes[0].frames))
        for block, covariance in likelihood.means.covariances(theta, recorded):
            if block.part == part:
                whitened = np.linalg.solve(covariance, block.products)
                total += block.freedom * float(np.trace(whitened))
                count += block.freedom * len(covariance)
                wider += float(_tails(likelihood, block, np.diagonal(covariance)).sum())
                own = np.diagonal(block.products) / np.diagonal(covariance)
                by_group += own.reshape(len(block.planes), -1).sum(axis=0)
        if count > 0:
            worst = int(np.argmax(np.abs(np.log(np.maximum(by_group, 1e-300)))))
            less = 1 / (1 + wider / count)
            yield Misfit("pattern", name, worst, total * less, count * less)


def _tails(likelihood: Likelihood, block: Block, expected: Array) -> Array:
    """Return (N,) by how much more the squares of mean images vary than normal ones do,
    times their freedom: noise of few codes has long tails. expected : (N,) DN^2."""
    if block.part != PIXEL:
        return np.zeros(len(expected))
    frames = likelihood.planes[0].frames
    again = np.maximum(frames - 1, 1)
    each = []
    for plane in (likelihood.planes[n] for n in block.planes):
        normal, own = plane.plane.freedom[PIXEL] * again, plane.freedom[:, PIXEL]
        more = np.where(own > 0, normal / np.where(own > 0, own, 1.0) - 1, 0.0)
        of_noise = plane.scatter[:, PIXEL] / frames
        each.append(np.maximum(more, 0.0) / again * of_noise**2)
    return block.freedom * np.concatenate(each) / expected**2
