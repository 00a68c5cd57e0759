# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Frames with a shading and row noise, and the model that knows the shading."""

from cg2raw.diagnose.inference.fitting import fit

from diagnose.planted import (
    READ,
    capture_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
)

SENSOR = sensor_of()
SHADING = {"lens_shading": [0.0, -0.3, -0.3, -0.3, 0.0, 0.0, 0.0]}


def groups_of(seed, sigma=0.0):
    """Return frames to fit and to select on, with a shading and row noise."""

    def rows(frame, rng):
        return sigma * READ * rng.standard_normal((1, frame.tiles.size[0], 1))

    result = []
    for number, group in enumerate(("fit", "select")):
        captures = [
            capture_of(kind, 10 * number + n, name=f"{kind}{n}{group}", group=group)
            for n in range(2)
            for kind in ("dark", "flat", "scene")
        ]
        frames = frames_of(SENSOR, captures)
        result.append(drawn(frames, model_of(SENSOR, **SHADING), [seed, number], rows))
    return result


def shaded(groups):
    """Return the model that knows the shading, fitted."""
    return fit(model_of(SENSOR, **SHADING), on(groups[0]))
