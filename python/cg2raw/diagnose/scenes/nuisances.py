# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Nuisances: what is wrong with a capture and not with the camera, as columns.

Each is a change of the light that enters the lens, known to be 0 up to a deviation:
where the render lies, how sharp and how bright it is, of which colour, and its smooth
error. None of it is written to a profile.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import legval
from scipy import fft
from scipy.ndimage import correlate1d

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.effects import mains_flicker
from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.model.amplifier_mismatch import NAME as MISMATCH
from cg2raw.model.flicker import NAME as FLICKER
from cg2raw.normal import CI95
from cg2raw.sensor import Sensor

FREE = 1.0  # relative deviation of light that nobody measured
POSE_DEVIATION = 1.0  # px, beside the place that correlation found
# Of a render's sharpness, by the Laplacian and its square: an edge that is sampled
# coarsely cannot be moved by part of a pixel exactly.
SHARPNESS = (0.004, 0.002)
# Share of light that a round aperture spreads beyond the reach of blur, as 1 / r^3: of
# one that passes 2 cycles a pixel. Source: M. Born, E. Wolf, Principles of Optics,
# section 8.5.2.
WINGS, FIRST_OF_WINGS, LAST_OF_WINGS = 0.01, 10.0, 64.0  # -, px, px
# Of the polynomials of a smooth error of light, each of which may be as large as is
# declared: nobody knows how smooth it is.
DEGREES = 6
# Relative, if none is declared: of light from frame to frame, of a render's smooth
# error, and of the light on a chart, which lamps make even to some per cent.
LEAST_DOUBT = {"light": 0.005, "radiance": 0.01}
UNEVEN_CHART = 0.05
UNSEEN = FLICKER, MISMATCH  # effects that some images have and do not show
HALF_WAVES = 8  # of light down a frame: those of which smooth shading may be made
SLOPE = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60  # derivative, to the sixth order


@dataclass(frozen=True)
class Nuisance:
    """One column. own : each view has its own; else all of a set have it together.

    change : (T, 3, H, W) of the camera RGB of blocks. down, across : (T, h, 1) and
    (T, 1, w), by which what it does to samples is multiplied: they hardly differ over
    the reach of a lens."""

    name: str
    deviation: float
    own: bool
    change: Array
    down: Array | float = 1.0
    across: Array | float = 1.0


def nuisances_of(
    capture_set: CaptureSet,
    frame: Frame,
    n: int,
    flicker: Sequence[float] | Array | None = None,
    is_blurred: bool = False,
    doubt: str = "",
) -> Iterator[Nuisance]:
    """Yield the nuisances of a view of n frames, as its render lies.

    flicker : amplitude and period of that of the light. is_blurred : by the lens of the
    model, whose far wings no effect has. doubt : one of UNSEEN, of any strength."""
    free, shows = capture_set.nuisances, frame.capture.shows
    if not shows.light:
        return
    least = {**LEAST_DOUBT, **capture_set.uncertainty}
    if not shows.render and "radiance" not in capture_set.uncertainty:
        least["radiance"] = UNEVEN_CHART
    camera = frame.camera.astype(np.float64)
    is_table = frame.samples is not None
    v, u = frame.tiles.places()
    if flicker is not None:
        with_margin, _ = frame.tiles.places(with_margin=True)
        rows = with_margin * np.hypot(*frame.tiles.shape) / 2
        for k, wave in enumerate(mains_flicker.EFFECT.waves(flicker, rows)):
            change = camera * wave[:, None]
            yield Nuisance(f"flicker {k}", 1 / np.sqrt(n), True, change)
    if frame.level_free and is_table:
        yield Nuisance("level", FREE, True, camera)
    elif frame.level_free or "white_balance" in free:
        for channel, name in enumerate(("red", "green", "blue")):
            change = np.zeros_like(camera)
            change[:, channel] = camera[:, channel]
            yield Nuisance(name, FREE, frame.level_free, change)
    elif "exposure" in free:
        yield Nuisance("exposure", FREE, False, camera)
    if "light" in free:
        yield Nuisance("light", least["light"] / np.sqrt(n), True, camera)
    if is_table:
        return
    if doubt == MISMATCH:
        for name, change in ("response", camera), ("offset", np.ones_like(camera)):
            yield Nuisance(f"{name} down", FREE, False, change, np.sign(v))
            yield Nuisance(f"{name} across", FREE, False, change, 1.0, np.sign(u))
    if doubt == FLICKER:
        turns = v * np.hypot(*frame.tiles.shape) / frame.tiles.shape[0] + 1
        for k in range(1, HALF_WAVES + 1):
            wave = np.cos(k * np.pi / 2 * turns)
            yield Nuisance(f"wave {k}", FREE, True, camera, wave)
    if shows.image and "radiance" in free:
        y, x = to_edge(v), to_edge(u)
        for a, b in fields(DEGREES):
            sides = legendre(a, y), legendre(b, x)
            yield Nuisance(f"field {a} {b}", least["radiance"], False, camera, *sides)
    if shows.render and is_blurred:
        yield Nuisance("wings of blur", WINGS, False, wings(camera))
    if shows.render and "registration" in free:
        for name, axis in (("row", 2), ("column", 3)):
            slope = correlate1d(camera, SLOPE, axis=axis, mode="nearest")
            for place, *by in (("", 1.0, 1.0), (" v", v, 1.0), (" u", 1.0, u)):
                yield Nuisance(name + place, POSE_DEVIATION, False, slope, *by)
        once = laplacian(camera)
        for name, change, deviation in zip(
            ("sharpness", "fine sharpness"),
            (once, laplacian(once)),
            SHARPNESS,
            strict=True,
        ):
            yield Nuisance(name, deviation, False, change)


