# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The evidence study's package, which no wheel has, its world and its cameras."""

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
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


GAPS = {  # of a source to real
    "real": 0.0,
    "real, other scenes": 0.1,
    "ours, dng": 0.2,
    "ours, paper": 0.5,
    "ours, spectral": 0.15,
    "upi, published": 2.0,
    "upi, camera": 1.0,
    "upi, graphics2raw": 1.2,
    "upi's matrices, our lights": 0.3,
    "translation, graphics2raw": 1.5,
}
CONDITIONS = ("ISO 1600, brightness 0.35", "ISO 1600, brightness 0.03")
CAMERAS = ("sony-a7s-ii", "nikon-d850")
DRAWS, FRAMES = 2, 8


def errors(seed):
    """Return {source: (draws, frames)}: alike noise, whose mean is 0, over each gap."""
    rng = np.random.default_rng(seed)
    base = 3.0 + rng.random((DRAWS, FRAMES))
    found = {}
    for source, gap in GAPS.items():
        noise = rng.normal(0.0, 0.05, (DRAWS, FRAMES)) if gap else np.zeros(1)
        found[source] = (base + gap + noise - noise.mean()).tolist()
    return found


def measures(seed):
    """Return {source: {measure: (draws, frames)}}; PSNR falls as errors rise."""
    return {
        source: {
            "difference": values,
            "psnr": (40.0 - np.array(values)).tolist(),
            "ssim": (1.0 - np.array(values) / 100.0).tolist(),
        }
        for source, values in errors(seed).items()
    }


@pytest.fixture(scope="session")
def planted():
    """Return results of what is learnt whose gaps to real are known, and those gaps."""
    cameras = {
        camera: {
            "hash": "planted",
            "studies": {
                "illuminant": errors(seed),
                "isp": measures(seed),
                "denoising": {condition: measures(seed) for condition in CONDITIONS},
            },
        }
        for seed, camera in enumerate(CAMERAS)
    }
    results = {"fingerprint": {}, "cameras": cameras}
    return SimpleNamespace(
        gaps=GAPS,
        sources=list(GAPS),
        cameras=list(CAMERAS),
        conditions=CONDITIONS,
        results=results,
    )
