# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Bundled sensors, versions of OpenColorIO, and the pixels to test chains with."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import PyOpenColorIO as ocio
import pytest

import cg2raw_ocio
from cg2raw import _core
from ocio import chain_runner

SYSTEM_PYTHON = Path("/usr/bin/python3")


@pytest.fixture(scope="session")
def profiles(repository):
    """Return all bundled profiles."""
    folder = repository / "plugins" / "profiles"
    return [_core.load_profile(str(path)) for path in sorted(folder.glob("*.json"))]


@pytest.fixture(params=["this Python", "the system's Python"])
def chains_of(request, tmp_path):
    """Return run(direction, transforms, pixels): a list of results, by two versions
    of OpenColorIO: (N, 3) float32 for each transform."""
    if request.param == "this Python":
        return lambda direction, transforms, pixels: [
            chain_runner.applied(direction, t, pixels) for t in transforms
        ]
    has_ocio = [SYSTEM_PYTHON, "-c", "import PyOpenColorIO, numpy"]
    if (
        not SYSTEM_PYTHON.exists()
        or subprocess.run(has_ocio, capture_output=True).returncode
    ):
        pytest.skip(f"{SYSTEM_PYTHON} has no PyOpenColorIO: python3-pyopencolorio")
    return lambda *arguments: system_chains(tmp_path, *arguments)


def system_chains(folder, direction, transforms, pixels):
    """The same by the system's OpenColorIO, in one process."""
    given, out = folder / "given.npz", folder / "out.npz"
    chains = [(direction, chain_runner.plain(t)) for t in transforms]
    np.savez(given, chains=json.dumps(chains), pixels=pixels)
    packages = str(Path(cg2raw_ocio.__file__).parents[1])
    command = [SYSTEM_PYTHON, chain_runner.__file__, given, out]
    environment = {**os.environ, "PYTHONPATH": packages}
    subprocess.run(command, env=environment, check=True, stderr=sys.stderr)
    results = np.load(out)
    assert str(results["version"]) != ocio.__version__
    return [results[str(number)] for number in range(len(transforms))]
