# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Sensor: a profile and what can be simulated with it."""

import os

import numpy as np

from cg2raw import _core


class RawFrame(np.ndarray):
    """(height, width) uint16 DN that remembers the simulation it came from.

    DN may be altered before they are written: what keeps the shape keeps `simulation`.
    A piece of another shape has none. write_dng refuses that, and flipped or transposed
    views, whose CFA would be another."""

    simulation = None

    def __array_finalize__(self, source):
        same = source is not None and source.shape == self.shape
        self.simulation = getattr(source, "simulation", None) if same else None


class Sensor:
    """One camera sensor. It is not altered: a changed profile is another sensor.

    id_or_path : id of an installed profile, or the path of one (.json).
    Raises ValueError for an unknown id, listing those installed, or a bad profile.
    """

    __slots__ = ("_profile",)

    def __init__(self, id_or_path):
        self._profile = _core.load_profile(os.fspath(id_or_path))

    @classmethod
    def from_json(cls, text, name="profile"):
        """Return the sensor of a profile's JSON text; name stands in messages."""
        sensor = cls.__new__(cls)
        sensor._profile = _core.parse_profile(text, name)
        return sensor

    @classmethod
    def from_dng(cls, path):
        """Return the sensor that one real DNG describes, by its metadata alone."""
        sensor = cls.__new__(cls)
        metadata = _core.read_dng_metadata(os.fspath(path))
        sensor._profile = _core.profile_from_dng(metadata)
        return sensor

    def __reduce__(self):
        return (Sensor.from_json, (self.to_json(), self.id))

    def __getattr__(self, name):
        if name == "_profile":
            raise AttributeError(name)
        return getattr(self._profile, name)

    def __dir__(self):
        return [*super().__dir__(), *dir(self._profile)]

    def __repr__(self):
        return f"Sensor({self.id!r})"

    def simulate(self, rgb, *, threads=0, **run):
        """Return the RAW frame that this sensor would have written of an image.

        rgb : (H, W, 3) or (H, W, 4) float, scene-linear Rec.709; alpha is ignored.
        threads : 0 for one per core; the result does not depend on it.
        run : see `simulation`.
        Returns (H, W) uint16 DN. Raises ValueError."""
        rgb = _float_image(rgb)
        simulation = self.simulation(rgb.shape[:2], **run)
        frame = simulation.raw(rgb, threads=threads).view(RawFrame)
        frame.simulation = simulation
        return frame

    def signal(self, rgb, **run):
        """Return (H, W) float32 before quantisation: 0..1 above black, not clamped."""
        rgb = _float_image(rgb)
        return self.simulation(rgb.shape[:2], **run).signal(rgb)

    def expectation(self, rgb, **run):
        """Return (mean, variance) of `signal` over frames, (H, W) float32 each.

        variance : in the square of 0..1 above black; the rounding to DN, which `signal`
        has not, adds 1/12 DN^2. 0 where the signal clips before its noise."""
        rgb = _float_image(rgb)
        return self.simulation(rgb.shape[:2], **run).expectation(rgb)

    def simulation(
        self,
        shape,
        *,
        illuminant,
        iso=None,
        noise="gaussian",
        seed=0,
        frame=0,
        digital_gain=1.0,
        convention="dng",
        highlights=True,
        effects=True,
        camera_input=False,
        as_shot=None,
    ):
        """Return what decides every pixel of an exposure.

        shape : (H, W) of the image.
        illuminant : word of the illuminant grammar, or an Illuminant.
        iso : None for no noise; else within one stop of the calibrated ISOs.
        noise : how it is drawn, with the same variance: "gaussian", or "physical"
            (Poisson photons, Tukey lambda read noise, row noise), which needs an iso
            and a profile whose noise has tukey_lambda and row_sigma.
        seed, frame : key of everything random; noise differs from frame to frame.
        digital_gain : multiplies the white balance gains (0 to 1000); "sample" draws it
            from the profile, by seed and frame.
        convention : "dng" (inverse of a DNG renderer) or "paper".
        highlights : keep white white while white balance is undone.
        effects : False for neither the profile's effects nor noise.
        camera_input : the image already is camera RGB under this illuminant.
        as_shot : (3,) neutral that the word as-shot stands for."""
        word = _word(illuminant, self.id)
        sampled = isinstance(digital_gain, str) and digital_gain == "sample"
        try:
            run = _core.Run(
                illuminant=word,
                iso=iso,
                noise=noise,
                seed=seed,
                frame=frame,
                digital_gain=1.0 if sampled else digital_gain,
                sample_digital_gain=sampled,
                convention=convention,
                highlights=highlights,
                effects=effects,
                camera_input=camera_input,
                as_shot=as_shot,
            )
        except TypeError:
            raise ValueError(
                f"iso {iso!r} and digital_gain {digital_gain!r} must be numbers (or "
                f"digital_gain sample), seed "
                f"{seed!r} and frame {frame!r} whole numbers from 0 to 2**64 - 1, "
                f"noise {noise!r} and convention {convention!r} texts, highlights "
                f"{highlights!r}, effects {effects!r} and camera_input "
                f"{camera_input!r} True or False, and as_shot {as_shot!r} three numbers"
            ) from None
        return _core.Simulation(self._profile, tuple(shape), run)

    def to_camera(
        self, rgb, *, illuminant, convention="dng", digital_gain=1.0, highlights=True
    ):
        """Return (H, W, 3) float32 camera RGB before the mosaic; arguments as above."""
        light = self.illuminant(_word(illuminant, self.id))
        rgb = _float_image(rgb)
        planes = _core.to_camera(
            self._profile, rgb, light, convention, digital_gain, highlights
        )
        return np.moveaxis(planes, 0, -1)


