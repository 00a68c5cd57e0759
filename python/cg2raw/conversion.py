# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Convert an image file to a DNG as the plugin does, without OpenImageIO as a host."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.cfa import is_mono
from cg2raw.dng import write_dng
from cg2raw.exposure import Run
from cg2raw.io import image_file, spectra_file
from cg2raw.io.atomic_file import FilePath
from cg2raw.io.image_file import Image
from cg2raw.raw_frame import RawFrame
from cg2raw.sensor import Sensor
from cg2raw.spectra import SEEN, Rows, estimated_light, is_estimate, seen_light
from cg2raw.upi import Upi, UpiDraw

# Fields of a Run that belong to the conversion to camera RGB, and their options.
CONVERTING = {
    "convention": "convention",
    "digital_gain": "gain",
    "highlights": "highlights",
}
COUNTED_ROWS = 16  # at a time: of photographs they fit a core's cache
NO_LIGHT = f"under which light? Add --illuminant WORD: {_core.illuminant_grammar}"


@dataclass(frozen=True)
class Request:
    """What is asked of every image; None, or a field of run that is absent, is not."""

    sensor: Sensor | None = None
    reference: str | None = None  # a DNG
    run: Mapping[str, Any] = field(default_factory=dict)  # fields of cg2raw.Run
    frame: int | None = None  # None: by the names of files, or the time code
    shot: Mapping[str, Any] = field(default_factory=dict)  # in place of what files say
    threads: int = 0  # 0: one per core; files do not depend on it
    exposure: float = 0.0  # EV
    white: float | None = None  # cd/m2 of white in spectral images
    layer: str | None = None  # None: the picture, by the conventions of renderers
    space: str | None = None  # the name of the pixels' colour space, if the file errs
    linearize: str | None = None  # "srgb"
    upi: Upi | None = None  # its method, in place of sensor, illuminant and gains
    writing: dict[str, Any] = field(default_factory=dict)  # keywords of write_dng


def convert(path: FilePath, output: FilePath, request: Request) -> dict[str, Any]:
    """Write the DNG @output of the image at @path; return the report, of JSON's types.

    Raises ValueError or OSError in one line; then there is no new file."""
    image, of_pixels, unseen = image_of(path, request)
    asked = {**request.run, **of_pixels, "frame": frame_of(image, output, request)}
    pixels = image.pixels
    if request.exposure:
        gain = np.float32(2.0**request.exposure)
        pixels = pixels.astype(np.float32, copy=False) * gain
    nan, inf = not_finite(pixels)
    shot, drawn = _core.Shot(**{**image.shot, **request.shot}), None
    if request.upi:
        image_file.check_rec709(image)
        frame = request.upi.simulate(pixels, threads=request.threads, **asked)
        drawn = request.upi.draw(asked.get("seed", Run.seed))
    else:
        sensor, run = exposure_of(image, request, asked)
        if request.reference:
            metadata = _core.read_dng_metadata(request.reference)
            sensor = sensor_of_reference(metadata, sensor)
            run["as_shot"] = metadata.as_shot_neutral
            shot = metadata.merged_shot(shot)
        run["exposure_time"] = shot.exposure_time
        assert sensor is not None  # without either, exposure_of has raised
        frame = sensor.simulate(pixels, threads=request.threads, **run)
    writing = writing_of(image, request)
    write_dng(output, frame, shot=shot, threads=request.threads, **writing)
    report = report_of(frame, request, asked, drawn)
    return {
        "input": str(path),
        "output": str(output),
        **report,
        "frame_rate": shot.frame_rate,
        "time_code": shot.time_code,
        "layer": image.layer or None,
        "linearized": image.undone or None,
        "unseen_energy": unseen,
        "nan": nan,
        "inf": inf,
    }


