# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Conditions: what goes wrong with a capture, and not with a camera."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from cg2raw.synthetic.camera import Plane
from cg2raw.synthetic.light import Field

# Of an ordinary studio. light: rms, relative, of each frame. exposure: largest relative
# error of a set. shift: largest, px, of a set. residual: px in the corner, of what is
# turned and scaled beside the shift. radiance: rms, relative, smooth, of a set's
# render. render_noise: rms, relative, of a render's pixel.
STUDIO: Mapping[str, float] = {
    "light": 0.005,
    "exposure": 0.2,
    "shift": 2.0,
    "residual": 0.2,
    "radiance": 0.01,
    "render_noise": 0.005,
}
# What the diagnosis is told may float, by what causes it.
DECLARED = {
    "light": "light",
    "exposure": "exposure",
    "shift": "registration",
    "residual": "registration",
    "radiance": "radiance",
    "render_noise": "radiance",
}


def checked(nuisances: Mapping[str, float] | None) -> dict[str, float]:
    """Return all nuisances, 0 for those not given. Raises ValueError."""
    given = dict(nuisances or {})
    for name, value in given.items():
        if name not in STUDIO:
            raise ValueError(f"nuisance {name!r} must be one of {', '.join(STUDIO)}")
        if not 0 <= value <= 10 * STUDIO[name]:
            raise ValueError(
                f"nuisance {name} = {value} must be 0 to {10 * STUDIO[name]:g}"
            )
    return {name: float(given.get(name, 0.0)) for name in STUDIO}


def declared(nuisances: Mapping[str, float]) -> frozenset[str]:
    """Return what a captures.yaml of these conditions says under `nuisance`."""
    return frozenset(DECLARED[name] for name, value in nuisances.items() if value)


def uncertainty(nuisances: Mapping[str, float]) -> dict[str, float]:
    """Return the lower bounds that a captures.yaml declares.

    None for registration: what is turned and scaled is affine, and found."""
    bounds = {"light": nuisances["light"], "radiance": nuisances["radiance"]}
    return {name: value for name, value in bounds.items() if value}


def misregistered(
    rng: Generator, scene: Plane, field: Field, nuisances: Mapping[str, float]
) -> Plane:
    """Return a scene with its margin as a camera sees it that stands a little aside."""
    distance = nuisances["shift"] * np.sqrt(rng.random())
    turn = rng.uniform(0, 2 * np.pi)
    skew = rng.standard_normal((2, 2))
    skew *= nuisances["residual"] * rng.random() / np.linalg.norm(skew) / field.corner
    dx = distance * np.cos(turn) + skew[0, 0] * field.x + skew[0, 1] * field.y
    dy = distance * np.sin(turn) + skew[1, 0] * field.x + skew[1, 1] * field.y
    if not (nuisances["shift"] or nuisances["residual"]):
        return scene
    return np.stack([field.moved(scene[..., k], dx, dy) for k in range(3)], -1)


def rendered(
    rng: Generator, scene: NDArray[Any], nuisances: Mapping[str, float]
) -> NDArray[np.float32]:
    """Return the render, (H, W, 3) float32, that is given for a scene."""
    height, width = scene.shape[:2]
    y, x = np.linspace(0, 1, height)[:, None], np.linspace(0, 1, width)[None]
    waves = [
        rng.standard_normal() * np.cos(np.pi * i * y) * np.cos(np.pi * j * x)
        for i in range(4)
        for j in range(4)
        if 0 < i + j < 4
    ]
    smooth = np.sum(waves, axis=0)
    error = nuisances["radiance"] * smooth / smooth.std()
    grain = nuisances["render_noise"] * rng.standard_normal((height, width))
    render: Plane = scene * (1 + error + grain)[..., None]
    return render.astype(np.float32)
