# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Files that a test writes for a command or function to read."""

import json

import numpy as np
import pytest


@pytest.fixture
def written(tmp_path):
    """Return write(document or text, name): the path of a file."""

    def write(content, name="camera.json"):
        text = content if isinstance(content, str) else json.dumps(content)
        (tmp_path / name).write_text(text)
        return tmp_path / name

    return write


@pytest.fixture(scope="session")
def wheel_plugin(repository):
    """Return the folder of the plugin for OpenImageIO's wheel, or skip."""
    pytest.importorskip("OpenImageIO")
    folder = repository / "build/wheel/lib/cg2raw/oiio"
    if not (folder / "dng.imageio.so").exists():
        pytest.skip(f"no plugin for OpenImageIO's wheel in {folder}: run scripts/setup")
    return folder


@pytest.fixture(scope="module")
def scene():
    """Return a (66, 98, 3) float32 image with negative, bright, NaN and Inf pixels."""
    pixels = np.random.default_rng(1).random((66, 98, 3), dtype=np.float32) * 1.2
    pixels[3, 4] = (-0.5, 9.0, np.inf)
    pixels[5, 6, 1] = np.nan
    return pixels
