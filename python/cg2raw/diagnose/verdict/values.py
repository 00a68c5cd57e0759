# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Values of what is named that are no figure of the fit: shapes of the dark frame and
of the light as calibrate has them, correlations by lags, changes of light by levels."""

import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from cg2raw.calibration.calibration import Calibration, effects_found
from cg2raw.calibration.fitting import BLACK
from cg2raw.calibration.measured import Measured
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.darks_and_flats import (
    VALIDATION,
    DarksAndFlats,
)
from cg2raw.diagnose.effects.registry import listed_parameters
from cg2raw.diagnose.verdict.measurements import measurements_of
from cg2raw.diagnose.verdict.profile import OF_SENSOR
from cg2raw.model import flicker
from cg2raw.model.amplifier_mismatch import NAME as MISMATCH
from cg2raw.model.amplifier_mismatch import AmplifierMismatch, unit_of
from cg2raw.model.flat_levels import CHANGES
from cg2raw.model.full_well import NAME as WELL
from cg2raw.model.lags import (
    NAMES,
    PARAMETERS,
    Blended,
    lags_of,
    variance_left,
    variance_left_of_lines,
)
from cg2raw.model.profile_values import LINES, PIXELS, profile_lags
from cg2raw.model.values import LOGARITHMS, Value
from cg2raw.normal import CI95
from cg2raw.statistics.constant import Array

# Parameters of effects of levels, and the share of a value that each has: of crosstalk
# both neighbours along a line have half.
OF_LEVELS: Mapping[str, tuple[tuple[str, int, float], ...]] = {
    "exposure": (("gain", 0, 1.0),),
    "white_balance": (("red", 0, 1.0), ("blue", 1, 1.0)),
    "crosstalk": (
        *(("left", 0, 0.5), ("right", 0, 0.5)),
        *(("up", 1, 0.5), ("down", 1, 0.5)),
    ),
    "gr_gb_imbalance": (("gr", 0, 1.0), ("gb", 1, 1.0)),
    "nonlinearity": (("quadratic", 0, 1.0), ("cubic", 1, 1.0)),
}
OF_VARIANCES = ("row_noise", "dsnu", "column_fixed_pattern", "prnu")
# As of calibrate: shapes; the dark current of the median pixel, which is what the
# registry calls so, beside them; the black level of the shortest darks.
OF_SHAPES = frozenset(
    {
        *("bias_structure", "amplifier_glow", "lens_shading", "black_level"),
        *("dark_current", "dark_current_nonuniformity"),
    }
)


def values_of(found: DarksAndFlats, named: Collection[str]) -> list[Value]:
    """Return the values of effects that are named, by training and validation frames;
    of one that stands for another, the later take the place of the fit's."""
    variances = [*found.values, *_withheld(found, named)]
    return [
        *_before_reduction(found, named, variances),
        *_of_levels(found, named),
        *_of_shapes(found, named),
        *_of_flicker(found, named),
        *_of_well(found, named),
        *of_amplifiers(found, {n: s[:2] for n, s in found.amplifiers.steps.items()}),
    ]


def _of_well(found: DarksAndFlats, named: Collection[str]) -> Iterator[Value]:
    if found.frames.well is not None and WELL in named:
        sensor = found.captures.sensor
        white = sensor.signal_range
        stated = (listed_parameters(sensor, WELL) or {}).get("below_white", 0.0)
        value = 1 - stated - found.frames.well.level / white
        half = CI95 * found.frames.well.error / white
        yield Value(WELL, "below_white", value, value - half, value + half)


def of_amplifiers(
    found: DarksAndFlats, steps: Mapping[str, tuple[float, float]]
) -> Iterator[Value]:
    """Yield steps between halves, each with its standard error, in the units of the
    registry."""
    white = found.captures.sensor.signal_range
    for parameter, (value, error) in steps.items():
        numbers = value + error * np.array([0, -CI95, CI95])
        yield Value(
            MISMATCH, parameter, *map(float, numbers / unit_of(parameter, white))
        )


def _of_flicker(found: DarksAndFlats, named: Collection[str]) -> Iterator[Value]:
    if flicker.NAME in named:
        for parameter, *numbers in flicker.flicker(found.both):
            yield Value(flicker.NAME, parameter, *numbers)


def _withheld(found: DarksAndFlats, named: Collection[str]) -> Iterator[Value]:
    """Yield a dark current, and deviations of patterns and lines, where the figures
    withhold them, since most of a dark is at 0: as the fit has them."""
    told = {one.effect for one in found.values}
    white = found.captures.sensor.signal_range
    for name in OF_VARIANCES:
        if name not in named or name in told:
            continue
        square, error = found.both.of(name)
        ends = (square, square - CI95 * error, square + CI95 * error)
        scale = 1.0 if name == "prnu" else white
        value, low, high = (float(np.sqrt(max(x, 0.0))) / scale for x in ends)
        yield Value(name, "sigma", value, low, high)
    if "dark_current" in named and "dark_current" not in told:
        rate, error = found.both.of("dark_current")
        ends = (rate, rate - CI95 * error, rate + CI95 * error)
        yield Value("dark_current", "per_second", *(x / white for x in ends))


