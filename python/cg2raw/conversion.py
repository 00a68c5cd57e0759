# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""From an image file to a DNG: the way of the plugin's attributes, without a host."""

from dataclasses import dataclass, field, replace

import numpy as np

from cg2raw import _core
from cg2raw.dng import write_dng
from cg2raw.io import image_file, image_spaces
from cg2raw.sensor import Sensor
from cg2raw.upi import Upi

METHODS = ("g2r", "upi")


@dataclass(frozen=True)
class Request:
    """What is asked of every image; None is not asked for."""

    sensor: Sensor | None = None
    reference: str | None = None  # a DNG
    illuminant: str | None = None
    convention: str | None = None
    gain: float | str | None = None  # digital gain, or "sample"
    highlights: bool | None = None
    iso: float | None = None
    noise: str | None = None
    seed: int = 0
    frame: int | None = None  # None: by the names of files, or the time code
    effects: bool = True
    exposure: float = 0.0  # EV
    layer: str | None = None  # None: the picture, by the conventions of renderers
    space: str | None = None  # the name of the pixels' colour space, if the file errs
    linearize: str | None = None  # "srgb"
    upi: Upi | None = None  # its method, in place of sensor, illuminant and gains
    writing: dict = field(default_factory=dict)  # keywords of write_dng


def convert(path, output, request):
    """Write the DNG @output of the image at @path; return the report, of JSON's types.

    Raises ValueError or OSError in one line; then there is no new file."""
    image = image_file.read_image(
        path, request.layer, undo=request.linearize, space=request.space
    )
    request = replace(request, frame=frame_of(image, output, request))
    pixels = image.pixels
    if request.exposure:
        pixels = pixels * np.float32(2.0**request.exposure)
    nan, inf = np.isnan(pixels).sum(), np.isinf(pixels).sum()
    shot, drawn = _core.Shot(**image.shot), None
    if request.upi:
        image_spaces.check_rec709(image)
        frame, drawn = upi_frame(pixels, request)
    else:
        sensor, run = exposure_of(image, request)
        if request.reference:
            metadata = _core.read_dng_metadata(request.reference)
            sensor = sensor_of_reference(metadata, sensor)
            run["as_shot"] = metadata.as_shot_neutral
            shot = metadata.merged_shot(shot)
        run["exposure_time"] = shot.exposure_time
        frame = sensor.simulate(pixels, **run)
    write_dng(output, frame, shot=shot, **request.writing)
    report = report_of(frame, request, drawn)
    return {
        "input": str(path),
        "output": str(output),
        **report,
        "layer": image.layer or None,
        "linearized": image.undone or None,
        "nan": int(nan),
        "inf": int(inf),
    }


def frame_of(image, output, request):
    """Return the frame number: as asked, or as names say it, 0 if nothing does.

    The output's name comes first, then the time code, as in the plugin, which does not
    know the input's."""
    if request.frame is not None:
        return request.frame
    said = (
        _core.frame_from_name(str(output)),
        _core.frame_from_time_code(image.time_code),
        _core.frame_from_name(image.path),
    )
    return next((number for number in said if number is not None), 0)


def exposure_of(image, request):
    """Return (Sensor or None, keywords of Sensor.simulate). Raises ValueError."""
    run = {
        "iso": request.iso,
        "seed": request.seed,
        "frame": request.frame,
        "effects": request.effects,
    }
    if request.noise:
        if request.iso is None:
            raise ValueError(
                "--noise is given without --iso: add --iso NUMBER, or leave it out"
            )
        run["noise"] = request.noise
    space = raw_space_of(image, request)
    if space:
        sensor, illuminant = space
        sensor = request.sensor or Sensor(sensor)
        run |= {"camera_input": True, "color_effects": False}
        return sensor, {**run, "illuminant": illuminant}
    if request.sensor is None and request.reference is None:
        raise ValueError("which sensor? Add --sensor ID (cg2raw sensors lists them)")
    image_spaces.check_rec709(image)
    if request.illuminant is None:
        raise ValueError(
            f"under which light? Add --illuminant WORD: {_core.illuminant_grammar}"
        )
    asked = {
        "convention": request.convention,
        "digital_gain": request.gain,
        "highlights": request.highlights,
    }
    run |= {name: value for name, value in asked.items() if value is not None}
    return request.sensor, {**run, "illuminant": request.illuminant}


def raw_space_of(image, request):
    """Return (sensor, illuminant) if the pixels already are RAW, else None.

    Raises ValueError if the request contradicts it."""
    space = _core.raw_space_from_name(image.space)
    if space is None:
        return None
    pixels = f'{image.path}: pixels already are "{image.space}"'
    sensor, illuminant = space
    if request.sensor and request.sensor.id.lower() != sensor.lower():
        raise ValueError(f"{pixels}, but --sensor is {request.sensor.id}: leave it out")
    if request.illuminant and request.illuminant.lower() != illuminant.lower():
        raise ValueError(
            f"{pixels}, but --illuminant is {request.illuminant}: leave it out"
        )
    for name in ("convention", "gain", "highlights"):
        if getattr(request, name) is not None:
            raise ValueError(
                f"{pixels}: --{name} belongs to the conversion, which has been done; "
                "leave it out"
            )
    return space


def sensor_of_reference(metadata, sensor):
    """Return the sensor of a reference DNG, with what only @sensor may know."""
    profile = _core.profile_from_dng(metadata)
    if sensor is not None:
        profile = _core.with_measurements(profile, sensor._profile, metadata.file)
    return Sensor._of(profile)


def upi_frame(pixels, request):
    """Return (RawFrame, UpiDraw) of a camera that UPI draws."""
    run = {"iso": request.iso, "effects": request.effects}
    if request.noise:
        run["noise"] = request.noise
    if request.highlights is not None:
        run["highlights"] = request.highlights
    frame = request.upi.simulate(pixels, seed=request.seed, frame=request.frame, **run)
    return frame, request.upi.draw(request.seed)


def report_of(frame, request, drawn):
    """Return what decided a frame, of JSON's types."""
    light = frame.simulation.illuminant
    report = {
        "width": frame.shape[1],
        "height": frame.shape[0],
        "sensor": light.sensor,
        "method": "upi" if drawn else "g2r",
        "illuminant": {
            "word": light.spec,
            "neutral": list(light.neutral),
            "cct": light.cct,
            "duv": light.duv,
        },
        "digital_gain": frame.simulation.digital_gain,
        "iso": request.iso,
        "seed": request.seed,
        "frame": request.frame,
    }
    if drawn:
        report["upi"] = {
            "weights": dict(zip(request.upi.matrices, drawn.weights, strict=True)),
            "camera_from_xyz": drawn.camera_from_xyz.tolist(),
            "red_gain": drawn.red_gain,
            "blue_gain": drawn.blue_gain,
            "shot_noise": drawn.shot_noise,
            "read_noise": drawn.read_noise,
        }
    return report
