# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Pixels through OpenColorIO, the core's answer, and the system's OpenColorIO 2.1."""

import os
import subprocess
from pathlib import Path

import numpy as np
import PyOpenColorIO as ocio
import pytest

from cg2raw import _core

DN = 65535
SCENE = "Linear Rec.709 (sRGB)"
SYSTEM_PYTHON = Path("/usr/bin/python3")


def pixels(count=20000, low=-0.05, high=1.1):
    """Return (count, 3) float32 scene-linear pixels, some of them out of 0..1."""
    random = np.random.default_rng(5).random((count, 3))
    return (low + (high - low) * random).astype(np.float32)


def through(processor, rgb):
    """Return (n, 3) pixels through an OCIO processor, on the CPU."""
    image = np.ones((len(rgb), 4), np.float32)
    image[:, :3] = rgb
    cpu = processor.getDefaultCPUProcessor()
    cpu.apply(ocio.PackedImageDesc(image, len(image), 1, 4))
    return image[:, :3]


def converted(config, source, target, rgb):
    """Return (n, 3) pixels from one space of a config to another."""
    return through(config.getProcessor(source, target), rgb)


def through_file(path, rgb):
    """Return (n, 3) pixels through a LUT or transform file."""
    file = ocio.FileTransform(str(path), interpolation=ocio.INTERP_LINEAR)
    return through(ocio.Config.CreateRaw().getProcessor(file), rgb)


def camera(sensor, illuminant, rgb, convention="dng", gain=1.0, highlights=True):
    """Return (n, 3) camera RGB of linear Rec.709, by the core."""
    profile = _core.load_profile(sensor)
    light = profile.illuminant(illuminant)
    transform = _core.camera_from_scene(profile, light, convention, gain, highlights)
    return _core.to_camera(transform, np.asarray(rgb, np.float32)[None])[0]


def difference(found, expected):
    """Return the largest difference of two images, DN of 16 bits."""
    return np.abs(found.astype(float) - expected).max() * DN


def system_python(build, *arguments, check=True, **keywords):
    """Run Debian's Python, with its PyOpenColorIO 2.1, or skip the test."""
    environment = {**os.environ, "PYTHONPATH": str(build / "lib/python")}
    environment.update(keywords.pop("env", {}))
    command = [SYSTEM_PYTHON, *map(str, arguments)]
    needed = "import numpy, PyOpenColorIO, cg2raw._core"
    for words, skip in (([SYSTEM_PYTHON, "-c", needed], True), (command, False)):
        if skip and not SYSTEM_PYTHON.exists():
            pytest.skip(f"no {SYSTEM_PYTHON}")
        done = subprocess.run(
            words, env=environment, text=True, capture_output=True, **keywords
        )
        if skip and done.returncode:
            pytest.skip(f"{SYSTEM_PYTHON}: {done.stderr.splitlines()[-1]}")
    if check:
        assert done.returncode == 0, done.stderr
    return done