def not_finite(pixels: NDArray[np.floating[Any]]) -> tuple[int, int]:
    """Return how many values are NaN, and how many infinite."""
    nan = inf = 0
    for first in range(0, len(pixels), COUNTED_ROWS):
        part = pixels[first : first + COUNTED_ROWS]
        if not np.isfinite(part).all():
            nan += int(np.isnan(part).sum())
            inf += int(np.isinf(part).sum())
    return nan, inf


def image_of(
    path: FilePath, request: Request
) -> tuple[Image, dict[str, Any], float | None]:
    """Return (Image, the fields of a Run that its pixels decide, the share of the
    spectra's energy that the sensor does not see) of a file.

    Raises ValueError, OSError."""
    file = spectra_file.spectra_in(path) if request.layer is None else None
    if file is not None:
        return spectral_image_of(file, request)
    if request.white is not None:
        raise ValueError(
            f"{path}: --white-luminance is for spectral images, and this one has no "
            "channels such as S0.550nm: leave it out"
        )
    if is_estimate(request.run.get("illuminant", "")):
        raise ValueError(
            f"{path}: --illuminant {request.run['illuminant']} is for spectral images, "
            "and this one has no channels such as S0.550nm: name the light"
        )
    image = image_file.read_image(
        path,
        request.layer,
        undo=request.linearize,
        space=request.space,
        keep_half=True,
    )
    return image, {}, None


def spectral_image_of(
    file: spectra_file.SpectraFile, request: Request
) -> tuple[Image, dict[str, Any], float]:
    """Return what image_of does of spectra: the Image is camera RGB.

    Raises ValueError, OSError."""
    start = f"{file.path}: its channels are a spectrum"
    if request.linearize or request.space:
        option = "--linearize" if request.linearize else "--iscolorspace"
        raise ValueError(f"{start}: {option} has no meaning, leave it out")
    sensor = request.sensor
    if request.upi or sensor is None or sensor.spectral_sensitivities is None:
        raise ValueError(
            f"{start}: give a --sensor that has spectral_sensitivities, and no --method"
        )
    for name, option in CONVERTING.items():
        if request.run.get(name, "sensor") not in ("sensor", "spectral", False):
            raise ValueError(f"{start}: --{option} has no meaning, leave it out")
    white = request.white or file.white
    if white is None:
        raise ValueError(
            f"{start} in W/(m2 sr nm): which luminance is white? Add --white-luminance "
            "CD_PER_M2, such as 100"
        )
    asked = request.run.get("illuminant")
    if asked is None:
        raise ValueError(NO_LIGHT)
    as_shot = None
    if request.reference:
        as_shot = _core.read_dng_metadata(request.reference).as_shot_neutral

    def estimate(word: str) -> Rows:
        return estimated_light(word, file.light, file.bins.wavelengths, file.statistic)

    light, word = seen_light(sensor, asked, estimate, as_shot)
    response = _core.SpectralResponse(sensor.profile, light, file.bins, white)
    image, unseen = spectra_file.read_camera(file, response)
    return image, {"illuminant": word, **SEEN}, unseen


def frame_of(image: Image, output: FilePath, request: Request) -> int:
    """Return the frame number: as asked, or as names say it, 0 if nothing does.

    The output's name comes first, then the time code, as in the plugin, which does not
    know the input's."""
    if request.frame is not None:
        return request.frame
    if name := _core.frame_name(str(output)):
        return name.number
    number = _core.frame_from_time_code(image.time_code)
    if number is not None:
        return number
    name = _core.frame_name(image.path)
    return name.number if name else 0


def writing_of(image: Image, request: Request) -> dict[str, Any]:
    """Return the keywords of write_dng: as asked; else an image that is not compressed
    makes a file that is not, as hosts of OpenImageIO have it for all formats."""
    kept = {"compression": "none"} if image.compression.lower() == "none" else {}
    return kept | request.writing


