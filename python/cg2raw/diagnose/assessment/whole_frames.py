# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Report frames from edge to edge: their sums and their pictures, piece by piece."""

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
    take_level_from,
)
from cg2raw.diagnose.frames.tiling import whole_tilings
from cg2raw.diagnose.inference.registration import Registration
from cg2raw.diagnose.likelihood.likelihood import Workers
from cg2raw.diagnose.likelihood.nuisance import hide_highlights
from cg2raw.diagnose.likelihood.prediction import Model


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


def look_at(
    capture_set: CaptureSet,
    frames: Sequence[Frame],
    base: Model,
    model: Model,
    registration: Registration | None,
    workers: Workers,
    details: bool,
) -> Look:
    """Go through all of the report frames under two models."""

    def one(frame: Frame) -> tuple[Sums, Sums, Picture | None]:
        return _look_at_one(capture_set, frame, base, model, registration, details)

    parts = workers.map(one, frames)
    return Look(
        sum((part[0] for part in parts), Sums()),
        sum((part[1] for part in parts), Sums()),
        [part[2] for part in parts if part[2] is not None],
    )


def _look_at_one(
    capture_set: CaptureSet,
    frame: Frame,
    base: Model,
    model: Model,
    registration: Registration | None,
    details: bool,
) -> tuple[Sums, Sums, Picture | None]:
    before, after = Sums(), Sums()
    canvas = Canvas(frame, capture_set.sensor.cfa) if details else None
    for piece in _pieces(capture_set, frame, base, registration):
        z_before, p_before = before.add(base, piece)
        z_after, p_after = after.add(model, piece)
        if canvas is not None:
            canvas.mount(piece, p_before.mean, p_after.mean, z_before, z_after)
    return before, after, None if canvas is None else canvas.picture()


def _pieces(
    capture_set: CaptureSet,
    frame: Frame,
    base: Model,
    registration: Registration | None,
) -> Iterator[Frame]:
    """Yield all of a frame; a small one as it is."""
    if frame.tiles.margin == 0:
        yield frame
        return
    source = source_of(capture_set, frame.capture)
    for tiles in whole_tilings(frame.tiles, repeat_of(capture_set.sensor.cfa)):
        piece = frame_of(source, tiles, frame.noise)
        if piece.level_free:
            take_level_from(piece, frame)
        elif registration is not None:
            registration.place(piece)
        if capture_set.nuisances:
            hide_highlights(piece, base)
        yield piece
