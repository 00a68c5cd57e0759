# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A scene: leaves, what lights them, and what shines by itself."""

from dataclasses import dataclass

from studies.world.colorimetry import Array
from studies.world.leaves import Leaves


@dataclass(frozen=True)
class Scene:
    """A frame before it has colours; n materials, L lights, the first the main one."""

    materials: Array  # (n, 81) reflectances
    leaves: Leaves
    shades: Array  # (L, H, W): how much of each light falls on a pixel
    emission: Array  # (L, H, W): light seen itself: highlights, sky, lamps; 1 is white
    bounce: Array  # (H, W): strength of one inter-reflection
    bounced: int  # the material that reflects it


@dataclass(frozen=True)
class Shot:
    """A scene under lights (L, 81), luminance 1, the first of which is its neutral."""

    scene: Scene
    lights: Array
