# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Nuisance fit: the size of what is wrong with captures."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.effects.base import Values
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.coordinate_search import ENOUGH, Box, best_of, climb
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.nuisance import Nuisance
from cg2raw.diagnose.likelihood.prediction import predict

HIGHLIGHT = 0.85  # of white; above it errors of the capture decide what clips
LEAST_DEVIATION = {
    "light": 0.005,
    "radiance": 0.01,
    "registration": 0.0,
    "texture": 0.0,
}
MOST_DEVIATION = {"light": 0.2, "radiance": 0.2, "registration": 0.5, "texture": 0.1}
STARTS = ((0.005, 0.01, 0.005, 0.001), (0.01, 0.03, 0.02, 0.003))
# Among what is free, where there are tables: no chart has quite its published colours.
PATCHES = "patches"
FIRST_SCALE = 5e-4
SEARCHES = 4


def nuisance_of(capture_set: CaptureSet, likelihood: Likelihood) -> Nuisance | None:
    """Return the nuisance that a capture set declares, fitted on frames.

    None if it declares none and every level is known."""
    free = capture_set.nuisances - {"temperature"}
    if any(frame.samples is not None for frame in likelihood.frames):
        free = free | {PATCHES}
    if not free and not any(frame.level_free for frame in likelihood.frames):
        return None
    least = {**LEAST_DEVIATION, **capture_set.uncertainty}
    start = Nuisance(
        light=least["light"] if "light" in free else 0.0,
        radiance=least["radiance"] if "radiance" in free else 0.0,
        registration=least["registration"] if "registration" in free else 0.0,
        texture=0.0,
        free=free,
    )
    return refitted(Model(capture_set.sensor, nuisance=start), likelihood, least)


def refitted(
    model: Model, likelihood: Likelihood, least: Mapping[str, float] = LEAST_DEVIATION
) -> Nuisance:
    """Return the nuisance of a model with standard deviations that fit frames best.

    least : lower bounds of them."""
    old = model.nuisance
    assert old is not None
    names = _moving(old)
    if not names:
        return old
    box = Box(
        np.array([least[name] for name in names]),
        np.array([MOST_DEVIATION[name] for name in names]),
        FIRST_SCALE,
    )

    def with_values(values: Values) -> Nuisance:
        deviations: dict[str, Any] = dict(zip(names, map(float, values), strict=True))
        return replace(old, apart=True, **deviations)

    def score(values: Values) -> float:
        return likelihood.total(replace(model, nuisance=with_values(values)))

    order = list(LEAST_DEVIATION)
    starts = [
        box.clipped(np.array([start[order.index(name)] for name in names]))
        for start in STARTS
    ]
    starts.append(box.clipped(np.array([getattr(old, name) for name in names])))
    values, height = best_of(starts, score)
    for _ in range(SEARCHES):
        values, higher = climb(box, values, height, score)
        if higher - height < ENOUGH:
            break
        height = higher
    found = with_values(values)
    # Repeats of a scene share one field, and count here as two.
    return replace(found, radiance=found.radiance * np.sqrt(2), apart=False)


def _moving(nuisance: Nuisance) -> list[str]:
    """Return the standard deviations that are fitted."""
    moving = [name for name in LEAST_DEVIATION if name in nuisance.free]
    if nuisance.free & {"registration", "radiance", PATCHES}:
        moving.append("texture")
    return moving


def without_highlights(frame: Frame, model: Model) -> Frame:
    """Return a frame that shows a scene without what is predicted near white. It counts
    as light that hardly anything is known of: enough to show a well that clips it."""
    if not frame.capture.shows.image:
        return frame
    bright = predict(model, frame).mean >= HIGHLIGHT
    return replace(frame, highlights=frame.keep & bright, keep=frame.keep & ~bright)
