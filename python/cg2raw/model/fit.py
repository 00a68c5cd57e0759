# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The fit of the likelihood: Fisher scoring from a start by least squares.

Variances may come out a little below 0: that is within their errors, and a bound at 0
would move the others."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, solve_triangular

from cg2raw.model.components import FIXED, TEMPORAL
from cg2raw.model.evaluation import Evaluation, Parameters
from cg2raw.model.likelihood import Likelihood
from cg2raw.model.planes import PlaneLikelihood
from cg2raw.model.recorded import fine_records
from cg2raw.statistics.codes import ROUNDING
from cg2raw.statistics.constant import PIXEL, Array, ConstantStatistics

ROUNDS = 60  # of scoring; ten are usual
HALVINGS = 10  # of a step that does not rise
NEAR = 1.0  # nats to the top: the likelihood is nearly a parabola
MEMORY = 10  # steps whose curvature counts
# Fits with the light and, if codes are coarse, the offsets by the one before.
AGAIN = 6
SETTLED = 0.05  # standard errors that nothing moves any more
UNSETTLED = 3.0  # likewise: of a fit that does not settle
SAME_LIGHT = 0.05  # relative: flats whose levels differ by less are of one light
DONE = 1e-5  # nats that a round would gain: 1/200 of a standard error
GAIN_DONE = 1e-3  # likewise, where only the value counts
# Of a parameter's own information that the others leave: below, it is not known.
UNKNOWN = 1e-10
KNOWN = 1e-6  # likewise: far above, all are known
ALIKE = 2.0  # nats: fits that differ by less explain alike
LEAST_START = 0.02  # DN^2, of read noise that a fit starts from
LEAST_NOISE = 1e-6  # DN^2, of a frame: far below what rounding makes
LEAST_FREEDOM = 16  # of pixels, that a variance is taken of: it is known to a third


@dataclass(frozen=True)
class Fit:
    """Parameters with their covariance; nan where the frames do not show them.
    is_settled : whether what codes hide of noise agrees with the noise that is found;
    else other values explain the frames as well."""

    parameters: Parameters
    theta: Array
    covariance: Array
    value: float
    likelihood: Likelihood
    is_settled: bool = True

    def of(self, name: str, site: int = 0) -> tuple[float, float]:
        """Return (value, standard error); nan, nan where it is not known."""
        at = self.parameters.of(name, site)
        error = float(np.sqrt(self.covariance[at, at]))
        return (float(self.theta[at]) if np.isfinite(error) else np.nan), error

    def error_at(self, name: str, more: float) -> float:
        """Return the standard error of a parameter that is larger by so much; nan where
        it is not known."""
        theta, at = self.theta.copy(), self.parameters.of(name)
        theta[at] += more
        there = self.likelihood(theta)
        _, covariance = _solved(there.score, there.information, self.known)
        return float(np.sqrt(covariance[at, at]))

    @property
    def known(self) -> NDArray[np.bool_]:
        """(n,) which parameters the frames show."""
        return np.isfinite(np.diagonal(self.covariance))

    def given(self, own: NDArray[np.bool_], pinned: Array) -> Array:
        """Return parameters of which those @own, (n,), are pinned, and all others as
        they are likeliest where the likelihood is normal."""
        theta = np.where(own, pinned, self.theta)
        at, others = np.flatnonzero(own), np.flatnonzero(self.known & ~own)
        moved = np.linalg.solve(
            self.covariance[np.ix_(at, at)], theta[at] - self.theta[at]
        )
        theta[others] += self.covariance[np.ix_(others, at)] @ moved
        bounded = self.parameters.are_bounded
        theta[bounded] = np.maximum(theta[bounded], 0.0)
        return theta

    def variance_of(self, slopes: Array) -> float:
        """Return the variance of what has slopes by the parameters, (n,); those that
        the frames do not show have no part in it."""
        used = self.known & (slopes != 0)
        return float(slopes[used] @ self.covariance[np.ix_(used, used)] @ slopes[used])


