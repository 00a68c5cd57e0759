# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Whole field: shading is fitted all over the frames that it was found on.

A search looks at a few tiles. A lens is no polynomial, and one that is fitted to a few
places is as far from it between them as its terms allow.
"""

from collections.abc import Collection
from functools import partial

import numpy as np

from cg2raw.cfa import repeat_of
from cg2raw.diagnose.assessment.pieces import Pieces
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array, even_tiling
from cg2raw.diagnose.inference.fisher_scoring import (
    Linearisation,
    Parameter,
    moved,
    solve,
)
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term
from cg2raw.diagnose.likelihood.workers import Workers

System = tuple[list[Parameter], Array, Array]  # with score and Fisher information


def on_whole_frames(model: Model, pieces: Pieces) -> Model:
    """Return a model with its fields of light, and what else moves the mean by light,
    after a step of Fisher scoring all over the frames; the same where it has no
    field, or where frames were taken whole before."""
    if not any(term.effect.is_field and not term.calibration for term in model.terms):
        return model
    held = [term.name for term in model.terms if not _is_of_light(term)]
    tiled = [
        frame
        for frame in pieces.learnt_from.frames
        if frame.capture.shows.light and not frame.tiles.is_whole
    ]
    work = partial(_system, model, held, pieces)
    systems = pieces.learnt_from.workers.map(work, tiled)
    if not systems:
        return model
    parameters, scores, information = zip(*systems, strict=True)
    step, _ = solve(np.sum(scores, 0), np.sum(information, 0))
    return moved(model, parameters[0], step)


def _is_of_light(term: Term) -> bool:
    return term.effect.acts_on_light and term.effect.moves_mean


def _system(
    model: Model, held: Collection[str], pieces: Pieces, frame: Frame
) -> System:
    """Return the system of small tiles all over a frame, whose files are not kept."""
    tiles = even_tiling(frame.tiles.shape, repeat_of(model.sensor.cfa))
    own = pieces.afresh()
    piece = own.of(frame, tiles)
    alone = Likelihood([piece], Workers(1))
    return Linearisation(model, alone).system(model, held)
