# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What a diagnosis shows: frames side by side, residual maps, fitted curves."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cg2raw.cfa import demosaic
from cg2raw.diagnose.diagnosis import Curve, Estimate, Picture
from cg2raw.diagnose.frames.frame import Frame, repeat_of
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.likelihood.likelihood import Workers, log_density
from cg2raw.diagnose.likelihood.prediction import Model, Prediction

LARGEST_SIDE = 512
FARTHEST_Z = 20.0
CELL = 4  # pixels a side of a cell of the residual map, at least
EDGES = np.linspace(-6, 6, 97)
POINTS = 60


class Canvas:
    """A picture of one frame that grows piece by piece; NaN where none was mounted."""

    def __init__(self, frame: Frame, cfa: str) -> None:
        self._frame, self._cfa = frame, cfa
        repeat = repeat_of(cfa)
        side = max(frame.tiles.shape)
        scale = max(1, -(-side // LARGEST_SIDE))
        self._scale = -(-scale // repeat) * repeat if scale > 1 else 1
        self._cell = max(CELL, self._scale)
        colors = self._shape(self._scale)
        cells = self._shape(self._cell)
        self._images = [np.full((*colors, 3), np.nan, np.float32) for _ in range(3)]
        self._maps = [np.full(cells, np.nan, np.float32) for _ in range(2)]

    def _shape(self, scale: int) -> tuple[int, int]:
        height, width = self._frame.tiles.shape
        return -(-height // scale), -(-width // scale)

    def mount(
        self, piece: Frame, before: Array, after: Array, *residuals: Array
    ) -> None:
        """Put the tiles of a piece in their places.

        before, after : predicted means. residuals : standardised, before and after."""
        signals = (piece.signal, np.clip(before, 0, 1), np.clip(after, 0, 1))
        for image, signal in zip(self._images, signals, strict=True):
            planes = [
                np.asarray(demosaic(np.ascontiguousarray(tile, "f4"), self._cfa))
                for tile in signal
            ]
            _mount(image, np.stack(planes), piece, self._scale)
        used = piece.keep & ~piece.censored
        for canvas, z in zip(self._maps, residuals, strict=True):
            shown = np.where(used, np.clip(z, -FARTHEST_Z, FARTHEST_Z), 0)
            _mount(canvas, shown * self._cell, piece, self._cell)

    def picture(self) -> Picture:
        """Return the picture as it is."""
        capture, neutral = self._frame.capture, np.array(self._frame.neutral)
        measured, before, after = self._images
        z_before, z_after = self._maps
        return Picture(
            name=capture.name,
            kind=capture.kind,
            measured=measured,
            before=before,
            after=after,
            z_before=z_before,
            z_after=z_after,
            neutral=tuple(neutral / neutral[1]),
        )


def _mount(canvas: Array, tiles: Array, frame: Frame, scale: int) -> None:
    """Write the means of cells of scale pixels into a canvas."""
    rows, columns = frame.tiles.rows_and_columns()
    for tile, row, col in zip(tiles, rows[:, 0, 0], columns[:, 0, 0], strict=True):
        # Whole cells of the canvas that lie in the tile.
        top, left = -(-row // scale), -(-col // scale)
        inner = tile[top * scale - row :, left * scale - col :]
        h, w = (n // scale for n in inner.shape[:2])
        cells = inner[: h * scale, : w * scale].reshape(h, scale, w, scale, -1)
        mean = cells.mean((1, 3)).reshape(h, w, *tile.shape[2:])
        canvas[top : top + h, left : left + w] = mean


def histogram(
    model: Model, frames: Sequence[Frame], workers: Workers
) -> tuple[Array, Array]:
    """Return (edges, counts) of the standardised residuals of frames."""

    def counted(frame: Frame) -> Array:
        _, z, _ = log_density(model, frame)
        used = z[frame.keep & ~frame.censored]
        return np.histogram(np.clip(used, EDGES[0], EDGES[-1]), EDGES)[0]

    return EDGES, np.sum(workers.map(counted, frames), 0)


def curves_of(
    model: Model,
    values: Mapping[str, Mapping[str, Estimate]],
    frames: Sequence[Frame],
) -> list[Curve]:
    """Return the curves that belong to a model's terms."""
    drawn = {
        "lens_shading": _fall_off,
        "blur": _transfer,
        "nonlinearity": _response,
    }
    curves = [
        drawn[term.name](model, term.values, values[term.name], frames)
        for term in model.terms
        if term.name in drawn
    ]
    noisy = {"shot_noise", "read_noise", "row_noise"} & set(model.names)
    if frames:
        curves.append(_photon_transfer(model, frames, sorted(noisy)))
    return curves


def _curve(
    values: Array, estimates: Mapping[str, Estimate], design: Array
) -> tuple[Array, Array, Array]:
    """Return (y, low, high) of 1 + design @ values; intervals add as independent."""
    errors = np.array([(e.ci95[1] - e.ci95[0]) / 2 for e in estimates.values()])
    y = 1 + design @ values
    half = np.sqrt((design**2) @ errors**2)
    return y, y - half, y + half


def _measured_ratio(
    model: Model, name: str, frames: Sequence[Frame], labels: Any, count: int
) -> tuple[Array, Array]:
    """Return (label, measured over predicted without the effect), light-weighted."""
    rest = model.without(name)
    above, below = np.zeros(count), np.zeros(count)
    for frame in frames:
        if frame.capture.kind == "dark":
            continue
        p: Prediction = log_density(rest, frame)[2]
        used = frame.keep & ~frame.censored & (p.mean < 0.9)
        chosen = labels(frame, p)[used]
        weight = (p.mean / p.variance)[used]
        above += np.bincount(chosen, weight * frame.signal[used], count)[:count]
        below += np.bincount(chosen, weight * p.mean[used], count)[:count]
    seen = below > 0
    return np.flatnonzero(seen).astype(float), above[seen] / below[seen]


def _fall_off(
    model: Model, values: Array, estimates: Any, frames: Sequence[Frame]
) -> Curve:
    r = np.linspace(0, 1, POINTS)
    design = np.zeros((POINTS, len(values)))
    design[:, :3] = np.stack([r**2, r**4, r**6], 1)
    count = 20

    def labels(frame: Frame, p: Prediction) -> Any:
        u, v = frame.tiles.field()
        return np.minimum((np.hypot(u, v) * count).astype(int), count - 1)

    x, y = _measured_ratio(model, "lens_shading", frames, labels, count)
    return Curve(
        "Fall-off of the lens",
        "radius, 1 in the corner",
        "relative illumination",
        r,
        *_curve(values, estimates, design),
        (x + 0.5) / count,
        y,
        "lens_shading",
    )


def _transfer(
    model: Model, values: Array, estimates: Any, frames: Sequence[Frame]
) -> Curve:
    f = np.linspace(0, 1, POINTS)
    design = np.zeros((POINTS, len(values)))
    for n in range(1, 11):
        design[:, n - 1] = np.cos(n * np.pi * f) - 1
    nothing = np.zeros(0)
    return Curve(
        "Transfer of contrast by the lens",
        "spatial frequency, 1 is Nyquist's",
        "contrast",
        f,
        *_curve(values, estimates, design),
        nothing,
        nothing,
        "blur",
    )


def _response(
    model: Model, values: Array, estimates: Any, frames: Sequence[Frame]
) -> Curve:
    x = np.linspace(0.02, 1, POINTS)
    design = np.stack([-x, -(x**2)], 1)
    count = 20

    def labels(frame: Frame, p: Prediction) -> Any:
        return np.clip((p.mean * count).astype(int), 0, count - 1)

    level, ratio = _measured_ratio(model, "nonlinearity", frames, labels, count)
    return Curve(
        "Response of the sensor",
        "light, 1 is white",
        "signal per light",
        x,
        *_curve(values, estimates, design),
        (level + 0.5) / count,
        ratio,
        "nonlinearity",
    )


def _photon_transfer(
    model: Model, frames: Sequence[Frame], noisy: Sequence[str]
) -> Curve:
    """Variance against level: of the model, and of the residuals."""
    count = 16
    edges = np.geomspace(1e-3, 1, count)
    square, weight, level = np.zeros((3, count + 1))
    expected = np.zeros(count + 1)
    for frame in frames:
        p = log_density(model, frame)[2]
        used = frame.keep & ~frame.censored & (p.mean < 0.95)
        chosen = np.digitize(p.mean[used], edges)
        residual = (frame.signal - p.mean)[used]
        square += np.bincount(
            chosen, np.minimum(residual**2, 50 * p.variance[used]), count + 1
        )
        level += np.bincount(chosen, np.maximum(p.mean[used], 0), count + 1)
        expected += np.bincount(chosen, p.variance[used], count + 1)
        weight += np.bincount(chosen, minlength=count + 1)
    seen = weight > 200
    x, y = level[seen] / weight[seen], expected[seen] / weight[seen]
    half = 1.96 * y * np.sqrt(2 / weight[seen])
    return Curve(
        "Photon transfer",
        "level, 1 is white",
        "variance",
        x,
        y,
        y - half,
        y + half,
        x,
        square[seen] / weight[seen],
        ", ".join(noisy),
    )
