# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Frames: the parts of captures that the inference works on, in signal units."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.cfa import repeat_of, sites_of
from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.diagnose.frames.noise_model import NoiseModel
from cg2raw.diagnose.frames.tiling import Array, Mask, Tiling
from cg2raw.sensor import Sensor
from cg2raw.statistics.codes import ROUNDING
from cg2raw.statistics.temperature import DOUBLING

# Pixels along the edges of a frame that are left out: what lies beyond an image
# is not known; beyond a uniform frame it is, but for filters of the file.
BORDER, UNIFORM_BORDER = 8, 4
PIECE = 16384  # pixels of a render that are in double precision at a time


@dataclass(frozen=True)
class Frame:
    """What the inference knows of one capture; arrays of tiles are (T, h, w).

    signal : measured, 0..1 above black.
    at_white, at_zero : the ADC's ends were reached: censored.
    keep : pixels that count.
    rendered : (T, 3, h + 2 margin, w + 2 margin) camera RGB as it enters the lens, of
        the tiles' blocks, with its glare context. camera, glare_context : the same
        where the capture shows it, and as bright.
    noise : betas at the CFA's sites, for the registry; beta1, beta2 : (h, w) of them.
    range : (h, w) DN from black to white.
    level_free : its brightness is not known at all.
    samples : (T, h, w) pixels that each value is the mean of, of a table of patches;
        None where values are those of pixels.
    warmth : how much faster charge gathers in it without light than in other frames,
        since it is warmer.
    rounding : variance that whole DN add to the noise, DN^2.
    memo : what was last predicted of it, which copies with another signal share.
    """

    capture: Capture
    tiles: Tiling
    signal: Array
    at_white: Mask
    at_zero: Mask
    keep: Mask
    camera: NDArray[np.float32]
    glare_context: _core.GlareContext
    neutral: tuple[float, ...]
    noise: NoiseModel
    beta1: Array
    beta2: Array
    range: Array
    site: NDArray[np.int64]
    color: NDArray[np.int64]
    rendered: tuple[NDArray[np.float32], _core.GlareContext]
    level_free: bool = False
    samples: Array | None = None
    warmth: float = 1.0
    rounding: float = ROUNDING
    memo: dict[str, Any] = field(default_factory=dict, compare=False, repr=False)

    @property
    def seconds(self) -> float:
        """Time that charge gathers without light: exposure time at the temperature of
        the captures, longer in a warmer frame. 1 where no exposure time is known, so
        that rates are per frame."""
        time = self.capture.exposure_time
        return self.warmth * (1.0 if time is None else time)

    @cached_property
    def squared_slope_and_light(self) -> tuple[Array, Array]:
        """The squares of the light's slope (per px) and of light at each pixel."""
        camera = self.camera.astype(float)
        squared = np.gradient(camera, axis=2) ** 2 + np.gradient(camera, axis=3) ** 2
        return self.of_site(squared), self.of_site(camera**2)

    def of_site(self, planes: Array) -> Array:
        """Return from (T, 3, H, W) with margins what each site's filter passes."""
        inner, color = self.tiles.inner(planes), self.color[None]
        green_or_blue = np.where(color == 1, inner[:, 1], inner[:, 2])
        return np.where(color == 0, inner[:, 0], green_or_blue)

    @property
    def censored(self) -> Mask:
        return self.at_white | self.at_zero


def camera_of(
    capture_set: CaptureSet, capture: Capture
) -> tuple[NDArray[np.float64], _core.Illuminant]:
    """Return (matrix, illuminant): camera RGB is scene @ matrix.T, unclipped.

    Source: DNG specification 1.7.1, chapter 6."""
    profile = capture_set.sensor.profile
    light = profile.illuminant(capture.illuminant, capture.as_shot)
    transform = _core.camera_from_scene(profile, light, "dng", 1.0, False)
    return np.asarray(transform.gains)[:, None] * np.asarray(transform.first), light


def planes_of_sites(
    cfa: str, shape: tuple[int, int], values: Sequence[float]
) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """Return (site, color, values) of every pixel of a tile, (h, w) each."""
    n = repeat_of(cfa)
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    site = (rows % n) * n + columns % n
    colors = ["RGB".index(letter) for letter in sites_of(cfa)]
    color = np.array(colors)[site]
    spread = np.asarray(values, float)
    if spread.size == 1:
        spread = np.full(n * n, spread.item())
    if spread.size == 3 and n != 1:
        spread = spread[colors]
    return site, color, spread[site]


@dataclass(frozen=True)
class Source:
    """A capture whose files were read: DN, and camera RGB, (H, W, 3) or (3,)."""

    capture: Capture
    sensor: Sensor
    raw: NDArray[np.uint16]
    camera: NDArray[np.float32]
    glare_context: _core.GlareContext
    neutral: tuple[float, ...]
    mask: Mask | None


