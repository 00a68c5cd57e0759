# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the CIE 1931 observer and a renderer's linear sRGB make of spectra."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.profile.illuminant_spectra import illuminant_spectrum
from cg2raw.profile.spectral_file import WAVELENGTHS

Array = NDArray[np.float64]
# Cone responses of the Bradford adaptation. Source: DNG specification 1.7.1, chapter 6.
BRADFORD = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)
LEAST_ALBEDO, MOST_ALBEDO = 0.002, 0.98  # of a renderer's linear sRGB
LEAST_LIGHT = 0.002  # of a light's linear sRGB, luminance 1: a renderer has no less


@cache
def observer() -> Array:
    """Return the colour matching functions (81, 3) at WAVELENGTHS."""
    import colour

    table = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    columns = [np.interp(WAVELENGTHS, table.wavelengths, c) for c in table.values.T]
    return np.stack(columns, axis=1)


@cache
def d65() -> Array:
    """Return D65 (81,), luminance 1."""
    return of_luminance_1(illuminant_spectrum("D65"))


def of_luminance_1(powers: Array) -> Array:
    """Return powers (..., 81) over their luminance."""
    return np.asarray(powers / (powers @ observer()[:, 1:2]))


def srgb_from_xyz() -> Array:
    """Return the matrix (3, 3) from XYZ under D65 to linear sRGB."""
    return np.asarray(np.linalg.inv(_core.xyz_d65_from_srgb()), float)


def albedos(reflectances: Array) -> Array:
    """Return linear sRGB (n, 3) of reflectances (n, 81) under D65; white is 1, 1, 1."""
    white = srgb_from_xyz() @ (d65() @ observer())
    rgb = (reflectances * d65()) @ observer() @ srgb_from_xyz().T / white
    return np.asarray(rgb.clip(LEAST_ALBEDO, MOST_ALBEDO))


def light_colours(lights: Array, white: Array) -> Array:
    """Return linear sRGB (n, 3) of lights (n, 81) where @white (81,) is 1, 1, 1.

    All have luminance 1, and are adapted from white to D65 by Bradford."""
    return under_d65(lights @ observer(), white).clip(LEAST_LIGHT)


def under_d65(xyz: Array, white: Array) -> Array:
    """Return linear sRGB (..., 3) of XYZ, adapted from @white (81,) to D65 by Bradford.

    White, at its own luminance of 1, is 1, 1, 1."""
    goal = d65() @ observer()
    gains = (BRADFORD @ goal) / (BRADFORD @ (white @ observer()))
    adapted = np.linalg.inv(BRADFORD) @ np.diag(gains) @ BRADFORD
    rgb = (srgb_from_xyz() @ adapted) / (srgb_from_xyz() @ goal)[:, None]
    return np.asarray(xyz @ rgb.T)