def fit(statistics: ConstantStatistics, profile: Array | None = None) -> Fit:
    """Return the fit of darks and flats.

    profile : (n,) values of what the frames do not show; 0 without.
    Raises ValueError where noise is not known: if no two frames repeat each other, all
    of a group are the same, or they are too small."""
    check_noise(statistics)
    likelihood = Likelihood(statistics, profile if statistics.is_flat.all() else None)
    theta, free = start_of(likelihood, profile)
    found = _settled(statistics, likelihood, theta, free)
    if profile is not None and likelihood.is_coarse:
        # Few codes have several explanations; the profile's is as good as any.
        for name in ("black_level", "read_noise", "gain"):
            own = found.parameters.each(name)
            theta[own] = profile[own]
        other = _settled(statistics, likelihood, theta, free)
        is_likelier = other.value > found.value - ALIKE
        if (is_likelier or not found.is_settled) and other.is_settled:
            return other
    return found


def _settled(
    statistics: ConstantStatistics,
    likelihood: Likelihood,
    theta: Array,
    free: NDArray[np.bool_],
) -> Fit:
    """Return the fit from a start, with light and codes as the fit before says."""
    found, most = refitted(likelihood, theta, free), 0.0
    for _ in range(AGAIN if likelihood.is_coarse else 1):
        before = found.theta
        likelihood = Likelihood(statistics, before, likelihood)
        found = refitted(likelihood, before, free)
        with np.errstate(invalid="ignore"):
            moved = (found.theta - before) ** 2 / np.diagonal(found.covariance)
        most = float(np.sqrt(np.nanmax(np.append(moved, 0.0))))
        if most < SETTLED:
            break
    return replace(found, is_settled=not likelihood.is_coarse or most <= UNSETTLED)


def check_noise(statistics: ConstantStatistics) -> None:
    """Raise ValueError where frames do not show their noise."""
    if not (statistics.frames > 1).any() and len(statistics.groups) < 2:
        raise ValueError(
            "frames: no two repeat each other, and all are of one exposure time and "
            "light: noise is not told from what is fixed; add a repeat, or darks of "
            "another time"
        )
    for plane in statistics.planes:
        if plane.freedom[PIXEL] < LEAST_FREEDOM:
            h, w = plane.shape
            raise ValueError(
                f"frames: a plane of the CFA has {w} x {h} samples, fewer than noise "
                f"is known of: their pixel part must have {LEAST_FREEDOM} degrees of "
                "freedom"
            )
        same = (plane.scatter[:, PIXEL] <= 0) & (statistics.frames > 1)
        if same.any():
            names = statistics.groups[int(np.flatnonzero(same)[0])].frames
            raise ValueError(
                f"{names[0]}: has the same pixels as its {len(names) - 1} repeats, or "
                "all of them are clipped: noise is not known; leave them out"
            )
        even = np.diagonal(plane.products[PIXEL]) < LEAST_NOISE
        if (single := even & (statistics.frames == 1)).any():
            name = statistics.groups[int(np.flatnonzero(single)[0])].frames[0]
            raise ValueError(
                f"{name}: all pixels of a colour are alike: it was simulated without "
                "noise, or is clipped; leave it out"
            )


@dataclass(frozen=True)
class Prior:
    """Parameters of which something is known: their places, means and covariance."""

    places: NDArray[np.int64]
    means: Array
    covariance: Array

    @classmethod
    def of_all(cls, priors: Sequence["Prior"]) -> "Prior":
        """Return that of all their parameters; none says anything of another's."""
        places, means = (
            np.concatenate(some)
            for some in zip(*((p.places, p.means) for p in priors), strict=True)
        )
        return cls(places, means, block_diag(*(p.covariance for p in priors)))

    def add_to(self, found: Evaluation, theta: Array) -> None:
        """Add the logarithm of the normal density, 0 at its mean."""
        inverse = np.linalg.inv(self.covariance)
        rest = theta[self.places] - self.means
        found.value -= float(rest @ inverse @ rest) / 2
        found.score[self.places] -= inverse @ rest
        found.information[np.ix_(self.places, self.places)] += inverse


