# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Nuisances: what is wrong with a capture and not with the camera.

Light that flickers from frame to frame, and a render's smooth error of radiance, are
Gaussian fields of few dimensions: they are integrated out, not fitted. What is left of
a wrong registration is a variance on edges. None of it is written to a profile.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.effects.catalogue import Candidate
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.inference.fisher_scoring import ENOUGH, search
from cg2raw.diagnose.likelihood.likelihood import Workers, total
from cg2raw.diagnose.likelihood.prediction import Model, Prediction, predict

FIELD = (5, 6)  # bumps of a smooth error, down and across a frame
WIDTH_OF_BUMP = 0.7  # of their distance, standard deviation
BUMPS_THAT_ADD = 1.6  # how many of their variances a pixel sees
HIGHEST = 0.85  # of white; above it errors of the capture decide what clips
UNSURE = 0.15  # relative, of light there
CLIPPED = 3.0  # standard deviations below its light that a pixel is clipped
LEAST = {"light": 0.005, "radiance": 0.01, "registration": 0.0, "texture": 0.0}
MOST = {"light": 0.2, "radiance": 0.2, "registration": 0.5, "texture": 0.1}
UNKNOWN_LEVEL = 0.3  # relative, of what nobody measured
AFTER_ALIGNMENT = 0.05  # relative, of an exposure that was estimated
SEARCHES = 4

STARTS = ((0.005, 0.01, 0.005, 0.001), (0.01, 0.03, 0.02, 0.003))


@dataclass(frozen=True)
class Nuisance:
    """Standard deviations: of a frame's brightness and of a smooth error, relative; of
    a shift, px; of fine texture, relative. free: which of the three float at all."""

    light: float
    radiance: float
    registration: float
    texture: float
    floating: frozenset[str]

    def pixel_variance(self, frame: Frame, variance: Array) -> Array | float:
        """Return what is independent from pixel to pixel."""
        if frame.capture.kind in ("dark", "flat"):
            return 0.0
        slope, light = _slope_and_light(frame)
        extra = self.registration**2 * slope + self.texture**2 * light
        whole = self.light**2 + BUMPS_THAT_ADD * self.radiance**2
        if frame.highlights is not None:
            extra = extra + frame.highlights * UNSURE**2 * light
        return extra + frame.censored * whole * light

    def _columns(self, frame: Frame, p: Prediction) -> Array | None:
        """(k, pixels) of the fields, in standard deviations of a pixel."""
        if frame.capture.kind == "dark":
            return None
        spread = np.sqrt(p.variance)
        bearing = np.maximum(p.exposed, 0) / spread
        clipped = frame.censored | (p.exposed > p.mean + CLIPPED * spread)
        bearing = np.where(frame.keep & ~clipped, bearing, 0).astype("f4")
        columns = []
        apart = frame.level_free or "white_balance" in self.floating
        unknown = UNKNOWN_LEVEL if frame.level_free else AFTER_ALIGNMENT
        if apart:
            columns += [unknown * bearing * (frame.color == c) for c in range(3)]
        brightness = self.light
        if "exposure" in self.floating:
            brightness = np.hypot(brightness, AFTER_ALIGNMENT)
        columns.append(brightness * bearing)
        if frame.capture.kind != "flat" and "radiance" in self.floating:
            down, across = _bumps(frame)
            rows = [self.radiance * bearing * down[..., i] for i in range(FIELD[0])]
            columns += [row * across[..., j] for row in rows for j in range(FIELD[1])]
        return np.array([column.ravel() for column in columns], "f4")

    def whiten(
        self, z: Array, p: Prediction, frame: Frame
    ) -> tuple[Array, Array | float]:
        """Return residuals whose fields are shrunk, and the cost per pixel."""
        columns, shrink, cost = self._shrinking(frame, p)
        if columns is None:
            return z, 0.0
        flat = z.ravel()
        along = shrink @ (columns @ flat.astype("f4"))
        shrunk = flat - along.astype("f4") @ columns
        return shrunk.reshape(z.shape), cost * frame.keep

    def _shrinking(self, frame: Frame, p: Prediction) -> tuple[Any, Any, float]:
        """Return (columns, what shrinks along them, cost per pixel).

        Of the prediction asked last it is kept: all derivatives are whitened alike."""
        known = frame.store.get("shrinking")
        if known is not None and known[0] is p and known[1] is self:
            return known[2]
        columns = self._columns(frame, p)
        result: tuple[Any, Any, float] = (None, None, 0.0)
        if columns is not None and columns.any():
            values, vectors = np.linalg.eigh((columns @ columns.T).astype(float))
            used = values > 1e-6 * max(values[-1], 1e-3)
            weight = (1 - (1 + values[used]) ** -0.5) / values[used]
            shrink = (vectors[:, used] * weight) @ vectors[:, used].T
            cost = -0.5 * np.log1p(values[used]).sum() / max(frame.keep.sum(), 1)
            result = (columns, shrink, float(cost))
        frame.store["shrinking"] = (p, self, result)
        return result


