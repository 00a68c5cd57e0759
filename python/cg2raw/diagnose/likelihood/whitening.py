# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Whitening: a model's effects turn structured noise into white noise, stage by stage,
and each says what that costs."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeGuard

import numpy as np

from cg2raw.diagnose.effects.base import (
    Effect,
    Values,
    Whitened,
    Whitener,
    WhiteningStage,
)
from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.effects.shared_fields import SharedFields
from cg2raw.diagnose.effects.shared_offset import SharedOffset
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.prediction import Prediction
from cg2raw.diagnose.frames.shrinkage import GroupCovariance, whitener_along
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.likelihood.censored_offsets import OffsetVariances
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.tails import tails_of

NO_VALUES: Values = np.zeros(0)
LINEAR_STAGES = "linear stages"  # in the memo of a prediction, with what they are of
LINKS = "links"  # of the stages that residuals passed, in the memo of a prediction


def whiten(z: Array, p: Prediction, model: Model, frame: Frame) -> Whitened:
    """Return residuals (T, h, w) without the structure that a model has, and the log
    of the determinant of that, per pixel.

    Offsets in frames that the ADC cuts are in the prediction (censored_offsets). Stages
    that the same residuals of the same prediction passed the last time, in a search
    along the values of a later one, are not passed again."""
    read = frame.beta2 * model.noise_gain("beta2")
    tails = tails_of(model, frame) if p.well is not None else p.tails
    stages = _Stages(replace(p, tails=tails), frame, read)
    start = _Link((id(z), read.tobytes()), z)
    before: list[_Link] = p.memo.get(LINKS, [])
    links = before[:1] if before and before[0].key == start.key else [start]
    for effect, values in _steps(model, frame):
        if isinstance(effect, SharedOffset) and cut_offsets(model, frame):
            continue
        name = effect and effect.name
        key = (name, values.tobytes(), _tails_in(effect, tails))
        old = before[len(links)] if len(links) < len(before) else None
        if old and old.key == key and links[-1] is before[len(links) - 1]:
            links.append(old)
            if effect and old.stage:
                stages.resume(effect, old.stage, values)
        else:
            links.append(_passed(links[-1], key, effect, values, stages))
    p.memo[LINKS] = links
    return links[-1].z, links[-1].cost


def _tails_in(effect: Effect | None, tails: tuple[float, float]) -> object:
    """Return the tails of read noise that an effect's own density has; None if none."""
    clips = effect is not None and effect.whitening is WhiteningStage.CLIPPING
    return tails if clips else None


@dataclass(frozen=True)
class _Link:
    """What a stage has left of residuals and added to the cost.

    key : what it is of. stage : that of an effect."""

    key: tuple[object, ...]
    z: Array
    cost: Array | float = 0.0
    stage: Whitener | None = None


def _passed(
    before: _Link,
    key: tuple[object, ...],
    effect: Effect | None,
    values: Values,
    stages: "_Stages",
) -> _Link:
    stage = None
    if effect is None:
        z, more = stages.p.shrinkage.apply(before.z, stages.frame.keep)
    else:
        stage = stages.next(effect, values)
        z, more = stage(before.z)
    return _Link(key, z, before.cost + more, stage)


def whiten_linearly(
    z: Array, p: Prediction, model: Model, frame: Frame, offsets: bool
) -> Array:
    """Return z whitened by what is linear and Gaussian; derivatives of a mean are
    whitened alike. offsets : with those that pixels share.

    What whitens does not depend on z: it is kept for the next one."""
    known = p.memo.get(LINEAR_STAGES)
    if not known or known[0] is not model or known[1] != offsets:
        known = model, offsets, list(_linear_stages(p, model, frame, offsets))
        p.memo[LINEAR_STAGES] = known
    for stage in known[2]:
        z = stage(z)[0]
    return z


def _linear_stages(
    p: Prediction, model: Model, frame: Frame, offsets: bool
) -> Iterator[Whitener]:
    stages = _Stages(p, frame, frame.beta2)
    for effect, values in _steps(model, frame):
        if effect is None:
            yield partial(p.shrinkage.apply, keep=frame.keep)
        elif effect.linear and (offsets or not isinstance(effect, SharedOffset)):
            yield stages.next(effect, values)


def colour_offsets(z: Array, p: Prediction, model: Model, frame: Frame) -> Array:
    """Return z such that its product with what `whiten_linearly` makes of an image is
    that of z with the image: the offsets that pixels share drop out."""
    stages = _Stages(p, frame, frame.beta2)
    for effect, values in _steps(model, frame):
        if isinstance(effect, SharedOffset):
            covariance = stages.covariance(effect, values)
            z = covariance.colour(z)
            stages.resume(effect, covariance.whiten, values)
        elif effect is not None and effect.linear:
            stages.next(effect, values)
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
    stages = _Stages(p, frame, frame.beta2)
    chain: list[Whitener] = []
    left: Array | float = 1.0
    for effect, values in _steps(model, frame):
        if shares_structure(effect):
            chain.append(stages.next(effect, values))
        if isinstance(effect, SharedOffset):
            left = left * (1 - effect.leverage(effect.along(p, values, frame), frame))
    for stage in [*chain, *reversed(chain)]:  # by the inverse covariance
        z = stage(z)[0]
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


def row_variance(model: Model, frame: Frame) -> Array | float:
    """Return the variance of the offsets that the rows of a frame have by a model."""
    return sum(
        effect.offset_variance(values, frame)
        for effect, values in _steps(model, frame)
        if isinstance(effect, SharedOffset) and effect.shares_offset == "row"
    )


class _Stages:
    """What whitens residuals of a prediction, one after the other: the direction of an
    offset or a field is that in residuals which those before have whitened.

    within : the prediction before what of its processing is whitened."""

    def __init__(self, p: Prediction, frame: Frame, read: Array) -> None:
        self.p, self.frame, self._read = p, frame, read
        self._linear: list[Whitener] = []
        self.within = p

    def next(self, effect: Effect, values: Values) -> Whitener:
        """Return what whitens by an effect, of residuals alone."""
        p, frame = self.p, self.frame
        if isinstance(effect, SharedOffset):
            stage: Whitener = self.covariance(effect, values).whiten
        elif isinstance(effect, SharedFields):
            fields = [self._seen(one) for one in effect.fields(p, values, frame)]
            stage = whitener_along(fields, frame)
        else:
            stage = effect.whitener(self.within, values, frame, self._read)
        self.resume(effect, stage, values)
        return stage

    def covariance(self, effect: SharedOffset, values: Values) -> GroupCovariance:
        """Return that of the residuals by then."""
        along = self._seen(effect.along(self.p, values, self.frame))
        return effect.covariance(along, self.frame)

    def resume(self, effect: Effect, stage: Whitener, values: Values) -> None:
        """Go on after a stage."""
        if effect.whitening is WhiteningStage.FILTER:
            before = self.within.variance / effect.variance_left(values)
            self.within = replace(self.within, variance=before)
        if effect.linear:
            self._linear.append(stage)

    def _seen(self, image: Array) -> Array:
        for stage in self._linear:
            image = stage(image)[0]
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
