# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Values of named effects, in the units of the registry, with 95 % intervals."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from cg2raw.model.figures import figures_of
from cg2raw.model.fit import Fit
from cg2raw.model.shapes.base import Shape
from cg2raw.normal import CI95
from cg2raw.statistics.constant import Array, ConstantStatistics

# Effects whose parameter is one of the figures; DN are shares of white.
FIGURES = {
    "row noise": ("row_noise", "sigma"),
    "black level drift": ("black_level_drift", "sigma"),
    "dark current": ("dark_current", "per_second"),
    "DSNU": ("dsnu", "sigma"),
    "fixed column pattern": ("column_fixed_pattern", "sigma"),
    "PRNU": ("prnu", "sigma"),
}
LOGARITHMS = {
    "read_noise": ("read_noise", "log_variance"),
    "shot_noise": ("gain", "log_gain"),
}


class Value(NamedTuple):
    """A parameter of an effect. low, high : its 95 % interval."""

    effect: str
    parameter: str
    value: float
    low: float
    high: float


def effect_values(
    statistics: ConstantStatistics,
    found: Fit,
    profile: Array,
    white: float,
    shapes: Iterable[Shape] = (),
    whole: tuple[float, float] = (1.0, 0.0),
) -> Iterator[Value]:
    """Yield what the frames show, named or not, but for shapes. profile : (n,)
    parameters of the null. white : DN above black. shapes : that are named. whole : the
    variance of read noise over that of samples that are not masked, and its standard
    error."""
    known = [
        (shape.name, one.name, one)
        for shape in shapes
        for one in shape.figures
        if np.isfinite([one.value, one.low, one.high]).all()
    ]
    figures = figures_of(statistics, found)
    known += [(*FIGURES[one.name], one) for one in figures if one.name in FIGURES]
    for effect, name, one in known:
        scale = white if one.unit.startswith("DN") else 1.0
        yield Value(effect, name, *(x / scale for x in (one.value, one.low, one.high)))
    for effect, (parameter, name) in LOGARITHMS.items():
        own = found.parameters.each(parameter)
        theta, covariance = found.theta[own], found.covariance[own, own]
        is_known = np.isfinite(covariance).all()
        if not (is_known and (np.minimum(theta, profile[own]) > 0).all()):
            continue
        ratio = theta / profile[own]
        slope = 1 / theta / len(theta)
        value = float(np.log(ratio).mean())
        error = float(np.sqrt(slope @ covariance @ slope))
        if effect == "read_noise":
            value += float(np.log(whole[0]))
            error = float(np.hypot(error, whole[1] / whole[0]))
        half = CI95 * error
        yield Value(effect, name, value, value - half, value + half)
    own = found.parameters.each("black_level")
    sites = np.ndindex(statistics.side, statistics.side)
    more = found.theta[own] - profile[own]
    halves = CI95 * np.sqrt(np.diagonal(found.covariance)[own])
    for (row, column), value, half in zip(sites, more, halves, strict=True):
        if np.isfinite(half):
            ends = (float(x) / white for x in (value, value - half, value + half))
            yield Value("black_level", f"offset_{row}{column}", *ends)