def refitted(
    likelihood: Likelihood,
    theta: Array,
    free: NDArray[np.bool_],
    prior: Prior | None = None,
    done: float = DONE,
) -> Fit:
    """Return the fit that scoring finds from a start; what is not free stays.

    done : nats that a round would gain, below which there is none."""

    def evaluated(theta: Array) -> Evaluation:
        found = likelihood(theta)
        if prior is not None:
            prior.add_to(found, theta)
        return found

    bounded = likelihood.parameters.are_bounded
    found = evaluated(theta)
    if not np.isfinite(found.value):
        theta = np.where(free & likelihood.parameters.are_variances, 0.0, theta)
        found = evaluated(theta)
    seen: list[tuple[Array, Array]] = []
    for _ in range(ROUNDS):
        curvature = _curvature(found.information, seen)
        step = _step(found.score, curvature, theta, free, bounded)
        rise = step @ found.score / 2
        if rise < done:
            break
        for halving in range(HALVINGS):
            trial = theta + step / 2**halving
            better = evaluated(trial)
            if better.value >= found.value:
                break
        else:
            break
        if rise < NEAR:
            fell = np.where(free, found.score - better.score, 0.0)
            seen = [*seen, (trial - theta, fell)][-MEMORY:]
        gain = better.value - found.value
        theta, found = trial, better
        if gain < done:
            break
    _, covariance = _solved(found.score, found.information, free)
    return Fit(likelihood.parameters, theta, covariance, found.value, likelihood)


def _curvature(information: Array, seen: Sequence[tuple[Array, Array]]) -> Array:
    """Return the information with the curvature that was seen along steps: (step, by
    how much the score fell), oldest first. Where scoring steps too far, as where codes
    are few, it is larger. Source: J. Nocedal, S. Wright, Numerical Optimization, 2006,
    equation 6.19 (BFGS)."""
    found = information.copy()
    for step, fell in seen:
        along = found @ step
        if step @ fell > 0 and step @ along > 0:
            found += np.outer(fell, fell) / (step @ fell)
            found -= np.outer(along, along) / (step @ along)
    return found


def _step(
    score: Array,
    information: Array,
    theta: Array,
    free: NDArray[np.bool_],
    bounded: NDArray[np.bool_],
) -> Array:
    """Return the step of scoring that leaves no bounded parameter below 0: those that
    would be go to 0, and the others' step is the best beside theirs."""
    let = free & ~(bounded & (theta <= 0) & (score < 0))
    clamped, step = np.zeros_like(let), np.zeros(len(theta))
    while True:
        fixed = np.where(clamped, -theta, 0.0)
        rest = score + information @ -fixed
        step = _solved(rest, information, let & ~clamped)[0] + fixed
        below = bounded & let & ~clamped & (theta + step < 0)
        if not below.any():
            return step
        clamped |= below


def _solved(
    score: Array, information: Array, free: NDArray[np.bool_]
) -> tuple[Array, Array]:
    """Return (step, covariance): 0 and nan of what is not free or not known."""
    own = np.diagonal(information)
    used = np.flatnonzero(free & (own > 0))
    scale = 1 / np.sqrt(own[used])
    inverse, lost = _inverse(information[np.ix_(used, used)] * np.outer(scale, scale))
    step, covariance = np.zeros(len(score)), np.full(information.shape, np.nan)
    step[used] = scale * (inverse @ (scale * score[used]))
    inverse[lost] = inverse[:, lost] = np.nan
    covariance[np.ix_(used, used)] = inverse * np.outer(scale, scale)
    return step, covariance


