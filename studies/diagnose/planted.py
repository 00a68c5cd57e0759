# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Planted: one effect put into the pixel values of real darks and flats.

By what each effect does to charge and level, and not by the registry: light that is
lost thins photo-electrons binomially, charge that is added is Poisson distributed.
Strengths are those of synthetic.strengths.KINDS, in their units."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.signal import lfilter

from cg2raw.arrays import RawImage
from cg2raw.diagnose.captures.capture import Capture
from cg2raw.sensor import Sensor
from cg2raw.synthetic.synthetic_camera import stream

Plane = NDArray[np.float64]

HOT_RATES = (20.0, 150.0)  # electrons/s, of the mean hot pixel; as the generator's
# Variance of the noisy pixels' noise over the others'; as the generator's.
NOISY = (5.0, 25.0)
FULL = 1.02  # of the brightest level, where a full well of strength 0 would lie


@dataclass(frozen=True)
class Levels:
    """What a planted effect has to know of a sensor: (H, W) black in DN, DN per
    electron, read noise in DN and its correlation with that of the next pixel of the
    row, white in DN, and the brightest flat in DN above black, 0 without flats."""

    black: Plane
    dn_per_electron: float
    read_noise: float
    white: int
    brightest: float
    correlation: float = 0.0


@dataclass(frozen=True)
class Exposure:
    """One real frame and the random numbers of what is planted in it.

    level : (H, W) DN above black. seconds : its exposure time. light : whether it has
    any. sensor : numbers that are the same for all frames. own : of this frame alone.
    """

    level: Plane
    seconds: float
    light: bool
    sensor: Generator
    own: Generator


Plant = Callable[[Exposure, float, Levels], Plane]


