# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""scenes.png: what the camera sees of scenes, developed, beside what a renderer has."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cg2raw.io.figure import DPI, drawn
from studies.cameras import Camera
from studies.figures.tiles import GAP, SCALE, tile
from studies.sources.frames import captured
from studies.sources.real import real
from studies.tasks.isp import CAMERA, pairs, toned, white_of
from studies.world.colouring import rendered
from studies.world.shots import KINDS, World, shots

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Pictures = Sequence[NDArray[np.float32]]  # (H, W, 3) each, alike, sRGB 0..1
COLUMNS = 4
LABELS = 28  # pixels, left of the pictures
FONT, LETTER = 9.5, 0.6  # points of a label; a letter's width over them, at most


def scene_pictures(world: World, camera: Camera) -> dict[str, Pictures]:
    """Return the first test scenes of each kind: real, developed, and rendered."""
    rules = replace(world.protocol.isp, step=1)
    found: dict[str, Pictures] = {}
    for kind in KINDS:
        taken = shots(world, "test", kind, camera.cards, rules.first, COLUMNS)
        frames = captured(real(taken, camera.sensitivities))
        seen = pairs(frames, camera.sensor, rules)
        found[f"{kind}: camera"] = list(seen.pictures[CAMERA])
        renders = [rendered(shot) for shot in taken]
        found[f"{kind}: render"] = [toned(image / white_of(image)) for image in renders]
    return found


def contact_sheet(pictures: Mapping[str, Pictures], colors: int | None = None) -> bytes:
    """Return the PNG of {title: pictures}: a row each.

    colors : of the PNG, fewer for a smaller file; None keeps all."""
    height, width = next(iter(pictures.values()))[0].shape[:2]
    down, across = SCALE * height + GAP, SCALE * width + GAP
    columns = max(map(len, pictures.values()))

    def draw(figure: "Figure") -> None:
        figure.set_layout_engine("none")  # tiles have pixels of their own
        for line, (title, row) in enumerate(pictures.items()):
            for number, picture in enumerate(row):
                axes = tile(figure, picture, LABELS + number * across, line * down)
                if number == 0:
                    room = 72.0 / DPI * SCALE * height / LETTER
                    axes.set_ylabel(title, fontsize=min(FONT, room / len(title)))

    size = LABELS + columns * across - GAP, len(pictures) * down - GAP
    return drawn(size[1] / DPI, draw, size[0] / DPI, colors=colors)
