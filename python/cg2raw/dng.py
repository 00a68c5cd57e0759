# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Write a mosaic of DN as a DNG; read what a DNG says."""

import contextlib
import os
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.argument_types import (
    TEXT,
    TRUTH,
    check_types,
    path_text,
    thread_count,
)
from cg2raw.arrays import is_uint16, raw_plane
from cg2raw.cfa import is_mono
from cg2raw.core_arguments import shown
from cg2raw.sensor import Sensor
from cg2raw.short_messages import NO_MEMORY


def write_dng(
    path: str | os.PathLike[str],
    raw: NDArray[np.uint16],
    *,
    sensor: Sensor | None = None,
    illuminant: str | _core.Illuminant | None = None,
    iso: float | None = None,
    effects: bool = True,
    compression: str = "ljpeg",
    preview: bool | None = None,
    matrices: str = "camera",
    tone_curve: str = "camera",
    crop: str = "border",
    shading: str | None = None,
    shot: Mapping[str, Any] | _core.Shot | None = None,
    threads: int = 0,
    sync: bool = True,
) -> None:
    """Write a mosaic as a DNG, complete or not at all.

    path : of the file; one that is there is replaced.
    raw : RawFrame, as Sensor.simulate returns it; or any (H, W) uint16 DN together with
        a sensor and an illuminant. Row 0, column 0 is the first site of the CFA.
    sensor, illuminant : what a plain array was taken by and under; an illuminant as for
        Sensor.simulate, none for a monochrome sensor.
    iso : Exif's ISO of a plain array, with the sensor's NoiseProfile at it; None for
        neither.
    effects : False if a plain array has none of the effects of the sensor's profile: no
        GainMap to undo a lens shading that is not there, and no NoiseProfile.
    compression : "ljpeg" (lossless JPEG), "ljpeg-2d" (the same with the predictor that
        suits each tile: 2 to 18 % smaller, but darktable does not open it) or "none".
    preview : whether IFD0 holds a rendered picture; None for one, unless the shot has a
        frame rate: players want the RAW there.
    matrices : "camera" (the sensor's) or "exact" (every reader gives the render back).
    tone_curve : "camera" (the reader's own) or "linear".
    crop : what DefaultCrop leaves out of the picture that converters show: "border" (2
        pixels on each side, where demosaicing lacks neighbours, as cameras do; nothing
        of pictures below 16 pixels) or "none". The file holds all pixels either way.
    shading : "tagged" (GainMaps undo the sensor's lens shading) or "baked" (nothing
        does); None for tagged, unless the shot has a frame rate: players know no
        GainMaps.
    shot : what Exif is to say: exposure_time (s), f_number, focal_length (mm),
        date_time_original ("YYYY:MM:DD HH:MM:SS"), artist, copyright, description,
        lens_model, orientation (1 to 8), exposure_bias (stops), exposure_mode (0 auto,
        1 manual, 2 bracket), brightness (APEX), pixel_aspect (width of a pixel over its
        height); what makes no sense is left out. Of a frame of a shot (CinemaDNG) also
        frame_rate (24, 23.976, "24000/1001"), time_code ("hh:mm:ss:ff"), reel_name,
        camera_label. None: not said. Or a Shot, as DngMetadata.merged_shot returns it.
        The ISO is the simulation's, or iso; so are the time, aperture and other fields
        of an exposure that a RawFrame was simulated with.
    threads : 0 for one per core; the bytes do not depend on it.
    sync : whether the file is on the disk before it has its name, so that not even a
        loss of power leaves a partial one; False is faster on slow disks.

    Every file says in its XMP that the picture is computer generated, by which sensor's
    profile and under which light; of a RawFrame also its seed, frame, convention and
    gain (docs/provenance.md).

    Raises ValueError naming path and reason; DN above the sensor's white level are one.
    Raises MemoryError naming path.
    Source: DNG specification 1.7.1."""
    simulation = _simulation_of(raw, sensor, illuminant, iso, effects)
    check_types(
        TEXT,
        {
            "compression": compression,
            "matrices": matrices,
            "tone_curve": tone_curve,
            "crop": crop,
        },
    )
    check_types(f"{TEXT} or None", {"shading": shading})
    check_types(f"{TRUTH} or None", {"preview": preview})
    check_types(TRUTH, {"sync": sync})
    with _naming(path):
        _core.write_dng(
            path_text(path), raw_plane(raw), simulation, compression, preview, matrices,
            tone_curve, thread_count(threads), _shot(shot or {}), sync, sensor is None,
            crop, shading,
        )  # fmt: skip


