# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Spectra of lights by name, temperature or file, and those that a camera meets."""

import os
import re
from typing import Any

import numpy as np

from cg2raw.io.atomic_file import FilePath
from cg2raw.near_words import CIE_LAMPS, FORMS, did_you_mean, near_illuminants
from cg2raw.profile.spectral_file import WAVELENGTHS, Array, check_cover, read_power
from cg2raw.system import has_folder

# Lights that cameras meet, for a distribution of neutrals without a photograph: black
# bodies (candle to halogen), CIE A, phases of daylight, the CIE's lamps. Source:
# CIE 015; ISO 11664-2.
REAL_LIGHTS = (
    *(f"{kelvin}K" for kelvin in range(2000, 4000, 250)),
    "A",
    *(f"D{kelvin}K" for kelvin in range(4000, 10001, 500)),
    *CIE_LAMPS,
)
GRAMMAR = (
    "a name in colour-science's CIE and ISO tables (A, D65, FL2, LED-B3, HP2 ...), "
    "3200K (black body, 1000 to 25000 K), D5500K (CIE daylight, 4000 to 25000 K), or a "
    "file (.csv or .json) of wavelength and power"
)


def illuminant_spectrum(light: FilePath) -> Array:
    """Return the relative power (81,) of a light at WAVELENGTHS.

    light : a word; GRAMMAR says which. Finer tables are averaged over the steps,
    coarser ones interpolated linearly; outside a table its end value holds (CIE 015,
    7.2.3). Raises ValueError that lists the grammar."""
    light = os.fspath(light)
    if has_folder(light) or light.endswith((".csv", ".json")):
        return _on_grid(*read_power(light))
    temperature = re.fullmatch(r"([Dd]?)([0-9]+(?:\.[0-9]+)?)[Kk]", light)
    if temperature:
        return _of_temperature(light, bool(temperature[1]), float(temperature[2]))
    import colour

    if light not in colour.SDS_ILLUMINANTS:
        raise ValueError(f"light {light!r} is unknown; {_hint(light)}")
    table = colour.SDS_ILLUMINANTS[light]
    check_cover(f"light {light!r}", table.wavelengths)
    return _on_grid(table.wavelengths, table.values)


def _hint(light: str) -> str:
    """Return the names that a light may have been meant to have, else the grammar."""
    near = [word for word in near_illuminants(light) if word not in FORMS]
    return did_you_mean(near) if near else f"it may be {GRAMMAR}"


def _of_temperature(light: str, daylight: bool, kelvin: float) -> Array:
    """Return the power of a phase of daylight, or of a black body."""
    import colour

    lowest = 4000.0 if daylight else 1000.0
    if not lowest <= kelvin <= 25000.0:
        raise ValueError(f"light {light!r} must be {lowest:g} to 25000 K; {GRAMMAR}")
    if daylight:
        table = colour.sd_CIE_illuminant_D_series(
            colour.temperature.CCT_to_xy_CIE_D(kelvin)
        )
    else:
        table = colour.sd_blackbody(kelvin, colour.SpectralShape(380, 780, 5))
    return _on_grid(table.wavelengths, table.values)


def _on_grid(wavelengths: Any, power: Any) -> Array:
    """Return power at WAVELENGTHS of a table of any step."""
    wavelengths, power = np.asarray(wavelengths), np.asarray(power)
    step = WAVELENGTHS[1] - WAVELENGTHS[0]
    if np.median(np.diff(wavelengths)) >= step:
        return np.asarray(np.interp(WAVELENGTHS, wavelengths, power))
    # Weights of linear interpolation, the other way: what a curve sampled on the grid
    # sees of each row, so that narrow lines between two grid points are not lost.
    distance = np.abs(wavelengths[None, :] - WAVELENGTHS[:, None])
    weight = np.clip(1.0 - distance / step, 0.0, None) * np.gradient(wavelengths)
    seen = weight.sum(axis=1)
    outside = np.interp(WAVELENGTHS, wavelengths, power)
    mean = weight @ power / np.where(seen > 0.0, seen, 1.0)
    return np.asarray(np.where(seen > 0.0, mean, outside))
