# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Values of what is named that are no figure of the fit: shapes of the dark frame and
of the light as calibrate has them, correlations by lags, changes of light by levels."""

from collections.abc import Collection, Iterator, Mapping

import numpy as np

from cg2raw.calibration.fitting import BLACK
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.profile_effects import effects_found
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.darks_and_flats import (
    VALIDATION,
    DarksAndFlats,
    levels_of,
    of_splits,
)
from cg2raw.diagnose.verdict.measurements import measurements_of
from cg2raw.model import flicker
from cg2raw.model.figures import NORMAL
from cg2raw.model.flat_levels import CHANGES
from cg2raw.model.lags import lags_of
from cg2raw.model.values import Value

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
OF_LAGS = (
    ("read_noise_correlation", "coefficient"),
    ("noise_reduction", "blend"),
    ("noise_reduction", "diagonal"),
)
# As of calibrate: shapes; the dark current of the median pixel, which is what the
# registry calls so, beside them; the black level of the shortest darks.
OF_SHAPES = frozenset(
    {
        *("bias_structure", "amplifier_glow", "lens_shading", "black_level"),
        *("dark_current", "dark_current_nonuniformity"),
    }
)


def more_values(found: DarksAndFlats, named: Collection[str]) -> list[Value]:
    """Return the values of effects that are named, by training and validation frames;
    of one that stands for another, they take the place of the fit's."""
    return [
        *_of_variances(found, named),
        *_of_lags(found, named),
        *_of_levels(found, named),
        *_of_shapes(found, named),
        *_of_flicker(found, named),
    ]


def _of_flicker(found: DarksAndFlats, named: Collection[str]) -> Iterator[Value]:
    if flicker.NAME in named:
        for parameter, *numbers in flicker.flicker(found.both):
            yield Value(flicker.NAME, parameter, *numbers)


def _of_variances(found: DarksAndFlats, named: Collection[str]) -> Iterator[Value]:
    """Yield deviations of patterns and lines where the figures withhold them, since
    most of a dark is at 0: as the fit has them."""
    told = {one.effect for one in found.values}
    sensor = found.captures.sensor
    white = sensor.white_level - float(np.mean(sensor.black_level))
    for name in OF_VARIANCES:
        if name not in named or name in told:
            continue
        square, error = found.both.of(name)
        ends = (square, square - NORMAL * error, square + NORMAL * error)
        scale = 1.0 if name == "prnu" else white
        value, low, high = (float(np.sqrt(max(x, 0.0))) / scale for x in ends)
        yield Value(name, "sigma", value, low, high)


def limits_of_levels(found: DarksAndFlats) -> Iterator[Value]:
    """Yield parameters of what flats that decide show of light, each alone, at 0."""
    own = found.of_split(VALIDATION)
    levels = levels_of(found.captures, found.used, own, found.selection.validation)
    if levels is None:
        return
    for name in levels.names:
        nothing = np.zeros(CHANGES[name][0])
        error = float(np.sqrt(levels.covariance_of([name], nothing)[0, 0]))
        half = NORMAL * error * OF_LEVELS[name][0][2]
        yield Value(name, OF_LEVELS[name][0][0], 0.0, -half, half)


def _of_lags(found: DarksAndFlats, named: Collection[str]) -> Iterator[Value]:
    both = of_splits(found.statistics, GROUPS[:2])
    lags = lags_of(both, found.both, found.profile)
    if lags is None or not {name for name, _ in OF_LAGS} & set(named):
        return
    pinned = [np.nan if name in named else 0.0 for name, _ in OF_LAGS]
    values, covariance = lags.fitted(np.array(pinned))
    for at, (name, parameter) in enumerate(OF_LAGS):
        if name in named:
            half = NORMAL * float(np.sqrt(covariance[at, at]))
            value = float(values[at])
            yield Value(name, parameter, value, value - half, value + half)


def _of_levels(found: DarksAndFlats, named: Collection[str]) -> Iterator[Value]:
    both = of_splits(found.statistics, GROUPS[:2])
    levels = levels_of(found.captures, found.used, both, found.both, named)
    names = [name for name in CHANGES if name in named]
    if levels is None or not names:
        return
    values = levels.fitted(names)
    errors = np.sqrt(np.diagonal(levels.covariance_of(names, values)))
    first = 0
    for name in names:
        for parameter, at, share in OF_LEVELS[name]:
            value = share * float(values[first + at])
            half = share * NORMAL * float(errors[first + at])
            yield Value(name, parameter, value, value - half, value + half)
        first += CHANGES[name][0]


def _of_shapes(found: DarksAndFlats, named: Collection[str]) -> Iterator[Value]:
    wanted = OF_SHAPES & set(named)
    if not wanted or any(capture.divided for capture in found.used):
        return
    measured = measurements_of(found, wanted)
    answers = effects_found(measured, False)
    if "black_level" in wanted:
        sensor, at = measured.sensor, found.both.parameters.of("black_level")
        white = sensor.white_level - float(np.mean(sensor.black_level))
        for level in measured.fit.figures:
            if level.name == BLACK and level.site is not None:
                site = "{}{}".format(*divmod(level.site, measured.sites.side))
                ends = np.array([level.value, level.low, level.high])
                ends = (ends - found.profile[at + level.site]) / white
                yield Value("black_level", f"offset_{site}", *map(float, ends))
    for name in sorted(wanted):
        for parameter, one in (answers.get(name) or {}).items():
            given = one if isinstance(one, Measured) else Measured(float(one), 0.0, "")
            half = NORMAL * given.standard_error
            yield Value(
                name, parameter, given.value, given.value - half, given.value + half
            )
