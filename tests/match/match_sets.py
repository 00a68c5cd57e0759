# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Sets of captures and renders whose exposures and tone are known."""

import json

import numpy as np

from cg2raw import Sensor
from cg2raw.match import look
from cg2raw.match.frame import REC709
from cg2raw.match.renders import Model, simulated

SHAPE = (128, 192)
LIGHTS = ("A", "D65", "3200K", "2500K", "5500K")
MEDIAN, SPREAD = 1.5, 0.7  # stops
LEVEL = -5.0  # stops of the scenes' median


def match_file(folder, **changes):
    """Return the exposure of a file of cg2raw match, with other fields.

    Captures are brighter by two stops in the median, and twice as far apart or more."""
    found = {
        "sensor": "samsung-s20fe",
        "exposure": {"quantiles": [[0, -1], [0.5, 1], [1, 2]]},
        "levels": {
            "captures": [[0, -9], [0.5, -3], [1, -1]],
            "renders": [[0, -7], [0.5, -5], [1, -4]],
        },
    }
    path = folder / "match.json"
    path.write_text(json.dumps(found | changes))
    return f"match:{path}"


def scene(rng, spread, level=LEVEL, shape=SHAPE):
    """Return (H, W, 3) linear light: textures of many scales, areas of their own
    brightness, a gradient, lamps, hues.

    spread : stops, standard deviation of the level between scenes."""
    height, width = shape
    frequency = np.hypot(np.fft.fftfreq(height)[:, None], np.fft.rfftfreq(width))
    frequency[0, 0] = 1

    def texture(slope, shape=shape):
        white = np.fft.rfft2(rng.normal(size=shape))
        values = np.fft.irfft2(white / frequency**slope, shape[-2:])
        return (values - values.mean()) / values.std()

    stops = texture(rng.uniform(1, 1.8)) * rng.uniform(0.6, 1.6)
    for _ in range(rng.integers(2, 8)):
        top, left = rng.integers(0, height), rng.integers(0, width)
        down, across = rng.integers(5, height // 2), rng.integers(5, width // 2)
        stops[top : top + down, left : left + across] += rng.normal(0, 1.5)
    stops += np.linspace(rng.uniform(0, 2), -rng.uniform(0, 2), height)[:, None]
    stops += level + spread * rng.normal() - np.median(stops)
    light = 2.0**stops
    rows, cols = np.mgrid[:height, :width]
    for _ in range(rng.integers(0, 6)):
        row, col, radius = (rng.uniform(0, side) for side in (height, width, 4))
        away = ((rows - row) ** 2 + (cols - col) ** 2) / (radius + 0.5) ** 2
        light += 2.0 ** (level + rng.uniform(4, 9)) * np.exp(-away / 2)
    hues = np.moveaxis(texture(1.5, (3, *shape)), 0, -1) * rng.uniform(0.1, 0.6)
    rgb = 2.0**hues
    return (rgb * (light / (rgb @ REC709))[..., None]).astype(np.float32)


def toned(rgb, contrast=1.0, saturation=1.0):
    """Return an image with another contrast around its median luminance, and another
    saturation around luminance."""
    luminance = rgb @ REC709
    middle = np.median(luminance)
    other = (middle * (luminance / middle) ** contrast)[..., None]
    colours = other + (rgb * other / luminance[..., None] - other) * saturation
    return np.maximum(colours, 0).astype(np.float32)


def sets(
    rng,
    sensor="canon-700d",
    count=200,
    scenes=0.3,
    shared=False,
    median=MEDIAN,
    spread=SPREAD,
    contrast=1.25,
    saturation=1.4,
):
    """Return (Frames of captures, of renders, the captures' exposures).

    scenes : stops between scenes. shared : both sets show the same ones."""
    sensor = Sensor(sensor)
    iso = 800 if sensor.noise else None
    of_captures = [scene(rng, scenes) for _ in range(count)]
    of_renders = of_captures if shared else [scene(rng, scenes) for _ in range(count)]
    exposures = rng.normal(median, spread, count)
    captures = []
    for index, exposure in enumerate(exposures):
        word = LIGHTS[rng.integers(len(LIGHTS))]
        image = toned(of_captures[index], contrast, saturation) * 2.0**exposure
        raw = sensor.simulate(
            image.astype(np.float32), illuminant=word, iso=iso, seed=9, frame=index
        )
        light = sensor.illuminant(word)
        captures.append(look(f"{index}", np.asarray(raw), sensor, light))
    model = Model(sensor, ("D65", "3200K"), iso)
    order = rng.permutation(count)
    renders = [simulated(f"{i}", of_renders[i], int(i), model) for i in order]
    return captures, renders, exposures
