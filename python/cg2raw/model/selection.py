# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Selection: each name is dropped on frames that did not fit it.

All is fitted on training frames. On validation frames, a name gains the log-likelihood
with its parameters as trained and all others fitted anew, less the same with its
parameters as the profile has them. Of one that gains too little, but something, the
other way round is tried as well, and the mean of both likelihood ratios counts. Source:
L. Wasserman, A. Ramdas, S. Balakrishnan, PNAS 117(29), 2020 (split and crossfit
likelihood-ratio tests)."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cg2raw.model.dark_levels import DRIFT, LEVELS, DarkLevels
from cg2raw.model.evaluation import Parameters
from cg2raw.model.fit import Fit, Prior, gain_of
from cg2raw.model.lags import FILTER, Blended, Lags, lag_gains
from cg2raw.model.shapes import Shapes
from cg2raw.model.shapes.dust import NAME as DUST
from cg2raw.model.shapes.heavy_tailed_noise import NAME as TAILS
from cg2raw.model.shapes.random_telegraph_noise import NAME as JUMPS
from cg2raw.model.values import LOGARITHMS
from cg2raw.normal import CI95
from cg2raw.statistics.constant import Array

# Names and their parameters; of those that each part has, their beginning.
NAMES: Mapping[str, tuple[str, ...]] = {
    **{name: (name,) for name in LEVELS},
    "read_noise": ("read_noise",),
    "shot_noise": ("gain",),
    "row_noise": ("row_noise",),
    "dsnu": ("dsnu", "dsnu and dark current"),
    "column_fixed_pattern": ("column_fixed_pattern",),
    "bias_structure": ("bias_structure",),
    "dark_current_nonuniformity": (
        "dark_current_nonuniformity",
        "dsnu and dark current",
    ),
    "amplifier_glow": ("amplifier_glow",),
    "prnu": ("prnu",),
    "lens_shading": ("lens_shading",),
    "color_shading": ("color_shading",),
    "mains_flicker": ("mains_flicker",),
}
# A covariance, which no profile states: without the one of its effects it is none.
BOTH = "dsnu and dark current"
OF_LENS = ("lens_shading", "color_shading")
FLICKER = "mains_flicker"
LAMP = ("lamp", FLICKER)  # what is new in every flat
MEAN = math.log(2)  # nats that the mean of two likelihood ratios has less than both
LEAST_SHAPE = 1e-12  # DN^2, or relative: of a stated shape that is none
# Components that no effect has: where structure is that nothing explains.
UNNAMED = ("column_noise", "row_fixed_pattern", "columns of light", "rows of light")
SPOTS = "spots of light"  # likewise, of pixels


@dataclass(frozen=True)
class Selection:
    """gains : nats of each name that the frames can show, on validation frames.
    unnamed : likewise of UNNAMED and SPOTS. unsure : how far other effects may move
    levels of darks, DN or DN/s, by name. levels : of LEVELS, those that darks decide.
    alike : by name, others that may be in its place."""

    gains: Mapping[str, float]
    training: Fit
    validation: Fit
    unnamed: Mapping[str, float] = field(default_factory=dict)
    unsure: Mapping[str, float] = field(default_factory=dict)
    levels: Collection[str] = ()
    alike: Mapping[str, Collection[str]] = field(default_factory=dict)

    def kept(self, least: float) -> list[str]:
        """Return the names that gain more than @least nats, best first."""
        order = sorted(self.gains, key=lambda name: -self.gains[name])
        return [name for name in order if self.gains[name] > least]


