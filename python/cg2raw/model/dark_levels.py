# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the levels of darks name: a black level, a dark current, a drift.

Each can stand for another, and would hide it if it were free: the set of names is
chosen that needs fewest."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from cg2raw.model.components import FIXED
from cg2raw.model.fit import Fit, Prior, gain_of, refitted
from cg2raw.model.mean_images import low_of
from cg2raw.model.smallest_set import Way, smallest_set
from cg2raw.statistics.constant import PARTS, Array, lines_of_mosaic, polynomials

LEVELS = BLACK, CURRENT, DRIFT = "black_level", "dark_current", "black_level_drift"
LENGTHS = 200  # of a decay that are tried: 2 % apart
LONGEST = 1 / 3  # of the frame: a decay that ends in it, to a twentieth
LOWEST = 0.1  # of the frame, where an amplifier's light is none
LEAST_LEVEL = 1e-6  # DN^2: far below what the mean of frames is known to


class DarkLevels:
    """places : (n,) which parameters are of each of LEVELS. profile : (n,) the null.
    median : by how much that of dark current is above its mean, and the standard error,
    DN/s: a profile has the median, the likelihood the mean. is_structured : whether the
    bias has a structure, whose first columns raise the mean. glows : whether an
    amplifier does, which raises the mean with time."""

    def __init__(
        self,
        places: Mapping[str, NDArray[np.bool_]],
        training: Fit,
        validation: Fit,
        profile: Array,
        median: tuple[float, float] = (0.0, 0.0),
        *,
        is_structured: bool = False,
        glows: bool = False,
    ) -> None:
        self.is_structured, self.glows = is_structured, glows
        if median == (0.0, 0.0):
            median = unknown_median(training)
        self.places, self.profile, self.median = places, profile.copy(), median
        self.profile[training.parameters.of("dark_current")] -= median[0]
        self.training, self.validation = training, validation
        self.priors = {name: self._prior(name) for name in places}

    def gains(self, least: float) -> dict[str, float]:
        """Return the nats of each name of the smallest set that explains levels.

        least : nats that a name needs."""
        gains = smallest_set(
            {name: int(name == "black_level_drift") for name in self.places},
            least,
            [
                Way(
                    lambda names: self._fitted(self.training, names)[0],
                    self._value,
                    lambda names: self._fitted(self.validation, names)[0].value,
                )
            ],
        ).gains
        named = [name for name, gain in gains.items() if gain > least]
        if not named or not self.validation.likelihood.is_coarse:
            return gains
        # Of darks at few codes one number tells level and noise: none gains more than
        # all that are named together, where noise is fitted from where it was.
        is_named = np.any([self.places[name] for name in named], axis=0)
        trained = np.where(is_named, self.training.theta, self.profile)
        most = gain_of(
            np.any([*self.places.values()], axis=0),
            trained,
            self.validation,
            self.profile,
            least,
        )
        return {name: min(gain, most) for name, gain in gains.items()}

    @property
    def unsure(self) -> dict[str, float]:
        """Return how far other effects may move a level, DN or DN/s, by name."""
        return {
            name: float(np.sqrt(np.diagonal(prior.covariance).mean()))
            for name, prior in self.priors.items()
            if prior is not None
        }

    def _value(self, names: Sequence[str], trained: Fit) -> float:
        """Return the log-likelihood of validation frames: of levels about those that
        others have told, as well as they are known, and of their drift."""
        found, prior = self._fitted(self.validation, names, trained)
        if prior is None:
            return found.value
        at = np.ix_(prior.places, prior.places)
        after, before = (
            np.linalg.slogdet(one)[1]
            for one in (found.covariance[at], prior.covariance)
        )
        return found.value + float(after - before) / 2

    def _fitted(
        self, fit: Fit, names: Sequence[str], trained: Fit | None = None
    ) -> tuple[Fit, Prior | None]:
        """Return the fit of the levels, and what it knows besides. names : whose
        parameters are fitted, or are as others have @trained them; all others' are as
        the profile has them, and its patterns let them be."""
        start, free = fit.theta.copy(), np.zeros(len(self.profile), bool)
        likelihood = fit.likelihood.without_means()
        if fit.likelihood.is_coarse:  # then a level and noise depend on each other
            likelihood = fit.likelihood
            free = fit.known & ~np.any([*self.places.values()], axis=0)
            if "black_level" not in names:
                read = fit.parameters.each("read_noise")
                start[read] = self.profile[read]
        priors, told = [], np.zeros_like(free)
        for name, own in self.places.items():
            if name in names and trained is None:
                free |= own
            elif name in names and trained is not None:
                start[own] = trained.theta[own]
                told |= own & (name != "black_level_drift")
            else:
                start[own] = self.profile[own]
                if (prior := self.priors[name]) is not None:
                    priors.append(prior)
                    free[prior.places] = True
        if trained is not None and told.any():
            places = np.flatnonzero(told)
            known = trained.covariance[np.ix_(places, places)]
            priors.append(Prior(places, trained.theta[places], known))
            free |= told
        prior = Prior.of_all(priors) if priors else None
        return refitted(likelihood, start, free, prior), prior

    def _prior(self, name: str) -> Prior | None:
        """Return where patterns whose mean is not 0 move a level from a profile's."""
        if name == "black_level_drift":
            return None
        signature = "constant" if name == "black_level" else "time"
        places, at = np.flatnonzero(self.places[name]), self.training.parameters.of
        plane = self.training.likelihood.planes[0]
        h, w = plane.plane.shape
        row, column = np.divmod(np.arange(len(places)), plane.side)
        covariance = LEAST_LEVEL * np.eye(len(places))
        for component in FIXED:
            if component.signature != signature:
                continue
            place = at(component.name)
            square = max(float(self.training.theta[place]), 0.0)
            if name == "dark_current":  # what is there is in both
                square = min(square, max(float(self.validation.theta[place]), 0.0))
            if component.per == "line":
                is_row = bool(component.parts[PARTS.index("fast_rows")])
                line, count = (row, h) if is_row else (column, w)
                covariance += square / count * np.equal.outer(line, line)
            elif component.planes == "none":
                covariance += square / (h * w) * np.eye(len(places))
            elif name == "dark_current" and not self.glows:
                parts = float(component.parts @ plane.plane.freedom)
                covariance += square * parts / (h * w)
        means = self.profile[places]
        if name == "dark_current":
            covariance += self.median[1] ** 2
            if self.glows:
                mean = mean_of_glow(self.training)
                means, covariance = means + mean, covariance + (mean / 2) ** 2
        elif self.is_structured:
            mean, error = first_columns(self.training)
            means, covariance = means + mean, covariance + error**2
        return Prior(places, means, covariance)


