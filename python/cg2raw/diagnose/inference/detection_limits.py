# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Visible: how strong an effect has to be for these captures to show it.

What a name has to gain, against what an effect of some strength is expected to gain on
the select frames: by Fisher's information where it moves mean or variance, else by the
Kullback-Leibler divergence of what the effect makes of noise.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from cg2raw.diagnose.diagnosis import Power
from cg2raw.diagnose.effects.catalogue import Candidate
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.inference.fisher_scoring import Linearisation
from cg2raw.diagnose.inference.intervals import scale_of
from cg2raw.diagnose.likelihood.likelihood import Workers
from cg2raw.diagnose.likelihood.prediction import (
    PATTERNS,
    Model,
    Prediction,
    pattern_bearing,
    place,
    predict,
)

Gain = Callable[[float], float]  # nats of a strength
Seen = Sequence[tuple[Frame, Prediction]]

WEAKEST = 1e-6  # of the strongest
NOISY = 9.0  # variance of noisy pixels, over the others'
READ_SHARES = 20  # classes of pixels by how much of their noise is read noise
STANDARD = np.linspace(-15, 15, 1501)


def _beside(information: NDArray[np.float64], one: int, own: Sequence[int]) -> float:
    """Return what is known of one parameter when those of other effects are fitted."""
    others = [i for i in range(len(information)) if i not in own]
    if not others or information[one, one] <= 0:
        return float(information[one, one])
    cross = information[one, others]
    scale = np.sqrt(np.maximum(np.diag(information)[others], 1e-30))
    inner = information[np.ix_(others, others)] / np.outer(scale, scale)
    taken = cross / scale @ np.linalg.pinv(inner, 1e-9, True) @ (cross / scale)
    rest = float(information[one, one] - taken)
    return rest if rest > 1e-6 * information[one, one] else 0.0


def smallest_visible(
    model: Model,
    candidates: Sequence[Candidate],
    frames: Sequence[Frame],
    workers: Workers,
    alpha: float,
    fitted: Sequence[Frame] = (),
) -> list[Power]:
    """Return, for the effects that were not named, the strength that would gain what a
    name has to gain.

    frames : that names are accepted by. fitted : that maps would be made from."""
    base = Linearisation(model, frames, workers)
    seen, learnt = (
        list(zip(group, workers.map(lambda f: predict(model, f), group), strict=True))
        for group in (frames, fitted)
    )
    needed = float(np.log(max(len(candidates), 1) / alpha))
    powers = []
    for candidate in candidates:
        if candidate.name in model.names or candidate.name == "hot_pixels":
            continue  # how many are hot is not how strong they are
        if candidate.way == "smooth" and candidate.name != "early_clipping":
            powers.append(_of_smooth(model, candidate, base, needed))
            continue
        gain = _gain_of(model, candidate, base, seen, learnt)
        if gain is not None:
            powers.append(_of_gain(candidate, gain, needed, frames))
    return powers


def _of_smooth(
    model: Model, candidate: Candidate, base: Linearisation, needed: float
) -> Power:
    parameters, _, information = base.system(place(model, candidate))
    own = [i for i, (name, _) in enumerate(parameters) if name == candidate.name]
    strongest = max(own, key=lambda i: information[i, i])
    known = _beside(information, strongest, own)
    index = parameters[strongest][1]
    strength = None
    if known > 1e-6:
        strength = float(np.sqrt(2 * (needed + len(own) / 2) / known))
    if strength is not None and strength > candidate.high[index]:
        strength = None
    parameter, unit = candidate.parameters[index], candidate.units[index]
    return Power(candidate.name, parameter, strength, unit)


def _of_gain(
    candidate: Candidate, gain: Gain, needed: float, frames: Sequence[Frame]
) -> Power:
    scale = scale_of(candidate.name, frames)
    strongest = float(candidate.high[0]) * scale
    strength = None
    if gain(strongest) > needed:
        low, high = np.log(strongest * WEAKEST), np.log(strongest)
        strength = strongest * WEAKEST
        if gain(strength) < needed:
            root = brentq(lambda x: gain(np.exp(x)) - needed, low, high, xtol=1e-3)
            strength = float(np.exp(root))
    parameter, unit = candidate.parameters[0], candidate.units[0]
    return Power(candidate.name, parameter, strength, unit)


def _gain_of(
    model: Model, candidate: Candidate, base: Linearisation, seen: Seen, learnt: Seen
) -> Gain | None:
    """Return what a strength is expected to gain; None if nobody can know."""
    if candidate.name in PATTERNS:
        return _of_map(candidate.name, seen, learnt) if learnt else None
    if candidate.name == "noise_reduction":
        return _of_filter(seen, base.system(place(model, candidate)))
    gains: dict[str, Callable[[Seen], Gain]] = {
        "row_noise": _of_rows,
        "photon_statistics": _of_photons,
        "heavy_tailed_noise": _of_tails,
        "early_clipping": _of_clipping,
    }
    return gains[candidate.name](seen)


