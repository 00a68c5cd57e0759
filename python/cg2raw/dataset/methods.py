# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Methods by which a camera and its light are chosen for an image."""

from dataclasses import dataclass

from cg2raw.dataset.keys import hashed
from cg2raw.sensor import Sensor
from cg2raw.upi import Upi


@dataclass(frozen=True)
class Scene:
    """What the clean and the noisy files of one image have in common."""

    image: str
    illuminant_index: int
    illuminant: str
    asked_gain: float | str  # a number, or "sample"
    patch: int


@dataclass(frozen=True)
class Camera:
    """The sensor that simulates, and how it is exposed."""

    sensor: Sensor
    illuminant: str
    digital_gain: float
    seed: int | None  # of what the method drew; None: nothing


def graphics2raw(sensor: Sensor, scene: Scene, seed: int) -> Camera:
    """Return the sensor itself under the scene's light.

    Raises ValueError if a gain is to be drawn from a sensor that has none."""
    gain = scene.asked_gain
    if isinstance(gain, str):  # "sample"
        key = (scene.image, sensor.id, scene.illuminant_index, scene.patch)
        gain = sensor.simulation(
            (2, 2),
            illuminant="D65",
            seed=seed,
            frame=hashed("digital_gain", *key),
            digital_gain="sample",
            effects=False,
        ).digital_gain
    return Camera(sensor, scene.illuminant, gain, None)


def upi(sensor: Sensor, scene: Scene, seed: int) -> Camera:
    """Return a camera that UPI draws with the CFA, levels and noise of the sensor: one
    for each image, patch and light. A gain that is to be drawn is UPI's own."""
    key = (seed, scene.image, sensor.id, scene.illuminant_index, scene.patch)
    draw_seed = hashed("upi", *key)
    gain = "upi" if scene.asked_gain == "sample" else scene.asked_gain
    drawn = Upi(sensor, digital_gain=gain).draw(draw_seed)
    return Camera(drawn.sensor, drawn.illuminant, drawn.digital_gain, draw_seed)


METHODS = {"graphics2raw": graphics2raw, "upi": upi}