def known_effects(sensor: Sensor) -> dict[Effect, Array]:
    """Return the standard errors (k,) of the values that darks and flats gave to
    effects of the mean, by their 95 % intervals: images may correct them by as much."""
    found = {}
    for entry in json.loads(sensor.to_json()).get("effects", []):
        one = every()[entry["name"]].of_cfa(sensor.cfa)
        ends = entry.get("ci95", {})
        if one.predicted and set(one.used) <= set(ends):
            low, high = np.array([ends[name] for name in one.used]).T
            if (high > low).all():
                found[one] = (high - low) / 2 / CI95
    return found


def fields(most: int) -> list[tuple[int, int]]:
    """Return degrees down and across of smooth fields, together up to @most."""
    every = range(most + 1)
    return [(a, b) for a in every for b in every if 0 < a + b <= most]


def legendre(degree: int, x: Array) -> Array:
    return np.asarray(legval(x, [0.0] * degree + [1.0]))


def to_edge(place: Array) -> Array:
    """Return places as -1 to 1 from edge to edge of a square frame; the polynomials of
    a longer one end within it."""
    return np.asarray(np.clip(place * np.sqrt(2), -1.5, 1.5))


def laplacian(camera: Array) -> Array:
    kernel = np.array([1.0, -2.0, 1.0])
    return np.asarray(
        correlate1d(camera, kernel, axis=2, mode="nearest")
        + correlate1d(camera, kernel, axis=3, mode="nearest")
    )


def wings(camera: Array) -> Array:
    """Return what far wings add to each pixel and take from it."""
    reach = int(LAST_OF_WINGS)
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1]
    r = np.hypot(x, y)
    kernel = np.where(
        (r >= FIRST_OF_WINGS) & (r <= reach), 1 / np.maximum(r, 1) ** 3, 0
    )
    kernel /= kernel.sum()
    around = [(0, 0), (0, 0), (reach, reach), (reach, reach)]
    wide = np.pad(camera, around, mode="symmetric")
    size = wide.shape[2:]
    spread = fft.irfft2(fft.rfft2(wide) * fft.rfft2(kernel, size), size)
    return np.asarray(spread[:, :, 2 * reach :, 2 * reach :] - camera)


def pose_of(found: Mapping[str, float]) -> Array:
    """Return the step (2, 3) of rows and columns: constant, by v, by u."""
    return np.array(
        [
            [found.get(axis + by, 0.0) for by in ("", " v", " u")]
            for axis in ("row", "column")
        ]
    )
