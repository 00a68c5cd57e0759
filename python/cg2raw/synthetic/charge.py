# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""From light on the sensor to electrons in its pixels; the patterns of one sensor."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.stats import invgauss

from cg2raw.synthetic.camera import Camera, Plane
from cg2raw.synthetic.light import Hidden, Values

HIGHEST_WAVE = 8  # of a lamp's light, of its first


@dataclass(frozen=True)
class Patterns:
    """What differs from pixel to pixel and is the same in all frames.

    gain : (H, W) relative, 0 on average. leak : (H, W) electrons per second, of which
    those of an uneven dark current are 0 on average.
    offset : (H, W) electrons at read-out. column : (W,) electrons at read-out.
    hot : (H, W) whether a pixel is.
    """

    gain: Plane
    leak: Plane
    offset: Plane
    column: Plane
    hot: NDArray[np.bool_]

    @staticmethod
    def none(shape: tuple[int, int]) -> "Patterns":
        zeros = np.zeros(shape)
        return Patterns(zeros, zeros, zeros, np.zeros(shape[1]), zeros > 0)


def patterns(
    rng: Generator, shape: tuple[int, int], hidden: Hidden, camera: Camera
) -> Patterns:
    """Draw the patterns of one sensor."""
    drawn = Patterns.none(shape)
    read = float(camera.read_noise.mean())
    if "prnu" in hidden:  # lognormal: gains are products
        sigma = hidden["prnu"]["sigma"]
        gain = np.expm1(sigma * rng.standard_normal(shape) - sigma**2 / 2)
        drawn = replace(drawn, gain=gain)
    if "dsnu" in hidden:  # leakage has a tail to one side: gamma
        v = hidden["dsnu"]
        gamma = rng.gamma(v["shape"], size=shape) - v["shape"]
        drawn = replace(
            drawn, offset=v["read_noises"] * read * gamma / v["shape"] ** 0.5
        )
    if "column_gain" in hidden:
        lines = hidden["column_gain"]["rms"] * rng.standard_normal(shape[1])
        drawn = replace(drawn, gain=drawn.gain + lines)
    if "column_fixed_pattern" in hidden:
        half = np.sqrt(3) * hidden["column_fixed_pattern"]["read_noises"] * read
        drawn = replace(drawn, column=rng.uniform(-half, half, shape[1]))
    if "hot_pixels" in hidden:
        v = hidden["hot_pixels"]
        hot = rng.random(shape) < v["share"]
        rate = v["electrons_per_second"] * rng.exponential(size=shape)
        drawn = replace(drawn, leak=np.where(hot, rate, 0.0), hot=hot)
    if "dark_current_nonuniformity" in hidden:
        law = uneven_dark(hidden["dark_current_nonuniformity"])
        uneven = law.rvs(size=shape, random_state=rng) - law.mean()
        drawn = replace(drawn, leak=drawn.leak + uneven)
    return drawn


def uneven_dark(values: Values) -> Any:
    """Return the law of pixels' dark current, electrons/s, with a median: inverse
    Gaussian, the time that a random walk takes to a place.

    Source: R. L. Baer, Proc. SPIE 6068, 2006."""
    skew = values["skew"]
    scale = values["electrons_per_second"] / float(invgauss.median(skew))
    return invgauss(skew, scale=scale)


def glow(values: Values, shape: tuple[int, int]) -> Plane:
    """Return electrons/s that an amplifier's light leaves in (H, W) pixels."""
    height, width = shape
    down = np.arange(height)[:, None] + 0.5 - values["down"] * height
    across = np.arange(width)[None] + 0.5 - values["across"] * width
    reach = values["fades_over"] * np.hypot(height, width)
    fading: Plane = np.exp(-np.hypot(down, across) / reach)
    return values["electrons_per_second"] * fading


def mosaic_light(
    rgb: Plane, hidden: Hidden, camera: Camera, flicker_phase: float
) -> Plane:
    """Return the light that each pixel collects, (H, W), white at 1."""
    x = camera.mosaic(rgb)
    if "mains_flicker" in hidden:
        x = x * _mains(hidden["mains_flicker"], flicker_phase, x.shape[0])[:, None]
    if "crosstalk" in hidden:
        v = hidden["crosstalk"]
        p = np.pad(x, 1, "reflect")
        shares = (v["from_left"], v["from_right"], v["from_above"], v["from_below"])
        near = (p[1:-1, :-2], p[1:-1, 2:], p[:-2, 1:-1], p[2:, 1:-1])
        x = x * (1 - sum(shares)) + sum(
            s * n for s, n in zip(shares, near, strict=True)
        )
    if "gr_gb_imbalance" in hidden:
        x = x * camera.over(_green_gains(camera, hidden["gr_gb_imbalance"]), x.shape)
    if "pdaf_pixels" in hidden:
        v = hidden["pdaf_pixels"]
        rows, cols = np.indices(x.shape)
        shaded = (rows % v["period"] == v["row"]) & (cols % v["period"] == v["column"])
        side = 2 * cols / (x.shape[1] - 1) - 1  # -1 at the left edge, 1 at the right
        x = np.where(shaded, (1 - v["loss"] * (1 + v["tilt"] * side)) * x, x)
    if "smear" in hidden:
        x = x + hidden["smear"]["share"] * x.mean(0)
    if "amplifier_mismatch" in hidden:
        v = hidden["amplifier_mismatch"]
        x = x * (1 + v["gain"] * _amplifier(v, x.shape))
    return x


