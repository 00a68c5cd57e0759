# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the frames of each source show: how bright, colourful and steep they are.

Of camera RGB, balanced and exposed alike. Nothing is learnt: where sources differ
in this, their learners differ by what the frames show."""

from collections.abc import Mapping

import numpy as np

from studies.sources.frames import Frames, TestSets
from studies.sources.sets import Draw, Sources
from studies.tasks.isp import white_of
from studies.world.exposure import exposed

DARKEST = 1e-3  # of white; steps below it are noise or black
STEEP = 0.9  # quantile of the steps between neighbours
MEASURES = ("brightness", "saturation", "steps")
TESTS = "test frames"

Values = dict[str, float]  # of MEASURES


def content_draw(
    draw: Draw, made: Sources, tests: TestSets
) -> Mapping[str, Mapping[str, Values]]:
    """Return the MEASURES of each source's frames, and of each set of test frames."""
    own = {source: content_of(make()) for source, make in made.items()}
    return {name: {TESTS: content_of(of), **own} for name, of in tests.items()}


def content_of(frames: Frames) -> Values:
    """Return medians over frames of: the median green, white 1; the median of how far
    the least channel is below the greatest, of it 1; a high quantile of steps between
    neighbours, in stops of green."""
    rows = [
        measured(exposed(image) / neutral.astype(np.float32))
        for image, neutral in zip(frames.images, frames.neutrals, strict=True)
    ]
    medians = np.median(np.array(rows), axis=0)
    return {n: round(float(v), 4) for n, v in zip(MEASURES, medians, strict=True)}


def measured(balanced: np.ndarray) -> tuple[float, float, float]:
    """Return MEASURES of balanced camera RGB (h, w, 3), of any exposure."""
    balanced = balanced / white_of(balanced)
    most = np.maximum(balanced.max(axis=2), DARKEST)
    saturation = (most - balanced.min(axis=2)) / most
    green = balanced[..., 1]
    stops = np.log2(np.maximum(green, DARKEST))
    steps = [np.abs(np.diff(stops, axis=axis)).ravel() for axis in (0, 1)]
    return (
        float(np.median(green)),
        float(np.median(saturation)),
        float(np.quantile(np.concatenate(steps), STEEP)),
    )
