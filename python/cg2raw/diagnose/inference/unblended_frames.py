# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Frames as they were before a camera blended neighbours.

A map of the sensor is of its pixels: noise reduction blends the maps of neighbours with
all else, and the law of blended rates is another one. So maps are made of frames whose
residuals are divided by that filter, with a model that lacks it.
"""

from dataclasses import replace

import numpy as np

from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.likelihood.censoring import scores
from cg2raw.diagnose.likelihood.jumps import predict_for_means
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term
from cg2raw.diagnose.likelihood.prediction import blending, predict


def unblended(model: Model, likelihood: Likelihood) -> tuple[Model, Likelihood]:
    """Return (the model without noise reduction, the frames without it); both as they
    are if there is none."""
    before = model
    for effect, _ in blending(model, likelihood.frames[0]):
        listed = model.profile_parameters.get(effect.name)
        before = before.without(effect.name)
        if listed is not None:
            nothing = -np.array(list(listed.values()), float)
            before = before.with_term(Term(effect, nothing, calibration=True))
    if before is model:
        return model, likelihood
    frames = likelihood.each(lambda frame: _unblended(model, before, frame))
    return before, likelihood.of(frames)


def _unblended(model: Model, before: Model, frame: Frame) -> Frame:
    """Return a frame divided by the filter, which makes its rounding larger."""
    p = predict_for_means(model, frame)
    rounding = frame.rounding
    residual = scores(p, frame)[0] * frame.keep * np.sqrt(p.variance)
    for effect, values in blending(model, frame):
        white = effect.whiten(residual, p, values, frame, frame.beta2)[0]
        residual = white / np.sqrt(effect.variance_left(values))
        rounding /= effect.variance_left(values)
    signal = predict(before, frame).mean + residual
    return replace(frame, signal=signal, rounding=rounding)
