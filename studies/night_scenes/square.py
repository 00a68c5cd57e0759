# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Builds a square: its paving."""

from .parts import ground
from .parts.library import geometry


def stage(scene):
    """Build the paving from behind the camera to behind the houses."""
    half, depth = scene.stage["half"], scene.stage["depth"]
    paving = ground.SURFACES[scene.stage["paving"]](scene.weather.wet)
    low, high = (-half - 3.0, -14.0, -0.2), (half + 3.0, depth + 3.0, 0.0)
    geometry.span("square", low, high, paving, edge=0.0)
