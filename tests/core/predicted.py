# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What effects are predicted to make of planted frames."""

import numpy as np

import cg2raw
from cg2raw import _core
from oracles import cameras

EFFECTS = {effect["name"]: effect for effect in cg2raw.effects()}
NEUTRAL = (0.5, 1.0, 0.7)
SHOT = {f"beta1_{site}": 2e-3 for site in ("00", "01", "10", "11")}


def values_of(name, **given):
    """Return one value per parameter of an effect, null where none is given."""
    known = {p["name"]: p["null"] for p in EFFECTS[name]["parameters"]}
    assert set(given) <= set(known), (name, given)
    return list({**known, **given}.values())


def sensor(cfa="RGGB", settings=(), **fields):
    """Return a sensor; settings are pairs of an effect and its given parameters."""
    effects = [
        {
            "name": name,
            "parameters": dict(
                zip(
                    [p["name"] for p in EFFECTS[name]["parameters"]],
                    values_of(name, **given),
                    strict=True,
                )
            ),
        }
        for name, given in settings
    ]
    text = cameras.profile_text(cfa=cfa, effects=effects, **fields)
    return cg2raw.Sensor.from_json(text)


def flat(level, height=48, width=64):
    """Return camera RGB (3, height, width) of one level."""
    return np.full((3, height, width), level, np.float32)


def noise_image(height=48, width=64, seed=3):
    """Return camera RGB (3, height, width) of independent pixels in 0.1 ... 0.9."""
    shape = (3, height, width)
    return np.random.default_rng(seed).uniform(0.1, 0.9, shape).astype(np.float32)


def predicted(camera, *settings, cfa="RGGB", exposure_time=None, of=None):
    """Return (mean, variance) in float64 of a whole frame of camera RGB (3, H, W)."""
    camera = np.asarray(camera, np.float32)
    mean, variance, _ = _core.predict_blocks(
        (of or sensor(cfa)).profile,
        [(name, values_of(name, **given)) for name, given in settings],
        camera[None],
        np.zeros((1, 2), np.int32),
        camera.shape[1:],
        0,
        NEUTRAL,
        exposure_time,
        _core.glare_context(camera),
    )
    return np.asarray(mean[0], float), np.asarray(variance[0], float)


def planes(camera, name, **given):
    """Return what an effect makes of three planes of light (3, H, W).

    A mosaic shows each colour at its sites: the four phases of the CFA show all."""
    seen = np.full(np.shape(camera), np.nan)
    for cfa in ("RGGB", "GRBG", "GBRG", "BGGR"):
        mean, _ = predicted(camera, (name, given), cfa=cfa)
        for row in (0, 1):
            for col in (0, 1):
                color = "RGB".index(cfa[2 * row + col])
                seen[color, row::2, col::2] = mean[row::2, col::2]
    assert np.isfinite(seen).all()
    return seen


def field(height, width):
    """Return u (1, width) and v (height, 1), offsets in half diagonals."""
    half = np.hypot(width, height) / 2.0
    u = (np.arange(width)[None, :] + 0.5 - width / 2.0) / half
    v = (np.arange(height)[:, None] + 0.5 - height / 2.0) / half
    return u, v


def drawn(level, settings, rows=1000, cols=400, **run):
    """A drawn frame of one level, camera RGB given."""
    image = np.full((rows, cols, 3), level, np.float32)
    planted = sensor(settings=settings)
    how = {"illuminant": "D65", "camera_input": True, "seed": 3, **run}
    mean, variance = (np.asarray(x, float) for x in planted.predict(image, **how))
    return np.asarray(planted.signal(image, **how), float), mean, variance


def deviates(count, sigmas=5):
    """Bounds of a mean and of a variance of normals, relative to sigma."""
    return sigmas / np.sqrt(count), sigmas * np.sqrt(2 / count)