def levels_of(sensor: Sensor, iso: float, captures: list[Capture]) -> Levels:
    """Return the levels of a calibrated sensor's captures."""
    shape = captures[0].shape
    side = round(len(sensor.black_level) ** 0.5)
    tile = np.reshape(np.array(sensor.black_level, float), (side, side))
    repeats = (-(-shape[0] // side), -(-shape[1] // side))
    black = np.tile(tile, repeats)[: shape[0], : shape[1]]
    reach = sensor.white_level - float(tile.mean())
    row = sensor.noise_at(iso)
    stated = [e for e in sensor.effects if e["name"] == "read_noise_correlation"]
    flats = [c for c in captures if c.shows.light]
    brightest = [float(np.median(flat.raw() - black)) for flat in flats]
    return Levels(
        black,
        float(np.mean(row["beta1"])) * reach,
        float(np.sqrt(np.mean(row["beta2"]))) * reach,
        sensor.white_level,
        max(brightest, default=0.0),
        next((e["parameters"]["coefficient"] for e in stated), 0.0),
    )


def planted(
    capture: Capture, name: str, strength: float, levels: Levels, seed: int
) -> RawImage:
    """Return a frame with an effect planted, (H, W) DN, rounded and cut at 0 and white.

    name : of PLANTS. strength : of it; its sign, where it has one, is the seed's."""
    shot = Exposure(
        capture.raw() - levels.black,
        capture.exposure_time or 0.0,
        capture.shows.light,
        stream(seed, f"planted/{name}"),
        stream(seed, f"planted/{name}/{capture.name}"),
    )
    level = PLANTS[name](shot, strength, levels) + levels.black
    whole: Plane = np.clip(np.floor(level + 0.5), 0, levels.white)
    return whole.astype(np.uint16)


def _thinned(shot: Exposure, kept: Plane | float, levels: Levels) -> Plane:
    """Return a level of which each photo-electron is kept with a probability: binomial,
    in its normal limit. Read noise, which is not thinned, is filled up."""
    if not shot.light:
        return shot.level
    gain = levels.dn_per_electron
    electrons = np.maximum(shot.level, 0.0) / gain
    spread = gain**2 * kept * (1 - kept) * electrons
    spread = spread + (1 - kept**2) * levels.read_noise**2
    normal = shot.own.standard_normal(shot.level.shape)
    result: Plane = shot.level * kept + np.sqrt(spread) * normal
    return result


def _exposure(shot: Exposure, s: float, levels: Levels) -> Plane:
    return _thinned(shot, 1 - s, levels)


def _lens_shading(shot: Exposure, s: float, levels: Levels) -> Plane:
    """cos^4 law, with the loss s in the corner."""
    height, width = shot.level.shape
    y = (np.arange(height)[:, None] + 0.5 - height / 2) / (height / 2)
    x = (np.arange(width)[None, :] + 0.5 - width / 2) / (width / 2)
    ratio = height / width
    square = (x**2 + (ratio * y) ** 2) / (1 + ratio**2)
    tangent = 1 / np.sqrt(1 - s) - 1  # its square, in the corner
    return _thinned(shot, (1 + tangent * square) ** -2, levels)


def _prnu(shot: Exposure, s: float, levels: Levels) -> Plane:
    """A factor per pixel, lognormal; noise is scaled with it, s^2 too much in all."""
    normal = shot.sensor.standard_normal(shot.level.shape)
    factor = np.exp(s * normal - s * s / 2)
    return shot.level * factor if shot.light else shot.level


def _charge(shot: Exposure, rate: Plane | float, levels: Levels) -> Plane:
    """Return a level with charge of (electrons/s) added."""
    mean = np.broadcast_to(np.asarray(rate * shot.seconds, float), shot.level.shape)
    return shot.level + levels.dn_per_electron * shot.own.poisson(mean)


def _hot_pixels(shot: Exposure, s: float, levels: Levels) -> Plane:
    shape = shot.level.shape
    hot = shot.sensor.random(shape) < s
    mean = np.exp(shot.sensor.uniform(*np.log(HOT_RATES)))
    rate = mean * shot.sensor.exponential(size=shape)
    return _charge(shot, np.where(hot, rate, 0.0), levels)


def _nonlinearity(shot: Exposure, s: float, levels: Levels) -> Plane:
    """The brightest flat loses the share s, others in proportion to their level."""
    share = s / max(levels.brightest, 1.0)
    return shot.level * (1 - share * np.maximum(shot.level, 0.0))


def _full_well(shot: Exposure, s: float, levels: Levels) -> Plane:
    """A ceiling of charge below the brightest level; what is read there has the read
    noise alone."""
    ceiling = FULL * (1 - s) * levels.brightest
    noise = levels.read_noise * shot.own.standard_normal(shot.level.shape)
    return np.where(shot.level > ceiling, ceiling + noise, shot.level)


def _shot_noise(shot: Exposure, s: float, levels: Levels) -> Plane:
    """Charge thinned to exp(-s) of it and read with a gain as much larger: of the same
    level, and of exp(s) times its shot noise. Charge is that of the level without read
    noise: of a dark its mean."""
    gain = levels.dn_per_electron
    charge = shot.level if shot.light else np.full_like(shot.level, shot.level.mean())
    variance = np.expm1(s) * gain * np.maximum(charge, 0.0)
    normal = shot.own.standard_normal(shot.level.shape)
    level: Plane = shot.level + np.sqrt(variance) * normal
    return level


def _along_rows(noise: Plane, levels: Levels) -> Plane:
    """Return noise of the same variance, correlated as the sensor's read noise is."""
    rho = levels.correlation
    noise[:, 1:] *= np.sqrt(1 - rho**2)
    found: Plane = lfilter([1.0], [1.0, -rho], noise, axis=1)
    return found


def _read_noise(shot: Exposure, s: float, levels: Levels) -> Plane:
    size = np.sqrt(np.expm1(s)) * levels.read_noise
    noise = size * shot.own.standard_normal(shot.level.shape)
    return shot.level + _along_rows(noise, levels)


def _heavy_tailed_noise(shot: Exposure, s: float, levels: Levels) -> Plane:
    """A share of the draws is wider; the others stay, and the variance grows. What is
    added has the correlation of read noise."""
    shape = shot.level.shape
    ratio = np.exp(shot.sensor.uniform(*np.log(NOISY)))
    noisy = shot.own.random(shape) < s
    size = np.sqrt(ratio - 1) * levels.read_noise
    more = np.where(noisy, size * shot.own.standard_normal(shape), 0.0)
    return shot.level + _along_rows(more, levels)


def _row_noise(shot: Exposure, s: float, levels: Levels) -> Plane:
    rows = shot.own.standard_normal((shot.level.shape[0], 1))
    level: Plane = shot.level + s * levels.read_noise * rows
    return level


def _column_fixed_pattern(shot: Exposure, s: float, levels: Levels) -> Plane:
    columns = shot.sensor.standard_normal((1, shot.level.shape[1]))
    level: Plane = shot.level + s * levels.read_noise * columns
    return level


def _dsnu(shot: Exposure, s: float, levels: Levels) -> Plane:
    offsets = shot.sensor.standard_normal(shot.level.shape)
    return shot.level + s * levels.read_noise * offsets


def _black_level(shot: Exposure, s: float, levels: Levels) -> Plane:
    sign = float(shot.sensor.choice([-1.0, 1.0]))
    return shot.level + sign * s * levels.read_noise


def _noise_reduction(shot: Exposure, s: float, _: Levels) -> Plane:
    """Each pixel blends with the four nearest of its colour in a Bayer pattern."""
    p = np.pad(shot.level, 2, "reflect")
    near = p[2:-2, :-4] + p[2:-2, 4:] + p[:-4, 2:-2] + p[4:, 2:-2]
    mixed: Plane = (1 - s) * shot.level + s * near / 4
    return mixed


PLANTS: Mapping[str, Plant] = {
    "exposure": _exposure,
    "lens_shading": _lens_shading,
    "prnu": _prnu,
    "dark_current": _charge,
    "hot_pixels": _hot_pixels,
    "nonlinearity": _nonlinearity,
    "full_well": _full_well,
    "shot_noise": _shot_noise,
    "read_noise": _read_noise,
    "heavy_tailed_noise": _heavy_tailed_noise,
    "row_noise": _row_noise,
    "column_fixed_pattern": _column_fixed_pattern,
    "dsnu": _dsnu,
    "black_level": _black_level,
    "noise_reduction": _noise_reduction,
}
