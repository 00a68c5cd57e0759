# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Maps of pixels: offsets, rates and gains of the same pixels, estimated together.

Each map is Gaussian with a variance of its own, which all pixels together show (see
map_prior): what is known of a pixel is its posterior under these priors. Of a map that
is log-normal, or of which a few pixels are wide, each pixel's prior is the normal that,
with its estimate, has the mean and variance of its posterior. Source of that: T. P.
Minka, UAI 17, 2001 (expectation propagation).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cg2raw.diagnose.effects.base import NORMAL_95, SensorMap
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.diagnose.inference.log_normal_law import Rates
from cg2raw.diagnose.inference.log_normal_map import LogNormalMap, fit_log_normal_map
from cg2raw.diagnose.inference.map_evidence import LEAST_INFORMATION, Evidence
from cg2raw.diagnose.inference.map_prior import (
    Stated,
    bounded_tail,
    lost_by_variance,
    mixed_prior_of,
)
from cg2raw.diagnose.inference.marginals import (
    LEAST_LEFT,
    Prior,
    marginal,
    posterior_covariance,
    slope_and_error,
)
from cg2raw.diagnose.inference.row_shifts import row_shifts
from cg2raw.diagnose.inference.slow_part import KEPT, high_pass, slow_part
from cg2raw.diagnose.likelihood.model import Term

MOST_TURNS = 30  # of all maps, until they agree
WARM_TURNS = 4  # of maps whose deviations are nearly known
LEAST_MAP_VARIANCE = 1e-200
MOST_OF_CHARGE = 0.99  # of the variance of a rate's estimate: some is of the read-out
AGREED = 1e-3  # relative change of their deviations, from where on they do


def pixel_maps(
    terms: Sequence[Term],
    effects: Sequence[FixedPattern],
    evidence: Evidence,
    stated: Sequence[Stated | None] | None = None,
) -> list[Term]:
    """Return terms with their maps and the maps' standard deviations.

    stated : of each map, what a profile says of it, which holds where pixels do not
    contradict it; None without."""
    stated = stated or [None] * len(terms)
    count = len(terms)
    priors = [Prior(float(term.values[0]) ** 2) for term in terms]
    turns = WARM_TURNS if count > 1 else 1
    if count > 1 and not all(prior.variance for prior in priors):
        priors = [
            _prior(k, effects[k], evidence, stated[k], None) for k in range(count)
        ]
        turns = MOST_TURNS
    slow: Slow = {}
    # Nearer than so many pixels tell a deviation they need not agree.
    pixels = max(int(evidence.known(k).sum()) for k in range(count))
    enough = max(AGREED, NORMAL_95 / np.sqrt(2 * max(pixels, 1)))
    for _ in range(turns):
        before = [prior.variance for prior in priors]
        for k in range(count):
            priors[k] = _prior(k, effects[k], evidence, stated[k], priors, slow)
        now = [prior.variance for prior in priors]
        if np.allclose(np.sqrt(now), np.sqrt(before), rtol=enough, atol=0):
            break
    means = _means(effects, evidence, priors, slow)
    covariance = posterior_covariance(evidence, priors)
    found = []
    for k, term in enumerate(terms):
        others = {terms[i].name: covariance[k, i] for i in range(count) if i != k}
        sensor_map = SensorMap(means[k], covariance[k, k], others, told=priors[k].told)
        values = np.array([np.sqrt(priors[k].variance)])
        if (rates := _law_of(priors[k])) is not None:
            sensor_map = rates.of_law(sensor_map, evidence.unseen)
        lost = priors[k].lost
        found.append(
            replace(term, values=values, sensor_map=sensor_map, contradicted=lost)
        )
    return found


# By the number of a map: its slow part beside its mean; by ~number: shifts of rows.
Slow = dict[int, Array]


@dataclass(frozen=True)
class _RatePrior(Prior):
    """Of a map whose pixels have a law of their own."""

    rates: LogNormalMap | None = None

    @cached_property
    def _normal(self) -> tuple[Array, Array]:
        assert self.rates is not None
        rates = self.rates.rates
        told = np.where(self.rates.known, 1 / rates.error, 0)
        estimate = rates.estimate - self.rates.shift
        return _as_normal(*self.rates.posterior, estimate, told)

    @property
    def each(self) -> Array:
        return np.asarray(1 / self._normal[0])

    @property
    def pull(self) -> Array:
        return self._normal[1]

    @cached_property
    def of_all(self) -> Prior:
        """What is hot may have any rate."""
        assert self.rates is not None
        mean, variance = self.rates.of_all
        hot, widest = self.rates.hot, 2 * self.rates.mixture.hot_rate**2
        own = (1 - hot) / variance + hot / widest
        return Prior(variance, 1 / own, (1 - hot) * mean / variance)


