# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Pictures by neural ISPs that were trained on each source, of a few test frames."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studies.sources.frames import captured
from studies.sources.real import real
from studies.sources.sets import Draw, Sources
from studies.tasks.isp import (
    XYZ,
    difference,
    pairs,
    pictures_of,
    pixel_learner,
    toned,
)
from studies.world.shots import night_shots

Array = NDArray[np.float32]
FRAMES = 2  # the first of the test frames
GOAL, INPUT = "goal", "input as it is"
SHOWN = ("real", "ours, own", "ours, match", "upi, match")
TRANSLATION = "translation"  # the first source whose name begins so is shown, too


@dataclass(frozen=True)
class Examples:
    """Pictures (n, H, W, 3), sRGB 0..1, by title, and CIEDE2000 (n, H, W) to the goal.

    The goal comes first and has no differences."""

    camera: str
    pictures: dict[str, Array]
    differences: dict[str, NDArray[np.float64]]


def isp_examples(draw: Draw, made: Sources) -> Examples:
    """Return the Examples by the learners of a draw, of few of its sources."""
    rules, camera = draw.world.protocol.isp, draw.camera
    shots = night_shots(draw.world, "test", rules.first, FRAMES)
    whole = replace(rules, step=1)  # the learner knows pixels, not what is beside them
    frames = captured(real(shots, camera.sensitivities))
    tests = pairs(frames, camera.sensor, whole)
    pictures = {GOAL: tests.pictures[XYZ], INPUT: toned(tests.inputs**2)}
    learner = pixel_learner(rules, draw.mode)
    for name in shown_of(made):
        own = pairs(made[name](), camera.sensor, rules)
        developer = learner(own, draw.seed, name)
        pictures[name] = pictures_of(developer, tests.inputs)[XYZ]
    differences = {
        name: difference(picture, tests.pictures[XYZ])
        for name, picture in pictures.items()
        if name != GOAL
    }
    return Examples(camera.id, pictures, differences)


def shown_of(names: Iterable[str]) -> list[str]:
    """Return the sources of which a learner is shown."""
    translated = [name for name in names if name.startswith(TRANSLATION)]
    return [*SHOWN, *translated[:1]]
