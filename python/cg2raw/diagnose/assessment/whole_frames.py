# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Whole report frames, from edge to edge: their sums, pictures and fixed
patterns, piece by piece."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from cg2raw.diagnose.assessment.figures import Canvas
from cg2raw.diagnose.assessment.gap import Sums
from cg2raw.diagnose.assessment.patterns import PatternSums, is_uniform, patterns_of
from cg2raw.diagnose.assessment.pieces import Pieces
from cg2raw.diagnose.diagnosis import FixedPattern, Picture
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Tiling
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model


@dataclass(frozen=True)
class Look:
    """What whole report frames say of two models; pictures and fixed patterns, if they
    were asked for."""

    before: Sums
    after: Sums
    pictures: Sequence[Picture]
    patterns: Sequence[FixedPattern] = ()

    @property
    def unchanged(self) -> "Look":
        """Of the first model in both places."""
        same = [
            replace(picture, after=picture.before, z_after=picture.z_before)
            for picture in self.pictures
        ]
        patterns = [
            replace(
                pattern,
                after=pattern.before,
                rows_after=pattern.rows_before,
                columns_after=pattern.columns_before,
            )
            for pattern in self.patterns
        ]
        return Look(self.before, self.before, same, patterns)


@dataclass(frozen=True)
class WholeFrames:
    """The report frames, to be gone through from edge to edge.

    base : the baseline's model. details : with pictures and patterns."""

    report: Likelihood
    base: Model
    pieces: Pieces
    details: bool

    def look_at(self, model: Model) -> Look:
        """Go through all of the frames under the baseline and a model."""
        views = [
            _View(frame, self._canvas(frame), self._pattern(frame))
            for frame in self.report.frames
        ]
        for tiles in {id(f.tiles): f.tiles for f in self.report.frames}.values():
            shown = [view for view in views if view.frame.tiles is tiles]
            self._go_through(tiles, shown, model)
        return Look(
            sum((view.before for view in views), Sums()),
            sum((view.after for view in views), Sums()),
            [view.canvas.picture() for view in views if view.canvas is not None],
            patterns_of([v.pattern for v in views if v.pattern is not None]),
        )

    def _go_through(
        self, tiles: Tiling, shown: Sequence["_View"], model: Model
    ) -> None:
        """Go through frames of one tiling: those that need no other frame one by one,
        so that each is read once; the rest by batches of tiles, for their maps."""
        batches = list(self.pieces.batches(tiles))
        alone = [view for view in shown if self._stands_alone(view.frame, model)]
        rest = [view for view in shown if view not in alone]
        work = partial(_add_all, self.pieces, batches, (self.base, model))
        self.report.workers.map(work, alone)
        for batch in batches if rest else ():
            models = (
                self.pieces.with_maps(self.base, batch),
                self.pieces.with_maps(model, batch),
            )
            self.report.workers.map(partial(_add, self.pieces, batch, models), rest)

    def _stands_alone(self, frame: Frame, model: Model) -> bool:
        """Return whether other frames tell nothing of a frame: no map, no light."""
        mapped = [*self.base.maps, *model.maps]
        return not mapped and not self.pieces.looks_for_light(frame)

    def _canvas(self, frame: Frame) -> Canvas | None:
        cfa = self.base.sensor.cfa
        drawn = self.details and frame.samples is None
        return Canvas(frame, cfa) if drawn else None

    def _pattern(self, frame: Frame) -> PatternSums | None:
        drawn = self.details and is_uniform(frame)
        return PatternSums(frame, self.base.sensor.cfa) if drawn else None


@dataclass(eq=False)
class _View:
    """One report frame, as far as it was gone through."""

    frame: Frame
    canvas: Canvas | None
    pattern: PatternSums | None
    before: Sums = field(default_factory=Sums)
    after: Sums = field(default_factory=Sums)


def _add_all(
    pieces: Pieces,
    batches: Sequence[Tiling],
    models: tuple[Model, Model],
    view: _View,
) -> None:
    """Count all of a frame, whose files are not kept."""
    own = pieces.afresh()
    for tiles in batches:
        _add(own, tiles, models, view)


def _add(
    pieces: Pieces, tiles: Tiling, models: tuple[Model, Model], view: _View
) -> None:
    """Count a batch of tiles. models : before and after, with maps of the batch."""
    piece = pieces.without_outliers(pieces.of(view.frame, tiles), models[1])
    z_before, p_before = view.before.add(models[0], piece)
    z_after, p_after = view.after.add(models[1], piece)
    if view.canvas is not None:
        view.canvas.mount(piece, p_before.mean, p_after.mean, z_before, z_after)
    if view.pattern is not None:
        view.pattern.add(piece, p_before, p_after)