def _prior(
    one: int,
    effect: FixedPattern,
    evidence: Evidence,
    stated: Stated | None,
    priors: Sequence[Prior] | None,
    slow: "Slow | None" = None,
) -> Prior:
    """Return the prior of one map, where the others are as unsure as their priors; None
    for others that are 0.

    stated : by a profile. slow : the slow parts of log-normal maps, once they are
    known: they change little."""
    known = evidence.known(one)
    weights, score = marginal(one, evidence, priors)
    slope, error = slope_and_error(one, evidence, weights)
    slope, error = np.where(known, slope, 1.0), np.where(known, error, 1.0)
    estimate = np.where(known, score / slope, 0)
    if effect.is_log_normal:
        noisier, of_charge, of_rows = (
            np.einsum("j...,jk...,k...", weights, more, weights) / slope**2
            for more in (evidence.noisier, evidence.of_charge, evidence.of_rows)
        )
        estimate = _own_part(one, effect, estimate, known, evidence.repeat, slow)
        before = None if priors is None else _law_of(priors[one])
        of_charge = np.minimum(of_charge, MOST_OF_CHARGE * error)
        rates = Rates(estimate, error, noisier, of_charge)
        if before is not None and slow is not None and ~one not in slow:
            rows = row_shifts(before.mixture, rates, known, of_rows)
            slow[~one], rates = rows, replace(rates, estimate=estimate - rows)
        return _of_rates(rates, known, stated, before)
    return _of_deviation(effect, estimate, error, known, evidence, stated)


def _of_deviation(
    effect: FixedPattern,
    estimate: Array,
    error: Array,
    known: Mask,
    evidence: Evidence,
    stated: Stated | None,
) -> Prior:
    """Return the prior of a map that is normal, but perhaps for a few pixels.

    error : variance of the estimates."""
    kept = 1.0
    if effect.lacks_slow_part:
        estimate, kept = high_pass(estimate, known / error, evidence.repeat), KEPT
    of_known = (estimate**2 / kept)[known], error[known]
    variance = bounded_tail(*of_known)
    mixed = mixed_prior_of(*of_known) if effect.has_long_tails else None
    likely = [variance]
    if mixed is not None:
        variance = max(variance, mixed.half_of_tail(of_known[1]))
        likely += [variance, mixed.narrow]  # with half of its tail, and without
    lost = 0.0
    if stated is not None:
        said = stated.numbers["sigma"] ** 2
        lost = min(lost_by_variance(said, each, error[known]) for each in likely)
        if stated.holds(lost, known.sum()):
            variance, lost = said, 0.0
            if mixed is not None:
                mixed = mixed_prior_of(*of_known, variance)
    seen = estimate / np.sqrt(kept), np.where(known, error, np.inf)
    if mixed is None:
        return Prior(variance, lost=lost, told=seen)
    mean, spread = mixed.posterior(estimate, error)
    told = np.where(known, 1 / error, 0)
    own, pull = _as_normal(mean, spread, estimate, told)
    pixels = np.where(known, 1 / own, variance)
    return Prior(variance, pixels, known * pull, lost, seen)


def _law_of(prior: Prior) -> LogNormalMap | None:
    return prior.rates if isinstance(prior, _RatePrior) else None


def _of_rates(
    rates: Rates, known: Mask, stated: Stated | None, before: LogNormalMap | None
) -> Prior:
    """Return the prior that a log-normal law gives to the rate of each pixel."""
    start = None if before is None else before.mixture
    found = fit_log_normal_map(rates, known, start, stated)
    if found is None:
        return Prior(0.0)
    return _RatePrior(found.mixture.law.sigma**2, lost=found.lost, rates=found)


def _as_normal(
    mean: Array, variance: Array, estimate: Array, told: Array
) -> tuple[Array, Array]:
    """Return (precisions, these times means) of the normal priors that, with estimates
    of precision told, have a mean and a variance."""
    least = LEAST_LEFT * told + LEAST_INFORMATION
    own = np.maximum(1 / np.maximum(variance, LEAST_MAP_VARIANCE) - told, least)
    return own, mean * (own + told) - told * estimate


def _own_part(
    one: int,
    effect: FixedPattern,
    estimate: Array,
    known: Mask,
    repeat: int,
    slow: Slow | None,
) -> Array:
    """Return estimates of a log-normal map without its slow part, but with their
    mean. slow : those of maps that are known already."""
    if not (effect.lacks_slow_part and known.any()):
        return estimate
    kept = {} if slow is None else slow
    if one not in kept:
        kept[one] = slow_part(estimate, known, repeat)
    return np.where(known, estimate - kept[one] - kept.get(~one, 0), 0)


def _means(
    effects: Sequence[FixedPattern],
    evidence: Evidence,
    priors: Sequence[Prior],
    slow: Slow,
) -> Array:
    """Return (K, T, h, w) posterior means: each map by what the others leave."""
    means = np.zeros_like(evidence.score)
    for _ in range(MOST_TURNS if len(effects) > 1 else 1):
        before = means.copy()
        for k, effect in enumerate(effects):
            own, known = evidence.information[k, k], evidence.known(k)
            others = np.einsum("k...,k...", evidence.information[k], means)
            own = np.where(known, own, LEAST_INFORMATION)
            left = (evidence.score[k] - others) / own
            estimate = np.where(known, means[k] + left, 0)
            prior = priors[k].each
            if effect.is_log_normal:
                estimate = _own_part(k, effect, estimate, known, evidence.repeat, slow)
                rates = _law_of(priors[k])
                estimate = np.where(known, estimate - (rates.shift if rates else 0), 0)
            elif effect.lacks_slow_part:
                estimate = high_pass(estimate, known * own, evidence.repeat)
            means[k] = (estimate * own + priors[k].pull) * (prior / (own * prior + 1))
        if np.abs(means - before).max() <= AGREED * np.abs(means).max():
            break
    return means
