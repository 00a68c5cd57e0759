# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Training sets of one seed: every source of the same renders, and the camera's own.

No two seeds share a scene, and neither do captures and renders of one seed."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from studies.cameras import Camera
from studies.protocol import SeedRules
from studies.sources.frames import Frames, Image, words_of
from studies.sources.ours import drawn, ours
from studies.sources.real import real
from studies.sources.renders import Renders
from studies.sources.translation import Translator, translation
from studies.sources.upi import GAINS, upi
from studies.world.colouring import rendered
from studies.world.exposure import auto_exposed
from studies.world.shots import World, shots

Sources = Mapping[str, Callable[[], Frames]]  # what makes training frames, by name
SHUFFLE = 62  # key of a generator
SETS = 3  # of a seed: captures, captures of other scenes, renders


@dataclass(frozen=True)
class Draw:
    """A training set of a camera in one of the protocol's modes, quick or full."""

    world: World
    camera: Camera
    mode: str
    seed: int  # of the set, of first weights and of order
    folder: Path | None = None  # that keeps trainings which take long


@dataclass(frozen=True)
class Material:
    """What the sources of one seed are made of."""

    captures: Frames  # the camera's own training frames
    other_captures: Frames  # of other scenes: how far real is from itself
    renders: list[Image]  # (H, W, 3) linear sRGB, exposed: no source saturates more
    as_rendered: list[Image]  # the same before that
    of_world: list[Image]  # renders of the world as rendered; the same if no others


def material(
    world: World,
    camera: Camera,
    kind: str,
    rules: SeedRules,
    frames: int,
    seed: int,
    *,
    rendered_images: Renders | None = None,
) -> Material:
    """Return the Material of a seed, so many frames of each set.

    kind : one of studies.world.shots.KINDS.
    rendered_images : in place of renders of the world."""
    captures, others, renders = (
        shots(
            world,
            "train",
            kind,
            camera.cards,
            first + seed * frames,
            frames,
            SETS * seed + number,
        )
        for number, first in enumerate((rules.real, rules.other, rules.rendered))
    )
    images = of_world = [rendered(shot) for shot in renders]
    if rendered_images is not None:
        images = rendered_images.drawn(frames, seed)
    return Material(
        real(captures, camera.sensitivities),
        real(others, camera.sensitivities),
        [auto_exposed(image) for image in images],
        images,
        of_world,
    )


def sources(
    found: Material, camera: Camera, seed: int, translator: Translator | None = None
) -> Sources:
    """Return what makes the training frames of a seed, by name.

    Of ours, the profile's neutrals are those of the seed's captures. Without a
    translator there is no translation among them."""
    renders, told = found.renders, camera.told(found.captures.neutrals)
    measured = drawn(len(renders), seed, "measured")
    with_curves = replace(camera, sensor=told).with_sensitivities()

    def by_upi(gains: str) -> Callable[[], Frames]:
        return lambda: upi(renders, told, gains, seed=seed)

    def our_lights() -> list[str]:
        words = drawn(len(renders), seed)
        return words_of(np.array([told.illuminant(word).neutral for word in words]))

    def by_upi_under_our_lights() -> Frames:
        return upi(renders, told, lights=our_lights(), seed=seed)

    def by_translation(lights: Callable[[], list[str]] = list) -> Frames:
        assert translator is not None
        return translation(renders, translator, told, lights=lights(), seed=seed)

    translated: Sources = {
        "translation": by_translation,
        "translation, our lights": lambda: by_translation(our_lights),
    }

    return {
        "real": lambda: found.captures,
        "real, other scenes": lambda: found.other_captures,
        "ours, dng": lambda: ours(renders, told, "dng", seed=seed),
        "ours, measured lights": lambda: ours(renders, told, lights=measured),
        "ours, paper": lambda: ours(renders, told, "paper", seed=seed),
        "ours, spectral": lambda: ours(renders, with_curves, "spectral", seed=seed),
        **{f"upi, {gains}": by_upi(gains) for gains in GAINS},
        "upi's matrices, our lights": by_upi_under_our_lights,
        **(translated if translator is not None else {}),
    }


def few(found: Material, camera: Camera, seed: int) -> Sources:
    """Return sources(), none of which is a translation's, and others that tell what a
    gap comes of: one knows what no user does, one knows of the neutrals what a bundled
    profile does."""
    told = camera.told(found.captures.neutrals)
    order = np.random.default_rng([seed, SHUFFLE]).permutation(len(found.renders))
    lights = words_of(found.captures.neutrals[order])
    bundled = camera.told_mixture(found.captures.neutrals)
    measured = drawn(len(found.renders), seed, "measured")
    return {
        **sources(found, camera, seed),
        "ours, captures' lights": lambda: ours(found.renders, told, lights=lights),
        "ours, mixture of lights": lambda: ours(
            found.renders, bundled, lights=measured
        ),
    }
