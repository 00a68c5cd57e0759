# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A DNG ColorMatrix from spectral sensitivities, for one light.

A DNG renderer inverts the matrix and adapts the light's white to D50 by Bradford (DNG
specification 1.7, chapter 6). The matrix sought makes its mean CIEDE2000 over training
reflectances least, against the CIE 1931 observer's colours of the same objects under
the same light or another, adapted alike. White is exact: the matrix maps the light's
XYZ to the camera's neutral. Six numbers stay free; they start from linear least
squares.
"""

import functools
from typing import Any

import numpy as np

from cg2raw.profile.spectral_file import WAVELENGTHS, Array

D50_XY = (0.3457, 0.3585)  # white of the DNG profile connection space
# Keeps the root of a colour difference smooth at 0; far below what is visible.
SMOOTHING = 1e-4  # CIEDE2000, squared


def xyz_under(power: Array, reflectances: Array | None = None) -> Array:
    """Return the CIE 1931 XYZ of reflectances (n, 81) under power (81,), white Y = 1.

    Without reflectances: XYZ (3,) of the light."""
    observer = power[:, None] * _observer()
    observer = observer / observer[:, 1].sum()
    if reflectances is None:
        return np.asarray(observer.sum(axis=0))
    return np.asarray(reflectances @ observer)


def balanced_camera(rgb: Array, power: Array, reflectances: Array) -> Array:
    """Return camera RGB (n, 3) of reflectances over that of the perfect reflector.

    rgb : (81, 3) sensitivities."""
    response = power[:, None] * rgb
    return np.asarray(reflectances @ (response / response.sum(axis=0)))


def adaptation_to_d50(white: Array) -> Array:
    """Return (3, 3) linear Bradford adaptation of XYZ from a white to D50."""
    from colour.adaptation import matrix_chromatic_adaptation_VonKries

    adaptation = matrix_chromatic_adaptation_VonKries(
        white, _d50(), transform="Bradford"
    )
    return np.asarray(adaptation, np.float64)


def delta_e(xyz_d50: Array, reference_xyz_d50: Array) -> Array:
    """Return CIEDE2000 (n,) of XYZ relative to D50, white Y = 1."""
    import colour

    lab = colour.XYZ_to_Lab(xyz_d50, D50_XY)
    reference = colour.XYZ_to_Lab(reference_xyz_d50, D50_XY)
    return np.asarray(colour.difference.delta_E_CIE2000(lab, reference), np.float64)


def fit_xyz_d50_from_camera(
    rgb: Array,
    power: Array,
    observed_under: Array | None = None,
) -> Array:
    """Return (3, 3) XYZ D50 from balanced camera RGB with the least mean CIEDE2000.

    rgb : (81, 3) sensitivities. power : (81,) of the light. observed_under : (81,) of
    the light under which the observer sees the colours that are sought; by default
    power. White (1, 1, 1) becomes XYZ of D50. That is a DNG ForwardMatrix. Raises
    ValueError if the fit does not end in an invertible matrix."""
    from scipy.optimize import minimize

    reflectances = training_reflectances()
    camera = balanced_camera(rgb, power, reflectances)
    observed = power if observed_under is None else observed_under
    to_d50 = adaptation_to_d50(xyz_under(observed))
    truth = xyz_under(observed, reflectances) @ to_d50.T

    def loss(free: Array) -> float:
        difference = delta_e(camera @ _white_preserving(free).T, truth)
        return float(np.sqrt(difference**2 + SMOOTHING).mean())

    start = _least_squares(camera, truth)
    fitted = minimize(loss, start, method="BFGS").x
    best = min((start, fitted), key=loss)
    matrix = _white_preserving(best)
    if not np.all(np.isfinite(matrix)) or np.linalg.cond(matrix) > 1e4:
        raise ValueError("no colour matrix fits: R, G and B see nearly the same")
    return matrix


def color_matrix(xyz_d50_from_camera: Array, rgb: Array, power: Array) -> Array:
    """Return the ColorMatrix (3, 3), XYZ -> camera, of a fitted matrix under its light.

    Its largest channel sees D50 as 1, as a DNG renderer scales it."""
    neutral = power @ rgb
    xyz_from_d50 = np.linalg.inv(adaptation_to_d50(xyz_under(power)))
    xyz_from_balanced = xyz_from_d50 @ xyz_d50_from_camera
    matrix = np.diag(neutral) @ np.linalg.inv(xyz_from_balanced)
    return np.asarray(matrix / np.max(matrix @ _d50()))


@functools.cache
def training_reflectances() -> Array:
    """Return (190, 81): the Academy's training patches, as colour-science carries them.

    Source: AMPAS P-2013-001 and rawtoaces."""
    from colour.characterisation import read_training_data_rawtoaces_v1

    return _frozen(read_training_data_rawtoaces_v1().values.T)


@functools.cache
def _observer() -> Array:
    """Return (81, 3): the CIE 1931 2 degree observer at WAVELENGTHS."""
    import colour

    table = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    return _frozen(table[WAVELENGTHS])


def _frozen(array: Any) -> Array:
    frozen: Array = np.array(array, np.float64)
    frozen.flags.writeable = False
    return frozen


def _d50() -> Array:
    x, y = D50_XY
    return np.array([x / y, 1.0, (1.0 - x - y) / y])


def _white_preserving(free: Array) -> Array:
    """Return the matrix of six free numbers, its columns 0 and 1: rows sum to D50."""
    columns = np.reshape(free, (3, 2))
    return np.column_stack([columns, _d50() - columns.sum(axis=1)])


def _least_squares(camera: Array, truth: Array) -> Array:
    """Return the free numbers that map camera RGB to XYZ with least squared error."""
    blue = camera[:, 2:]
    solved = np.linalg.lstsq(camera[:, :2] - blue, truth - blue * _d50(), rcond=None)
    return np.asarray(solved[0].T.ravel(), np.float64)
