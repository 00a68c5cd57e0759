# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Whole field: shading is fitted to every pixel of the frames that it was found on.

A search looks at tiles. A lens is no polynomial, and one that is fitted to a few places
is as far from it between them as its terms allow.
"""

from collections.abc import Iterator
from functools import partial

import numpy as np

from cg2raw.diagnose.assessment.pieces import Pieces
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Tiling
from cg2raw.diagnose.inference.fisher_scoring import Linearisation, moved, solve
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model, Term


def on_whole_frames(model: Model, pieces: Pieces) -> Model:
    """Return a model with its fields of light, and what else moves the mean by light,
    after a step of Fisher scoring on whole frames; the same where it has no field, or
    where frames were taken whole before.

    Maps are left out: they are of these frames, and have taken up what is missing."""
    if not any(term.effect.is_field and not term.calibration for term in model.terms):
        return model
    bare = model.without_maps()
    held = [term.name for term in model.terms if not _is_of_light(term)]
    systems = [
        Linearisation(bare, part).system(bare, held) for part in _parts(bare, pieces)
    ]
    if not systems:
        return model
    parameters, scores, information = zip(*systems, strict=True)
    step, _ = solve(np.sum(scores, 0), np.sum(information, 0))
    return moved(model, parameters[0], step)


def _is_of_light(term: Term) -> bool:
    return term.effect.acts_on_light and term.effect.moves_mean


def _parts(model: Model, pieces: Pieces) -> Iterator[Likelihood]:
    """Yield the lit frames of a batch of tiles, of all that there are."""
    lit = [f for f in pieces.learnt_from.frames if f.capture.shows.light]
    workers = pieces.learnt_from.workers
    for tiles in {id(f.tiles): f.tiles for f in lit if not f.tiles.is_whole}.values():
        alike = [frame for frame in lit if frame.tiles is tiles]
        for batch in pieces.batches(tiles):
            cut = partial(_cut, pieces, batch, model)
            yield Likelihood(workers.map(cut, alike), workers)


def _cut(pieces: Pieces, tiles: Tiling, model: Model, frame: Frame) -> Frame:
    return pieces.without_outliers(pieces.of(frame, tiles), model)
