# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Frames without the offsets that their pixels share.

The offset of a row is new in every frame, and as large as its pixels' noise on some
sensors: in a map of pixels it would be a pattern of the rows of the few frames that the
map is made of. So it is taken out of them, as large as the model, with the maps that it
has, makes most likely.
"""

from dataclasses import replace

import numpy as np

from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.likelihood.censored_offsets import censored_offsets
from cg2raw.diagnose.likelihood.censoring import scores
from cg2raw.diagnose.likelihood.jumps import predict_for_means
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.whitening import (
    cut_offsets,
    has_shared_structure,
    without_shared,
)

MOST_AWAY = 4.0  # standard deviations, that a pixel may move an offset by as one


def without_shared_offsets(model: Model, likelihood: Likelihood) -> Likelihood:
    """Return the frames without what the pixels of each share, by a model."""
    return likelihood.of(
        likelihood.each(
            lambda frame: (
                _without(model, frame) if has_shared_structure(model, frame) else frame
            )
        )
    )


def _without(model: Model, frame: Frame) -> Frame:
    p = predict_for_means(model, frame)
    cut = cut_offsets(model, frame)
    if cut is not None:
        offsets = censored_offsets(p, cut, frame).likeliest.mean - p.mean
        return replace(frame, signal=frame.signal - offsets)
    z = scores(p, frame)[0] * frame.keep
    near = np.clip(z, -MOST_AWAY, MOST_AWAY)
    moved = without_shared(near, p, model, frame) - near
    return replace(frame, signal=frame.signal + moved * np.sqrt(p.variance))
