# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What a diagnosis shows: frames side by side, residual maps, fitted curves."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cg2raw.cfa import demosaic
from cg2raw.diagnose.diagnosis import Curve, Estimate, Picture
from cg2raw.diagnose.frames import Array, Frame
from cg2raw.diagnose.likelihood import Workers, log_density
from cg2raw.diagnose.prediction import Model, Prediction

LARGEST_SIDE = 512
CELL = 4  # pixels a side of a cell of the residual map, at least
EDGES = np.linspace(-6, 6, 97)
POINTS = 60


def _mounted(tiles: Array, frame: Frame, scale: int) -> Array:
    """Return the tiles in their places on the frame, in cells of scale pixels; NaN
    between them."""
    height, width = (-(-n // scale) for n in frame.tiles.shape)
    canvas = np.full((height, width, *tiles.shape[3:]), np.nan)
    rows, columns = frame.tiles.rows_and_columns()
    for tile, row, col in zip(tiles, rows[:, 0, 0], columns[:, 0, 0], strict=True):
        h, w = (n // scale * scale for n in tile.shape[:2])
        cells = tile[:h, :w].reshape(h // scale, scale, w // scale, scale, -1)
        mean = cells.mean((1, 3)).reshape(h // scale, w // scale, *tile.shape[2:])
        top, left = row // scale, col // scale
        canvas[top : top + h // scale, left : left + w // scale] = mean
    return canvas


def _colors(signal: Array, cfa: str, frame: Frame, scale: int) -> Array:
    planes = [
        np.asarray(demosaic(np.ascontiguousarray(tile, np.float32), cfa))
        for tile in signal
    ]
    return _mounted(np.stack(planes).astype(float), frame, scale).astype(np.float32)


def picture_of(base: Model, model: Model, frame: Frame) -> Picture:
    """Return one frame as measured and as simulated before and after."""
    cfa = model.sensor.cfa
    scale = max(1, -(-max(frame.tiles.shape) // LARGEST_SIDE))
    cell = max(CELL, 2 * scale)
    images: list[Any] = [_colors(frame.signal, cfa, frame, scale)]
    maps = []
    for each in (base, model):
        _, z, p = log_density(each, frame)
        images.append(_colors(np.clip(p.mean, 0, 1), cfa, frame, scale))
        used = np.where(frame.keep & ~frame.censored, np.clip(z, -20, 20), 0)
        maps.append(_mounted(used, frame, cell).astype(np.float32) * cell)
    return Picture(frame.capture.name, frame.capture.kind, *images, *maps)


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
