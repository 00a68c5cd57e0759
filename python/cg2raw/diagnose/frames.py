# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Frames: the parts of captures that the inference works on, in signal units."""

import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.diagnose.captures import Capture, CaptureSet
from cg2raw.diagnose.noise_estimate import NoiseModel

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

TILE = (96, 128)  # rows, columns of the pieces of a large frame
MARGIN = 24  # pixels around a tile that blur and aberrations take in
MOST_MASKED = 6  # tiles' pixels for one that counts
BORDER = 8  # pixels along the edges of a whole frame that are left out


@dataclass(frozen=True)
class Tiling:
    """Where the tiles of a frame lie; the same in all frames of one shape.

    origins : (T, 2) row and column of each tile's first pixel, margin included; a
        multiple of the CFA's repeat.
    size : rows and columns of a tile without its margin.
    """

    shape: tuple[int, int]
    size: tuple[int, int]
    margin: int
    origins: NDArray[np.int32]

    def cut(self, image: NDArray[Any], with_margin: bool = False) -> NDArray[Any]:
        """Return the tiles (T, h, w, ...) of an image (H, W, ...)."""
        inset = 0 if with_margin else self.margin
        height, width = (n + 2 * (self.margin - inset) for n in self.size)
        return np.stack(
            [
                image[r + inset : r + inset + height, c + inset : c + inset + width]
                for r, c in self.origins
            ]
        )

    def rows_and_columns(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the row (T, h, 1) and column (T, 1, w) of every pixel."""
        first = self.origins.astype(np.int64) + self.margin
        rows = first[:, :1, None] + np.arange(self.size[0])[None, :, None]
        columns = first[:, 1:, None] + np.arange(self.size[1])[None, None, :]
        return rows, columns

    def field(self) -> tuple[Array, Array]:
        """Return (u, v): offset from the centre in half diagonals; (T, h, w) each."""
        height, width = self.shape
        half = np.hypot(height, width) / 2
        rows, columns = self.rows_and_columns()
        u = (columns + 0.5 - width / 2) / half
        v = (rows + 0.5 - height / 2) / half
        return tuple(np.broadcast_arrays(u, v))


def tiling(
    shape: tuple[int, int], pixels: int, repeat: int = 2, wanted: Mask | None = None
) -> Tiling:
    """Return tiles that hold about so many pixels of a frame, corners among them.

    wanted : (H, W), where any frame counts; if that is less than half, tiles lie where
        most of it is."""
    height, width = shape
    if height * width <= 1.5 * pixels or min(shape) < 2 * MARGIN + max(TILE):
        return Tiling(shape, shape, 0, np.zeros((1, 2), np.int32))
    size = (TILE[0] - TILE[0] % repeat, TILE[1] - TILE[1] % repeat)
    if wanted is not None and wanted.mean() < 0.5:
        origins = _where_wanted(wanted, size, pixels, repeat)
    else:
        across = max(2, round(np.sqrt(pixels / (size[0] * size[1]) * width / height)))
        down = max(2, round(pixels / (size[0] * size[1] * across)))
        origins = np.array(
            [
                (row, column)
                for row in _places(height, size[0], down, repeat)
                for column in _places(width, size[1], across, repeat)
            ]
        )
    return Tiling(shape, size, MARGIN, origins.astype(np.int32))


def _places(length: int, tile: int, count: int, repeat: int) -> NDArray[np.int64]:
    """Return the first pixels of tiles from one end to the other, at most so many and
    none on another: a pixel counts once."""
    count = min(count, (length - 2 * MARGIN) // tile)
    places = np.linspace(0, length - tile - 2 * MARGIN, count).astype(np.int64)
    return places - places % repeat


def _where_wanted(
    wanted: Mask, size: tuple[int, int], pixels: int, repeat: int
) -> NDArray[np.int64]:
    """Return tiles beside each other that hold most of what counts."""
    rows, columns = (
        _places(n, tile, (n - 2 * MARGIN) // tile, repeat)
        for n, tile in zip(wanted.shape, size, strict=True)
    )
    held = {
        (row, column): int(
            wanted[
                row + MARGIN : row + MARGIN + size[0],
                column + MARGIN : column + MARGIN + size[1],
            ].sum()
        )
        for row in rows
        for column in columns
    }
    chosen, sum_ = [], 0
    for place in sorted(held, key=lambda at: -held[at]):
        if held[place] == 0 or sum_ > pixels:
            break
        if len(chosen) * size[0] * size[1] > MOST_MASKED * pixels:
            break
        chosen.append(place)
        sum_ += held[place]
    return np.array(sorted(chosen) or [(0, 0)])


@dataclass
class Frame:
    """What the inference knows of one capture; arrays of tiles are (T, h, w).

    signal : measured, 0..1 above black.
    at_white, at_zero : the ADC's ends were reached: censored.
    keep : pixels that count.
    camera : (T, 3, h + 2 margin, w + 2 margin) camera RGB as it enters the lens.
    noise : betas at the CFA's sites, for the registry; beta1, beta2 : (h, w) of them.
    range : (h, w) DN from black to white.
    uniform : (T, h, w) for the randomised residuals of censored pixels.
    level_free : its brightness is not known at all.
    """

    capture: Capture
    tiles: Tiling
    signal: Array
    at_white: Mask
    at_zero: Mask
    keep: Mask
    camera: NDArray[np.float32]
    surround: Any
    neutral: tuple[float, ...]
    noise: NoiseModel
    beta1: Array
    beta2: Array
    range: Array
    uniform: Array
    site: NDArray[np.int64]
    color: NDArray[np.int64]
    level_free: bool = False
    store: dict[str, Any] = field(default_factory=dict)

    @property
    def seconds(self) -> float:
        """Exposure time; 1 where none is known, so that rates are per frame."""
        return self.capture.exposure_time or 1.0

    @property
    def censored(self) -> Mask:
        return self.at_white | self.at_zero


def camera_of(capture_set: CaptureSet, capture: Capture) -> tuple[Any, Any]:
    """Return (matrix, illuminant): camera RGB is scene @ matrix.T, unclipped.

    Source: DNG specification 1.7.1, chapter 6."""
    profile = capture_set.sensor._profile
    light = profile.illuminant(capture.illuminant, capture.as_shot)
    transform = _core.camera_from_scene(profile, light, "dng", 1.0, False)
    return np.asarray(transform.gains)[:, None] * np.asarray(transform.first), light


def repeat_of(cfa: str) -> int:
    """Return the side of a CFA's repeat."""
    return round(np.sqrt(len(cfa)))


def planes_of_sites(
    cfa: str, shape: tuple[int, int], values: Sequence[float]
) -> tuple[Any, Any, Any]:
    """Return (site, color, values) of every pixel of a tile, (h, w) each."""
    n = repeat_of(cfa)
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    site = (rows % n) * n + columns % n
    color = np.array(["RGB".index(letter) for letter in cfa.upper()])[site]
    spread = np.asarray(values, float)
    if spread.size == 1:
        spread = np.full(n * n, spread.item())
    if spread.size == 3 and n != 1:
        spread = spread[["RGB".index(letter) for letter in cfa.upper()]]
    return site, color, spread[site]


def _keep(capture: Capture, tiles: Tiling) -> Mask:
    height, width = tiles.size
    keep = np.ones((len(tiles.origins), height, width), bool)
    if tiles.margin == 0 and min(height, width) > 4 * BORDER:
        edge = np.zeros_like(keep)
        edge[:, BORDER:-BORDER, BORDER:-BORDER] = True
        keep &= edge
    if capture.mask is not None:
        keep &= tiles.cut(capture.mask())
    return keep


def _light(
    capture: Capture, tiles: Tiling, matrix: Any
) -> tuple[NDArray[np.float32], Any, bool]:
    """Return (camera tiles, surround, whether the level is unknown)."""
    count = len(tiles.origins)
    height, width = (n + 2 * tiles.margin for n in tiles.size)
    scene = np.zeros(3) if capture.scene is None else capture.scene()
    if np.ndim(scene) == 1:
        color = np.maximum(matrix @ np.asarray(scene, float), 0).astype(np.float32)
        whole = np.broadcast_to(color, (64, 64, 3))
        camera = np.broadcast_to(
            color[None, :, None, None], (count, 3, height, width)
        ).copy()
    else:
        whole = np.maximum(scene @ matrix.T.astype(np.float32), 0)
        camera = np.ascontiguousarray(
            np.moveaxis(tiles.cut(whole, with_margin=True), -1, 1)
        )
    surround = _core.surround(np.ascontiguousarray(whole, np.float32))
    return camera.astype(np.float32), surround, capture.scene is None


def frame_of(
    capture_set: CaptureSet, capture: Capture, tiles: Tiling, noise: NoiseModel
) -> Frame:
    """Read one capture. Raises ValueError for a file that cannot be read."""
    sensor = capture_set.sensor
    matrix, light = camera_of(capture_set, capture)
    raw = capture.raw()
    cut = tiles.cut(raw)
    signal = tiles.cut(np.asarray(sensor.signal_from_raw(raw))).astype(float)
    camera, surround, unknown = _light(capture, tiles, matrix)
    site, color, black = planes_of_sites(sensor.cfa, tiles.size, sensor.black_level)
    neutral = np.asarray(light.neutral, float)
    beta1, beta2 = (
        planes_of_sites(sensor.cfa, tiles.size, beta)[2]
        for beta in (noise.beta1, noise.beta2)
    )
    key = zlib.crc32(f"{capture.name}/{capture.set}/{capture.group}".encode())
    frame = Frame(
        capture=capture,
        tiles=tiles,
        signal=signal,
        at_white=cut >= sensor.white_level,
        at_zero=cut == 0,
        keep=_keep(capture, tiles),
        camera=camera,
        surround=surround,
        neutral=tuple(neutral / neutral.max()),
        noise=noise,
        beta1=beta1,
        beta2=beta2,
        range=sensor.white_level - black,
        uniform=np.random.default_rng(key).random(signal.shape),
        site=site,
        color=color,
        level_free=unknown and capture.kind != "dark",
    )
    if frame.level_free:
        _take_level_from(frame)
    return frame


def _take_level_from(frame: Frame) -> None:
    """The light of a flat that nobody measured: what its middle shows."""
    middle = [
        np.median(frame.signal[:, frame.color == c][frame.keep[:, frame.color == c]])
        for c in range(3)
    ]
    color = np.maximum(np.array(middle, np.float32), 0)
    frame.camera = np.broadcast_to(
        color[None, :, None, None], frame.camera.shape
    ).copy()
    whole = np.ascontiguousarray(np.broadcast_to(color, (64, 64, 3)))
    frame.surround = _core.surround(whole)