def _bumps(frame: Frame) -> tuple[Array, Array]:
    """Return Gaussian bumps along rows (T, h, 1, n) and columns (T, 1, w, n)."""
    if "bumps" not in frame.store:
        parts = []
        for places, length, count in zip(
            frame.tiles.rows_and_columns(), frame.tiles.shape, FIELD, strict=True
        ):
            distance = places[..., None] / length * (count - 1) - np.arange(count)
            bump = np.exp(-0.5 * (distance / WIDTH_OF_BUMP) ** 2)
            parts.append(bump.astype("f4"))
        frame.store["bumps"] = tuple(parts)
    return frame.store["bumps"]


def _slope_and_light(frame: Frame) -> tuple[Array, Array]:
    """Return the squares of slope (per px) and of light at each pixel."""
    if "slope" not in frame.store:
        camera = frame.camera.astype(float)
        squared = np.gradient(camera, axis=2) ** 2 + np.gradient(camera, axis=3) ** 2
        frame.store["slope"] = (of_site(squared, frame), of_site(camera**2, frame))
    return frame.store["slope"]


def of_site(planes: Array, frame: Frame) -> Array:
    """Return from (T, 3, H, W) with margins what each site's filter passes."""
    inner = frame.tiles.inner(planes)
    color = frame.color[None]
    return np.where(
        color == 0, inner[:, 0], np.where(color == 1, inner[:, 1], inner[:, 2])
    )


def nuisance_of(
    capture_set: CaptureSet, frames: Sequence[Frame], workers: Workers
) -> Nuisance | None:
    """Return the nuisance that a capture set declares, fitted on frames.

    None if it declares none and every level is known."""
    floating = capture_set.nuisances
    if not floating and not any(frame.level_free for frame in frames):
        return None
    given = {**LEAST, **capture_set.uncertainty}
    start = Nuisance(
        light=given["light"] if "light" in floating else 0.0,
        radiance=given["radiance"] if "radiance" in floating else 0.0,
        registration=given["registration"] if "registration" in floating else 0.0,
        texture=0.0,
        floating=floating,
    )
    return refitted(Model(capture_set.sensor, nuisance=start), frames, workers, given)


def refitted(
    model: Model, frames: Sequence[Frame], workers: Workers, given: Any = None
) -> Nuisance:
    """Return the nuisance of a model with standard deviations that fit frames best."""
    old: Nuisance = model.nuisance
    moving = {
        "light": "light" in old.floating,
        "radiance": "radiance" in old.floating,
        "registration": "registration" in old.floating,
        "texture": bool(old.floating & {"registration", "radiance"}),
    }
    names = [name for name, moves in moving.items() if moves]
    if not names:
        return old
    least = {**LEAST, **(given or {})}
    candidate = Candidate(
        name="nuisance",
        way="flow",
        parameters=tuple(names),
        units=("1",) * len(names),
        low=np.array([least[name] for name in names]),
        high=np.array([MOST[name] for name in names]),
        steps=np.full(len(names), 1e-3),
        first_scale=5e-4,
    )

    def with_values(values: Any) -> Nuisance:
        deviations: dict[str, Any] = dict(zip(names, map(float, values), strict=True))
        return replace(old, **deviations)

    def score(values: Any) -> float:
        trial = replace(model, nuisance=with_values(values))
        return total(trial, frames, workers)

    order = list(moving)
    starts = [
        candidate.clipped(np.array([start[order.index(name)] for name in names]))
        for start in STARTS
    ]
    starts.append(candidate.clipped(np.array([getattr(old, n) for n in names])))
    scores = [score(values) for values in starts]
    best = int(np.argmax(scores))
    values, height = starts[best], scores[best]
    for _ in range(SEARCHES):
        values, higher = search(candidate, values, height, score)
        if higher - height < ENOUGH:
            break
        height = higher
    found = with_values(values)
    # Repeats of a scene share one field, and count here as two.
    return replace(found, radiance=found.radiance * np.sqrt(2))


def hide_highlights(frame: Frame, model: Model) -> None:
    """Take what is predicted near white out of a frame that shows a scene. It counts as
    light that hardly anything is known of: enough to show a well that clips it."""
    if frame.capture.kind in ("scene", "chart"):
        bright = predict(model, frame).mean >= HIGHEST
        frame.highlights = frame.keep & bright
        frame.keep &= ~bright
