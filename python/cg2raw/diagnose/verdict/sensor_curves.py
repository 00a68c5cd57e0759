# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Photon transfer and dark signal, measured and by the profile and what was found.

Source: EMVA Standard 1288, release 4.0."""

from collections.abc import Iterator, Sequence

import numpy as np

from cg2raw.diagnose.diagnosis import Characteristics, Trend
from cg2raw.model.fit import Fit
from cg2raw.model.planes import PlaneLikelihood
from cg2raw.statistics.constant import PIXEL, Array

Point = tuple[float, float, float, float, bool]


def characteristics_of(fits: Sequence[tuple[Fit, Array, bool]]) -> Characteristics:
    """Return the curves of darks and flats.

    fits : of each half of the frames, what was found, the profile's parameters (n,),
    and whether the half was held out."""
    gain = float(np.mean([_of_sites(found, "gain") for found, _, _ in fits]))
    transfer = _trend(point for one in fits for point in _transfer(*one))
    levels = _trend(point for one in fits for point in _dark_levels(*one))
    missing = []
    if transfer is None:
        missing.append(
            "No photon-transfer curve: two frames of the same light or of the same "
            "exposure time in the dark are needed; take repeats."
        )
    if levels is None or len(np.unique(levels.x)) < 2:
        missing.append(
            "No dark-current line: darks at two exposure times or more are needed."
        )
    per_dn = 1 / gain if gain > 0 else None
    return Characteristics(transfer, levels, [], per_dn, missing)


def _trend(points: Iterator[Point]) -> Trend | None:
    every = sorted(points)
    if not every:
        return None
    x, measured, before, after, held_out = np.array(every, float).T
    return Trend(x, measured, before, after, held_out > 0)


def _transfer(found: Fit, profile: Array, is_held_out: bool) -> Iterator[Point]:
    """Yield the mean of the planes: variance of pixels against what is above black."""
    planes = found.likelihood.planes
    each = [
        np.mean([_variance(plane, theta) for plane in planes], axis=0)
        for theta in (profile, found.theta)
    ]
    level = np.mean([plane.signal(found.theta) for plane in planes], axis=0)
    measured = np.mean([plane.scatter[:, PIXEL] for plane in planes], axis=0)
    for g in np.flatnonzero(planes[0].repeats):
        yield level[g], measured[g], each[0][g], each[1][g], is_held_out


def _variance(plane: PlaneLikelihood, theta: Array) -> Array:
    expected: Array = plane.temporal(theta, *plane.records(theta))[0][:, PIXEL]
    return expected


def _dark_levels(found: Fit, profile: Array, is_held_out: bool) -> Iterator[Point]:
    """Yield levels of darks above black, DN, against exposure time."""
    planes, statistics = found.likelihood.planes, found.likelihood.means.statistics
    levels = np.mean([plane.plane.level for plane in planes], axis=0)
    black = _of_sites(found, "black_level")
    current = found.parameters.of("dark_current")
    for g, info in enumerate(statistics.groups):
        if info.kind != "dark" or info.exposure_time is None:
            continue
        time = info.exposure_time
        first = profile[found.parameters.of("black_level") :][: len(planes)].mean()
        before = first - black + profile[current] * time
        after = found.theta[current] * time
        yield time, levels[g] - black, before, after, is_held_out


def _of_sites(found: Fit, name: str) -> float:
    """Return the mean over the sites of a parameter that each has for itself."""
    at = found.parameters.of(name)
    return float(found.theta[at : at + found.parameters.sites].mean())
