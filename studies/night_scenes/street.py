# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Builds a street: its ground and its end."""

from .parts import ground


def stage(scene):
    """Build road and pavements, or the paving of an alley."""
    size = scene.stage
    ground.road(size["road"], size["wall"], scene.weather.wet, far=size["far"])
    ground.beyond(size["far"], scene.weather.wet)