def _amplifier(values: Values, shape: tuple[int, ...]) -> Plane:
    """Return (H, W) -0.5 where the first of two amplifiers reads, and 0.5."""
    side = 0 if values["one_above_the_other"] else 1
    return np.where(np.indices(shape)[side] < shape[side] // 2, -0.5, 0.5)


def _mains(values: Values, phase: float, rows: int) -> Plane:
    """Return (rows,) the light of a lamp on rectified mains, 1 on average.

    |sin| by its Fourier series, exposed for a share of a wave; its swing is that of the
    first wave."""
    turns = np.arange(rows) / values["rows"] + phase
    waves = np.arange(1, HIGHEST_WAVE + 1)
    heights = np.sinc(waves * values["exposed"]) / (4 * waves**2 - 1)
    light = np.cos(2 * np.pi * waves * turns[:, None]) @ heights
    swung: Plane = 1 - values["swing"] * light / heights[0]
    return swung


def _green_gains(camera: Camera, values: Values) -> Plane:
    """Greens in red rows and in blue rows differ by split, shared unevenly."""
    gains = np.ones((2, 2))
    for row in range(2):
        in_red_row = 0 in camera.colors[row]
        share = values["lean"] if in_red_row else values["lean"] - 1
        gains[row, camera.colors[row] == 1] += values["split"] * share
    return gains


def electrons(
    x: Plane, hidden: Hidden, camera: Camera, fixed: Patterns, seconds: float
) -> Plane:
    """Return the expected charge, (H, W) electrons, of a mosaic of light."""
    full: Plane = camera.over(camera.full_well, x.shape)
    dark = fixed.leak + camera.dark
    if "dark_current" in hidden:
        dark = dark + hidden["dark_current"]["electrons_per_second"]
    if "dark_current_nonuniformity" in hidden:  # the profile knows the median
        law = uneven_dark(hidden["dark_current_nonuniformity"])
        dark = dark + float(law.mean() - law.median())
    if "amplifier_glow" in hidden:
        dark = dark + glow(hidden["amplifier_glow"], x.shape)
    charge: Plane = np.maximum(full * x * (1 + fixed.gain) + dark * seconds, 0.0)
    if "nonlinearity" not in hidden:
        return charge
    v = hidden["nonlinearity"]
    if v["power"] == 0:  # pixels that fill up: 1 - exp
        scale = _filling_scale(v["loss"])
        return full * -np.expm1(-charge / full * scale) / scale
    level = np.minimum(charge / full, 1.5)
    return charge * (1 - v["loss"] * level ** v["power"])


def _filling_scale(loss: float) -> float:
    """Return s with (1 - exp(-s)) / s = 1 - loss, by Newton's method."""
    s = 2 * loss
    for _ in range(20):
        value = -np.expm1(-s) / s - (1 - loss)
        s -= value / ((np.exp(-s) * (1 + s) - 1) / s**2)
    return s


def pedestal(
    hidden: Hidden, camera: Camera, fixed: Patterns, shape: tuple[int, int]
) -> Plane:
    """Return the expected DN without charge, (H, W)."""
    black = camera.over(camera.black, shape)
    if "black_level" in hidden:
        v = hidden["black_level"]
        shift = [v[f"dn_{row}{col}"] for row in range(2) for col in range(2)]
        black = black + camera.over(np.reshape(shift, (2, 2)), shape)
    if "bias_structure" in hidden:
        black = black + _structure(hidden["bias_structure"], shape)
    gain = camera.over(camera.dn_per_electron, shape)
    if "amplifier_mismatch" in hidden:
        v = hidden["amplifier_mismatch"]
        offset = v["read_noises"] * camera.read_noise.mean()
        black = black + gain * offset * _amplifier(v, shape)
    return black + gain * (fixed.offset + fixed.column)


def _structure(values: Values, shape: tuple[int, int]) -> Plane:
    """Return (H, W) DN: a plane, and first columns that settle by halves."""
    down, across = (np.linspace(-0.5, 0.5, n) for n in shape)
    settling = values["first_dn"] * 0.5 ** (np.arange(shape[1]) / values["half_px"])
    structure: Plane = values["right_dn"] * across + settling
    return structure + values["down_dn"] * down[:, None]
