# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Training sets of one seed: every source of the same renders, and the camera's own.

No two seeds share a scene, and neither do captures and renders of one seed."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from studies.cameras import Camera
from studies.protocol import SeedRules
from studies.sources.frames import Frames, Image, words_of
from studies.sources.ours import ours
from studies.sources.real import real
from studies.sources.upi import GAINS, upi
from studies.world.colouring import rendered
from studies.world.shots import World, shots

SETS = 3  # of a seed: captures, captures of other scenes, renders


@dataclass(frozen=True)
class Material:
    """What the sources of one seed are made of."""

    captures: Frames  # the camera's own training frames
    other_captures: Frames  # of other scenes: how far real is from itself
    renders: list[Image]  # (H, W, 3) linear sRGB


def material(
    world: World, camera: Camera, kind: str, rules: SeedRules, frames: int, seed: int
) -> Material:
    """Return the Material of a seed, so many frames of each set.

    kind : one of studies.world.shots.KINDS."""
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
    return Material(
        real(captures, camera.sensitivities),
        real(others, camera.sensitivities),
        [rendered(shot) for shot in renders],
    )


def sources(
    found: Material, camera: Camera, seed: int
) -> Mapping[str, Callable[[], Frames]]:
    """Return what makes the training frames of a seed, by name.

    Of ours, the profile's neutrals are those of the seed's captures."""
    renders, told = found.renders, camera.told(found.captures.neutrals)
    with_curves = replace(camera, sensor=told).with_sensitivities()

    def by_upi(gains: str) -> Callable[[], Frames]:
        return lambda: upi(renders, told, gains, seed=seed)

    def by_upi_under_our_lights() -> Frames:
        words = words_of(ours(renders, told, seed=seed).neutrals)
        return upi(renders, told, lights=words, seed=seed)

    return {
        "real": lambda: found.captures,
        "real, other scenes": lambda: found.other_captures,
        "ours, dng": lambda: ours(renders, told, "dng", seed=seed),
        "ours, paper": lambda: ours(renders, told, "paper", seed=seed),
        "ours, spectral": lambda: ours(renders, with_curves, "spectral", seed=seed),
        **{f"upi, {gains}": by_upi(gains) for gains in GAINS},
        "upi's matrices, our lights": by_upi_under_our_lights,
    }
