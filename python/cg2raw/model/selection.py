# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Selection: each name is dropped on frames that did not fit it.

All is fitted on training frames. On validation frames, a name gains the log-likelihood
with its parameters as trained and all others fitted anew, less the same with its
parameters as the profile has them. Source: L. Wasserman, A. Ramdas, S. Balakrishnan,
PNAS 117(29), 2020 (split likelihood-ratio test)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cg2raw.model.components import FIXED
from cg2raw.model.fit import Fit, Prior, refitted
from cg2raw.statistics.constant import PARTS, Array

LEAST_LEVEL = 1e-6  # DN^2: far below what the mean of frames is known to
# The mean of a log-normal law lies above its median by so many deviations at most.
SKEWED = 0.3


# Names and their parameters; of those that each part has, their beginning.
NAMES: Mapping[str, tuple[str, ...]] = {
    "black_level": ("black_level",),
    "dark_current": ("dark_current",),
    "black_level_drift": ("black_level_drift",),
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


@dataclass(frozen=True)
class Selection:
    """gains : nats of each name that the frames can show, on validation frames."""

    gains: Mapping[str, float]
    training: Fit
    validation: Fit

    def kept(self, least: float) -> list[str]:
        """Return the names that gain more than @least nats, best first."""
        order = sorted(self.gains, key=lambda name: -self.gains[name])
        return [name for name in order if self.gains[name] > least]


def selection(training: Fit, validation: Fit, profile: Array) -> Selection:
    """Return what each name gains. profile : (n,) parameters of the null."""
    names = training.parameters.names
    gains = {}
    for name, parameters in NAMES.items():
        own = np.isin([name.partition(",")[0] for name in names], parameters)
        own &= np.isfinite(np.diagonal(training.covariance))
        own &= np.isfinite(np.diagonal(validation.covariance))
        if own.any():
            gains[name] = gain_of(own, training, validation, profile)
    return Selection(gains, training, validation)


def gain_of(
    own: NDArray[np.bool_], training: Fit, validation: Fit, profile: Array
) -> float:
    """Return the nats of parameters @own, (n,), as trained over those of a profile."""
    free = np.isfinite(np.diagonal(validation.covariance)) & ~own
    values = []
    for pinned, prior in (
        (training.theta, None),
        (profile, level_prior(own, training, profile)),
    ):
        start = np.where(own, pinned, validation.theta)
        let = free if prior is None else free | own
        values.append(refitted(validation.likelihood, start, let, prior).value)
    return values[0] - values[1]


def level_prior(own: NDArray[np.bool_], training: Fit, profile: Array) -> Prior | None:
    """Return where patterns of a mean other than 0 may move levels from a profile's;
    None if @own are no levels."""
    at, sites = training.parameters.of, training.parameters.sites
    levels = slice(at("black_level"), at("black_level") + sites)
    plane = training.likelihood.planes[0]
    side = plane.side
    h, w = plane.plane.shape
    if own[levels].all():
        signature, places = "constant", np.arange(levels.start, levels.stop)
    elif own[at("dark_current")]:
        signature, places = "time", np.array([at("dark_current")])
    else:
        return None
    row, column = np.divmod(np.arange(len(places)), side)
    covariance = LEAST_LEVEL * np.eye(len(places))
    for component in FIXED:
        if component.signature != signature:
            continue
        square = max(float(training.theta[at(component.name)]), 0.0)
        if component.per == "line":
            is_row = bool(component.parts[PARTS.index("fast_rows")])
            line = row if is_row else column
            covariance += square / (h if is_row else w) * np.equal.outer(line, line)
        elif component.name in ("dsnu", "prnu"):
            covariance += square / (h * w) * np.eye(len(places))
        elif component.name == "dark_current_nonuniformity":
            covariance += SKEWED**2 * square
        else:
            parts = float(component.parts @ plane.plane.freedom)
            covariance += square * parts / (h * w)
    return Prior(places, profile[places], covariance)
