# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Illumination: what is slow in flats of a lamp that nobody measured is its light.

A lamp, a screen or a twilight sky is not even, nor is a lens a polynomial. What flats
have in common beyond the model of a sensor, and varies slowly over the frame, is taken
as the light that fell on it: held-out flats have it too. What varies from pixel to
pixel stays, and is PRNU. Source: EMVA Standard 1288, release 4.0 (low frequencies of a
flat are not the pixels').
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cg2raw.cfa import repeat_of
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.shrinkage import shown_light
from cg2raw.diagnose.frames.tiling import Array, Tiling
from cg2raw.diagnose.inference.map_evidence import mean_around
from cg2raw.diagnose.inference.slow_part import SMOOTH
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict

FEWEST_FLATS = 2  # that show the same light
SHADING = "lens_shading"
SURE_SHADING = 2.0  # of how uneven the light is, from where on a shading is none of it


def of_unmeasured_light(frame: Frame) -> bool:
    """Return whether a frame is a flat whose light nobody measured."""
    return frame.level_free and frame.samples is None and frame.capture.kind == "flat"


def light_of(frame: Frame) -> str:
    """Return which light a flat shows: that of its set, or of all flats without one."""
    named = frame.capture.set
    return "" if named == frame.capture.name else named


def unmeasured(frames: Sequence[Frame]) -> list[list[Frame]]:
    """Return the flats of every unmeasured light that there are enough of."""
    lights: dict[tuple[str, tuple[int, ...]], list[Frame]] = {}
    for frame in frames:
        if of_unmeasured_light(frame):
            key = light_of(frame), frame.signal.shape
            lights.setdefault(key, []).append(frame)
    return [flats for flats in lights.values() if len(flats) >= FEWEST_FLATS]


def illumination(model: Model, flats: Sequence[Frame]) -> Array:
    """Return the light (T, 3, h, w) of flats of one shape beside that of a model: 1
    where they are alike. Colours are camera RGB's."""
    first = flats[0]
    pull, told = np.zeros((2, *first.signal.shape))
    for frame in flats:
        p = predict(model, frame)
        light = shown_light(frame, p)
        pull += light * (frame.signal - p.mean) / p.variance
        told += light**2 / p.variance
    width = SMOOTH * min(repeat_of(model.sensor.cfa), 2)
    found = np.ones((len(pull), 3, *pull.shape[1:]))
    for color in np.unique(first.color):
        of_color = first.color == color
        found[:, color] += mean_around(pull * of_color, told * of_color, width)[0]
    if len(np.unique(first.color)) == 1:
        found[:] = found[:, first.color.flat[0], None]
    return found


def without_unsure_shading(model: Model, frames: Sequence[Frame]) -> Model:
    """Return a model without its shading, if that is hardly more than how uneven light
    is beside it, and nobody measured the light of any frame: it may be the lamp's."""
    lights = unmeasured(frames)
    free = sum(len(flats) for flats in lights)
    if model.term(SHADING) is None or not free:
        return model
    if free < sum(frame.capture.shows.light for frame in frames):
        return model
    rest = model.without(SHADING)
    for flats in lights:
        first = flats[0]
        shown, flat = (predict(one, first).exposed for one in (model, rest))
        colors = illumination(model, flats)
        light = np.log(np.take_along_axis(colors, first.color[None, None], 1)[:, 0])
        shading = np.log(shown / flat)
        if _spread(shading, first) > SURE_SHADING * _spread(light, first):
            return model
    return rest


def _spread(image: Array, frame: Frame) -> float:
    """Return the standard deviation of an image about the means of its colours."""
    squares = [
        np.var(image[:, of_color][frame.keep[:, of_color]])
        for of_color in (frame.color == c for c in np.unique(frame.color))
    ]
    return float(np.sqrt(np.mean(squares)))


def lit(frame: Frame, light: Array) -> Frame:
    """Return a flat with its light times another (T, 3, h, w), which goes on beyond the
    edges of tiles as it is there."""
    blocks = _with_margins(light, frame.tiles).astype(np.float32)
    camera, context = frame.rendered
    return replace(
        frame, camera=frame.camera * blocks, rendered=(camera * blocks, context)
    )


def _with_margins(light: Array, tiles: Tiling) -> Array:
    found = []
    for one, before in zip(light, tiles.origins - tiles.blocks, strict=True):
        after = np.subtract(tiles.block_size, tiles.size) - before
        places = [(0, 0), *zip(before, after, strict=True)]
        found.append(np.pad(one, places, mode="edge"))
    return np.stack(found)


def as_lit(model: Model, splits: Splits) -> Splits:
    """Return the frames, flats of unmeasured light with the light that they show."""
    for flats in unmeasured(splits.fit.frames):
        light = illumination(model, flats)
        frames = [
            lit(frame, light) if _is_alike(frame, flats[0]) else frame
            for frame in splits.frames
        ]
        splits = Splits(frames, splits.workers)
    return splits


def as_lit_with_gain(model: Model, splits: Splits) -> tuple[Splits, float]:
    """Return the frames as lit, and the nats that the select frames gain by that."""
    found = as_lit(model, splits)
    if found is splits:  # no light is unmeasured
        return splits, 0.0
    return found, found.select.total(model) - splits.select.total(model)


def _is_alike(frame: Frame, flat: Frame) -> bool:
    return (
        of_unmeasured_light(frame)
        and light_of(frame) == light_of(flat)
        and frame.signal.shape == flat.signal.shape
    )