def source_of(
    capture_set: CaptureSet, capture: Capture, raw: NDArray[np.uint16]
) -> Source:
    """Return a capture with its mosaic and render, which is read. Raises ValueError for
    a file that cannot be."""
    matrix, light = camera_of(capture_set, capture)
    scene = np.zeros(3) if capture.scene is None else np.asarray(capture.scene())
    if scene.ndim == 3 and scene.shape[:2] != tuple(capture.shape):
        raise ValueError(
            f"{capture.name}: scene of {scene.shape[0]} x {scene.shape[1]} pixels, "
            f"capture of {capture.shape[0]} x {capture.shape[1]}; must be alike: "
            "render the active area"
        )
    if not np.isfinite(scene).all():
        raise ValueError(
            f"{capture.name}: the scene has values that are not finite; must be "
            "numbers: render it without, or mask them and write 0"
        )
    # In double precision, in pieces: in single, the last bits are the processor's.
    pixels = scene.reshape(-1, 3)
    flat = np.empty_like(pixels)
    for first in range(0, len(pixels), PIECE):
        piece = slice(first, first + PIECE)
        flat[piece] = pixels[piece] @ matrix.T
    camera = np.maximum(flat, 0, out=flat).astype(np.float32, copy=False)
    camera = camera.reshape(scene.shape)
    whole = camera if camera.ndim == 3 else np.broadcast_to(camera, (64, 64, 3))
    neutral = np.asarray(light.neutral, float)
    return Source(
        capture=capture,
        sensor=capture_set.sensor,
        raw=raw,
        camera=camera,
        glare_context=_core.glare_context(np.ascontiguousarray(whole)),
        neutral=tuple(neutral / neutral.max()),
        mask=None if capture.mask is None else capture.mask(),
    )


def camera_tiles(camera: NDArray[np.float32], tiles: Tiling) -> NDArray[np.float32]:
    """Return camera RGB as (T, 3, h + 2 margin, w + 2 margin).

    camera : (H, W, 3) of a frame; or a colour, (3,), or one of each tile, (T, 3)."""
    if camera.ndim == 3:
        cut = np.moveaxis(tiles.cut(camera, with_margin=True), -1, 1)
        return np.ascontiguousarray(cut)
    shape = (len(tiles.origins), 3, *tiles.block_size)
    return np.broadcast_to(camera.reshape(-1, 3, 1, 1), shape).copy()


def _keep(source: Source, tiles: Tiling) -> Mask:
    keep = np.ones((len(tiles.origins), *tiles.size), bool)
    border = BORDER if source.camera.ndim == 3 else UNIFORM_BORDER
    if min(tiles.shape) > 4 * BORDER:
        for places, end in zip(tiles.rows_and_columns(), tiles.shape, strict=True):
            keep &= (places >= border) & (places < end - border)
    if source.mask is not None:
        keep &= tiles.cut(source.mask)
    return keep


def warmth_of(capture: Capture, temperature: float | None) -> float:
    """Return how much faster charge gathers in a capture without light than at a
    temperature, degrees Celsius; 1 if either is not known."""
    if temperature is None or capture.temperature is None:
        return 1.0
    return float(2 ** ((capture.temperature - temperature) / DOUBLING))


def frame_of(
    source: Source, tiles: Tiling, noise: NoiseModel, warmth: float = 1.0
) -> Frame:
    """Return the tiles of a capture."""
    sensor, capture = source.sensor, source.capture
    cut = tiles.cut(source.raw)
    site, color, black = planes_of_sites(sensor.cfa, tiles.size, sensor.black_level)
    range_ = sensor.white_level - black
    beta1, beta2 = (
        planes_of_sites(sensor.cfa, tiles.size, beta)[2]
        for beta in (noise.beta1, noise.beta2)
    )
    camera, keep = camera_tiles(source.camera, tiles), _keep(source, tiles)
    frame = Frame(
        capture=capture,
        tiles=tiles,
        signal=(cut.astype(float) - black) / range_,
        at_white=cut >= sensor.white_level,
        at_zero=cut == 0,
        keep=keep,
        camera=camera,
        glare_context=source.glare_context,
        rendered=(camera, source.glare_context),
        neutral=source.neutral,
        noise=noise,
        beta1=beta1,
        beta2=beta2,
        range=range_,
        site=site,
        color=color,
        level_free=capture.scene is None and capture.shows.light,
        warmth=warmth,
    )
    return with_level_of(frame, frame) if frame.level_free else frame


def with_level_of(frame: Frame, known: Frame) -> Frame:
    """Return a flat whose light nobody measured with what another frame of it shows.

    Without filters there is one colour, which all three planes have."""
    colors = np.unique(known.color)
    middles = [
        np.median(known.signal[:, known.color == c][known.keep[:, known.color == c]])
        for c in colors
    ]
    middle = middles if len(colors) == 3 else middles * 3
    color = np.maximum(np.array(middle, np.float32), 0)
    camera = camera_tiles(color, frame.tiles)
    glare_context = _core.glare_context(np.full((64, 64, 3), color))
    return replace(
        frame,
        camera=camera,
        glare_context=glare_context,
        rendered=(camera, glare_context),
    )
