# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The way back: captures as a found profile simulates them, to be diagnosed again.

With the profile as its own model there must be no gap."""

import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from cg2raw.diagnose.captures import Capture, CaptureSet
from cg2raw.sensor import Sensor

Simulate = Callable[[Sensor, Capture, int], Any]


def simulated(
    capture_set: CaptureSet, sensor: Sensor, simulate: Simulate | None = None
) -> CaptureSet:
    """Return captures of the same scenes by another sensor, without nuisances.

    simulate : (sensor, capture, number of the frame) -> (H, W) uint16 DN;
        `by_registry` if not given."""
    draw = simulate or by_registry
    captures = [
        replace(capture, raw=partial(draw, sensor, capture, number), log_density=None)
        for number, capture in enumerate(capture_set.captures)
    ]
    return replace(
        capture_set,
        sensor=sensor,
        captures=captures,
        nuisances=frozenset(),
        uncertainty={},
    )


def _scene(capture: Capture) -> Any:
    scene = np.zeros(3) if capture.scene is None else np.asarray(capture.scene())
    if scene.ndim == 3:
        return np.ascontiguousarray(scene, np.float32)
    return np.broadcast_to(scene.astype(np.float32), (*capture.shape, 3)).copy()


def by_registry(sensor: Sensor, capture: Capture, number: int) -> Any:
    """Return a frame as Sensor.simulate draws it."""
    return np.asarray(
        sensor.simulate(
            _scene(capture),
            illuminant=capture.illuminant,
            iso=capture.iso,
            exposure_time=capture.exposure_time,
            convention="sensor",
            frame=number,
            threads=1,
        )
    )


def by_plugin(
    oiiotool: Sequence[str],
    profile: Path,
    sensor: Sensor,
    capture: Capture,
    number: int,
) -> Any:
    """Return a frame as OpenImageIO's plugin writes it, read back by LibRaw.

    oiiotool : command, with the plugin on its path. profile : file of the sensor."""
    import OpenImageIO as oiio

    from cg2raw.diagnose.raw_files import read_header, read_raw

    with tempfile.TemporaryDirectory() as folder:
        scene, dng = Path(folder) / "scene.exr", Path(folder) / "frame.dng"
        pixels = _scene(capture)
        spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "float")
        image = oiio.ImageBuf(spec)
        image.set_pixels(spec.roi, pixels)
        if not image.write(str(scene)):
            raise OSError(f"{scene}: {image.geterror()}")
        words = {
            "dng:sensor": str(profile),
            "dng:illuminant": capture.illuminant,
            "dng:convention": "sensor",
            "dng:iso": str(capture.iso),
            "dng:frame": str(number),
        }
        command = [*oiiotool, str(scene)]
        for name, value in words.items():
            command += ["--sattrib", name, value]
        command += ["--attrib:type=float", "ExposureTime", str(capture.exposure_time)]
        subprocess.run([*command, "-o", str(dng)], check=True, capture_output=True)
        return read_raw(str(dng), read_header(str(dng)).active)
