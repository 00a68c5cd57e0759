# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Source: one image of a data set, read once, as each sensor takes it."""

from typing import Any, Protocol

import numpy as np

from cg2raw import Run, Sensor, _core
from cg2raw.arrays import FloatImage
from cg2raw.dataset.plan import Plan
from cg2raw.io.image_file import Image, read_image
from cg2raw.io.spectra_file import SpectraFile, read_spectra, spectra_in
from cg2raw.spectra import SEEN, Rows, estimated_light, is_estimate, seen_light

Box = tuple[int, int, int, int]  # x, y, width, height


class Source(Protocol):
    """What files are made of; image : as it was read."""

    image: Image

    def seen(
        self, box: Box, sensor: Sensor, word: str
    ) -> tuple[FloatImage, dict[str, Any]]:
        """Return (pixels of a crop, the fields of a Run that they decide).

        word : of the illuminant. Raises ValueError."""

    def meter(self, rule: str, sensor: Sensor, word: str) -> float | None:
        """Return what the light meter of an exposure reads of the whole image."""

    def row(self) -> dict[str, Any]:
        """Return what the manifest says of the image."""


def read_source(path: str, plan: Plan) -> Source:
    """Return the Source at @path. Raises ValueError, OSError."""
    file = spectra_in(path) if plan.layer is None else None
    if file is not None:
        return SpectralSource(file, plan)
    words = () if isinstance(plan.illuminants, int) else plan.illuminants
    for word in filter(is_estimate, words):
        raise ValueError(
            f"has no spectrum for --illuminants {word}, and its light must be named"
        )
    undo = "stated-or-srgb" if plan.linearize else "stated"
    return RgbSource(read_image(path, plan.layer, undo=undo, space=plan.space))


def crop(pixels: FloatImage, box: Box) -> FloatImage:
    """Return the (h, w, N) pixels of a box, in memory of their own if it is smaller."""
    x, y, columns, rows = box
    return np.ascontiguousarray(pixels[y : y + rows, x : x + columns])


class RgbSource:
    """Scene-linear Rec.709, the same for all sensors and lights."""

    def __init__(self, image: Image) -> None:
        self.image = image
        self.last: tuple[Box, FloatImage] | None = None
        self.read: float | None = None  # by the light meter

    def seen(
        self, box: Box, sensor: Sensor, word: str
    ) -> tuple[FloatImage, dict[str, Any]]:
        """As Source says it."""
        if self.last is None or self.last[0] != box:
            self.last = box, crop(self.image.pixels, box)
        return self.last[1], {}

    def meter(self, rule: str, sensor: Sensor, word: str) -> float | None:
        """As Source says it; luminance is the same for all sensors."""
        if self.read is None:
            run = Run(exposure=rule, illuminant="D65")
            self.read = sensor.metered(self.image.pixels, run, threads=1).meter
        return self.read

    def row(self) -> dict[str, Any]:
        """As Source says it."""
        return {
            "layer": self.image.layer,
            "transfer": self.image.undone or "linear",
            "white_luminance": None,
        }


class SpectralSource:
    """Spectra, of which each sensor sees something else."""

    def __init__(self, file: SpectraFile, plan: Plan) -> None:
        check_plan(plan)
        self.file, self.white = file, white_of(file, plan)
        self.image = read_spectra(file)
        self.last: tuple[tuple[Box, str, str], FloatImage, str] | None = None
        self.lights: dict[str, Rows] = {}  # by their words
        self.read: dict[tuple[str, str], float | None] = {}  # by the light meter

    def seen(
        self, box: Box, sensor: Sensor, word: str
    ) -> tuple[FloatImage, dict[str, Any]]:
        """As Source says it; the pixels are camera RGB."""
        key = (box, sensor.id, word)
        if self.last is None or self.last[0] != key:
            self.last = key, *self.camera(box, sensor, word)
        _, pixels, white = self.last
        return pixels, {"illuminant": white, **SEEN}

    def camera(self, box: Box, sensor: Sensor, word: str) -> tuple[FloatImage, str]:
        """Return (camera RGB of a crop, the word for what is white)."""
        light, white = seen_light(sensor, word, self.estimate)
        response = _core.SpectralResponse(
            sensor.profile, light, self.file.bins, self.white
        )
        return response.to_camera(crop(self.image.pixels, box), threads=1), white

    def meter(self, rule: str, sensor: Sensor, word: str) -> float | None:
        """As Source says it, of what the sensor sees."""
        key = (sensor.id, word)
        if key not in self.read:
            height, width = self.image.pixels.shape[:2]
            pixels, of_pixels = self.seen((0, 0, width, height), sensor, word)
            run = Run(exposure=rule, **of_pixels)
            self.read[key] = sensor.metered(pixels, run, threads=1).meter
        return self.read[key]

    def estimate(self, word: str) -> Rows:
        """Return the light's spectrum, of the whole image, measured once a word."""
        if word not in self.lights:
            self.lights[word] = estimated_light(
                word,
                self.file.light,
                self.file.bins.wavelengths,
                lambda statistic: statistic.of([self.image.pixels]),
            )
        return self.lights[word]

    def row(self) -> dict[str, Any]:
        """As Source says it; no matrix has made its camera RGB."""
        return {
            "layer": "",
            "transfer": "linear",
            "white_luminance": self.white,
            "transform_first": None,
            "transform_second": None,
            "transform_gains": None,
        }


def white_of(file: SpectraFile, plan: Plan) -> float:
    """Return cd/m2 of white, as asked or as the file says. Raises ValueError."""
    white = plan.white_luminance or file.white
    if white is None:
        raise ValueError(
            "its channels are spectral radiance in W/(m2 sr nm): which luminance is "
            "white? Add --white-luminance CD_PER_M2, such as 100"
        )
    return white


def check_plan(plan: Plan) -> None:
    """Raise ValueError for options that have no meaning for spectra."""
    start = "its channels are a spectrum: "
    if plan.method != "graphics2raw":
        raise ValueError(f"{start}--method {plan.method} is of RGB; leave it out")
    if plan.convention not in ("sensor", "spectral"):
        raise ValueError(
            f"{start}--convention {plan.convention} is of RGB: --convention spectral, "
            "or name its RGB picture by --layer"
        )
    if plan.digital_gains != (1.0,):
        raise ValueError(f"{start}--digital-gain is of RGB: change --exposure")
    if plan.scene_luminance is not None:
        raise ValueError(
            f"{start}their luminance is known; leave --scene-luminance out"
        )
    if isinstance(plan.illuminants, int):
        raise ValueError(
            f"{start}its light is in them, and --illuminants {plan.illuminants} draws "
            "others: --illuminants WORD, or estimate"
        )
    for id, sensor in plan.cameras.items():
        if sensor.spectral_sensitivities is None:
            raise ValueError(
                f"{start}sensor {id} has no spectral_sensitivities: leave it out of "
                "--sensors"
            )