def limits_of_levels(found: DarksAndFlats) -> Iterator[Value]:
    """Yield parameters of what flats that decide show of light, each alone, at 0."""
    own = found.statistics.of_splits([VALIDATION])
    levels = found.levels_of(own, found.selection.validation)
    if levels is None:
        return
    for name in levels.names:
        nothing = np.zeros(CHANGES[name][0])
        error = float(np.sqrt(levels.covariance_of([name], nothing)[0, 0]))
        half = CI95 * error * OF_LEVELS[name][0][2]
        yield Value(name, OF_LEVELS[name][0][0], 0.0, -half, half)


def _before_reduction(
    found: DarksAndFlats, named: Collection[str], values: Iterable[Value]
) -> Iterator[Value]:
    """Yield the values of what neighbours share, and others as they were before noise
    reduction, named or stated, lowered them: frames have what it leaves, and so has the
    null that logarithms are over."""
    both, at = (
        found.statistics.of_splits(GROUPS[:2]),
        profile_lags(found.captures.sensor),
    )
    over, lags = Blended(1.0, 0.0), lags_of(both, found.both, found.profile, null=at)
    if lags is not None and not NAMES.keys().isdisjoint(named):
        at, covariance = lags.fitted_of(named)
        over = Blended.of(lags, at, covariance)
        errors = np.sqrt(np.diagonal(covariance))
        for (name, parameter), value, error in zip(PARAMETERS, at, errors, strict=True):
            if name in named:
                numbers = np.full(3, value)
                yield _moved(Value(name, parameter, *numbers), numbers, error)
    error = over.error / over.left
    left = dict.fromkeys(PIXELS, variance_left(*at[1:]))
    left |= dict.fromkeys(LINES, variance_left_of_lines(*at[1:]))
    for one in values:
        numbers = np.array(one[2:])
        if one.effect in LOGARITHMS:
            yield _moved(one, numbers - np.log(over.left), error)
        elif one.effect in left and one.parameter == "sigma":
            numbers /= np.sqrt(left[one.effect])
            yield _moved(one, numbers, numbers[0] * error / 2)
        else:
            yield one


def _moved(one: Value, numbers: Array, error: float) -> Value:
    """Return a value with other (value, low, high), and another standard error added
    to theirs."""
    value = float(numbers[0])
    low, high = (float(np.hypot(end - value, CI95 * error)) for end in numbers[1:])
    return Value(one.effect, one.parameter, value, value - low, value + high)


def _of_levels(found: DarksAndFlats, named: Collection[str]) -> Iterator[Value]:
    both = found.statistics.of_splits(GROUPS[:2])
    levels = found.levels_of(both, found.both, named)
    names = [name for name in CHANGES if name in named]
    if levels is None or not names:
        return
    values = levels.fitted(names)
    errors = np.sqrt(np.diagonal(levels.covariance_of(names, values)))
    first = 0
    for name in names:
        for parameter, at, share in OF_LEVELS[name]:
            value = share * float(values[first + at])
            half = share * CI95 * float(errors[first + at])
            yield Value(name, parameter, value, value - half, value + half)
        first += CHANGES[name][0]


def _of_shapes(found: DarksAndFlats, named: Collection[str]) -> Iterator[Value]:
    wanted = OF_SHAPES & set(named)
    if not wanted or found.frames.are_divided:
        return
    measured = measurements_of(found, wanted)
    shapes = _shapes(measured, wanted)
    moved = [  # by the error of each step between halves
        _shapes(measurements_of(replace(found, as_taken=rest), wanted), wanted)
        for name, step in found.amplifiers.steps.items()
        for more in [AmplifierMismatch(stated={name: step.error})]
        for rest in [more.taken_off(found.as_taken)]
    ]
    if "black_level" in wanted:
        sensor, at = measured.sensor, found.both.parameters.of("black_level")
        white = sensor.signal_range
        for level in measured.fit.figures:
            if level.name == BLACK and level.site is not None:
                site = "{}{}".format(*divmod(level.site, measured.sites.side))
                ends = np.array([level.value, level.low, level.high])
                ends = (ends - found.profile[at + level.site]) / white
                yield Value("black_level", f"offset_{site}", *map(float, ends))
    for (name, parameter), one in shapes.items():
        away = [each.get((name, parameter), one).value - one.value for each in moved]
        stated = listed_parameters(measured.sensor, name) or {}
        before = 0.0 if name in OF_SENSOR else stated.get(parameter, 0.0)
        half = CI95 * math.hypot(one.standard_error, *away)
        value = one.value - before
        yield Value(name, parameter, value, value - half, value + half)


def _shapes(
    measured: Calibration, wanted: Collection[str]
) -> dict[tuple[str, str], Measured]:
    """Return what calibrate has of effects, by name and parameter."""
    answers = effects_found(measured, False)
    return {
        (name, parameter): one if isinstance(one, Measured) else Measured(one, 0.0, "")
        for name in sorted(wanted)
        for parameter, one in (answers.get(name) or {}).items()
    }
