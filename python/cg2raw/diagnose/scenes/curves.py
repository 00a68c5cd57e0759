# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Curves: what was fitted beside what was measured."""

from collections.abc import Sequence

import numpy as np

from cg2raw.diagnose.diagnosis import Curve
from cg2raw.diagnose.effects.base import EstimatesByEffect, Labels, MeasuredRatio
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.scenes.model import Model
from cg2raw.diagnose.scenes.predict import predict
from cg2raw.normal import CI95


def curves_of(
    model: Model,
    values: EstimatesByEffect,
    frames: Sequence[Frame],
) -> list[Curve]:
    """Return the curves that belong to a model's terms."""

    frames = [frame for frame in frames if frame.samples is None]

    def measured_without(name: str) -> MeasuredRatio:
        return lambda labels, count: _measured_ratio(
            model.without(name), frames, labels, count
        )

    found = [
        term.effect.curve(
            term.values, values.get(term.name, {}), measured_without(term.name)
        )
        for term in model.terms
    ]
    curves = [curve for curve in found if curve is not None]
    if frames:
        noisy = {t.name for t in model.terms if t.effect.in_photon_transfer}
        curves.append(_photon_transfer(model, frames, sorted(noisy)))
    return curves


def _measured_ratio(
    rest: Model,
    frames: Sequence[Frame],
    labels: Labels,
    count: int,
) -> tuple[Array, Array]:
    """Return (label, measured over predicted without the effect), light-weighted."""
    above, below = np.zeros(count), np.zeros(count)
    for frame in frames:
        if not frame.capture.shows.light:
            continue
        p = predict(rest, frame)
        used = frame.keep & ~frame.censored & (p.mean < 0.9)
        chosen = labels(frame, p)[used]
        weight = (p.mean / p.variance)[used]
        above += np.bincount(chosen, weight * frame.signal[used], count)[:count]
        below += np.bincount(chosen, weight * p.mean[used], count)[:count]
    seen = below > 0
    return np.flatnonzero(seen).astype(float), above[seen] / below[seen]


def _photon_transfer(
    model: Model, frames: Sequence[Frame], noisy: Sequence[str]
) -> Curve:
    """Variance against level: of the model, and of the residuals."""
    count = 16
    edges = np.geomspace(1e-3, 1, count)
    square, weight, level = np.zeros((3, count + 1))
    expected = np.zeros(count + 1)
    for frame in frames:
        p = predict(model, frame)
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
    half = CI95 * y * np.sqrt(2 / weight[seen])
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
