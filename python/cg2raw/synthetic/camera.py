# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Camera: the numbers of a sensor's profile, in electrons."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw import Sensor

Plane = NDArray[np.float64]
COLORS = "RGB"


@dataclass(frozen=True)
class Camera:
    """A Bayer sensor at one ISO under one light.

    colors : (2, 2) 0, 1, 2 for R, G, B of the sites of a repeat.
    black : (2, 2) DN. white : DN.
    full_well : (2, 2) electrons between black and white.
    read_noise : (2, 2) electrons rms.
    balanced_from_scene : (3, 3), rows add up to 1.
    neutral : (3,) camera RGB of white, largest 1.
    dark : electrons/s without light of a pixel, that the profile knows of.
    """

    colors: NDArray[np.int64]
    black: Plane
    white: int
    full_well: Plane
    read_noise: Plane
    balanced_from_scene: Plane
    neutral: Plane
    dark: float = 0.0

    @property
    def dn_per_electron(self) -> Plane:
        """(2, 2): the system gain."""
        return (self.white - self.black) / self.full_well

    def over(self, per_site: NDArray[Any], shape: tuple[int, int]) -> NDArray[Any]:
        """Return (H, W) values of a (2, 2) repeat."""
        rows, cols = (shape[0] + 1) // 2, (shape[1] + 1) // 2
        return np.tile(per_site, (rows, cols))[: shape[0], : shape[1]]

    def light(self, scene: NDArray[Any]) -> Plane:
        """Return camera RGB, white at 1, of (..., 3) scene-linear Rec.709."""
        balanced = scene.astype(np.float64) @ self.balanced_from_scene.T
        return balanced * self.neutral

    def mosaic(self, rgb: Plane) -> Plane:
        """Return the (H, W) sites of (H, W, 3)."""
        color = self.over(self.colors, rgb.shape[:2])
        return np.take_along_axis(rgb, color[..., None], axis=-1)[..., 0]


def camera_of(sensor: Sensor, illuminant: str, iso: float) -> Camera:
    """Return the camera that a Sensor describes, with its noise at an ISO.

    Raises ValueError for other mosaics than Bayer, and for a profile with effects: the
    generator has its own, and cannot draw those."""
    if len(sensor.black_level) != 4:  # one per site
        raise ValueError(
            f"sensor {sensor.id}: cfa {sensor.cfa} must be a Bayer pattern"
        )
    if sensor.effects:
        raise ValueError(
            f"sensor {sensor.id} has effects of its own, {sensor.effects[0]['name']}; "
            "take a profile without"
        )
    row = sensor.noise_at(iso)
    wells = 1.0 / np.array(row["beta1"], float).reshape(2, 2)
    reads = np.sqrt(np.array(row["beta2"], float).reshape(2, 2)) * wells
    transform = sensor.transform(illuminant, highlights=False)
    return Camera(
        colors=np.array([COLORS.index(letter) for letter in sensor.cfa]).reshape(2, 2),
        black=np.array(sensor.black_level, float).reshape(2, 2),
        white=sensor.white_level,
        full_well=wells,
        read_noise=reads,
        balanced_from_scene=np.array(transform.first, float),
        neutral=np.array(transform.gains, float),
    )
