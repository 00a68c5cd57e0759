# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Pieces: large frames from edge to edge, a batch of tiles at a time."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cache

from cg2raw.cfa import repeat_of
from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.diagnose.frames.frame import (
    Frame,
    Source,
    frame_of,
    source_of,
    with_level_of,
)
from cg2raw.diagnose.frames.tiling import Tiling, whole_tilings
from cg2raw.diagnose.inference.nuisance_fit import without_highlights
from cg2raw.diagnose.inference.registration import Registration
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model

KEPT_BYTES = 1 << 30  # of frames that are not read again for each batch


@dataclass
class Pieces:
    """What large frames show of any of their tiles.

    base : the baseline's model. learnt_from : the frames that a model is fitted to."""

    capture_set: CaptureSet
    base: Model
    registration: Registration | None
    learnt_from: Likelihood
    _sources: dict[str, Source] = field(default_factory=dict)
    _bytes: int = 0

    def afresh(self) -> "Pieces":
        """Return pieces of which nothing is kept yet."""
        return replace(self, _sources={}, _bytes=0)

    def batches(self, tiles: Tiling) -> Iterator[Tiling]:
        """Yield tilings that together are a frame."""
        return whole_tilings(tiles, repeat_of(self.capture_set.sensor.cfa))

    def of(self, frame: Frame, tiles: Tiling) -> Frame:
        """Return a frame's tiles; a small one, or a table, as it is."""
        if tiles.is_whole:
            return frame
        piece = frame_of(self._source(frame), tiles, frame.noise, frame.warmth)
        if piece.level_free:
            piece = with_level_of(piece, frame)
        elif self.registration is not None:
            piece = self.registration.placed(piece)
        if self.capture_set.doubts_light:
            piece = without_highlights(piece, self.base)
        return piece

    def _source(self, frame: Frame) -> Source:
        """Return a frame's files, of which the first are kept, and what has room."""
        name = frame.capture.name
        known = self._sources.get(name)
        if known is None:
            capture = _of_known_truth(frame.capture)
            known = source_of(self.capture_set, capture)
            size = known.raw.nbytes + known.camera.nbytes
            if not self._sources or self._bytes + size <= KEPT_BYTES:
                self._bytes += size
                self._sources[name] = known
        return known


def _of_known_truth(capture: Capture) -> Capture:
    """Return a capture that works its true density out once, where it has one."""
    truth = capture.log_density
    return capture if truth is None else replace(capture, log_density=cache(truth))
