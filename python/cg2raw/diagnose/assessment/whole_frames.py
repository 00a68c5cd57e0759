# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Whole report frames, from edge to edge: their sums and pictures, piece by piece."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from cg2raw.diagnose.assessment.figures import Canvas
from cg2raw.diagnose.assessment.gap import Sums
from cg2raw.diagnose.assessment.pieces import Pieces
from cg2raw.diagnose.diagnosis import Picture
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model


@dataclass(frozen=True)
class Look:
    """What whole report frames say of two models; pictures, if they were asked for."""

    before: Sums
    after: Sums
    pictures: Sequence[Picture]

    @property
    def unchanged(self) -> "Look":
        """Of the first model in both places."""
        same = [
            replace(picture, after=picture.before, z_after=picture.z_before)
            for picture in self.pictures
        ]
        return Look(self.before, self.before, same)


@dataclass(frozen=True)
class WholeFrames:
    """The report frames, to be gone through from edge to edge.

    base : the baseline's model. details : with pictures."""

    report: Likelihood
    base: Model
    pieces: Pieces
    details: bool

    def look_at(self, model: Model) -> Look:
        """Go through all of the frames under the baseline and a model."""
        views = [_View(frame, self._canvas(frame)) for frame in self.report.frames]
        work = partial(_add_all, self.pieces, (self.base, model))
        self.report.workers.map(work, views)
        return Look(
            sum((view.before for view in views), Sums()),
            sum((view.after for view in views), Sums()),
            [view.canvas.picture() for view in views if view.canvas is not None],
        )

    def _canvas(self, frame: Frame) -> Canvas | None:
        cfa = self.base.sensor.cfa
        drawn = self.details and frame.samples is None
        return Canvas(frame, cfa) if drawn else None


@dataclass(eq=False)
class _View:
    """One report frame, as far as it was gone through."""

    frame: Frame
    canvas: Canvas | None
    before: Sums = field(default_factory=Sums)
    after: Sums = field(default_factory=Sums)


def _add_all(pieces: Pieces, models: tuple[Model, Model], view: _View) -> None:
    """Count all of a frame, whose files are not kept. models : before and after."""
    own = pieces.afresh()
    for tiles in own.batches(view.frame.tiles):
        piece = own.of(view.frame, tiles)
        z_before, p_before = view.before.add(models[0], piece)
        z_after, p_after = view.after.add(models[1], piece)
        if view.canvas is not None:
            view.canvas.mount(piece, p_before.mean, p_after.mean, z_before, z_after)