def _of_rows(seen: Seen) -> Gain:
    told = []
    for frame, p in seen:
        of_row = frame.tiles.over_rows(frame.keep / p.variance)
        beside = frame.tiles.over_rows(np.ones_like(p.variance)) / p.variance.shape[2]
        told.append((of_row, 1 / beside))

    def gain(sigma: float) -> float:
        return sum(
            float((w * (sigma**2 * t - np.log1p(sigma**2 * t))).sum()) / 2
            for t, w in told
        )

    return gain


def _of_map(name: str, seen: Seen, learnt: Seen) -> Gain:
    """The map is learnt from the fit frames as far as their noise lets it."""
    shape, tiles = seen[0][0].signal.shape, seen[0][0].tiles
    of_columns = name == "column_noise"

    def told(group: Seen) -> list[Array]:
        parts = []
        for frame, p in group:
            if frame.signal.shape == shape:
                bearing = pattern_bearing(name, frame, np.maximum(p.exposed, 0))
                used = frame.keep & ~frame.censored
                part = used * bearing**2 / p.variance
                parts.append(tiles.over_columns(part) if of_columns else part)
        return parts

    known, shown = sum(told(learnt)), told(seen)
    # Columns of tiles above each other count once.
    once = shape[1] / tiles.over_columns(np.ones(shape)) if of_columns else 1.0

    def gain(sigma: float) -> float:
        left = sigma**2 / (1 + sigma**2 * known)
        nats = [(sigma**2 * each - np.log1p(left * each)) * once for each in shown]
        return sum(float(each.sum()) for each in nats) / 2

    return gain


def _of_photons(seen: Seen) -> Gain:
    """Skewness and kurtosis of a normal distribution cost these shares of a nat."""
    skew, excess = 0.0, 0.0
    for frame, p in seen:
        photons = np.maximum(p.exposed, 1e-12)
        third = p.photon_variance**2 / photons / p.variance**1.5
        fourth = p.photon_variance**3 / photons**2 / p.variance**2
        skew += float((third[frame.keep] ** 2).sum()) / 12
        excess += float((fourth[frame.keep] ** 2).sum()) / 48
    return lambda fraction: fraction**2 * (skew + excess)


def _of_tails(seen: Seen) -> Gain:
    shares = np.concatenate(
        [(np.minimum(f.beta2 / p.variance, 1))[f.keep] for f, p in seen]
    )
    count, edges = np.histogram(shares, READ_SHARES, (0, 1))
    middles = (edges[1:] + edges[:-1]) / 2

    def gain(fraction: float) -> float:
        core = middles[:, None] / (1 + fraction * (NOISY - 1))
        rest = 1 - middles[:, None]
        density = (1 - fraction) * _normal(rest + core)
        density = density + fraction * _normal(rest + NOISY * core)
        ratio = np.log(density / _normal(np.ones((1, 1))))
        nats = (density * ratio).sum(1) * (STANDARD[1] - STANDARD[0])
        return float(count @ nats)

    return gain


def _normal(variance: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.exp(-0.5 * STANDARD**2 / variance) / np.sqrt(2 * np.pi * variance)


def _of_filter(seen: Seen, system: tuple[Sequence[Any], Array, Array]) -> Gain:
    """Of how noise is shared, and of mean and variance.

    system : of a model with noise reduction, as Linearisation returns it."""
    pixels = sum(int(frame.keep.sum()) for frame, _ in seen)
    parameters, _, information = system
    blend_at = parameters.index(("noise_reduction", 0))
    moved = float(information[blend_at, blend_at])
    waves = np.cos(2 * np.pi * np.arange(64) / 64)

    def gain(blend: float) -> float:
        response = 1 - blend + blend / 2 * (waves[:, None] + waves)
        power = response**2 / ((1 - blend) ** 2 + blend**2 / 4)
        shared = -0.5 * pixels * float(np.log(power + 1e-4).mean())
        return shared + 0.5 * moved * blend**2

    return gain


def _of_clipping(seen: Seen) -> Gain:
    """A bright pixel stands at the well in place of where it was expected."""
    bright = [
        (p.mean[used], p.variance[used])
        for frame, p in seen
        for used in [frame.keep & ~frame.at_white & (p.mean > 0.2)]
    ]

    def gain(below_white: float) -> float:
        return sum(
            float((np.maximum(x - (1 - below_white), 0) ** 2 / v).sum()) / 2
            for x, v in bright
        )

    return gain
