# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The parts that studies/scenes has, and how groups of them are moved.

Shapes, materials and facades stay where the renders of tests/data are made."""

import sys
from contextlib import contextmanager
from pathlib import Path

import bpy

SCENES = Path(__file__).resolve().parents[2] / "scenes"
if str(SCENES) not in sys.path:
    sys.path.append(str(SCENES))

# isort: split
import scene_geometry as geometry  # noqa: E402
import scene_materials as materials  # noqa: E402
import scene_render as render  # noqa: E402
import street_facades as facades  # noqa: E402

__all__ = ["facades", "geometry", "group", "materials", "paint", "render", "steel"]


@contextmanager
def group(location, turn=0.0):
    """Move what is made inside by @location in m, after @turn about z in radians."""
    before = {item.name for item in bpy.data.objects}
    yield
    made = [
        item
        for item in bpy.data.objects
        if item.name not in before and item.parent is None
    ]
    geometry.gather(made, location, (0.0, 0.0, turn))


def paint(color, roughness=0.4, **inputs):
    """Return a uniform material of some linear Rec.709 reflectance."""
    return materials.plain("paint", color, roughness, **inputs)


def steel(color=(0.035, 0.038, 0.04), roughness=0.35):
    """Return dark painted steel."""
    return paint(color, roughness, Metallic=0.8)
