# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Plan of a data set: name, key and drawn settings of each file."""

import json
from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import cached_property
from itertools import product
from typing import Any

from cg2raw import Sensor, __version__, effects
from cg2raw.dataset.images import folder_of
from cg2raw.dataset.kept_profiles import PLAN, checked, sha256_of
from cg2raw.dataset.keys import hashed
from cg2raw.dataset.methods import Camera, Scene

ENDINGS = {"dng": ".dng", "npy": ".npy", "exr": ".exr"}
# Effects that need an exposure time.
TIMED = {effect["name"] for effect in effects() if effect["needs_exposure_time"]}


@dataclass(frozen=True)
class Plan:
    """All that decides the bytes of a data set, but for its images.

    sensors : ids, in order.
    illuminants : words, or the number of lights that are drawn for each image.
    digital_gains : numbers, or ("sample",), drawn from the sensor's profile.
    isos : numbers; None is clean.
    crop : (width, height) of the random crops, or None; patches : how many per image.
    element_type : "float32" or "uint16", of packed files.
    exposure, f_number, scene_luminance, nd_filter, time_limits, f_number_limits : as of
    cg2raw.Run; of an image's exposure, crops have the same. f_number : None for what
    each image's Exif says. bracket : stops of the files of each exposure, or None.
    exposure_time : seconds; None for what each image's Exif says.
    white_luminance : cd/m2 of white in spectral images; None for what each says.
    layer : of layered images; None for the picture by the conventions of renderers.
    linearize : "srgb", the curve of whole numbers whose files state none; None: they
    are an error. space : of all images, whatever they say.
    frame_from : what tells the noise of one image from that of another: its "name", its
    "index" among the images, or "none", nothing.
    profiles : {id: JSON text}, as Sensor.to_json gives it.
    light_draws : what a number of illuminants draws, words of "sample", of the Gaussian
    of the sensor's neutrals, or of "measured", near the neutrals themselves.
    folders : what an image's folder is called by; older data sets have none, theirs
    were called as the image files."""

    sensors: tuple[str, ...]
    illuminants: tuple[str, ...] | int
    digital_gains: tuple[float | str, ...]
    isos: tuple[float | None, ...]
    exposure_time: float | None
    white_luminance: float | None
    noise: str | None
    convention: str
    method: str
    format: str
    element_type: str
    compression: str
    crop: tuple[int, int] | None
    patches: int
    seed: int
    layer: str | None
    frame_from: str
    profiles: dict[str, str]
    light_draws: str = "sample"
    folders: str = "stem"
    linearize: str | None = None
    exposure: str | None = None
    f_number: float | None = None
    scene_luminance: float | None = None
    nd_filter: float | None = None
    time_limits: str | None = None
    f_number_limits: str | None = None
    bracket: tuple[float, ...] | None = None
    space: str | None = None

    def words(self, image: str) -> list[str]:
        """Return the words of the illuminants of one image."""
        if isinstance(self.illuminants, int):
            return [
                # 31 bits: the largest draw of the illuminant grammar
                f"{self.light_draws}:"
                f"{hashed('illuminant', self.seed, image, index) >> 22}"
                for index in range(self.illuminants)
            ]
        return list(self.illuminants)

    def variants(self, image: str, index: int) -> Iterator["Variant"]:
        """Yield the Variants of the index-th image, in the order of the manifest."""
        shots: dict[str, str | int | None]
        shots = {"name": image, "index": index, "none": None}
        shot = shots[self.frame_from]
        words = self.words(image)
        scenes = product(range(self.patches), self.sensors, range(len(words)))
        for patch, sensor, light in scenes:
            for gain, iso, stops in product(
                self.digital_gains, self.exposures[sensor], self.bracket or (None,)
            ):
                yield Variant(
                    self,
                    image,
                    shot,
                    patch,
                    sensor,
                    light,
                    words[light],
                    gain,
                    iso,
                    stops,
                )

    @property
    def files_of_an_image(self) -> int:
        """Return how many Variants an image has."""
        lights = self.illuminants
        count = lights if isinstance(lights, int) else len(lights)
        isos = sum(len(self.exposures[sensor]) for sensor in self.sensors)
        steps = len(self.bracket or (None,))
        return self.patches * count * len(self.digital_gains) * isos * steps

    @cached_property
    def cameras(self) -> dict[str, Sensor]:
        """Return {id: Sensor}."""
        return {id: Sensor.from_json(self.profiles[id], id) for id in self.sensors}

    @cached_property
    def exposures(self) -> dict[str, list[float | None]]:
        """Return {id: those of the ISOs at which the sensor's noise is known}."""
        return {
            id: [iso for iso in self.isos if self.why_not(camera, iso) is None]
            for id, camera in self.cameras.items()
        }

    @cached_property
    def timed(self) -> dict[str, list[str]]:
        """Return {id: effects of the sensor that need an exposure time}, if any."""
        listed = {
            id: [e["name"] for e in camera.effects if e["name"] in TIMED]
            for id, camera in self.cameras.items()
        }
        return {id: names for id, names in listed.items() if names}

    def run(
        self, camera: Camera, iso: float | None, seconds: float | None
    ) -> dict[str, Any]:
        """Return the fields of the cg2raw.Run of a Camera that a method has chosen."""
        return {
            "exposure": self.exposure,
            "f_number": self.f_number,
            "scene_luminance": self.scene_luminance,
            "nd_filter": self.nd_filter or 0.0,
            "time_limits": self.time_limits,
            "f_number_limits": self.f_number_limits,
            "illuminant": camera.illuminant,
            "digital_gain": camera.digital_gain,
            "iso": iso,
            "noise": self.noise if iso is not None else None,
            "seed": self.seed,
            "convention": self.convention,
            "exposure_time": seconds,
        }

    def seconds(self, of_image: float | None) -> float | None:
        """Return the exposure time of an image whose Exif says @of_image, or None.

        Raises ValueError if there is none and a sensor needs it."""
        found = of_image if self.exposure_time is None else self.exposure_time
        if found is None and self.timed:
            id, names = next(iter(self.timed.items()))
            raise ValueError(
                f"has no exposure time, and {', '.join(names)} of {id} need one: "
                "--exposure-time SECONDS, or oiiotool --attrib ExposureTime SECONDS"
            )
        return found

    @cached_property
    def profile_sha256(self) -> dict[str, str]:
        """Return {id: SHA-256 of the profile's JSON text}."""
        return {id: sha256_of(text) for id, text in self.profiles.items()}

    def why_not(self, camera: Sensor, iso: float | None) -> str | None:
        """Return why a Sensor has no noise at an ISO, None if it has."""
        if iso is None:
            return None
        try:
            known = camera.noise_at(iso)
        except ValueError as error:
            return str(error)
        if self.noise == "physical" and "tukey_lambda" not in known:
            return f"{camera.id} has no tukey_lambda and row_sigma: --noise gaussian"
        return None

    def crop_at(
        self, image: str, patch: int, width: int, height: int
    ) -> tuple[int, int, int, int]:
        """Return (x, y, width, height) of a crop. Raises ValueError if it is larger."""
        if self.crop is None:
            return (0, 0, width, height)
        if width < self.crop[0] or height < self.crop[1]:
            raise ValueError(
                f"is {width}x{height}, smaller than the crop "
                f"{self.crop[0]}x{self.crop[1]}"
            )
        key = ("crop", self.seed, image, patch)
        x = hashed(*key, "x") % (width - self.crop[0] + 1)
        y = hashed(*key, "y") % (height - self.crop[1] + 1)
        return (x, y, *self.crop)

    def to_json(self) -> str:
        """Return the text of dataset.json."""
        found = {field.name: getattr(self, field.name) for field in fields(self)}
        found["profiles"] = {id: json.loads(text) for id, text in self.profiles.items()}
        found["profile_sha256"] = self.profile_sha256
        return json.dumps({"cg2raw": __version__, **found}, indent=1) + "\n"

    @classmethod
    def from_json(cls, text: str | bytes) -> "Plan":
        """Return the plan of dataset.json. Raises ValueError, KeyError, TypeError."""
        found = json.loads(text)
        del found["cg2raw"]
        found["profiles"] = {id: checked(PLAN, id, found) for id in found["profiles"]}
        del found["profile_sha256"]
        for name, value in found.items():
            if isinstance(value, list):
                found[name] = tuple(value)
        return cls(**found)


