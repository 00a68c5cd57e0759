# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Ground truth: what the manifest says of a file's light, colours, levels and noise."""

from collections.abc import Sequence

import numpy as np

from cg2raw import Illuminant, Sensor, _core
from cg2raw.cfa import is_mono
from cg2raw.dataset.journal import Row

PHYSICAL = ["poisson_shot_noise", "heavy_tailed_noise"]
GAUSSIAN = ["shot_noise", "read_noise"]
SHAPE = ("tukey_lambda", "row_sigma", "outlier_fraction", "outlier_variance_ratio")


def truth(
    sensor: Sensor,
    illuminant: Illuminant,
    convention: str,
    gain: float,
    shape: Sequence[int],
) -> Row:
    """Return what is known of the light and of the file's numbers."""
    transform = _core.camera_from_scene(sensor.profile, illuminant, convention, gain)
    return {
        "width": shape[1],
        "height": shape[0],
        "black_level": list(map(float, sensor.black_level)),
        "white_level": float(sensor.white_level),
        "cfa": sensor.cfa,
        "digital_gain": gain,
        "neutral": list(illuminant.neutral),
        "xy": list(illuminant.xy),
        "cct": illuminant.cct,
        "duv": illuminant.duv,
        "camera_from_xyz": matrix_of(sensor, illuminant),
        "transform_first": transform.first.ravel().tolist(),
        "transform_second": transform.second.ravel().tolist(),
        "transform_gains": list(transform.gains),
    }


def matrix_of(sensor: Sensor, illuminant: Illuminant) -> list[float] | None:
    """Return the colour matrix, 9 numbers row by row; None of a monochrome sensor."""
    if is_mono(sensor.cfa):
        return None
    matrix: list[float] = sensor.camera_from_xyz(illuminant.xy).ravel().tolist()
    return matrix


def noise_of(sensor: Sensor, iso: float | None, noise: str | None) -> Row:
    """Return what is known of a file's noise; all of it None without noise.

    noise : as of cg2raw.Run. Source of the relations to electrons: EMVA 1288 R4.0."""
    names = ("beta1", "beta2", "system_gain", "read_noise", "noise_effects", *SHAPE)
    found: Row = dict.fromkeys(names)
    if iso is None:
        return found
    known = sensor.noise_at(iso)
    found |= {name: known.get(name) for name in ("beta1", "beta2", *SHAPE)}
    found["noise_effects"] = effects_of(sensor, noise, known.get("row_sigma", 0.0))
    beta1, beta2 = np.array(known["beta1"]), np.array(known["beta2"])
    if beta1.all():  # else the profile states no electrons
        dn_of_white = sensor.white_level - np.array(sensor.black_level)
        found["system_gain"] = (beta1 * dn_of_white).tolist()
        found["read_noise"] = (np.sqrt(beta2) / beta1).tolist()
    return found


def effects_of(sensor: Sensor, noise: str | None, row_sigma: float) -> list[str]:
    """Return the names of the effects that draw the noise of an ISO."""
    named = {None: sensor.noise_effects, "gaussian": GAUSSIAN, "physical": PHYSICAL}
    drawn = list(named[noise])
    if "heavy_tailed_noise" in drawn and row_sigma > 0.0:
        drawn.append("row_noise")
    return drawn