def unknown_median(fit: Fit) -> tuple[float, float]:
    """Return by how much the median of the pixels' dark current is above the mean, and
    the standard error, DN/s, where their law is not known: between none and what a
    log-normal law from 0 on has, of their mean and variance."""
    mean, variance = (
        max(float(fit.theta[fit.parameters.of(name)]), 0.0)
        for name in ("dark_current", "dark_current_nonuniformity")
    )
    if mean == 0:
        return 0.0, 0.0
    half = mean * (1 - 1 / np.sqrt(1 + variance / mean**2)) / 2
    return -float(half), float(half)


def mean_of_glow(fit: Fit) -> float:
    """Return the mean of an amplifier's glow, DN/s, to about a half: far from the
    amplifier there is none, so it is as far above the lowest tenth of the frame."""
    planes = fit.likelihood.planes
    dark, time = ~planes[0].is_flat, planes[0].time
    weights = planes[0].frames * dark
    weights = weights * (time - weights @ time / weights.sum())
    weights /= weights @ time
    side = planes[0].side
    down, across = (polynomials(length) for length in planes[0].plane.shape)
    image = np.zeros(planes[0].plane.shape)
    for site, plane in enumerate(planes):
        low = np.tensordot(weights, low_of(plane.plane, site, side), 1)
        low[0, 0] = 0.0
        image += down.T @ low @ across / len(planes)
    return max(-float(np.quantile(image, LOWEST)), 0.0)


def first_columns(fit: Fit) -> tuple[float, float]:
    """Return by how much columns that settle from the first one on raise the mean of
    the shortest darks, and the standard error, DN."""
    planes = fit.likelihood.planes
    dark = ~planes[0].is_flat
    shortest = dark & (planes[0].time == planes[0].time[dark].min())
    weights = planes[0].frames * shortest / (planes[0].frames @ shortest)
    columns = [weights @ plane.plane.columns for plane in planes]
    return mean_of_decay(lines_of_mosaic(columns, across=True))


def mean_of_decay(lines: Array) -> tuple[float, float]:
    """Return the mean of the decay in lines, (N,) DN, and its standard error: least
    squares of a straight ramp, which adds nothing, and an exponential from the first
    line on, averaged by likelihood over its length, up to that of the frame."""
    count = len(lines)
    along = np.arange(count)
    means, variances, squares = [], [], []
    for length in np.geomspace(1.0, count * LONGEST, LENGTHS):
        fall = np.exp(-along / length)
        design = np.column_stack([fall, np.ones(count), along])
        inverse = np.linalg.inv(design.T @ design)
        height = float(inverse[0] @ design.T @ lines)
        rest = lines - design @ (inverse @ design.T @ lines)
        squares.append(float(rest @ rest))
        means.append(height * fall.mean())
        variances.append(inverse[0, 0] * fall.mean() ** 2)
    freedom = count - 4
    weights = (min(squares) / np.array(squares)) ** (freedom / 2)
    weights /= weights.sum()
    mean = float(weights @ means)
    of_each = np.array(variances) * np.array(squares) / freedom
    variance = weights @ (of_each + np.square(means)) - mean**2
    return mean, float(np.sqrt(variance))
