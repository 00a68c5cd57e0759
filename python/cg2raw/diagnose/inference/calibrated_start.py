# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Calibrated start: a profile that states its fixed patterns is where a search begins.

Somebody measured that sensor: its profile is near to it in most effects, and a fit of
all of them would trade one for another. So the profile's numbers stay, captures show
the maps, and effects are added to that one by one.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Mask
from cg2raw.diagnose.inference.baseline import Baseline
from cg2raw.diagnose.inference.fitting import fit_alone, scored
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.full_start import MOST_OUT, MOST_OUTLIERS, Start
from cg2raw.diagnose.inference.illumination import (
    SHADING,
    as_lit_with_gain,
    unmeasured,
    without_unsure_shading,
)
from cg2raw.diagnose.inference.outliers import (
    expected_outliers,
    outliers,
    without_outliers,
)
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.inference.warmth import reading_error, warmed
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict

TURNS_OF_LIGHT = 2  # of maps, what frames set aside, and how warm they are
# Turns of all maps, at most, and the change of their deviations that ends them.
MOST_TURNS_OF_ALL, SETTLED_TO = 6, 0.05
LEAKS = 3.0  # standard deviations that the charge of a pixel is, which may flicker


def calibrated_start(baseline: Baseline, effects: Sequence[Effect]) -> Start | None:
    """Return the profile with its maps, beside which flats show their light; None if it
    lacks most of the fixed patterns that captures could show.

    effects : that may be named."""
    model, splits = baseline.model, baseline.splits
    if not is_calibrated(model, effects):
        return None
    error = reading_error(splits.frames, "temperature" in baseline.free)
    shown = splits
    model = _with_sure_shading(model, effects, shown)  # or spots would take it
    for _ in range(TURNS_OF_LIGHT):
        model = fit_patterns(model, shown.fit)
        splits = warmed(model, splits, error)
        shown = without_outliers(model, splits, MOST_OUT)
        if model.term(SHADING):
            model = fit_alone(model, SHADING, shown.fit)
    light = model
    splits, gain = as_lit_with_gain(light, splits)
    model = settled(model, without_transients(model, splits).fit)
    return Start(model, without_transients(model, splits), light, gain)


def settled(model: Model, likelihood: Likelihood) -> Model:
    """Return the model with maps that agree with each other: pixels that jump and maps
    of means explain the same frames, and settle between them by halves."""
    for _ in range(MOST_TURNS_OF_ALL):
        before = {term.name: term.values for term, _, _ in model.maps}
        model = fit_patterns(model, likelihood)
        now = {term.name: term.values for term, _, _ in model.maps}
        if all(np.allclose(now[n], before.get(n, 0.0), rtol=SETTLED_TO) for n in now):
            break
    return model


def _with_sure_shading(
    model: Model, effects: Sequence[Effect], splits: Splits
) -> Model:
    """Return the model with shading beside its profile's, if flats whose light nobody
    measured have more of it than that light is uneven."""
    shadings = [effect for effect in effects if effect.name == SHADING]
    if not shadings or not unmeasured(splits.fit.frames):
        return model
    shaded = model.with_effect(shadings[0])
    shaded, _ = scored(shaded, splits.fit.total(shaded), splits.fit)
    return without_unsure_shading(shaded, splits.fit.frames)


def is_calibrated(model: Model, effects: Sequence[Effect]) -> bool:
    """Return whether a profile states most of the fixed patterns that may be named."""
    patterns = {e.name for e in effects if isinstance(e, FixedPattern)}
    stated = {term.name for term in model.terms if term.calibration}
    return len(patterns & stated) > len(patterns - stated)


def lost_without_each(model: Model, likelihood: Likelihood) -> dict[str, float]:
    """Return the nats that frames lose without each of a model's effects, of which most
    are maps of what a profile states."""
    whole = likelihood.total(model)
    return {name: whole - likelihood.total(model.without(name)) for name in model.names}


def without_transients(model: Model, splits: Splits) -> Splits:
    """Return the frames without outliers that no effect is to explain: in one frame
    alone, as of a cosmic ray, in a pixel that leaks charge, which flickers, or in as
    few pixels of a dark as its profile says are defective; these in all frames."""
    far = splits.workers.map(
        lambda frame: outliers(model, frame, MOST_OUTLIERS), splits.frames
    )
    mapped = [term.name for term, effect, _ in model.maps if effect.layout == "pixels"]
    often: dict[tuple[int, ...], Mask] = {}
    defective: dict[tuple[int, ...], Mask] = {}
    for frame, mask in zip(splits.frames, far, strict=True):
        one = mask & (mask.mean() <= expected_outliers(model, frame, mapped))
        defective[mask.shape] = defective.get(mask.shape, False) | one
    for shape in defective:
        same = [mask for mask in far if mask.shape == shape]
        often[shape] = np.sum(same, axis=0) > 1

    def cleaned(one: tuple[Frame, Mask]) -> Frame:
        frame, mask = one
        if mask.any():
            mask = mask & (~often[mask.shape] | _is_hot(model, frame))
        return replace(frame, keep=frame.keep & ~mask & ~defective[mask.shape])

    pairs = list(zip(splits.frames, far, strict=True))
    return Splits(splits.workers.map(cleaned, pairs), splits.workers)


def _is_hot(model: Model, frame: Frame) -> Mask:
    """Return (T, h, w), True in pixels whose charge by the maps of a model is large."""
    charge = np.zeros(frame.signal.shape)
    for _, effect, known in model.maps:
        if effect.is_charge and known.mean.shape == charge.shape:
            charge += frame.seconds * known.mean
    found: Mask = charge > LEAKS * np.sqrt(predict(model, frame).variance)
    return found
