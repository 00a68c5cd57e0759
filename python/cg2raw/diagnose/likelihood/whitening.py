# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Whitening: a model's effects turn structured noise into white noise, stage by stage,
and each says what that costs."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import TypeGuard

import numpy as np

from cg2raw.diagnose.effects.base import Effect, Values, Whitened
from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.effects.shared_fields import SharedFields
from cg2raw.diagnose.effects.shared_offset import SharedOffset
from cg2raw.diagnose.effects.whitening_stage import WhiteningStage
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.shrinkage import whiten_along
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.likelihood.censored_offsets import OffsetVariances
from cg2raw.diagnose.likelihood.model import Model

NO_VALUES: Values = np.zeros(0)


def whiten(z: Array, p: Prediction, model: Model, frame: Frame) -> Whitened:
    """Return residuals (T, h, w) without the structure that a model has, and the log
    of the determinant of that, per pixel.

    Offsets in frames that the ADC cuts are in the prediction (censored_offsets)."""
    read = frame.beta2 * model.noise_gain("beta2")
    cost: Array | float = 0.0
    within = p  # the camera, before what of its processing is whitened
    for effect, values in _steps(model, frame):
        if effect is None:
            z, more = p.shrinkage.apply(z, frame.keep)
        elif isinstance(effect, FixedPattern):
            z, more = effect.whiten_by_map(z, within, model.map_on(effect, frame))
        elif isinstance(effect, SharedFields):
            fields = effect.fields(p, values, frame)
            seen = [_whitened_before(effect, one, p, model, frame) for one in fields]
            z, more = whiten_along(z, seen, frame)
        elif not isinstance(effect, SharedOffset):
            z, more = effect.whiten(z, within, values, frame, read)
            within = effect.unfiltered(within, values)
        elif cut_offsets(model, frame) is None:
            along = _along(effect, p, values, model, frame)
            z, more = effect.to_power(z, along, frame, -0.5)
        else:
            continue
        cost = cost + more
    return z, cost


def whiten_linearly(
    z: Array, p: Prediction, model: Model, frame: Frame, offsets: bool
) -> Array:
    """Return z whitened by what is linear and Gaussian; derivatives of a mean are
    whitened alike. offsets : with those that pixels share."""
    within = p
    for effect, values in _steps(model, frame):
        if effect is None:
            z = p.shrinkage.apply(z, frame.keep)[0]
        elif isinstance(effect, SharedOffset):
            if offsets:
                along = _along(effect, p, values, model, frame)
                z = effect.to_power(z, along, frame, -0.5)[0]
        elif isinstance(effect, SharedFields):
            fields = effect.fields(p, values, frame)
            seen = [_whitened_before(effect, one, p, model, frame) for one in fields]
            z = whiten_along(z, seen, frame)[0]
        elif effect.linear:
            z = effect.whiten(z, within, values, frame, frame.beta2)[0]
            within = effect.unfiltered(within, values)
    return z


def colour_offsets(z: Array, p: Prediction, model: Model, frame: Frame) -> Array:
    """Return z such that its product with what `whiten_linearly` makes of an image is
    that of z with the image: the offsets that pixels share drop out."""
    for effect, values in _steps(model, frame):
        if isinstance(effect, SharedOffset):
            along = _along(effect, p, values, model, frame)
            z = effect.to_power(z, along, frame, 0.5)[0]
    return z


def shares_structure(effect: Effect | None) -> TypeGuard[Effect]:
    """Return whether an effect is what pixels of one frame share, new in each."""
    return effect is not None and effect.whitens_variance and effect.linear


def has_shared_structure(model: Model, frame: Frame) -> bool:
    """Return whether pixels of a frame share anything by a model."""
    return any(shares_structure(effect) for effect, _ in _steps(model, frame))


def without_shared(z: Array, p: Prediction, model: Model, frame: Frame) -> Array:
    """Return residuals z (T, h, w), that nothing whitened, without what pixels of a
    frame most likely share, and with the variance that this takes from them."""
    stages: list[Callable[[Array], Whitened]] = []
    left: Array | float = 1.0
    for effect, values in _steps(model, frame):
        if isinstance(effect, SharedOffset):
            along = effect.along(p, values, frame)
            left = left * (1 - effect.leverage(along, frame))
            for before in stages:
                along = before(along)[0]
            stages.append(
                partial(effect.to_power, along=along, frame=frame, power=-0.5)
            )
        elif shares_structure(effect):
            read = frame.beta2
            stages.append(
                partial(effect.whiten, p=p, values=values, frame=frame, read=read)
            )
    for whiten_once in [*stages, *reversed(stages)]:  # by the inverse covariance
        z = whiten_once(z)[0]
    return z / np.sqrt(left)


def cut_offsets(model: Model, frame: Frame) -> OffsetVariances | None:
    """Return the variances of what pixels share where the ADC cuts it, so that no
    filter whitens it; None if it does not, or if they share nothing.

    Of a row's offset, few pixels at 0 hide little; of the frame's, which all pixels
    tell together, any hide some."""
    if not (frame.is_cut or (frame.at_zero & frame.keep).any()):
        return None
    shared = {
        effect.shares_offset: effect.offset_variance(values, frame)
        for effect, values in _steps(model, frame)
        if isinstance(effect, SharedOffset)
    }
    if not shared or not (frame.is_cut or "frame" in shared):
        return None
    return OffsetVariances(shared.get("row", 0.0), shared.get("frame", 0.0))


def _along(
    effect: SharedOffset, p: Prediction, values: Values, model: Model, frame: Frame
) -> Array:
    """Return the direction of an offset in residuals that what comes before it has
    whitened: of the frame's, the rows have taken some already."""
    along = effect.along(p, values, frame)
    return _whitened_before(effect, along, p, model, frame)


def _whitened_before(
    effect: Effect, image: Array, p: Prediction, model: Model, frame: Frame
) -> Array:
    """Return an image as what is linear and comes before an effect whitens it."""
    within = p
    for other, of_other in _steps(model, frame):
        if other is effect:
            break
        if isinstance(other, SharedOffset):
            along = _along(other, p, of_other, model, frame)
            image = other.to_power(image, along, frame, -0.5)[0]
        elif other is not None and other.linear:
            image = other.whiten(image, within, of_other, frame, frame.beta2)[0]
            within = other.unfiltered(within, of_other)
    return image


def _steps(model: Model, frame: Frame) -> Iterator[tuple[Effect | None, Values]]:
    """Yield effects with their values, None for the nuisance, in order."""
    for stage in WhiteningStage:
        if stage is WhiteningStage.NUISANCE and model.nuisance is not None:
            yield None, NO_VALUES
        if frame.samples is not None:
            continue  # means of many pixels are normal, and independent
        for effect in every().values():
            if effect.whitening is stage:
                values = model.values_of(effect, frame)
                if values is not None:
                    yield effect, values
