# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The evidence study's package, which no wheel has, its world and its cameras."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# At the end: python/cg2raw there lacks the compiled core.
sys.path += [str(ROOT / "python"), str(ROOT / "scripts" / "studies")]


@pytest.fixture(scope="session")
def world():
    """Return the World of luxpy's data files if found, else the small one."""
    from studies.places import luxpy_folder
    from studies.world.shots import load_world

    return load_world(luxpy_folder())


@pytest.fixture(scope="session")
def camera_of(camera_data):
    """Return camera_of(id): a Camera; skipped without camera data."""
    from studies.cameras import known_camera

    return lambda name: known_camera(name, camera_data)