@dataclass(frozen=True)
class Variant:
    """One file of a data set."""

    plan: Plan
    image: str
    shot: str | int | None  # what keys the noise of the image
    patch: int
    sensor: str
    illuminant_index: int
    illuminant: str
    asked_gain: float | str
    iso: float | None
    bracket: float | None = None

    @property
    def key(self) -> tuple[object, ...]:
        """Return what keys this file's noise."""
        return (
            self.shot,
            self.sensor,
            self.illuminant_index,
            self.asked_gain,
            self.iso,
            self.patch,
        )

    @cached_property
    def path(self) -> str:
        """Return the file's path in the data set's folder."""
        return self.path_at(self.iso)

    @property
    def clean_path(self) -> str | None:
        """Return the path of the clean file of the same scene, None if not made."""
        if self.iso is None or None not in self.plan.isos:
            return None
        return self.path_at(None)

    def path_at(self, iso: float | None) -> str:
        """Return the path that the file has at another ISO."""
        exposure = "clean" if iso is None else f"iso{short(iso)}"
        if self.bracket is not None:
            exposure += f"_ev{self.bracket:+g}"
        patch = "" if self.plan.crop is None else f"_p{self.patch}"
        return (
            f"{folder_of(self.image)}/{self.sensor}_l{self.illuminant_index}_"
            f"g{short(self.asked_gain)}_{exposure}{patch}{ENDINGS[self.plan.format]}"
        )

    @property
    def frame(self) -> int:
        """Return the frame number that keys the file's noise."""
        return hashed("frame", *self.key)

    @property
    def scene(self) -> Scene:
        """Return what clean and noisy files have in common."""
        return Scene(
            self.image,
            self.illuminant_index,
            self.illuminant,
            self.asked_gain,
            self.patch,
        )


def short(number: float | str) -> str:
    """Return a number as briefly as it reads back; a word as it is."""
    if isinstance(number, float) and number.is_integer():
        return str(int(number))
    return str(number)