def selection(
    training: Fit,
    validation: Fit,
    profile: Array,
    least: float,
    lags: tuple[Lags, Lags] | None = None,
    shapes: Shapes | None = None,
    allowed: Mapping[str, float] | None = None,
    together: Fit | None = None,
) -> Selection:
    """Return what each name gains.

    profile : (n,) parameters of the null. least : nats that a name needs. lags : of
    both, of repeats. shapes : of the same frames; None where they are not known.
    allowed : variance of a coefficient that frames may have beyond a shape that a
    profile states, by name. together : the fit of all these frames, which levels of
    single darks of two times need."""
    shapes = shapes or Shapes({})
    parameters = training.parameters
    gains: dict[str, float] = {}
    alike: Mapping[str, Collection[str]] = {}
    blended = None
    if lags is not None:
        (gains, alike), trained, covariance = lag_gains(*lags, least)
        if gains[FILTER] > least:
            blended = Blended.of(lags[0], trained, covariance)
    known = training.known & validation.known
    places = _places_of(parameters, known)
    allowed = dict(allowed or {})
    if min(shapes.spots, profile[parameters.of("prnu")]) > 0:
        allowed["prnu"] = shapes.spots
    for name in ("dsnu", "dark_current_nonuniformity"):
        if profile[parameters.of(name)] > 0 and name in places:
            places[name][parameters.of(BOTH)] = False
    has_one_flat = not known[parameters.are(LAMP)].any()
    of_rows = np.array([name.endswith(", slow_rows") for name in parameters.names])
    for name, own in places.items():
        if name in LEVELS:
            continue
        at, prior = np.flatnonzero(own), None
        if blended is not None and name in ("read_noise", "shot_noise"):
            prior = blended.prior(at, profile)
        elif name in allowed:
            size = max(allowed[name], LEAST_SHAPE)
            prior = Prior(at, profile[at], size**2 * np.eye(len(at)))
        values = [fit.theta for fit in (training, validation)]
        if name in LOGARITHMS:
            values = [_in_common(theta, own, profile) for theta in values]
        there = gain_of(own, values[0], validation, profile, least, prior)
        back = -np.inf
        is_weak = 0 < there <= least + MEAN and (prior is None or name in allowed)
        if is_weak and _may_gain(training, own, profile, least):
            back = gain_of(own, values[1], training, profile, least, prior)
        gains[name] = float(np.logaddexp(there, back)) - MEAN
        if has_one_flat and name in OF_LENS and gains[name] > least:
            # Of waves down the rows, those of one flat may be of the light's.
            if gain_of(own & ~of_rows, values[0], validation, profile, least) < least:
                alike = {**alike, name: (FLICKER,)}
        has_dust = DUST in shapes.found and shapes.found[DUST].nats > least
        if has_dust and name in OF_LENS and gains[name] > least:
            at = np.flatnonzero(own)
            of_spots = Prior(at, profile[at], shapes.corners**2 * np.eye(len(at)))
            if gain_of(own, values[0], validation, profile, least, of_spots) < least:
                alike = {**alike, name: (*alike.get(name, ()), DUST)}
    is_structured = "bias_structure" in allowed
    is_structured |= gains.get("bias_structure", 0.0) > least
    glows = gains.get("amplifier_glow", 0.0) > least
    of_darks = _dark_levels(
        training, validation, together, profile, shapes, is_structured, glows
    )
    if of_darks is not None:
        gains |= of_darks.gains(least)
    gains |= {name: shape.nats for name, shape in shapes.found.items()}
    if "read_noise" in gains:
        left = 1.0 if blended is None else blended.left
        own = places["read_noise"]
        gains["read_noise"] = _nats_of_core(
            gains, validation, own, left * float(profile[own].mean()), shapes, least
        )
    dust = shapes.found.get(DUST)
    unnamed = {SPOTS: dust.unlike} if dust is not None and dust.unlike > 0 else {}
    for name in UNNAMED:
        own = parameters.are([name]) & known
        if own.any():
            unnamed[name] = gain_of(own, training.theta, validation, profile, least)
    unsure = {} if of_darks is None else of_darks.unsure
    levels = () if of_darks is None else tuple(of_darks.places)
    return Selection(gains, training, validation, unnamed, unsure, levels, alike)


def _dark_levels(
    training: Fit,
    validation: Fit,
    together: Fit | None,
    profile: Array,
    shapes: Shapes,
    is_structured: bool,
    glows: bool,
) -> DarkLevels | None:
    """Return the levels of darks; None where nothing says how far they may be off: they
    could be any of LEVELS. Arguments: as of selection() and DarkLevels."""
    pairs = [(training, validation)]
    pairs += [] if together is None else [(together, together)]
    for pair in pairs:
        each = _places_of(pair[0].parameters, pair[0].known & pair[1].known)
        levels = {name: each[name] for name in LEVELS if name in each}
        if DRIFT in levels:
            median = shapes.dark_median
            return DarkLevels(
                levels, *pair, profile, median, is_structured=is_structured, glows=glows
            )
    return None


def _nats_of_core(
    gains: Mapping[str, float],
    validation: Fit,
    own: NDArray[np.bool_],
    variance: float,
    shapes: Shapes,
    least: float,
) -> float:
    """Return the nats of read noise: of its core where there are jumps or tails.

    own : (n,), its parameters. variance : DN^2, of the profile."""
    found = gains["read_noise"]
    if gains.get(JUMPS, 0.0) > least:
        found = shapes.read_noise(variance, shapes.cores) or found
    if gains.get(TAILS, 0.0) > least:
        found = min(_nats_with_tails(validation, own, variance, shapes), found)
    return found


def _nats_with_tails(
    validation: Fit, own: NDArray[np.bool_], profile: float, shapes: Shapes
) -> float:
    """Return the nats that read noise may gain where it has tails. own : (n,), its
    parameters. profile : DN^2.

    A profile's noise is that of most draws, or of more, up to all; and few frames lack
    the rarest and widest, which may add as much as tails do."""
    kept = float(validation.theta[own].mean())
    whole, error = shapes.whole
    if shapes.most[1] is None:  # codes are few: only all draws together are known
        chance = (
            validation.variance_of(own / own.sum()) * whole**2 + (kept * error) ** 2
        )
        return (kept * whole - profile) ** 2 / chance / 2
    most = shapes.most[1][0]
    seen = kept * (whole + CI95 * error)
    if most < profile < seen + max(seen - most, 0.0):
        return 0.0
    return shapes.read_noise(profile, shapes.most) or np.inf


def _may_gain(fit: Fit, own: NDArray[np.bool_], profile: Array, least: float) -> bool:
    """Return whether parameters @own, (n,), are as far from a profile's as half the
    nats that a name needs."""
    away = (fit.theta - profile)[own]
    return bool(away @ np.linalg.solve(fit.covariance[np.ix_(own, own)], away) > least)


def _in_common(theta: Array, own: NDArray[np.bool_], profile: Array) -> Array:
    """Return parameters of which those @own, (n,), are as many times a profile's, as an
    effect of one value has them; as they are where the profile's are none."""
    if not (np.minimum(theta, profile)[own] > 0).all():
        return theta
    factor = np.exp(np.log(theta[own] / profile[own]).mean())
    return np.where(own, factor * profile, theta)


def _places_of(
    parameters: Parameters, known: NDArray[np.bool_]
) -> dict[str, NDArray[np.bool_]]:
    """Return (n,) which parameters are of each of NAMES that has any that is known.
    known : (n,)."""
    each = {name: parameters.are(own) & known for name, own in NAMES.items()}
    return {name: own for name, own in each.items() if own.any()}
