# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a profile says of the likelihood's parameters: the null of each name."""

from collections.abc import Callable, Mapping

import numpy as np

from cg2raw.model.evaluation import Parameters
from cg2raw.model.lags import PARAMETERS, variance_left, variance_left_of_lines
from cg2raw.sensor import Sensor
from cg2raw.statistics.constant import Array

Values = Mapping[str, float]


def square(values: Values, white: float) -> float:
    """Return the variance, DN^2, of a deviation that is a share of white."""
    return (values["sigma"] * white) ** 2


def log_normal_variance(values: Values, white: float) -> float:
    """Return the variance, (DN/s)^2, of dark current with a log-normal law."""
    square = values["log_sigma"] ** 2
    median = values["rate"] * white
    return float(median**2 * np.exp(square) * np.expm1(square))


# Effects of a profile that set the parameter of their name; white is above black, DN.
OF_EFFECTS: Mapping[str, Callable[[Values, float], float]] = {
    "dark_current": lambda values, white: values["per_second"] * white,
    "black_level_drift": square,
    "row_noise": square,
    "dsnu": square,
    "column_fixed_pattern": square,
    "dark_current_nonuniformity": log_normal_variance,
    "prnu": lambda values, white: values["sigma"] ** 2,
}
# What noise reduction lowers of pixels, and of rows and columns.
PIXELS = ("read_noise", "gain", "dsnu", "dark_current_nonuniformity", "prnu")
LINES = ("row_noise", "column_fixed_pattern")


def profile_values(sensor: Sensor, iso: float | None, parameters: Parameters) -> Array:
    """Return the parameters, (n,), as a sensor's profile has them: variances DN^2, of
    light relative, as noise reduction leaves them. Without an ISO, read noise and gain
    are 0.

    Raises ValueError for an ISO without noise."""
    found = np.zeros(len(parameters))
    black = np.asarray(sensor.black_level, float)
    white = float(sensor.white_level - black.mean())
    row = {"beta1": 0.0, "beta2": 0.0} if iso is None else sensor.noise_at(iso)
    effects = {e["name"]: e["parameters"] for e in sensor.effects or ()}
    sites = range(parameters.sites)
    for site in sites:
        read, gain = (
            float(np.broadcast_to(row[name], len(black))[site])
            for name in ("beta2", "beta1")
        )
        more = effects.get("read_noise", {}).get("log_variance", 0.0)
        found[parameters.of("read_noise", site)] = read * white**2 * np.exp(more)
        more = effects.get("shot_noise", {}).get("log_gain", 0.0)
        found[parameters.of("gain", site)] = gain * white * np.exp(more)
        offset = effects.get("black_level", {}).get(f"offset_{site:02b}", 0.0)
        found[parameters.of("black_level", site)] = black[site] + offset * white
    for name, value in OF_EFFECTS.items():
        if name in effects:
            found[parameters.of(name)] = value(effects[name], white)
    _, *blended = profile_lags(sensor)
    for name in PIXELS:
        of_sites = name in ("read_noise", "gain")
        places = parameters.each(name) if of_sites else parameters.of(name)
        found[places] *= variance_left(*blended)
    for name in LINES:
        found[parameters.of(name)] *= variance_left_of_lines(*blended)
    return found


def profile_lags(sensor: Sensor) -> Array:
    """Return what a profile has of lags.PARAMETERS."""
    effects = {e["name"]: e["parameters"] for e in sensor.effects or ()}
    return np.array([effects.get(name, {}).get(one, 0.0) for name, one in PARAMETERS])