def exposure_of(
    image: Image, request: Request, asked: dict[str, Any]
) -> tuple[Sensor | None, dict[str, Any]]:
    """Return (Sensor or None, fields of a Run) of those that are asked for.

    Raises ValueError."""
    if "noise" in asked and asked.get("iso") is None:
        raise ValueError(
            "--noise is given without --iso: add --iso NUMBER, or leave it out"
        )
    space = raw_space_of(image, request)
    if space:
        sensor, illuminant = space
        done = {"camera_input": True, "color_effects": False, "illuminant": illuminant}
        found = request.sensor or Sensor(sensor)
        if is_mono(found.cfa):
            raise ValueError(
                f"sensor {found.id} is monochrome and has no RAW colour space: leave "
                "the conversion to it out, and name it by --sensor"
            )
        return found, asked | done
    if request.sensor is None and request.reference is None:
        raise ValueError(
            "which sensor? Add --sensor ID (cg2raw sensors lists them), or, if its "
            'pixels are RAW already, --iscolorspace "RAW - <sensor> - <illuminant>"'
        )
    image_file.check_rec709(image)
    if "illuminant" not in asked and not is_mono_sensor(request):
        raise ValueError(NO_LIGHT)
    return request.sensor, asked


def is_mono_sensor(request: Request) -> bool:
    """Return whether the sensor, or that of the reference, needs no illuminant."""
    if request.sensor is not None:
        return is_mono(request.sensor.cfa)
    assert request.reference is not None  # exposure_of has raised without either
    return is_mono(_core.read_dng_metadata(request.reference).cfa)


def raw_space_of(image: Image, request: Request) -> tuple[str, str] | None:
    """Return (sensor, illuminant) if the pixels already are RAW, else None.

    Raises ValueError if the request contradicts it."""
    space = _core.raw_space_from_name(image.space)
    if space is None:
        return None
    pixels = f'{image.path}: pixels already are "{image.space}"'
    sensor, illuminant = space
    if request.sensor and request.sensor.id.lower() != sensor.lower():
        raise ValueError(f"{pixels}, but --sensor is {request.sensor.id}: leave it out")
    asked = request.run.get("illuminant", illuminant)
    if asked.lower() != illuminant.lower():
        raise ValueError(f"{pixels}, but --illuminant is {asked}: leave it out")
    for name, option in CONVERTING.items():
        if name in request.run:
            raise ValueError(
                f"{pixels}: --{option} belongs to the conversion, which has been done; "
                "leave it out"
            )
    return space


def sensor_of_reference(metadata: _core.DngMetadata, sensor: Sensor | None) -> Sensor:
    """Return the sensor of a reference DNG, with what only @sensor may know."""
    profile = _core.profile_from_dng(metadata)
    if sensor is not None:
        profile = _core.with_measurements(profile, sensor.profile, metadata.file)
    return Sensor.from_profile(profile)


def report_of(
    frame: RawFrame, request: Request, asked: dict[str, Any], drawn: UpiDraw | None
) -> dict[str, Any]:
    """Return what decided a frame, of JSON's types. asked : fields of its Run."""
    simulation = frame.simulation
    assert simulation is not None  # of what simulate returns
    light = simulation.illuminant
    report: dict[str, Any] = {
        "width": frame.shape[1],
        "height": frame.shape[0],
        "sensor": light.sensor,
        "method": "upi" if drawn else "graphics2raw",
        "illuminant": {
            "word": light.spec,
            "neutral": list(light.neutral),
            "cct": light.cct,
            "duv": light.duv,
            "spectrum": simulation.spectrum or None,
        },
        "digital_gain": simulation.digital_gain,
        "iso": asked.get("iso"),
        "seed": asked.get("seed", Run.seed),
        "frame": asked["frame"],
    }
    if request.upi and drawn:
        report["upi"] = {
            "weights": dict(zip(request.upi.matrices, drawn.weights, strict=True)),
            "camera_from_xyz": drawn.camera_from_xyz.tolist(),
            "red_gain": drawn.red_gain,
            "blue_gain": drawn.blue_gain,
            "shot_noise": drawn.shot_noise,
            "read_noise": drawn.read_noise,
        }
    return report
