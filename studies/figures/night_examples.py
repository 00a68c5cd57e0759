# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The paper's application: RAW of dark scenes at high ISO, denoised and developed by
learners that were trained on each source's RAW of renders."""

from dataclasses import replace

import numpy as np

from studies.figures.contact_sheet import Pictures
from studies.figures.isp_examples import GOAL, SHOWN, shown_of
from studies.learners.lesson import Array
from studies.learners.patches import patch_learner
from studies.sources.frames import Frames, captured
from studies.sources.real import real
from studies.sources.sets import Draw, Sources
from studies.tasks.denoising import Condition, conditions, lesson_of, packed
from studies.tasks.isp import CAMERA, pairs, pictures_of, pixel_learner
from studies.world.shots import night_shots

FRAMES = 2  # test frames
ENLARGED = 2  # their sides, as many times those of the study
NOISY = "not denoised"


def night_examples(draw: Draw, made: Sources) -> dict[str, Pictures]:
    """Return {title: pictures}: the first test frames at each ISO, the brighter ones.

    What is not denoised is developed by the learner that the camera's own frames teach.
    """
    rules = draw.world.protocol.denoising
    asked = [
        condition
        for condition in conditions(rules)
        if condition.brightness == max(rules.brightness)
    ]
    clean, neutrals = test_planes(draw)
    isp = draw.world.protocol.isp
    goal = pairs(half_size(clean, neutrals), draw.camera.sensor, replace(isp, step=1))
    found: dict[str, list[Array]] = {GOAL: list(goal.pictures[CAMERA]) * len(asked)}
    learner, isp_learner = (
        patch_learner(rules, draw.mode),
        pixel_learner(isp, draw.mode),
    )
    for source in shown_of(made):
        frames = made[source]()
        planes = packed(frames.images)
        training = pairs(frames, draw.camera.sensor, isp)
        developer = isp_learner(training, draw.seed, source)
        for condition in asked:
            noisy = with_noise(clean, condition)
            lesson = lesson_of(planes, condition, rules, draw.seed, source)
            shown = {source: learner(lesson)(noisy)}
            if source == SHOWN[0]:
                shown = {NOISY: noisy, **shown}
            for title, values in shown.items():
                balanced = half_size(values / condition.brightness, neutrals)
                inputs = pairs(balanced, draw.camera.sensor, replace(isp, step=1))
                pictures = pictures_of(developer, inputs.inputs)[CAMERA]
                found.setdefault(title, []).extend(pictures)
    return dict(found)


def test_planes(draw: Draw) -> tuple[Array, np.ndarray]:
    """Return clean planes (n, 4, h, w) of test frames, white 1, and their neutrals."""
    protocol = draw.world.protocol
    scene = protocol.scene
    larger = replace(
        scene, height=ENLARGED * scene.height, width=ENLARGED * scene.width
    )
    world = replace(draw.world, protocol=replace(protocol, scene=larger))
    shots = night_shots(world, "test", protocol.isp.first, FRAMES)
    frames = captured(real(shots, draw.camera.sensitivities))
    return packed(frames.images), frames.neutrals


def with_noise(clean: Array, condition: Condition) -> Array:
    """Return planes as the camera keeps them in the dark."""
    dark = clean * np.float32(condition.brightness)
    return condition.noise.added(dark, np.random.default_rng(79))


def half_size(planes: Array, neutrals: np.ndarray) -> Frames:
    """Return Frames of planes (n, 4, h, w) of RGGB: the two greens' mean is G."""
    red, first, second, blue = np.moveaxis(planes, 1, 0)
    images = np.stack([red, (first + second) / 2.0, blue], axis=-1)
    return Frames(list(images.astype(np.float32)), neutrals)
