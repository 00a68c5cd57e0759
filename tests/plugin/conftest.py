# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The scene that the tests of the plugin write."""

import numpy as np
import pytest

import cg2raw
from images import write_image
from spectral_files import random_spectra


@pytest.fixture(scope="session")
def scene():
    """Return a (96, 128, 3) float32 image: ramps, saturated colours and highlights."""
    rows, cols = np.mgrid[0:96, 0:128].astype(np.float32)
    random = np.random.default_rng(1).random((96, 128, 3), dtype=np.float32)
    ramps = np.stack([cols / 127, rows / 95, (rows + cols) / 222], axis=-1)
    pixels = ramps * 0.8 + random * 0.2
    pixels[40:60, 40:60] *= 6.0
    return pixels.astype(np.float32)


@pytest.fixture(scope="session")
def writing_openimageio():
    """Let the OpenImageIO of this Python write DNGs, or skip."""
    try:
        cg2raw.register_oiio_plugin()
    except ValueError as error:
        pytest.skip(str(error))


@pytest.fixture(scope="session")
def spectra():
    """Return (40, 56, N) spectra: smooth ones, and lines."""
    return random_spectra()


@pytest.fixture
def exr(tmp_path, scene):
    """Return the path of the scene as a float OpenEXR file."""
    return write_image(tmp_path / "scene.exr", scene)


@pytest.fixture
def ours(oiiotool):
    """Return ours(path): a name by which this oiiotool's choice is our reader.

    LibRaw's reader, of the system's, keeps the ending .dng."""

    def link(path):
        if oiiotool.name == "oiio-wheel":
            return path
        other = path.with_suffix(".cg2raw")
        other.unlink(missing_ok=True)
        other.symlink_to(path)
        return other

    return link
