# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A camera that does not exist, by its spectral sensitivities."""

import numpy as np

from cg2raw.profile.spectral_file import WAVELENGTHS, Sensitivities

SENSOR = {
    "cfa": "RGGB",
    "width": 6000,
    "height": 4000,
    "bits": 14,
    "black_level": 1024,
    "white_level": 15000,
}


def three_lobes():
    """Sensitivities of Gaussian shape, as broad as a real camera's."""
    centres, widths = np.array([600.0, 535.0, 460.0]), np.array([35.0, 42.0, 30.0])
    rgb = np.exp(-0.5 * ((WAVELENGTHS[:, None] - centres) / widths) ** 2)
    return Sensitivities("lobes.json", rgb * [0.8, 1.0, 0.7], "Acme", "Lobes 3")


def camera_json(rgb, **header):
    rows = zip(WAVELENGTHS, rgb.tolist(), strict=True)
    return {
        "header": {"manufacturer": "Acme", "model": "Lobes 3", **header},
        "spectral_data": {
            "index": {"main": ["R", "G", "B"]},
            "data": {"main": {f"{wavelength:g}": row for wavelength, row in rows}},
        },
    }