def _inverse(matrix: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return the inverse of a symmetric matrix of diagonal 1, and which rows are of
    directions that are not known, which it leaves out."""
    try:
        root = np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        root = np.zeros((1, 1))
    if np.diagonal(root).min(initial=1.0) ** 2 > KNOWN:
        inverse = solve_triangular(root, np.eye(len(root)), lower=True)
        return inverse.T @ inverse, np.zeros(len(root), bool)
    values, vectors = np.linalg.eigh(matrix)
    known = values > UNKNOWN
    inverse = vectors[:, known] / values[known] @ vectors[:, known].T
    return inverse, (vectors[:, ~known] ** 2).sum(axis=1) > 0.01


def start_of(
    likelihood: Likelihood, profile: Array | None = None
) -> tuple[Array, NDArray[np.bool_]]:
    """Return a start by least squares, and which parameters the frames can show.

    profile : (n,) values of all others; 0 without."""
    parameters = likelihood.parameters
    theta, free = np.zeros(len(parameters)), np.ones(len(parameters), bool)
    first = likelihood.planes[0]
    darks, flats = ~first.is_flat, first.is_flat
    has_times = len(set(first.time[darks])) > 1
    # Flats of one light do not tell what is in proportion to it.
    lights = first.plane.level[flats]
    is_told = darks.any() or np.ptp(lights) > SAME_LIGHT * lights.max()
    if profile is None:
        is_told = True  # of what is alike, one is taken for the other
    of_signature = {"constant": bool(is_told), "light": bool(flats.any())}
    of_signature |= {"time": has_times, "constant and time": has_times}
    for component in (*TEMPORAL, *FIXED):
        at = parameters.of(component.name)
        free[at] = of_signature[component.signature]
        if parameters.sites == 1 and component.name.startswith("color_shading"):
            free[at] = False
    if first.frames[flats].sum() < 2:  # what is new in every flat looks like the lens
        free[parameters.are(["lamp", "mains_flicker"])] = False
    free[parameters.of("dark_current")] = has_times
    if first.frames[darks].sum() < 3:  # two times: read noise would look the same
        free[parameters.of("dsnu and dark current")] = False
    rest = int(darks.sum()) - likelihood.levels.parameters_of_means
    free[parameters.of("black_level_drift")] = (darks & first.repeats).any() or rest > 0
    free[parameters.each("black_level")] = darks.any()
    # Of two codes there is one share: it tells the noise, or the level.
    has_share = likelihood.means.statistics.dark_codes <= 2
    if profile is not None and has_share:
        free[parameters.each("black_level")] = False
        free[parameters.of("black_level_drift")] = False
    free[parameters.each("read_noise")] = is_told
    if profile is not None:
        theta = np.where(free, theta, profile)
    _start_levels(likelihood, theta, darks)
    for plane in likelihood.planes:
        coded = plane.scatter[:, PIXEL] - ROUNDING
        noise = coded if has_share else plane.unrounded()
        _start_noise(plane, theta, free, profile, noise)
    _start_patterns(likelihood, theta, free)
    if profile is not None and first.frames[flats].sum() == 1:
        # One flat has PRNU as well. By darks alone the gain may be anything where its
        # error is larger than itself.
        stated = parameters.are(["gain"]) & (profile > 0)
        there = likelihood(np.where(stated, profile, theta))
        variance = np.diagonal(_solved(there.score, there.information, free)[1])
        lost = stated & ~(variance < profile**2)
        theta, free = np.where(lost, profile, theta), free & ~lost
    return theta, free


def _start_levels(
    likelihood: Likelihood, theta: Array, darks: NDArray[np.bool_]
) -> None:
    parameters, first = likelihood.parameters, likelihood.planes[0]
    if not darks.any():
        return
    noise = max(float(first.unrounded()[first.measured].min()), LEAST_START)
    places = np.array([plane.places(noise) for plane in likelihood.planes])
    time, weights = first.time[darks], np.sqrt(first.frames[darks])
    design = np.column_stack([np.ones(len(time)), time])
    if not np.ptp(time):
        design = design[:, :1]
    values = np.linalg.lstsq(
        design * weights[:, None], places[:, darks].T * weights[:, None], rcond=None
    )[0]
    theta[parameters.each("black_level")] = values[0]
    if len(values) > 1:
        theta[parameters.of("dark_current")] = max(float(values[1].mean()), 0.0)
    levels = [
        np.mean([p.plane.levels[g] for p in likelihood.planes], axis=0)
        for g in np.flatnonzero(darks & first.repeats)
    ]
    drift = parameters.of("black_level_drift")
    if levels:
        squares = sum(((x - x.mean()) ** 2).sum() for x in levels)
        theta[drift] = squares / sum(len(x) - 1 for x in levels)
    elif len(time) > len(values):
        away = (places[:, darks].T - design @ values).mean(axis=1) * weights
        theta[drift] = away @ away / (len(time) - len(values))


def _start_noise(
    plane: PlaneLikelihood,
    theta: Array,
    free: NDArray[np.bool_],
    profile: Array | None,
    noise: Array,
) -> None:
    """Least squares of the scatter, each weighted by its own measured size.

    noise : (G,) DN^2, of pixels before it is recorded."""
    place = plane.parameters.of
    read, gain = place("read_noise", plane.site), place("gain", plane.site)
    hidden = plane.scatter[:, PIXEL] - noise
    rest = plane.scatter - hidden[:, None] - (0.0 if free[read] else theta[read])
    theta[gain] = 0.0
    signal = plane.signal(theta)
    again = plane.measured
    free[gain] = np.ptp(signal[again]) > 0 or not free[read]
    if profile is not None and not free[gain]:
        theta[gain] = profile[gain]
    names = [place(c.name) for c in TEMPORAL]
    columns = [n for n in (read, gain, *names) if free[n]]
    by_variance = np.zeros((len(signal), len(theta)))
    by_variance[:, read], by_variance[:, gain] = 1.0, signal
    _, by = plane.temporal(theta, *fine_records(0 * signal, 0 * signal, by_variance))
    freedom = plane.freedom.copy()
    single = plane.measured & ~plane.repeats
    freedom[single, PIXEL] = plane.plane.freedom[PIXEL]
    known = (freedom > 0) & (plane.scatter > 0)
    weights = np.sqrt(freedom[known]) / plane.scatter[known]
    design = by[known][:, columns] * weights[:, None]
    scale = np.abs(design).max(axis=0) + 1e-300
    values = np.linalg.lstsq(design / scale, rest[known] * weights, rcond=None)[0]
    theta[columns] = np.maximum(values / scale, 0.0)
    theta[read] = max(theta[read], LEAST_START)


def _start_patterns(
    likelihood: Likelihood, theta: Array, free: NDArray[np.bool_]
) -> None:
    """Least squares of the products less the noise, each weighted by its size; none of
    those that pixels have is 0."""
    designs, rests = [], []
    names = range(likelihood.parameters.of(FIXED[0].name), len(theta))
    used = [n for n in names if free[n]]
    for block in likelihood.means.blocks:
        planes = [likelihood.planes[s] for s in block.planes]
        noise = [p.scatter[:, block.part] / p.frames for p in planes]
        size = np.sqrt(np.diagonal(block.products) + 1e-300)
        weights = np.sqrt(block.freedom) / np.outer(size, size)
        rests.append(
            ((block.products - np.diag(np.concatenate(noise))) * weights).ravel()
        )
        design = np.zeros((len(used), block.products.size))
        fixed = zip(block.places[: block.fixed], block.terms, strict=False)
        for place, term in fixed:
            if free[place]:
                design[used.index(place)] = (term * weights).ravel()
        designs.append(design)
    design = np.concatenate(designs, axis=1).T
    scale = np.abs(design).max(axis=0) + 1e-300
    design /= scale
    products = design.T @ np.column_stack([design, np.concatenate(rests)])
    values = np.linalg.lstsq(products[:, :-1], products[:, -1], rcond=None)[0]
    theta[used] = np.maximum(values, 0.0) / scale
    theta[likelihood.parameters.of("dsnu and dark current")] = 0.0


def gain_of(
    own: NDArray[np.bool_],
    trained: Array,
    validation: Fit,
    profile: Array,
    least: float,
    prior: Prior | None = None,
) -> float:
    """Return the nats of parameters @own, (n,), as trained over those of a profile; 0
    where no start leads to frames that either allows.

    trained : (n,). least : nats that count. prior : of how far something else moves
    them from the profile's."""
    free = validation.known & ~own
    let = free if prior is None else free | own

    def values(starts: Sequence[Array]) -> list[float]:
        sides = zip(starts, ((let, prior), (free, None)), strict=True)
        return [
            refitted(validation.likelihood, start, used, about, GAIN_DONE).value
            for start, (used, about) in sides
        ]

    null, found = values([validation.given(own, to) for to in (profile, trained)])
    if found - null > least and validation.likelihood.is_coarse:
        # Few codes have several explanations: the likelier one of two starts counts.
        start = np.where(validation.known, profile, validation.theta)
        again = values([np.where(own, to, start) for to in (profile, trained)])
        null, found = max(null, again[0]), max(found, again[1])
    return found - null if np.isfinite([null, found]).all() else 0.0