def read_dng_metadata(path: str | os.PathLike[str], cfa: str = "") -> _core.DngMetadata:
    """Return what a DNG says of its camera and shot; no pixels are read.

    cfa : of a demosaicked file (LinearRaw, ProRAW), which does not say it: RGGB ...

    Raises ValueError naming file, tag, value and bound. Source: DNG specification
    1.7.1."""
    check_types(TEXT, {"cfa": cfa})
    with _naming(path):
        return _core.read_dng_metadata(path_text(path), cfa)


@contextlib.contextmanager
def _naming(path: str | os.PathLike[str]) -> Iterator[None]:
    """Name @path where there is not enough memory; the core names it in all else."""
    try:
        yield
    except MemoryError:
        raise MemoryError(f"{path}: {NO_MEMORY}") from None


NUMBERS = (
    *("exposure_time", "f_number", "focal_length", "pixel_aspect"),
    *("exposure_bias", "exposure_mode", "brightness"),
)
TEXTS = ("date_time_original", "artist", "copyright", "description", "lens_model")
OF_SHOT = ("frame_rate", "time_code", "reel_name", "camera_label")


def _shot(shot: Mapping[str, Any] | _core.Shot) -> _core.Shot:
    """Return the core's Shot of a dict, or of itself; None is not said."""
    if isinstance(shot, _core.Shot):
        return shot
    if not isinstance(shot, Mapping):
        raise ValueError(f"shot {shown(shot)} must be a dict or a Shot")
    fields = {name: value for name, value in shot.items() if value is not None}
    if "frame_rate" in fields:
        fields["frame_rate"] = str(fields["frame_rate"])
    known = (*NUMBERS, *TEXTS, "orientation", *OF_SHOT)
    for name in fields:
        if name == "iso":
            raise ValueError("shot has an iso: give it as the argument iso")
        if name not in known:
            raise ValueError(f"shot has no {shown(name)}; known: {', '.join(known)}")
    try:
        return _core.Shot(**fields)
    except TypeError:
        raise ValueError(
            f"shot {shown(fields)}: {', '.join(NUMBERS)} must be numbers, orientation "
            "a whole number, the others texts"
        ) from None


def _simulation_of(
    raw: NDArray[Any],
    sensor: Sensor | None,
    illuminant: str | _core.Illuminant | None,
    iso: float | None,
    effects: bool,
) -> _core.Simulation:
    """Return what the file says of its pixels."""
    if sensor is not None:
        if not isinstance(sensor, Sensor):
            raise TypeError(f"sensor {shown(sensor)} must be a Sensor: cg2raw.Sensor")
        if illuminant is None and not is_mono(sensor.cfa):
            raise ValueError("a sensor needs an illuminant: give the light, or neither")
        return sensor.simulation(
            raw_plane(raw).shape, illuminant=illuminant or "", iso=iso, effects=effects
        )
    if illuminant is not None or iso is not None or not effects:
        raise ValueError(
            "illuminant, iso and effects are for a plain array and its sensor"
        )
    simulation: _core.Simulation | None = getattr(raw, "simulation", None)
    if simulation is None:
        raise ValueError(
            "raw must be a frame as Sensor.simulate returns it; for any other array "
            "give sensor and illuminant too"
        )
    if not raw.flags.c_contiguous:
        raise ValueError(
            "raw is a flipped or transposed view: its CFA would be another"
        )
    if not is_uint16(raw):
        raise ValueError(f"raw must stay uint16 DN, not {raw.dtype}")
    return simulation
