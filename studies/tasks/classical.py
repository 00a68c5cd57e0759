# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The calibration of the world: grey world and shades of grey, as published on NUS.

It knows no source but real, so that no constant of the world can favour one."""

from collections.abc import Mapping
from dataclasses import astuple

import numpy as np
from numpy.typing import NDArray

from studies.cameras import NUS, Camera
from studies.protocol import ClassicalRules
from studies.sources.real import real
from studies.tasks.angles import Summary, degrees
from studies.world.exposure import exposed
from studies.world.shots import World, shots

# Of the eight NUS cameras, geometric means. Source: D. Cheng, D. Prasad and M. Brown,
# JOSA A 31(5), 2014, as J. Barron, ICCV 2015, and others since sum it up.
PUBLISHED = {
    "grey world": Summary(4.14, 3.20, 0.90, 9.00),
    "shades of grey": Summary(3.40, 2.57, 0.77, 7.41),
}
Image = NDArray[np.float32]


def estimates(image: Image, rules: ClassicalRules) -> dict[str, NDArray[np.float64]]:
    """Return each method's neutral (3,), of any scale, of camera RGB (H, W, 3), 0..1.

    Pixels with a saturated channel are left out, unless all are."""
    kept = image[image.max(axis=2) < rules.saturated].astype(np.float64)
    pixels = kept if len(kept) else image.reshape(-1, 3).astype(np.float64)
    norm = (pixels**rules.power).mean(axis=0) ** (1.0 / rules.power)
    return {"grey world": pixels.mean(axis=0), "shades of grey": norm}


def classical(world: World, camera: Camera, frames: int) -> dict[str, list[float]]:
    """Return each method's errors in degrees of that many test frames of one of NUS.

    No two cameras photograph a scene."""
    rules = world.protocol.classical
    first = rules.first + list(NUS).index(camera.id) * frames
    tests = shots(world, "test", "day", camera.cards, first, frames, seed=first)
    truth = real(tests, camera.sensitivities)
    found: dict[str, list[float]] = {name: [] for name in PUBLISHED}
    for image, neutral in zip(truth.images, truth.neutrals, strict=True):
        estimated = estimates(exposed(image, world.protocol.exposure), rules)
        for name, estimate in estimated.items():
            found[name].append(float(degrees(estimate, neutral)))
    return found


def over_cameras(found: Mapping[str, Mapping[str, Summary]]) -> dict[str, Summary]:
    """Return each method's Summary, geometric means over cameras as PUBLISHED has them.

    found : {camera: {method: of its errors in degrees}}."""
    together = {}
    for method in PUBLISHED:
        rows = [astuple(summaries[method]) for summaries in found.values()]
        together[method] = Summary(*np.exp(np.log(rows).mean(axis=0)).tolist())
    return together
