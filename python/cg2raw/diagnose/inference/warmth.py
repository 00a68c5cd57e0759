# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Warmth: hot pixels tell the temperature of each dark better than its header.

A reading is rounded to some tenths of a degree, by which dark charge differs by a
percent: many standard deviations of a hot pixel. So each frame's charge is compared
with the map of all of them, within what the reading leaves open.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cg2raw.diagnose.effects.dark_current import DARK_CURRENT
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict

GLOW = "amplifier_glow"  # of a profile, which alone moves predictions besides
SURE = 10.0  # standard deviations of a pixel's rate, from where on it is a thermometer
FARTHEST_HOT = 6.0  # standard deviations of a residual that counts
STEPS = 3  # until what counts stays
UNKNOWN_WARMTH = (
    0.05  # relative, of dark charge, where a temperature is declared as free
)


def reading_error(frames: Sequence[Frame], is_free: bool) -> float:
    """Return the relative standard deviation of dark charge that readings of the
    temperature leave open: by their least difference, to which they are rounded. 0
    where there are none, unless the temperature is free."""
    readings = np.unique([frame.warmth for frame in frames])
    if len(readings) > 1:
        return float(np.diff(np.log(readings)).min() / np.sqrt(12))
    return UNKNOWN_WARMTH if is_free else 0.0


def warmed(model: Model, splits: Splits, error: float) -> Splits:
    """Return the frames as warm as the hot pixels of a model's maps say, the fit frames
    as warm as before on the average. error : of reading_error."""
    if not error:
        return splits

    def factor(frame: Frame) -> float:
        return 1.0 if frame.capture.shows.light else _factor(model, frame, error)

    factors = np.array(splits.workers.map(factor, splits.frames))
    fitted = [
        f.capture.group == "fit" and not f.capture.shows.light and f.seconds > 0
        for f in splits.frames
    ]
    if any(fitted):
        factors = factors / np.exp(np.log(factors[fitted]).mean())
    frames = [
        frame if frame.capture.shows.light else replace(frame, warmth=frame.warmth * by)
        for frame, by in zip(splits.frames, factors, strict=True)
    ]
    return Splits(frames, splits.workers)


def as_warm(splits: Splits, others: Splits) -> Splits:
    """Return the frames as warm as the same frames among others."""
    pairs = zip(splits.frames, others.frames, strict=True)
    frames = [replace(frame, warmth=other.warmth) for frame, other in pairs]
    return Splits(frames, splits.workers)


def by_temperature(model: Model, splits: Splits) -> Model:
    """Return the model with dark current that goes with the temperature, as all does
    that the profile says of charge without light, or alone: as the select frames say.
    """
    listed = model.profile_parameters
    if DARK_CURRENT not in model.found_names or not {DARK_CURRENT, GLOW} <= set(listed):
        return model
    other = replace(model, by_temperature=not model.by_temperature)
    other = fit(other, splits.fit)
    gain = splits.select.total(other) - splits.select.total(model)
    return other if gain > 0 else model


def _factor(model: Model, frame: Frame, error: float) -> float:
    """Return by how much a dark's charge exceeds what is predicted."""
    charge = _sure_charge(model, frame)
    used = (charge > 0) & frame.keep & ~frame.censored
    if not used.any():
        return 1.0
    p = predict(model, frame)
    residual = (frame.signal - p.mean)[used]
    spread = np.sqrt(p.variance)[used]
    slope = charge[used] / spread
    found = 0.0
    for _ in range(STEPS):
        z = residual / spread - found * slope
        inside = np.abs(z) < FARTHEST_HOT
        weight = (slope[inside] ** 2).sum() + 1 / error**2
        found += float(((slope * z)[inside].sum() - found / error**2) / weight)
    return 1 + found


def _sure_charge(model: Model, frame: Frame) -> Array:
    """Return the charge of pixels whose rate is known well, 0 of the others."""
    charge = np.zeros_like(frame.signal)
    for _, effect, sensor_map in model.maps:
        if effect.is_charge and sensor_map.mean.shape == charge.shape:
            sure = sensor_map.mean > SURE * np.sqrt(sensor_map.variance)
            charge += np.where(sure, frame.seconds * sensor_map.mean, 0)
    return charge
