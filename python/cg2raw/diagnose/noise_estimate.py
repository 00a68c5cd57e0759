# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The doubted model's noise; estimated where the profile has none."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.optimize import nnls

from cg2raw.diagnose.captures import Capture, CaptureSet


@dataclass(frozen=True)
class NoiseModel:
    """variance(x) = beta1 x + beta2, x in 0..1 above black; one value a CFA site.

    beta2 : without that of rows, where the profile draws them.
    measured : False if it was estimated from the captures, and so proves nothing.
    drawn : how the profile says that noise is drawn beyond its variance: values of
        flows by name, in the units of the vocabulary.
    """

    beta1: tuple[float, ...]
    beta2: tuple[float, ...]
    measured: bool = True
    drawn: Mapping[str, tuple[float, ...]] = field(default_factory=dict)


def noise_models(capture_set: CaptureSet) -> dict[float | None, NoiseModel]:
    """Return the noise of every ISO of the captures.

    Raises ValueError for an ISO that is too far from those of the profile."""
    sensor = capture_set.sensor
    models: dict[float | None, NoiseModel] = {}
    for iso in {capture.iso for capture in capture_set.captures}:
        if sensor.noise and iso is not None:
            models[iso] = _of_row(sensor, sensor.noise_at(iso))
        else:
            chosen = [c for c in capture_set.captures if c.iso == iso]
            models[iso] = _estimated(sensor, chosen)
    return models


def _of_row(sensor: Any, row: Mapping[str, Any]) -> NoiseModel:
    """Return the noise of one ISO as the profile draws it."""
    beta2 = np.asarray(row["beta2"], float)
    drawn: dict[str, tuple[float, ...]] = {}
    rows = 0.0
    if "photon_statistics" in sensor.noise_effects:
        drawn["photon_statistics"] = (1.0,)
    if "heavy_tailed_noise" in sensor.noise_effects:
        rows = row.get("row_sigma", 0.0)
        beta2 = np.maximum(beta2 - rows**2, 1e-12)
        if row.get("outlier_fraction", 0.0) > 0:
            drawn["heavy_tailed_noise"] = (
                row["outlier_fraction"],
                row["outlier_variance_ratio"],
            )
    for effect in sensor.effects:
        if effect["name"] == "row_noise":
            rows = float(np.hypot(rows, effect["parameters"]["sigma"]))
    if rows:
        drawn["row_noise"] = (rows / float(np.sqrt(beta2.mean())),)
    return NoiseModel(tuple(row["beta1"]), tuple(beta2), drawn=drawn)


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
    (slope, offset), _ = nnls(design * w[:, None], v * w)
    return NoiseModel((max(slope, 1e-8),), (max(offset, 1e-10),), measured=False)
