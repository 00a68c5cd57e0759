# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""View: the frames that repeat each other, as one mean image."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array, Mask


@dataclass(frozen=True)
class View:
    """frame : the first of those that repeat each other. frames : all of them.

    signal : (T, h, w), their mean."""

    frame: Frame
    frames: Sequence[Frame]
    signal: Array

    @property
    def n(self) -> int:
        return len(self.frames)

    @cached_property
    def away(self) -> Array:
        """(n, T, h, w), what each frame has beyond the mean, but for light that is
        brighter in all of it."""
        return np.array([_beside(self.signal, frame) for frame in self.frames])

    @property
    def is_table(self) -> bool:
        """Whether it is a table of patch means, without pixels."""
        return self.frame.samples is not None

    @property
    def is_chart(self) -> bool:
        """Whether it shows patches of published colours."""
        shows = self.frame.capture.shows
        return shows.image and not shows.render

    @cached_property
    def patches(self) -> Array:
        """Number (T, h, w) of the patch and colour of each sample of a chart."""
        frame = self.frame
        if self.is_table:
            number = np.arange(len(frame.signal))[:, None, None]
        else:
            inner = frame.tiles.inner(frame.rendered[0])
            flat = np.moveaxis(inner, 1, -1).reshape(-1, 3)
            number = np.unique(flat, axis=0, return_inverse=True)[1]
            number = number.reshape(frame.signal.shape)
        return np.asarray(number * 3 + frame.color)

    @property
    def group(self) -> str:
        return self.frame.capture.group

    @property
    def keep(self) -> Mask:
        """Samples that count and reach no end of the converter in any frame."""
        kept = [frame.keep & ~frame.censored for frame in self.frames]
        return np.asarray(np.logical_and.reduce(kept))


def views_of(frames: Sequence[Frame]) -> list[View]:
    """Return the views of frames, in their order."""
    alike: dict[object, list[Frame]] = {}
    for number, frame in enumerate(frames):
        capture = frame.capture
        place = (capture.set, capture.group, capture.kind, capture.iso, frame.seconds)
        alone = number if frame.samples is not None or frame.level_free else None
        alike.setdefault((place, frame.keep.tobytes(), alone), []).append(frame)
    return [_view(members) for members in alike.values()]


def _view(frames: Sequence[Frame]) -> View:
    return View(frames[0], frames, np.mean([one.signal for one in frames], axis=0))


def _beside(mean: Array, frame: Frame) -> Array:
    away = np.where(frame.keep, frame.signal - mean, 0.0)
    lit = np.where(frame.keep, mean, 0.0)
    square = float((lit**2).sum())
    return away - lit * (float((away * lit).sum()) / square if square else 0.0)
