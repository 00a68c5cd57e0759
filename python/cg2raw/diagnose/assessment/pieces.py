# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Pieces: large frames from edge to edge, a batch of tiles at a time."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cache, partial

from cg2raw.cfa import repeat_of
from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.diagnose.frames.frame import (
    Frame,
    Source,
    frame_of,
    source_of,
    with_level_of,
)
from cg2raw.diagnose.frames.tiling import Array, Tiling, whole_tilings
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.illumination import (
    illumination,
    light_of,
    lit,
    of_unmeasured_light,
    unmeasured,
)
from cg2raw.diagnose.inference.nuisance_fit import without_highlights
from cg2raw.diagnose.inference.outliers import outliers
from cg2raw.diagnose.inference.registration import Registration
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model

KEPT_BYTES = 1 << 30  # of frames that are not read again for each batch
KEPT_LIGHTS = 4  # of batches of tiles
MAP_ROUNDS = 2  # of maps, and of outliers that are in the frames that they are made of


@dataclass
class Pieces:
    """What large frames show of any of their tiles.

    base : the baseline's model. learnt_from : the frames that maps are made from.
    most_outliers : share of a piece that may be set aside, 0 for none. light : the
    model beside which flats of unmeasured light show theirs; None: they are even."""

    capture_set: CaptureSet
    base: Model
    registration: Registration | None
    learnt_from: Likelihood
    most_outliers: float = 0.0
    light: Model | None = None
    _sources: dict[str, Source] = field(default_factory=dict)
    _bytes: int = 0
    _lights: dict[tuple[str, bytes], Array] = field(default_factory=dict)

    def afresh(self) -> "Pieces":
        """Return pieces of which nothing is kept yet."""
        return replace(self, _sources={}, _bytes=0, _lights={})

    def batches(self, tiles: Tiling) -> Iterator[Tiling]:
        """Yield tilings that together are a frame."""
        return whole_tilings(tiles, repeat_of(self.capture_set.sensor.cfa))

    def of(self, frame: Frame, tiles: Tiling) -> Frame:
        """Return a frame's tiles; a small one, or a table, as it is."""
        if tiles.is_whole:
            return frame
        piece = self._as_read(frame, tiles)
        if self.looks_for_light(piece):
            light = self._light_of(piece)
            piece = piece if light is None else lit(piece, light)
        return piece

    def looks_for_light(self, frame: Frame) -> bool:
        """Return whether other flats tell how even a frame's light was."""
        return self.light is not None and of_unmeasured_light(frame)

    def _as_read(self, frame: Frame, tiles: Tiling) -> Frame:
        piece = frame_of(self._source(frame), tiles, frame.noise, frame.warmth)
        if piece.level_free:
            piece = with_level_of(piece, frame)
        elif self.registration is not None:
            piece = self.registration.placed(piece)
        if self.capture_set.doubts_light:
            piece = without_highlights(piece, self.base)
        return piece

    def without_outliers(self, piece: Frame, model: Model) -> Frame:
        """Return a piece without its outliers under a model."""
        if not self.most_outliers:
            return piece
        far = outliers(model, piece, self.most_outliers)
        return replace(piece, keep=piece.keep & ~far)

    def with_maps(self, model: Model, tiles: Tiling) -> Model:
        """Return a model with its maps of these tiles."""
        if tiles.is_whole or not list(model.maps):
            return model
        frames = [f for f in self.learnt_from.frames if f.tiles.shape == tiles.shape]
        uniform = [f for f in frames if not f.capture.shows.image] or frames
        if not uniform:
            return model
        workers = self.learnt_from.workers
        pieces = workers.map(lambda frame: self.of(frame, tiles), uniform)
        for _ in range(MAP_ROUNDS if self.most_outliers else 1):
            model = fit_patterns(model, Likelihood(pieces, workers))
            cleaned = partial(self.without_outliers, model=model)
            pieces = workers.map(cleaned, pieces)
        return model

    def _light_of(self, piece: Frame) -> Array | None:
        """Return what flats of one light show of it in the tiles of a piece; None if
        they are too few."""
        key = light_of(piece), piece.tiles.origins.tobytes()
        if key not in self._lights:
            alike = [
                flats
                for flats in unmeasured(self.learnt_from.frames)
                if light_of(flats[0]) == light_of(piece)
                and flats[0].tiles.shape == piece.tiles.shape
            ]
            if not alike:
                return None
            pieces = [self._as_read(flat, piece.tiles) for flat in alike[0]]
            if len(self._lights) >= KEPT_LIGHTS:
                self._lights.clear()
            assert self.light is not None
            self._lights[key] = illumination(self.light, pieces)
        return self._lights[key]

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
