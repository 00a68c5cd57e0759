# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Residual image: what is left in a dark of a picture that was taken before it.

A dark less its repeats is compared with each picture, by means of blocks of pixels,
without what whole rows and columns have."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cg2raw.arrays import RawImage
from cg2raw.cfa import repeat_of
from cg2raw.diagnose.captures.capture import Capture
from cg2raw.normal import robust_deviation
from cg2raw.sensor import Sensor
from cg2raw.statistics.temperature import set_points

Means = NDArray[np.float32]
LEAST_BLOCK = 4  # pixels along a side
CUT = 5.0  # standard deviations, where what single blocks have is cut off
COARSE = 16  # blocks along a side, whose means noise hardly moves
SURE = 3.0  # standard errors of a variance
LEAST_SHARE = 0.05  # of the noise of a block: less than that moves nothing


@dataclass(frozen=True)
class ResidualImage:
    """dark, picture : names. share : of the picture's light that the dark has. nats :
    that it gains."""

    dark: str
    picture: str
    share: float
    nats: float

    def __str__(self) -> str:
        return (
            f"{self.dark}: has a residual image of {self.picture}, "
            f"{100 * self.share:.2g} % of its light"
        )


@dataclass(frozen=True)
class Blocks:
    """Means of blocks of frames, kept while these are read."""

    sensor: Sensor
    means: dict[str, Means] = field(default_factory=dict)

    @property
    def side(self) -> int:
        """Pixels along a block's: whole repeats of the CFA."""
        repeat = repeat_of(self.sensor.cfa)
        return -(-LEAST_BLOCK // repeat) * repeat

    def of(self, capture: Capture) -> Means:
        """Return (rows, columns) DN above black; the frame is read the first time."""
        if capture.name not in self.means:
            self.watched(capture).raw()
        return self.means[capture.name]

    def watched(self, capture: Capture) -> Capture:
        """Return a capture whose blocks are kept as soon as it is read; those of flats
        are of no use."""
        if capture.shows.light and not capture.shows.image:
            return capture

        def raw() -> RawImage:
            image = capture.raw()
            if capture.name not in self.means:
                black = np.float32(np.mean(self.sensor.black_level))
                self.means[capture.name] = means_of_blocks(image, self.side) - black
            return image

        return replace(capture, raw=raw)


def residual_images(
    captures: Sequence[Capture], darks: Sequence[Capture], blocks: Blocks, least: float
) -> list[ResidualImage]:
    """Return what darks have of the pictures among captures.

    darks : of which those that repeat each other are compared. least : nats that a
    residual image needs, for each dark and picture alone."""
    series: dict[tuple[object, ...], list[Capture]] = {}
    for dark, point in zip(
        darks, set_points([d.temperature for d in darks]), strict=True
    ):
        key = dark.exposure_time, dark.iso, point, blocks.means[dark.name].shape
        series.setdefault(key, []).append(dark)
    repeated = [
        some
        for some in series.values()
        if len(some) > 1 and blocks.means[some[0].name].size
    ]
    images = [[blocks.means[one.name] for one in some] for some in repeated]
    is_any = any(_may_show(image, some) for some in images for image in some)
    pictures = _pictures(captures, blocks) if is_any else []
    least += math.log(max(len(darks) * len(pictures), 1))
    found = []
    for some in repeated:
        left = {one.name: blocks.means[one.name] for one in some}
        while len(left) > 1:  # what one has is missing in the mean of the others
            total = np.sum([*left.values()], axis=0)
            best = max(
                (
                    _best(name, image, total - image, len(left) - 1, pictures)
                    for name, image in left.items()
                ),
                key=lambda one: one.nats,
            )
            if best.nats <= least:
                break
            found.append(best)
            del left[best.dark]
    return found


def _may_show(dark: Means, repeats: Sequence[Means]) -> bool:
    """Return whether a dark may have a picture that matters: the means of COARSE blocks
    on a side vary by more than noise, or are too few to say. If none does, no picture
    need be read."""
    if min(dark.shape) < 2 * COARSE:
        return True
    away = _alone(dark - np.mean(repeats, axis=0))
    means = _alone(means_of_blocks(away, COARSE))
    freedom = math.prod(length - 1 for length in means.shape)
    ratio = float((means**2).sum()) * COARSE**2 / freedom
    least = 1 + (LEAST_SHARE * COARSE) ** 2 / 2 - SURE * math.sqrt(2 / freedom)
    return bool(ratio > least * float((away**2).mean()))


def means_of_blocks(image: NDArray[Any], side: int) -> Means:
    """Return (h // side, w // side) means; what is over at the ends is in none."""
    h, w = (length // side for length in image.shape)
    cut = image[: h * side, : w * side].astype(np.float32)
    found: Means = cut.reshape(h, side, w, side).mean(axis=(1, 3))
    return found


class _Picture(NamedTuple):
    """light : blocks, without whole rows and columns. level : DN, mean of all."""

    name: str
    light: Means
    level: float


def _pictures(captures: Sequence[Capture], blocks: Blocks) -> list[_Picture]:
    """Return a picture of each set: its repeats show the same."""
    first: dict[object, Capture] = {}
    for capture in captures:
        if capture.shows.image and capture.means is None:
            first.setdefault(capture.set, capture)
    found = []
    for capture in first.values():
        if (image := blocks.of(capture)).size:
            level = float(np.abs(image).mean())
            found.append(_Picture(capture.name, _alone(image), level))
    return found


def _best(
    dark: str, image: Means, others: Means, count: int, pictures: Sequence[_Picture]
) -> ResidualImage:
    """Return the picture that a dark has most of, beyond the mean of @count others,
    whose sum is given; none, of 0 nats, where that is too little to move anything."""
    away = _alone(image - others / np.float32(count))
    scale = robust_deviation(away, 0.0)
    away = np.clip(away, -CUT * scale, CUT * scale)
    noise = scale / math.sqrt(1 + 1 / count)
    best = ResidualImage(dark, "", 0.0, 0.0)
    for name, light, level in pictures:
        if light.shape != away.shape or not scale:
            continue
        size = float((light**2).sum())
        share = float((away * light).sum()) / size if size else 0.0
        nats = size * share**2 / scale**2 / 2
        matters = share * level > LEAST_SHARE * noise
        if share > 0 and matters and nats > best.nats:
            best = ResidualImage(dark, name, share, nats)
    return best


def _alone(image: Means) -> Means:
    """Return an image without what whole rows and columns have."""
    rows, columns = image.mean(axis=1, keepdims=True), image.mean(axis=0)
    found: Means = image - rows - columns + image.mean()
    return found
