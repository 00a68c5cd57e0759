# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Darks and flats drawn from a profile whose effects are known."""

import numpy as np

from cg2raw.calibration import UniformFrame
from diagnose import planted

ISO = 100.0
BLACK, WHITE = 256.0, 16383
RANGE = WHITE - BLACK
GAIN, READ = 2.5, 3.0  # e-/DN; DN, rounding not included
SHAPE = (192, 256)
# Effects that a calibration takes together, with what two of them are beside.
PATTERNS = {
    "dsnu": {"sigma": 2 / RANGE},
    "column_fixed_pattern": {"sigma": 0.5 / RANGE},
    "dark_current": {"per_second": 0.5 / RANGE},
    "dark_current_nonuniformity": {"rate": 0.4 / RANGE, "log_sigma": 0.5},
    "hot_pixels": {"fraction": 0.01, "rate": 4 / RANGE},
    "prnu": {"sigma": 0.01},
}


def sensor_of(effects=None, shape=SHAPE, **fields):
    """Return a 14-bit Bayer sensor with @effects, {name: {parameter: value}}."""
    size = {"width": shape[1], "height": shape[0]}
    return planted.sensor_of(GAIN * RANGE, GAIN * READ, effects, **size, **fields)


def frames_of(sensor, seed=1, biases=6, darks=6, flats=6, **more):
    """Return biases, darks of 30 s and flats of half the range, drawn by @seed.

    more : dark_times (s), flat_times (s, under one lamp that fills half the range in
    one second), shape, drift (DN, of each frame's level), lamp (relative)."""
    shape = more.get("shape", (sensor.height, sensor.width))
    rng = np.random.default_rng(seed)
    plan = [("dark", 0.0)] * biases
    for time in more.get("dark_times", (30.0,)):
        plan += [("dark", time)] * darks
    for time in more.get("flat_times", (1.0,)):
        plan += [("flat", time)] * flats
    found = []
    for number, (kind, time) in enumerate(plan):
        lamp = 0.5 * time * (1 + rng.normal() * more.get("lamp", 0.0))
        shift = rng.normal() * more.get("drift", 0.0)
        light = lamp if kind == "flat" else 0.0
        raw = drawn(sensor, shape, light, time, seed, number, shift)
        found.append(UniformFrame(f"{kind}-{number}", kind, raw, time, ISO))
    return found


def frame_of(number, kind, dn, time=0.0, white=WHITE):
    """Return the frame whose codes are DN, rounded and clipped. time : s."""
    raw = np.clip(np.rint(dn), 0, white).astype(np.uint16)
    return UniformFrame(f"{kind}-{number}", kind, lambda: raw, time, ISO)


def drawn(sensor, shape, light, time, seed, number, shift):
    """Return () -> (H, W) uint16 of one frame, @light of white on each site."""

    def raw():
        image = np.full((*shape, 3), light, np.float32)
        signal = sensor.signal(
            image,
            illuminant="neutral:1:1",
            iso=ISO,
            seed=seed,
            frame=number,
            convention="sensor",
            camera_input=True,
            exposure_time=time,
        )
        return sensor.raw_from_signal(signal + np.float32(shift / RANGE))

    return raw
