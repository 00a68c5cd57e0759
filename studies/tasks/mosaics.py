# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Study 2 of mosaics as files have them: training on DNGs that the plugin wrote, and
tests on photographs."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from studies.cameras import Camera
from studies.places import data_folder
from studies.protocol import ChosenRules, PhotographsRules
from studies.sources.frames import Frames, TestSets, captured
from studies.sources.mosaics import photograph_files, photographs
from studies.sources.sets import Draw, Sources
from studies.tasks.denoising import Conditions, denoising_draw
from studies.world.shots import World


def files_draw(draw: Draw, made: Sources, tests: TestSets) -> dict[str, Conditions]:
    """Return the Scores of learners of arrays and of files."""
    return denoising_draw(draw, few(made, draw.world.protocol.files), tests)


def photographs_draw(
    draw: Draw, made: Sources, tests: TestSets
) -> dict[str, Conditions]:
    """Return the Scores on photographs, each the mean over its frames."""
    rules = draw.world.protocol.photographs
    counts = [len(of) for of in taken(rules).values()]
    found = denoising_draw(draw, few(made, rules), tests)
    return {
        name: by_photograph(conditions, counts) for name, conditions in found.items()
    }


def few(made: Sources, rules: ChosenRules) -> Sources:
    """Return the sources that a table of the protocol names and that there are."""
    return {source: made[source] for source in rules.sources if source in made}


def test_photographs(world: World, camera: Camera, mode: str) -> Frames:
    """Return all frames of photographs, as a camera's auto exposure has them."""
    found = taken(world.protocol.photographs).values()
    images = [image for frames in found for image in frames]
    return captured(Frames(images, np.ones((len(images), 3))))


def files() -> list[Path]:
    """Return the files that the photographs are."""
    return list(photograph_files(data_folder()).values())


def taken(rules: PhotographsRules) -> dict[str, Any]:
    """Return the frames of each photograph."""
    return photographs(data_folder(), rules.bin, rules.size, rules.crops)


def by_photograph(values: Any, counts: list[int]) -> Any:
    """Return values whose lists of frames are means of each photograph's frames."""
    if isinstance(values, Mapping):
        return {name: by_photograph(part, counts) for name, part in values.items()}
    parts = np.split(np.array(values), np.cumsum(counts)[:-1])
    return [round(float(part.mean()), 6) for part in parts]
