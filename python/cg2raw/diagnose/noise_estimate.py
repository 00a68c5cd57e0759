# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The doubted model's noise; estimated where the profile has none."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cg2raw.diagnose.captures import Capture, CaptureSet


@dataclass(frozen=True)
class NoiseModel:
    """variance(x) = beta1 x + beta2, x in 0..1 above black; one value a CFA site.

    measured : False if it was estimated from the captures, and so proves nothing."""

    beta1: tuple[float, ...]
    beta2: tuple[float, ...]
    measured: bool = True


def noise_models(capture_set: CaptureSet) -> dict[float | None, NoiseModel]:
    """Return the noise of every ISO of the captures.

    Raises ValueError for an ISO that is too far from those of the profile."""
    sensor = capture_set.sensor
    models: dict[float | None, NoiseModel] = {}
    for iso in {capture.iso for capture in capture_set.captures}:
        if sensor.noise and iso is not None:
            row = sensor.noise_at(iso)
            models[iso] = NoiseModel(tuple(row["beta1"]), tuple(row["beta2"]))
        else:
            chosen = [c for c in capture_set.captures if c.iso == iso]
            models[iso] = _estimated(sensor, chosen)
    return models


def _estimated(sensor: Any, captures: Sequence[Capture]) -> NoiseModel:
    """Variance against level from differences of neighbours of one colour.

    Second differences cancel slopes; their median forgets edges. Source: A. Foi et al.,
    IEEE Trans. Image Process. 17(10), 2008, for the model."""
    levels, variances, weights = [], [], []
    step = 2 * round(np.sqrt(len(sensor.cfa)) / 2)
    for capture in captures[:6]:
        raw = capture.raw()
        height, width = (min(n, 1536) for n in raw.shape)
        signal = np.asarray(sensor.signal_from_raw(raw[:height, :width]), float)
        a, b, c = signal[:, : -2 * step], signal[:, step:-step], signal[:, 2 * step :]
        second, level = b - (a + c) / 2, (a + b + c) / 3
        usable = (raw[:height, step : width - step] < sensor.white_level) & (
            level < 0.9
        )
        edges = np.unique(np.quantile(level[usable], np.linspace(0, 1, 25)))
        bins = np.digitize(level[usable], edges)
        for one in np.unique(bins):
            chosen = bins == one
            if chosen.sum() < 200:
                continue
            spread = np.median(np.abs(second[usable][chosen])) / 0.6745
            levels.append(level[usable][chosen].mean())
            variances.append(spread**2 / 1.5)
            weights.append(chosen.sum())
    if not levels:
        raise ValueError(
            f"sensor {sensor.id} has no noise at these ISOs and none of the captures "
            "shows enough pixels to estimate it: give a profile with noise, and iso"
        )
    x, v = np.maximum(levels, 0), np.array(variances)
    w = np.sqrt(weights) / np.maximum(v, 1e-12)
    design = np.stack([x, np.ones_like(x)], 1)
    from scipy.optimize import nnls

    (slope, offset), _ = nnls(design * w[:, None], v * w)
    return NoiseModel(
        (max(slope, 1e-8),), (max(offset, 1e-10),), measured=False
    )
