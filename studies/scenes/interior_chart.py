# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The 24 patch colour chart of the interior. Lengths in metres."""

import scene_geometry as geometry
import scene_materials as materials
from scene_render import degrees

# 8 bit sRGB values of the 24 patch ColorChecker as published by its maker (before
# November 2014), row by row from dark skin to black.
CHART_SRGB = (
    (115, 82, 68),
    (194, 150, 130),
    (98, 122, 157),
    (87, 108, 67),
    (133, 128, 177),
    (103, 189, 170),
    (214, 126, 44),
    (80, 91, 166),
    (193, 90, 99),
    (94, 60, 108),
    (157, 188, 64),
    (224, 163, 46),
    (56, 61, 150),
    (70, 148, 73),
    (175, 54, 60),
    (231, 199, 31),
    (187, 86, 149),
    (8, 133, 161),
    (243, 243, 242),
    (200, 200, 200),
    (160, 160, 160),
    (122, 122, 121),
    (85, 85, 85),
    (52, 52, 52),
)
PATCH = 0.040  # side of a patch
PITCH = 0.0455  # between patch centres
CHART_SIZE = (0.292, 0.205)


def linear(code):
    """Decode one 8 bit sRGB value to linear light. Source: IEC 61966-2-1."""
    value = code / 255.0
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


def patch_centres():
    """Return the 24 patch centres (x, y, z) in the chart's frame; it faces -y."""
    return [
        ((column - 2.5) * PITCH, -0.0048, (1.5 - row) * PITCH)
        for row in range(4)
        for column in range(6)
    ]


def chart(location, turn, lean):
    """Stand the chart on a wooden ledge; angles in radians. Returns its pivot."""
    black = materials.matte("chart_frame", (0.028, 0.028, 0.028))
    oak = materials.wood("chart_stand", (0.20, 0.10, 0.04), (0.42, 0.25, 0.12))
    parts = [
        geometry.box(
            "chart", (CHART_SIZE[0], 0.006, CHART_SIZE[1]), (0, 0, 0), black, edge=0.002
        )
    ]
    for index, centre in enumerate(patch_centres()):
        paint = materials.matte(
            f"patch_{index + 1:02d}", [linear(code) for code in CHART_SRGB[index]]
        )
        parts.append(
            geometry.box(
                f"patch_{index + 1:02d}",
                (PATCH, 0.004, PATCH),
                (centre[0], -0.0028, centre[2]),
                paint,
                edge=0.0,
            )
        )
    low = -CHART_SIZE[1] / 2
    parts.append(
        geometry.box("ledge", (0.33, 0.045, 0.018), (0, -0.008, low - 0.010), oak)
    )
    parts.append(
        geometry.box(
            "strut", (0.03, 0.012, 0.23), (0, 0.045, -0.01), oak, degrees(20, 0, 0)
        )
    )
    return geometry.gather(parts, location, (-lean, 0, turn))
