# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Sensor: a profile and what can be simulated with it."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from cg2raw import _core
from cg2raw.argument_types import effect_parameters, path_text, thread_count
from cg2raw.arrays import (
    FloatImage,
    RawImage,
    output_plane,
    pixels_of,
    planes_of,
    raw_plane,
    rgb_image,
    signal_plane,
)
from cg2raw.cfa import demosaic, mosaic
from cg2raw.core_arguments import shown
from cg2raw.exposure import (
    Light,
    Run,
    RunFields,
    check_transform,
    core_run,
    illuminant_word,
    takes_run,
)
from cg2raw.raw_frame import RawFrame

if TYPE_CHECKING:  # type checkers bring it along
    from typing_extensions import Unpack

    Fields = _core.SensorProfile  # what Sensor.__getattr__ finds
else:
    Fields = object


class Sensor(Fields):
    """One camera sensor. It is not altered: a changed profile is another sensor.

    id_or_path : id of an installed profile, or the path of one (.json).

    Its attributes are those of its SensorProfile, such as id, cfa, black_level and
    white_level, and so are its methods illuminant, noise_at and to_json.
    Raises ValueError for an unknown id, listing those installed, or a bad profile.
    """

    __slots__ = ("_profile",)
    _profile: _core.SensorProfile

    def __init__(self, id_or_path: str | os.PathLike[str]) -> None:
        self._profile = _core.load_profile(path_text(id_or_path))

    @classmethod
    def from_json(cls, text: str, name: str = "profile") -> "Sensor":
        """Return the sensor of a profile's JSON text; name stands in messages.

        Raises ValueError naming field, value and bound."""
        return cls.from_profile(_core.parse_profile(text, name))

    @classmethod
    def from_dng(cls, path: str | os.PathLike[str]) -> "Sensor":
        """Return the sensor that one real DNG describes, by its metadata alone.

        Raises ValueError naming file, tag, value and bound."""
        metadata = _core.read_dng_metadata(path_text(path))
        return cls.from_profile(_core.profile_from_dng(metadata))

    @classmethod
    def from_profile(cls, profile: _core.SensorProfile) -> "Sensor":
        """Return the sensor of a profile that is loaded already."""
        if not isinstance(profile, _core.SensorProfile):
            raise TypeError(f"profile {shown(profile)} must be a SensorProfile")
        sensor = cls.__new__(cls)
        sensor._profile = profile
        return sensor

    @property
    def profile(self) -> _core.SensorProfile:
        """The profile, as functions of the core take it."""
        return self._profile

    @property
    def signal_range(self) -> float:
        """DN from the mean black level to white."""
        return self.white_level - float(np.mean(self.black_level))

    def __reduce__(self) -> Any:
        return (Sensor.from_json, (self.to_json(), self.id))

    def __getattr__(self, name: str) -> Any:
        if name == "_profile":
            raise AttributeError(name)
        return getattr(self._profile, name)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *dir(self._profile)]

    def __repr__(self) -> str:
        return f"Sensor({self.id!r})"

    @takes_run
    def simulate(
        self, rgb: ArrayLike, *, threads: int = 0, **run: "Unpack[RunFields]"
    ) -> RawFrame:
        """Return the RAW frame that this sensor would have recorded of an image.

        rgb : (H, W, 3) or (H, W, 4) float, scene-linear Rec.709; alpha is ignored.
            float32 is read in place where its channels lie together; float16 is
            converted a few rows at a time; other floats are copied to float32.
        threads : 0 for one per core; the result does not depend on it.
        run : the fields of cg2raw.Run; only a monochrome sensor needs no illuminant.

        Returns (H, W) uint16 DN. Other Python threads run meanwhile.
        Raises ValueError for other arrays and bad runs."""
        image = rgb_image(rgb)
        simulation = self._simulation_of(image, run, threads)
        frame = simulation.raw(image, threads=thread_count(threads)).view(RawFrame)
        frame.simulation = simulation
        return frame

    @takes_run
    def signal(
        self, rgb: ArrayLike, *, threads: int = 0, **run: "Unpack[RunFields]"
    ) -> FloatImage:
        """Return (H, W) float32 before quantisation: 0..1 above black, not clamped.

        rgb, threads, run : see `simulate`. Raises ValueError."""
        image = rgb_image(rgb)
        simulation = self._simulation_of(image, run, threads)
        return simulation.signal(image, threads=thread_count(threads))

    @takes_run
    def predict(
        self, rgb: ArrayLike, *, threads: int = 0, **run: "Unpack[RunFields]"
    ) -> tuple[FloatImage, FloatImage]:
        """Return (mean, variance) of `signal` over frames, (H, W) float32 each.

        rgb, threads, run : see `simulate`.
        variance : in the square of 0..1 above black; the rounding to DN, which `signal`
        has not, adds 1/12 DN^2. 0 where the signal clips before its noise.

        Raises ValueError."""
        image = rgb_image(rgb)
        simulation = self._simulation_of(image, run, threads)
        return simulation.predict(image, threads=thread_count(threads))

    @takes_run
    def simulation(
        self, shape: Sequence[int], **run: "Unpack[RunFields]"
    ) -> _core.Simulation:
        """Return what decides every pixel of an exposure.

        shape : (H, W) of the image.
        run : the fields of cg2raw.Run; only a monochrome sensor needs no illuminant.

        Raises ValueError naming what is wrong and what is allowed."""
        height, width = shape
        run_of_core = core_run(self.id, Run(**run))
        return _core.Simulation(self._profile, (height, width), run_of_core)

    def metered(self, rgb: ArrayLike, run: Run, *, threads: int = 0) -> Run:
        """Return a Run whose light meter is read of an image, if it needs one.

        rgb : as of `simulate`, such as the whole image that patches are taken of.
        Raises ValueError."""
        return replace(run, meter=self._metered(rgb_image(rgb), run, threads).meter)

    def _metered(self, image: Any, run: Run, threads: int) -> _core.Run:
        own = core_run(self.id, run)
        return _core.metered(self._profile, own, image, threads=thread_count(threads))

    def _simulation_of(
        self, image: Any, run: "RunFields", threads: int
    ) -> _core.Simulation:
        """Return the Simulation of an image, whose light is metered if need be."""
        own = self._metered(image, Run(**run), threads)
        return _core.Simulation(self._profile, image.shape[:2], own)

    def to_camera(
        self,
        rgb: ArrayLike,
        *,
        illuminant: Light = "",
        convention: str = "dng",
        digital_gain: float = 1.0,
        highlights: bool = True,
        threads: int = 0,
    ) -> FloatImage:
        """Return (H, W, 3) float32 camera RGB before the mosaic, white at 1.

        rgb : (H, W, 3 or 4) float, scene-linear Rec.709; other arguments as of
        cg2raw.Run. Raises ValueError."""
        transform = self.transform(illuminant, convention, digital_gain, highlights)
        return _core.to_camera(transform, rgb_image(rgb), threads=thread_count(threads))

    def to_scene(
        self,
        camera: ArrayLike,
        *,
        illuminant: Light = "",
        convention: str = "dng",
        digital_gain: float = 1.0,
        threads: int = 0,
    ) -> FloatImage:
        """Return (H, W, 3) float32 scene-linear Rec.709 of camera RGB.

        camera : (H, W, 3 or 4) float camera RGB, white at 1, such as to_camera and
            demosaic return; other arguments as of cg2raw.Run.

        As the processor of a camera does it: white balance, clip at white, colour
        matrix. Undoes to_camera, but for what clipped and for highlights that were kept
        white: those come out as white. Colours outside Rec.709 have negative values.
        Raises ValueError. Source: DNG specification 1.7.1, chapter 6."""
        transform = self.transform(illuminant, convention, digital_gain, False)
        image = rgb_image(camera, "camera RGB, white at 1")
        return _core.to_scene(transform, image, threads=thread_count(threads))

    def transform(
        self,
        light: Light = "",
        convention: str = "dng",
        digital_gain: float = 1.0,
        highlights: bool = True,
    ) -> _core.CameraTransform:
        """Return how scene-linear Rec.709 becomes camera RGB under a light: its first
        matrix (3, 3), and gains of white balance (3,).

        highlights : whether clipped ones stay white. Raises ValueError. Source: DNG
        specification 1.7.1, chapter 6."""
        check_transform(convention, digital_gain, highlights)
        seen = self._profile.illuminant(illuminant_word(light, self.id))
        return _core.camera_from_scene(
            self._profile, seen, convention, digital_gain, highlights
        )

    def mosaic(self, camera: ArrayLike, *, threads: int = 0) -> FloatImage:
        """Return the (H, W) float32 mosaic of (H, W, 3 or 4) camera RGB by this CFA."""
        return mosaic(camera, self.cfa, threads=threads)

    def demosaic(self, signal: ArrayLike, *, threads: int = 0) -> FloatImage:
        """Return (H, W, 3) float32 camera RGB of an (H, W) mosaic; see cg2raw.demosaic.

        signal : float, 0..1 above black; signal_from_raw makes it of DN."""
        return demosaic(signal, self.cfa, threads=threads)

    def signal_from_raw(self, raw: ArrayLike) -> FloatImage:
        """Return (H, W) float32 (DN - black) / (white - black), per CFA site.

        raw : (H, W) uint16 DN. Negative below black. Raises ValueError."""
        return _core.signal_from_raw(self._profile, raw_plane(raw))

    def raw_from_signal(self, signal: ArrayLike) -> RawImage:
        """Return (H, W) uint16 DN of a signal, 0..1 above black, clamped to 0 .. white.

        signal : (H, W) float. Rounds half up. Raises ValueError."""
        return _core.raw_from_signal(self._profile, signal_plane(signal))

    def add_noise(
        self,
        signal: ArrayLike,
        *,
        iso: float,
        noise: str | None = None,
        seed: int = 0,
        frame: int = 0,
        out: FloatImage | None = None,
        threads: int = 0,
    ) -> FloatImage:
        """Return a clean (H, W) mosaic with the sensor's noise, float32, not clamped.

        signal : (H, W) float, 0..1 above black, finite; a site of 0.99999 and above is
            clipped and stays as it is.
        iso, noise, seed, frame : as of cg2raw.Run; it is the noise that the same run
            of `signal` has. None of the profile's effects are applied.
        out : (H, W) float32 to write to and return, such as `signal` itself.

        Raises ValueError, also if the profile has no noise at that ISO."""
        run = Run(illuminant="D65", iso=iso, noise=noise, seed=seed, frame=frame)
        clean = signal_plane(signal)
        out, threads = output_plane(out, clean), thread_count(threads)
        own = core_run(self.id, run)
        return _core.add_noise(self._profile, clean, own, out, threads)

    def apply_effect(
        self,
        image: ArrayLike,
        name: str,
        parameters: Mapping[str, float],
        *,
        seed: int = 0,
        frame: int = 0,
        illuminant: Light = "D65",
        exposure_time: float | None = None,
        threads: int = 0,
    ) -> FloatImage:
        """Return an image with one effect of optics, sensor or read-out, float32.

        image : (H, W, 3 or 4) float camera RGB for an effect of the stages color and
            optics; for all others an (H, W) mosaic, 0..1 above black. The whole active
            area, finite.
        name, parameters : of cg2raw.effects(); every parameter is given.
        seed, frame : of what is temporal; a fixed pattern belongs to the sensor.
        illuminant : the light whose white color_matrix leaves neutral.
        exposure_time : seconds, where the effect needs it.

        Raises ValueError naming effect, parameter, value and bounds."""
        run = Run(
            illuminant=illuminant, seed=seed, frame=frame, exposure_time=exposure_time
        )
        result = _core.apply_effect(
            self._profile,
            planes_of(image),
            name,
            effect_parameters(name, parameters),
            core_run(self.id, run),
            threads=thread_count(threads),
        )
        return pixels_of(result)

    def predict_effect(
        self,
        image: ArrayLike,
        name: str,
        parameters: Mapping[str, float],
        *,
        illuminant: Light = "D65",
        exposure_time: float | None = None,
        threads: int = 0,
    ) -> tuple[FloatImage, FloatImage]:
        """Return (mean, variance) of apply_effect over frames, float32.

        mean : of the image's shape; variance : (H, W), in the square of 0..1 above
        black, and 0 for an effect before the mosaic, which has none.
        Arguments and errors as of apply_effect."""
        run = Run(illuminant=illuminant, exposure_time=exposure_time)
        mean, variance = _core.predict_effect(
            self._profile,
            planes_of(image),
            name,
            effect_parameters(name, parameters),
            core_run(self.id, run),
            threads=thread_count(threads),
        )
        return pixels_of(mean), variance