def _word(illuminant, sensor):
    """Return the word of the grammar that names an illuminant, exactly."""
    if isinstance(illuminant, str):
        return illuminant
    if not isinstance(illuminant, _core.Illuminant):
        raise ValueError(
            f"illuminant {illuminant!r} must be one word or an Illuminant; the words: "
            f"{_core.illuminant_grammar}"
        )
    if illuminant.sensor != sensor:
        raise ValueError(
            f"{illuminant!r} is as {illuminant.sensor} sees it, not {sensor}: give the "
            f"word {illuminant.spec!r}, or the illuminant of {sensor}"
        )
    red, _, blue = illuminant.neutral
    return f"neutral:{red!r}:{blue!r}"


def _float_image(rgb):
    """Return an (H, W, 3 or 4) image as float32; integers are no scene-linear light."""
    try:
        rgb = np.asarray(rgb)
    except ValueError as error:
        raise ValueError(f"rgb is no image: {error}") from None
    if rgb.ndim != 3 or rgb.shape[2] not in (3, 4):
        raise ValueError(
            f"rgb must have the shape (H, W, 3) or (H, W, 4), not {rgb.shape}"
        )
    if not np.issubdtype(rgb.dtype, np.floating):
        raise ValueError(
            f"rgb must be floating point, scene-linear Rec.709, not {rgb.dtype}: scale "
            "integers to 0..1 and linearise them first"
        )
    return rgb.astype(np.float32, copy=False)


def write_dng(
    path,
    raw,
    *,
    compression="ljpeg",
    preview=True,
    matrices="camera",
    tone_curve="camera",
    shot=None,
    threads=0,
):
    """Write a simulated frame as a DNG, complete or not at all.

    raw : RawFrame, as Sensor.simulate returns it.
    compression : "ljpeg" (lossless JPEG) or "none".
    preview : whether IFD0 holds a rendered picture.
    matrices : "camera" (the sensor's) or "exact" (every reader gives the render back).
    tone_curve : "camera" (the reader's own) or "linear".
    shot : dict of what Exif is to say: exposure_time (s), f_number, focal_length (mm),
        date_time_original ("YYYY:MM:DD HH:MM:SS"), artist, copyright, description,
        lens_model, orientation (1 to 8); what makes no sense there is left out. Or a
        Shot, as DngMetadata.merged_shot returns it. The ISO is the simulation's.
    Raises ValueError naming path and reason."""
    simulation = getattr(raw, "simulation", None)
    if simulation is None:
        raise ValueError("raw must be a frame as Sensor.simulate returns it")
    if not raw.flags.c_contiguous:
        raise ValueError(
            "raw is a flipped or transposed view: its CFA would be another"
        )
    if raw.dtype != np.uint16:
        raise ValueError(f"raw must stay uint16 DN, not {raw.dtype}")
    if "\0" in os.fspath(path):
        raise ValueError(f"path {path!r} holds a NUL character")
    _core.write_dng(
        os.fspath(path),
        raw,
        simulation,
        compression,
        preview,
        matrices,
        tone_curve,
        threads,
        _shot(shot or {}),
    )


def _shot(shot):
    """Return the core's Shot of a dict, or of itself."""
    if isinstance(shot, _core.Shot):
        return shot
    try:
        return _core.Shot(**shot)
    except TypeError:
        raise ValueError(
            f"shot {shot!r} must be a dict of exposure_time, f_number, focal_length "
            "(numbers), date_time_original, artist, copyright, description, lens_model "
            "(texts) and orientation (a whole number)"
        ) from None
