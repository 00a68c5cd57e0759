# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The levels of darks: black level, dark current and drift."""

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from cg2raw.model.evaluation import Evaluation
from cg2raw.model.planes import PlaneLikelihood
from cg2raw.model.recorded import Records
from cg2raw.statistics.codes import ROUNDING
from cg2raw.statistics.constant import PIXEL, Array, ConstantStatistics

# Of the noise: laws of few codes are known so well. CUT : share of samples at the end
# of codes, as far as which a normal law would be known.
TRUST, CUT = 0.03, 1e-3


class Line(NamedTuple):
    """How well levels are on a line. freedom : of their scatter about it, frame by
    frame. misfit : by how much groups miss it, over what their frames' scatter makes;
    at least 1 (R. Birge, Physical Review 40, 1932)."""

    freedom: int
    misfit: float


class LevelLikelihood:
    """The levels of darks: of each plane, what all planes have in common apart.

    In the mean of the planes the drift is as large as in each; what they differ by has
    none. Means over groups are normal, the scatter within is chi-square."""

    def __init__(
        self,
        planes: list[PlaneLikelihood],
        statistics: ConstantStatistics,
        theta: Array | None,
    ) -> None:
        self.planes, self.parameters = planes, planes[0].parameters
        self.darks = np.flatnonzero(~planes[0].is_flat)
        self.frames = statistics.frames[self.darks].astype(float)
        self.groups = [statistics.groups[g] for g in self.darks]
        self.time = planes[0].time[self.darks]
        count = len(planes)
        # Orthonormal: the first row is the mean, times the root of their number.
        self.turn = np.linalg.qr(np.column_stack([np.ones(count), np.eye(count)]))[0].T
        self.turn *= np.where(self.turn[:1].sum() < 0, -1.0, 1.0)
        # Planes differ in dark current by the chance of their pixels'.
        at = self.parameters.of("dark_current_nonuniformity")
        uneven = 0.0 if theta is None else max(float(theta[at]), 0.0)
        self.uneven = uneven / planes[0].plane.masked.size
        at = self.parameters.of("dark_current")
        self.rate = 0.0 if theta is None else float(theta[at])
        # What a reading leaves open of a temperature, its charge has.
        error = np.array([group.warmth_error for group in self.groups])
        self.unread = (self.rate * self.time * error) ** 2
        self.unsure = np.mean([level_doubt(plane)[self.darks] for plane in planes], 0)
        self.parameters_of_means = (
            1 + int(np.ptp(self.time) > 0) if len(self.time) else 0
        )

    def add_to(
        self,
        found: Evaluation,
        theta: Array,
        recorded: Sequence[Records],
    ) -> None:
        """Add what darks' levels say. recorded : of each plane, records at theta."""
        if not len(self.darks):
            return
        at, g, count = self.parameters.of, self.darks, len(self.planes)
        blacks = self.parameters.each("black_level")
        places = np.array([one.values.place[g] for one in recorded])
        response = np.mean([one.values.fixed[g] for one in recorded], axis=0)
        by_place = np.array([one.slopes.place[g] for one in recorded])
        floor, rest = ((noise[g] + self.unsure) / response**2 for noise in self.noise)
        for axis in range(count):
            weights = self.turn[axis]
            mean = weights.sum() * theta[at("dark_current")] * self.time
            mean = mean + weights @ theta[blacks]
            slopes = np.einsum("p,pgn->gn", weights, by_place)
            slopes[:, blacks] -= weights
            slopes[:, at("dark_current")] -= weights.sum() * self.time
            if axis > 0:
                covariance = np.diag(rest / self.frames)
                covariance += self.uneven * np.outer(self.time, self.time)
                found.add_correlated(weights @ places - mean, slopes, covariance)
                continue
            drift = theta[at("black_level_drift")]
            variance = count * (drift + floor + self.unread)
            if (variance <= 0).any():
                found.value = -np.inf
                return
            by = np.zeros((len(g), len(theta)))
            by[:, at("black_level_drift")] = count
            share = max(1 - self.parameters_of_means / len(g), 0.0)
            found.add_normal(
                weights @ places - mean,
                slopes,
                variance / self.frames,
                by / self.frames[:, None],
                share,
            )
            again = self.frames > 1
            level, both, warmer = self.scatter[again].T
            charge = weights.sum() * response[again]
            squares = level - 2 * charge * both + charge**2 * warmer
            found.add_chi_square(
                squares / response[again] ** 2,
                variance[again],
                by[again],
                self.frames[again] - 1.0,
            )

    @cached_property
    def scatter(self) -> Array:
        """(darks, 3) DN^2, of the frames of each group of darks: variance of the mean
        level of all planes, times the root of their number; its covariance with what
        frames have more of charge than their mean, as readings say; variance of that.
        0 of single frames."""
        found = np.zeros((len(self.darks), 3))
        for number, g in enumerate(self.darks):
            if self.frames[number] > 1:
                levels = np.array([plane.plane.levels[g] for plane in self.planes])
                group = self.groups[number]
                time, warmth = group.exposure_time or 0.0, group.warmth or (1.0,)
                charge = self.rate * time * (np.array(warmth) - np.mean(warmth))
                both = np.cov(self.turn[0] @ levels, charge + 0 * levels[0])
                found[number] = both[0, 0], both[0, 1], both[1, 1]
        return found

    @cached_property
    def noise(self) -> tuple[Array, Array]:
        """(G,) DN^2 each, the variances of a frame's mean level, and of what a
        plane's level differs from it, by the noise of pixels and lines."""
        count, side = len(self.planes), self.planes[0].side
        each = [plane.level_noise() for plane in self.planes]
        pixel, lines = np.mean(each, axis=0)
        # Each line is shared by as many planes as the repeat has sites along it.
        apart = lines * (count - side) / max(count - 1, 1)
        return pixel / count + lines / side, pixel + apart

    def line(self, theta: Array) -> Line | None:
        """Return how well the darks' levels are on their line; None without darks."""
        if not len(self.darks):
            return None
        freedom = int(self.frames.sum()) - self.parameters_of_means
        left = len(self.darks) - self.parameters_of_means
        places = [plane.records(theta).values.place for plane in self.planes]
        levels = np.mean(places, axis=0)[self.darks]
        black = theta[self.parameters.each("black_level")].mean()
        on_line = black + theta[self.parameters.of("dark_current")] * self.time
        floor = self.noise[0][self.darks]
        variance = theta[self.parameters.of("black_level_drift")] + floor + self.unread
        squares = (levels - on_line) ** 2 * self.frames / variance
        misfit = np.sqrt(max(float(squares.sum()) / left, 1.0)) if left > 0 else 1.0
        return Line(freedom, float(misfit))


def level_doubt(plane: PlaneLikelihood) -> Array:
    """Return (G,) DN^2, how far a level is not known from few codes: by TRUST of the
    noise where it is below half a code, or where codes end."""
    codes = plane.scatter[:, PIXEL]
    is_cut = (plane.plane.low > CUT) | (plane.plane.high > CUT)
    found: Array = TRUST**2 * codes * (is_cut | (codes < 0.25 + ROUNDING))
    return found
