# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Whole report frames, from edge to edge: their sums and pictures, piece by piece."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from cg2raw.diagnose.assessment.figures import Canvas
from cg2raw.diagnose.assessment.gap import Sums
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.diagnosis import Picture
from cg2raw.diagnose.frames.frame import (
    Frame,
    frame_of,
    repeat_of,
    source_of,
    with_level_of,
)
from cg2raw.diagnose.frames.tiling import whole_tilings
from cg2raw.diagnose.inference.nuisance_fit import without_highlights
from cg2raw.diagnose.inference.registration import Registration
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

    capture_set: CaptureSet
    report: Likelihood
    base: Model
    registration: Registration | None
    details: bool

    def look_at(self, model: Model) -> Look:
        """Go through all of the frames under the baseline and a model."""
        parts = self.report.each(lambda frame: self._look_at_one(frame, model))
        return Look(
            sum((part[0] for part in parts), Sums()),
            sum((part[1] for part in parts), Sums()),
            [part[2] for part in parts if part[2] is not None],
        )

    def _look_at_one(
        self, frame: Frame, model: Model
    ) -> tuple[Sums, Sums, Picture | None]:
        before, after = Sums(), Sums()
        canvas = Canvas(frame, self.capture_set.sensor.cfa) if self.details else None
        for piece in self._pieces(frame):
            z_before, p_before = before.add(self.base, piece)
            z_after, p_after = after.add(model, piece)
            if canvas is not None:
                canvas.mount(piece, p_before.mean, p_after.mean, z_before, z_after)
        return before, after, None if canvas is None else canvas.picture()

    def _pieces(self, frame: Frame) -> Iterator[Frame]:
        """Yield all of a frame; a small one as it is."""
        if frame.tiles.margin == 0:
            yield frame
            return
        source = source_of(self.capture_set, frame.capture)
        repeat = repeat_of(self.capture_set.sensor.cfa)
        for tiles in whole_tilings(frame.tiles, repeat):
            piece = frame_of(source, tiles, frame.noise)
            if piece.level_free:
                piece = with_level_of(piece, frame)
            elif self.registration is not None:
                piece = self.registration.placed(piece)
            if self.capture_set.nuisances:
                piece = without_highlights(piece, self.base)
            yield piece
