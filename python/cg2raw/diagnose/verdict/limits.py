# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Detection limits: how strong an effect would have had to be to be named."""

from collections.abc import Collection, Iterator

import numpy as np
from scipy.optimize import brentq
from scipy.special import gammaincinv

from cg2raw.diagnose.darks_and_flats import VALIDATION, DarksAndFlats
from cg2raw.diagnose.diagnosis import DetectionLimit
from cg2raw.diagnose.effects.registry import unit_of
from cg2raw.diagnose.verdict.values import limits_of_levels, of_amplifiers
from cg2raw.model.values import LOGARITHMS, Value, effect_values
from cg2raw.normal import ABOVE95, CI95

MOST_FREEDOM = 1e6  # of a variance: as good as normal


def detection_limits(
    found: DarksAndFlats, named: Collection[str]
) -> Iterator[DetectionLimit]:
    """Yield the limit of each parameter that the frames show and whose effect is not
    named: how much more than the profile has would be named in 95 of 100 such sets."""
    for one, strength in _seen_from(found):
        if one.effect not in named and np.isfinite(strength):
            unit = unit_of(one.effect, one.parameter, found.captures.sensor.cfa)
            yield DetectionLimit(one.effect, one.parameter, float(strength), unit)


def _seen_from(found: DarksAndFlats) -> Iterator[tuple[Value, float]]:
    """Yield values, and how strong they must be.

    A parameter that is u errors away gains u^2 / 2, and the root of that has a normal
    error: of noise and patterns, which both ways of two splits decide, 1 / sqrt(2)."""
    white, validation = found.captures.sensor.signal_range, found.selection.validation
    own = found.statistics.of_splits([VALIDATION])
    errors = found.amplifiers.errors.items()
    of_steps = of_amplifiers(found, {name: (0.0, error) for name, error in errors})
    values = effect_values(own, validation, found.profile, white)
    root = np.sqrt(2 * found.least)
    one_way, both_ways = root + ABOVE95, root + ABOVE95 / np.sqrt(2)
    for one in (*values, *limits_of_levels(found), *of_steps):
        if one.parameter == "sigma":
            had = found.profile[found.both.parameters.of(one.effect)]
            square = had + _variance_seen(found, one.effect)
            scale = 1.0 if one.effect == "prnu" else white
            yield one, (np.sqrt(square) - np.sqrt(had)) / scale
            continue
        unsure = found.selection.unsure.get(one.effect, 0.0) / white
        error = (one.high - one.low) / 2 / CI95
        if one.effect == "dark_current":  # whose interval is Student's
            error = validation.of(one.effect)[1] / white
        errors_away = both_ways if one.effect in LOGARITHMS else one_way
        yield one, errors_away * np.hypot(error, unsure)


def _variance_seen(found: DarksAndFlats, name: str) -> float:
    """Return the variance that is seen: where an estimate of it is at the lowest
    twentieth of its chi-square law, whose freedom is by how the error grows with it."""
    fit = found.selection.validation
    _, error = fit.of(name)
    more = 2 * error
    grown = fit.error_at(name, more) - error if np.isfinite(error) else np.nan
    if not np.isfinite(grown):
        return np.nan
    freedom = np.clip(2 * (more / max(grown, 1e-3 * error)) ** 2, 1.0, MOST_FREEDOM)
    ways = 1 if name == "black_level_drift" else 2
    low = gammaincinv(ways * freedom / 2, 0.05) / (ways * freedom / 2)

    def missing(ratio: float) -> float:
        gain = freedom / 2 * (low * ratio - np.log1p(ratio))
        return float(gain - found.least)

    return float(error * np.sqrt(freedom / 2) * brentq(missing, 0.0, 1e9))
