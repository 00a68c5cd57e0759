# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Dust: soft dark spots at places of the sensor."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, stats

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.effects.base import Estimates, SensorMap
from cg2raw.diagnose.effects.families import GAIN, LIGHT, TEMPORAL
from cg2raw.diagnose.effects.fixed_pattern import FixedPattern, share_interval
from cg2raw.diagnose.effects.sizes import percent, value_of
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.frames.tiling import Array, Mask
from cg2raw.sensor import Sensor

# Standard deviation, px, that the map of spots is smoothed by: smaller ones are pixels.
SPOT_WIDTH = 1.5
FROM_EDGE = 6  # px along the edges of tiles: a spot that reaches them may be cut
MEGAPIXEL = 1e6


class Dust(FixedPattern):
    name = "dust"
    title = "dust"
    where = "soft dark spots, the same in all frames, in proportion to light"
    families = frozenset({GAIN, TEMPORAL})
    needs = LIGHT
    layout = "spots"
    measured_by_uniform_frames = False  # a shading that is not fitted would be in it
    # Edges that are sharper than the map's, and the level of what is slow beside spots.
    taken_up_by = {"prnu": 0.015}
    has_strength = False  # how many there are is not how dark they are
    told_apart = {
        "lens_shading": "Flats at another aperture: shadows of dust get smaller and "
        "darker and stay where they are, vignetting is that of the whole frame.",
        "prnu": "Flats: dust shades pixels that lie side by side alike, PRNU differs "
        "from each to the next.",
    }

    def sensitivity(self, frame: Frame, photons: Array) -> Array:
        return photons if frame.capture.shows.light else np.zeros_like(photons)

    def registry_estimates(
        self, estimates: Estimates, sensor_map: SensorMap | None
    ) -> Estimates:
        """Number, depth and radius of the spots that the map has."""
        assert sensor_map is not None
        spots = Spots.of(np.maximum(-sensor_map.mean * sensor_map.share, 0))
        share = MEGAPIXEL / sensor_map.mean.size
        low, high = share_interval(spots.count, 1.0)
        return {
            "density": Estimate(
                spots.count * share, "1/MP", (low * share, high * share)
            ),
            "depth": _mean_of(spots.depths, "1"),
            "radius": _mean_of(spots.radii, "px"),
        }

    def size_in(self, values: Estimates, sensor: Sensor | None) -> str:
        return f"spots shade {percent(value_of(values, 'sigma'))} rms of the frame"


def _mean_of(values: Array, unit: str) -> Estimate:
    """Return the mean of a few, with the interval of Student's t."""
    if not values.size:
        return Estimate(0.0, unit, (0.0, 0.0))
    mean, error = float(values.mean()), float(values.mean())
    if values.size > 1:
        far = stats.t.ppf(0.975, values.size - 1)
        error = float(far * values.std(ddof=1) / np.sqrt(values.size))
    return Estimate(mean, unit, (max(mean - error, 0.0), mean + error))


def pieces_of(mask: Mask) -> tuple[NDArray[np.int32], int]:
    """Return (numbers of the connected pieces of a mask (T, h, w) from 1, 0 elsewhere;
    how many there are): none goes from tile to tile."""
    touching = np.zeros((3, 3, 3))
    touching[1] = 1
    pieces, count = ndimage.label(mask, touching)
    return pieces, count


@dataclass(frozen=True)
class Spots:
    """Of a map: how many spots there are; depths and radii of those that lie within. A
    spot is Gaussian, its radius where half of its loss is left."""

    count: int
    depths: Array
    radii: Array

    @classmethod
    def of(cls, loss: Array) -> "Spots":
        """Return the spots of a map of losses (T, h, w), 0 between them."""
        spots, count = pieces_of(loss > 0)
        inner = spots[:, FROM_EDGE:-FROM_EDGE, FROM_EDGE:-FROM_EDGE]
        cut = set(np.unique(spots)) - set(np.unique(inner))
        for side in (0, -1):
            cut |= set(np.unique(inner[:, side])) | set(np.unique(inner[:, :, side]))
        numbers = np.array([n for n in range(1, count + 1) if n not in cut], int)
        if not numbers.size:
            return cls(count, np.zeros(0), np.zeros(0))
        deepest = np.full(count + 1, np.inf)
        deepest[numbers] = ndimage.maximum(loss, spots, numbers)
        half = loss > 0.5 * deepest[spots]
        seen = np.asarray(ndimage.sum_labels(half, spots, numbers), float) / np.pi
        # The map's kernel is 2 g - g * g, of a Gaussian g: it takes some of the top.
        squared, width = seen / (2 * np.log(2)), SPOT_WIDTH**2
        left = 2 * squared / (squared + width) - squared / (squared + 2 * width)
        return cls(count, deepest[numbers] / left, np.sqrt(seen))


EFFECT = Dust()
