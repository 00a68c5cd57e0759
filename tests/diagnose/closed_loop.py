# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Closed loop: captures simulated from an updated profile, to be diagnosed again.

With the profile as its own model there must be no gap."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from cg2raw.arrays import FloatImage, RawImage
from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.sensor import Sensor

Simulate = Callable[[Sensor, Capture, int], RawImage]


def simulated(
    capture_set: CaptureSet, sensor: Sensor, simulate: Simulate | None = None
) -> CaptureSet:
    """Return captures of the same scenes by another sensor, without nuisances.

    simulate : (sensor, capture, number of the frame) -> (H, W) uint16 DN;
        `by_registry` if not given."""
    draw = simulate or by_registry
    captures = [
        replace(capture, raw=partial(draw, sensor, capture, number))
        for number, capture in enumerate(capture_set.captures)
    ]
    return replace(
        capture_set,
        sensor=sensor,
        captures=captures,
        nuisances=frozenset(),
        uncertainty={},
    )


def scene_of(capture: Capture) -> FloatImage:
    """Return what a capture shows, (H, W, 3) float32; zeros where it is unknown."""
    scene = np.zeros(3) if capture.scene is None else np.asarray(capture.scene())
    if scene.ndim == 3:
        return np.ascontiguousarray(scene, np.float32)
    return np.broadcast_to(scene.astype(np.float32), (*capture.shape, 3)).copy()


def by_registry(
    sensor: Sensor, capture: Capture, number: int, seed: int = 0
) -> RawImage:
    """Return a frame as Sensor.simulate draws it."""
    return np.asarray(
        sensor.simulate(
            scene_of(capture),
            illuminant=capture.illuminant,
            iso=capture.iso,
            exposure_time=capture.exposure_time,
            convention="sensor",
            frame=number,
            seed=seed,
            threads=1,
        )
    )
