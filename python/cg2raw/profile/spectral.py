# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A sensor profile from measured spectral sensitivities, without a photograph.

It needs colour-science and SciPy (the extra cg2raw[profile])."""

import importlib.util
import json
import os
import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from cg2raw import _core
from cg2raw.cfa import is_mono
from cg2raw.io.atomic_file import FilePath
from cg2raw.profile.illuminant_spectra import REAL_LIGHTS, illuminant_spectrum
from cg2raw.profile.lamps import check_lamp_names, lamp_field, lamp_name
from cg2raw.profile.matrix_fit import color_matrix, fit_xyz_d50_from_camera
from cg2raw.profile.spectral_file import (
    MONO,
    WAVELENGTHS,
    Array,
    Sensitivities,
    read_sensitivities,
)

CALIBRATION_ILLUMINANTS = ("A", "D65")
LONGEST_ID = 100  # characters; cg2raw/profile.h, longest_sensor_id
DECIMALS_OF_MATRIX = 4  # steps of a DNG's ColorMatrix, as its renderer keeps it
DECIMALS_OF_NEUTRAL = 6  # steps of a DNG's AsShotNeutral
DECIMALS_OF_SENSITIVITY = 6  # of a peak of 1; measurements have three or four


def neutral_under(sensitivities: Sensitivities, light: FilePath) -> Array:
    """Return the neutral (R/G, 1, B/G) that a camera sees of grey under a light.

    sensitivities : Sensitivities. light : a word of illuminant_spectra.GRAMMAR.
    Raises ValueError for an unknown light, or one that a channel does not see."""
    response = illuminant_spectrum(light) @ sensitivities.rgb
    if not np.all(response > 0.0):
        raise ValueError(
            f"{sensitivities.file}: under light {str(light)!r} grey is "
            f"{response.tolist()}; each channel must see it"
        )
    return np.asarray(response / response[1])


def color_matrices(sensitivities: Sensitivities) -> dict[str, Array]:
    """Return {"A": (3, 3), "D65": (3, 3)}: DNG ColorMatrices, XYZ -> camera.

    Raises ValueError if the channels see too much the same."""
    return {
        light: fitted_matrix(sensitivities, light) for light in CALIBRATION_ILLUMINANTS
    }


def fitted_matrix(sensitivities: Sensitivities, light: FilePath) -> Array:
    """Return the DNG ColorMatrix (3, 3), XYZ -> camera, of a light.

    A and D65 are fitted to what the observer sees under them. Another light is fitted
    to the colours under D65, as a scene in Rec.709 has them: under a lamp with lines
    an observer's colours are not those, and a photographer wants the latter, too.
    light : a word of illuminant_spectra.GRAMMAR.
    Raises ValueError if the channels see too much the same."""
    power = illuminant_spectrum(light)
    calibrates = os.fspath(light) in CALIBRATION_ILLUMINANTS
    observed = power if calibrates else illuminant_spectrum("D65")
    try:
        fitted = fit_xyz_d50_from_camera(
            sensitivities.rgb, power, observed_under=observed
        )
    except ValueError as error:
        raise ValueError(f"{sensitivities.file}: {os.fspath(light)}: {error}") from None
    matrix = color_matrix(fitted, sensitivities.rgb, power)
    return np.asarray(matrix.round(DECIMALS_OF_MATRIX))


def spectral_field(sensitivities: Sensitivities, mono: bool = False) -> dict[str, Any]:
    """Return a profile's "spectral_sensitivities": of the measured wavelengths.

    mono : the one channel of a monochrome sensor.
    Rows farther apart than 5 nm give way to the monotone curve through them, at every
    5 nm, since the core takes rows for corners of straight lines. Where nothing was
    measured of 380 to 780 nm there is 0."""
    table = sensitivities.measured()
    wavelengths, rgb = table.wavelengths, table.rgb
    if np.max(np.diff(wavelengths)) > WAVELENGTHS[1] - WAVELENGTHS[0]:
        wavelengths, rgb = WAVELENGTHS, table.at(WAVELENGTHS)  # 0 outside the table
    below = WAVELENGTHS[wavelengths[0] > WAVELENGTHS]
    above = WAVELENGTHS[wavelengths[-1] < WAVELENGTHS]
    nothing = [np.zeros((len(outside), 3)) for outside in (below, above)]
    curves = np.concatenate([nothing[0], rgb, nothing[1]])
    curves = curves.round(DECIMALS_OF_SENSITIVITY) + 0.0
    channels = MONO if mono else "RGB"
    return {
        "unit": table.unit,
        "scale": table.scale,
        "wavelengths": np.concatenate([below, wavelengths, above]).tolist(),
        **{name: curves[:, i].tolist() for i, name in enumerate(channels)},
    }


def profile_from_ssf(
    path: FilePath | Sensitivities,
    *,
    cfa: str | None = None,
    width: int | None = None,
    height: int | None = None,
    bits: int | None = None,
    black_level: float | Sequence[float] | None = None,
    white_level: int | None = None,
    make: str | None = None,
    model: str | None = None,
    id: str | None = None,
    lights: Sequence[FilePath] | None = None,
    lamps: Sequence[FilePath] = (),
    unit: str = "energy",
) -> dict[str, Any]:
    """Return the profile (a dict of schema 1) of a camera's spectral sensitivities.

    path : file that read_sensitivities reads, or its Sensitivities.
    cfa, width, height, bits, black_level, white_level : of the sensor; sensitivities do
        not tell them. black_level : DN, one for all CFA sites or one each.
    make, model : by default those of the file's header; id : by default made of them.
    lights : words of illuminant_spectra.GRAMMAR whose neutrals make the distribution of
        illuminants; by default REAL_LIGHTS.
    lamps : words of the same grammar that get a matrix of their own, beside those of A
        and D65; dng:illuminant names them as "FL2", or "lamp:NAME" where a file does.
    unit : of the file's numbers, "energy" (A/W) or "photon" (quantum efficiency).
    Raises ValueError; what is missing is listed at once."""
    _need_libraries()
    mono = cfa is not None and is_mono(cfa)
    if not isinstance(path, Sensitivities):
        path = read_sensitivities(os.fspath(path), mono, unit)
    measured = path
    profile: dict[str, Any] = {
        "make": make or measured.make,
        "model": model or measured.model,
        "cfa": cfa,
        "width": width,
        "height": height,
        "bits": bits,
        "black_level": black_level,
        "white_level": white_level,
    }
    _check_whole(measured.file, profile)
    black = np.ravel(np.array(black_level)).tolist()
    sites = 1 if mono else 4
    profile["black_level"] = black * sites if len(black) == 1 else black
    camera = _core.camera_name(profile["make"], profile["model"])
    names = {"id": id or _id_of(camera), "unique_camera_model": camera}
    if mono:
        return _mono_profile({"schema": 1, **names, **profile}, measured, lamps)
    lights = REAL_LIGHTS if lights is None else tuple(lights)
    if not lights:
        raise ValueError(f"{measured.file}: lights is empty; name at least one light")
    lamps = [lamp for lamp in lamps if lamp_name(lamp) not in CALIBRATION_ILLUMINANTS]
    check_lamp_names(measured.file, lamps)
    colours = _colour_fields(measured, lights, lamps)
    profile = {"schema": 1, **names, **profile, **colours}
    profile["sources"] = _sources(measured, lights, make, model)
    if lamps:
        profile["sources"]["lamps"] = (
            profile["sources"]["color_matrix_1"]
            + ", to the colours that they have under D65"
        )
    _core.parse_profile(json.dumps(profile), measured.file)
    return profile


def _mono_profile(
    profile: dict[str, Any], measured: Sensitivities, lamps: Sequence[FilePath]
) -> dict[str, Any]:
    """Return the profile of a monochrome sensor: it has no matrices and no neutrals.

    Raises ValueError."""
    if lamps:
        raise ValueError(
            f"{measured.file}: a monochrome sensor has no matrix that light "
            f"{os.fspath(lamps[0])!r} could have; leave it out"
        )
    profile["spectral_sensitivities"] = spectral_field(measured, mono=True)
    sources = _sources(measured, (), profile["make"], profile["model"])
    profile["sources"] = {
        name: text for name, text in sources.items() if name in profile
    }
    _core.parse_profile(json.dumps(profile), measured.file)
    return profile


def _need_libraries() -> None:
    """Raise ValueError unless the optional libraries are installed."""
    for module, name in (("colour", "colour-science"), ("scipy", "SciPy")):
        if importlib.util.find_spec(module) is None:
            raise ValueError(
                f"a profile from sensitivities needs {name}: pip install "
                "'cg2raw[profile]'"
            )


def _check_whole(file: str, profile: dict[str, Any]) -> None:
    """Raise ValueError that lists the fields which are None."""
    missing = [name for name, value in profile.items() if value is None]
    if missing:
        raise ValueError(
            f"{file}: sensitivities do not tell {', '.join(missing)}; give "
            + ("each of them" if len(missing) > 1 else "it")
        )


def _colour_fields(
    measured: Sensitivities, lights: Sequence[FilePath], lamps: Sequence[FilePath]
) -> dict[str, Any]:
    """Return the fields of a profile that sensitivities tell."""
    fields: dict[str, Any] = {}
    for number, (light, matrix) in enumerate(color_matrices(measured).items(), start=1):
        fields[f"calibration_illuminant_{number}"] = light
        fields[f"color_matrix_{number}"] = (matrix.ravel() + 0.0).tolist()
    if lamps:
        fields["lamps"] = [
            lamp_field(lamp, _neutral(measured, lamp), fitted_matrix(measured, lamp))
            for lamp in lamps
        ]
    fields["spectral_sensitivities"] = spectral_field(measured)
    neutrals = [_neutral(measured, light) for light in lights]
    return {**fields, "illuminants": {"neutrals": neutrals}}


def _neutral(measured: Sensitivities, light: FilePath) -> list[float]:
    """Return (R/G, B/G) of a light as profiles have it."""
    neutral = neutral_under(measured, light)[[0, 2]]
    return [float(ratio) for ratio in neutral.round(DECIMALS_OF_NEUTRAL)]


def _id_of(camera: str) -> str:
    """Return an id, cut if too long: "Canon EOS 600D" -> "canon-eos-600d"."""
    return (
        re.sub(r"[^a-z0-9.]+", "-", camera.lower())
        .strip("-.")[:LONGEST_ID]
        .rstrip("-.")
    )


def _sources(
    measured: Sensitivities,
    lights: Sequence[FilePath],
    make: str | None,
    model: str | None,
) -> dict[str, str]:
    """Return {field: where it is from}."""
    given = "given by who made the profile"
    header = f"header of {measured.file}"
    origin = f" ({measured.origin})" if measured.origin else ""
    matrices = (
        f"spectral sensitivities {measured.file}{origin}: fitted to "
        "spectral_sensitivities by the least mean CIEDE2000 of a DNG renderer over the "
        "Academy's 190 training reflectances, white exact"
    )
    sources = {
        "make": given if make else header,
        "model": given if model else header,
        "cfa, width, height, bits, black_level, white_level": given,
    }
    for number in (1, 2):
        sources[f"calibration_illuminant_{number}"] = matrices
        sources[f"color_matrix_{number}"] = matrices
    sources["spectral_sensitivities"] = f"{measured.file}{origin}{_how_kept(measured)}"
    sources["illuminants"] = (
        f"neutrals of {measured.file} under {len(lights)} lights: "
        + ", ".join(os.path.basename(light) for light in lights)
    )
    return {field: text for key, text in sources.items() for field in key.split(", ")}


def _how_kept(measured: Sensitivities) -> str:
    """Return what of the profile's sensitivities was not measured."""
    wavelengths = measured.measured().wavelengths
    step = np.max(np.diff(wavelengths))
    said = f"; rows of {step:g} nm, a monotone curve through them" if step > 5.0 else ""
    if wavelengths[0] > WAVELENGTHS[0] or wavelengths[-1] < WAVELENGTHS[-1]:
        said += (
            f"; 0 outside {wavelengths[0]:g} to {wavelengths[-1]:g} nm, not measured"
        )
    return said
