# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Detection limits: how strong an effect has to be for these captures to show it.

What a name has to gain, against what an effect of some strength is expected to gain on
the select frames: by Fisher's information where it moves mean or variance, else by what
the effect itself expects.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from cg2raw.diagnose.diagnosis import DetectionLimit
from cg2raw.diagnose.effects.base import Effect, Gain
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.fisher_scoring import Linearisation
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model

WEAKEST = 1e-6  # of the strongest
NO_INFORMATION = 1e-6


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


def detection_limits(
    model: Model,
    effects: Sequence[Effect],
    selected: Likelihood,
    fitted: Likelihood,
    alpha: float,
) -> list[DetectionLimit]:
    """Return, for the effects that were not named, the strength that would gain what a
    name has to gain.

    selected : frames that names are accepted by. fitted : that maps are made from."""
    base = Linearisation(model, selected)
    seen, learnt = selected.predicted(model), fitted.predicted(model)
    needed = float(np.log(max(len(effects), 1) / alpha))
    limits = []
    for effect in effects:
        if effect.name in model.names:
            continue
        is_searched = effect.scored and effect.estimator != "smooth"
        own = _information(model, effect, base) if is_searched else 0.0
        gain = effect.expected_gain(seen, learnt, own)
        if gain is not None:
            limits.append(_by_gain(effect, gain, needed, selected.frames))
        elif effect.estimator == "smooth":
            limits.append(_by_information(model, effect, base, needed))
    return limits


def _information(model: Model, effect: Effect, base: Linearisation) -> float:
    """Return Fisher's information of an effect's first value."""
    parameters, _, information = base.system(model.with_effect(effect))
    first = parameters.index((effect.name, 0))
    return float(information[first, first])


def _by_information(
    model: Model, effect: Effect, base: Linearisation, needed: float
) -> DetectionLimit:
    parameters, _, information = base.system(model.with_effect(effect))
    own = [i for i, (name, _) in enumerate(parameters) if name == effect.name]
    strongest = max(own, key=lambda i: information[i, i])
    known = _beside(information, strongest, own)
    index = parameters[strongest][1]
    strength = None
    if known > NO_INFORMATION:
        strength = float(np.sqrt(2 * (needed + len(own) / 2) / known))
    if strength is not None and strength > effect.high[index]:
        strength = None
    return DetectionLimit(
        effect.name, effect.parameters[index], strength, effect.units[index]
    )


def _by_gain(
    effect: Effect, gain: Gain, needed: float, frames: Sequence[Frame]
) -> DetectionLimit:
    strongest = float(effect.high[0]) * effect.unit_scale(frames)
    strength = None
    if gain(strongest) > needed:
        low, high = np.log(strongest * WEAKEST), np.log(strongest)
        strength = strongest * WEAKEST
        if gain(strength) < needed:
            root = brentq(lambda x: gain(np.exp(x)) - needed, low, high, xtol=1e-3)
            strength = float(np.exp(root))
    return DetectionLimit(effect.name, effect.parameters[0], strength, effect.units[0])
