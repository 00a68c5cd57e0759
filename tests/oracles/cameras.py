# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Cameras to test with: published matrices, and profiles made of them."""

import csv
import functools
import json
from pathlib import Path

import numpy as np

from . import adobe

DATA = Path(__file__).parents[1] / "data"
# The Fujifilm X-M1's: rawler, data/cameras/fuji/x-m1.toml.
X_TRANS = "GGRGGBGGBGGRBRGRBGGGBGGRGGRGGBRBGBRG"
QUAD = "RRGGRRGGGGBBGGBB"  # Bayer of 2 x 2 equal sites each
NINE = (
    "Canon1DsMkIII",
    "Canon600D",
    "FujifilmXM1",
    "NikonD40",
    "NikonD5200",
    "OlympusEPL6",
    "PanasonicGX1",
    "SamsungNX2000",
    "SonyA57",
)


def rows_of(name):
    """Rows of a table of tests/data; lines that start with # say its source."""
    with open(DATA / name, newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


@functools.cache
def matrices(camera):
    """ColorMatrices (3, 3) of one of the NINE: under A, under D65."""
    found = {
        row["illuminant"]: np.reshape(
            [float(row[f"m{i}{j}"]) for i in range(3) for j in range(3)], (3, 3)
        )
        for row in rows_of("nine_cameras.csv")
        if row["camera"] == camera
    }
    return found["A"], found["D65"]


def oracle(camera):
    return adobe.Camera([2850.0, 6500.0], matrices(camera))


def profile(**fields):
    """A legal profile as a dict: 14 bits, black 512, RGGB, the D40's matrices.

    A field given as None is left out; a larger CFA has its numbers once for all."""
    cm_a, cm_d65 = matrices("NikonD40")
    bayer = len(fields.get("cfa") or "RGGB") == 4

    def per_site(value):
        return [value] * 4 if bayer else value

    legal = {
        "schema": 1,
        "id": "test-sensor",
        "make": "cg2raw",
        "model": "Test Sensor",
        "unique_camera_model": "cg2raw Test Sensor",
        "sources": {"noise": "planted"},
        "cfa": "RGGB",
        "width": 64,
        "height": 48,
        "bits": 14,
        "black_level": per_site(512),
        "white_level": 16383,
        "calibration_illuminant_1": "A",
        "calibration_illuminant_2": "D65",
        "color_matrix_1": cm_a.ravel().tolist(),
        "color_matrix_2": cm_d65.ravel().tolist(),
        "illuminants": {
            "neutrals": [[0.9, 0.3], [0.5, 0.6], [0.7, 0.35], [0.45, 0.75], [0.6, 0.5]]
        },
        "noise": [
            {"iso": 100, "beta1": per_site(1e-4), "beta2": per_site(1e-6)},
            {"iso": 400, "beta1": per_site(4e-4), "beta2": per_site(9e-6)},
        ],
        "effects": [],
    }
    legal.update(fields)
    return {name: value for name, value in legal.items() if value is not None}


def profile_text(**fields):
    return json.dumps(profile(**fields))


def mono_text(**fields):
    """JSON text of a legal monochrome profile: 14 bits, black 512, one ISO."""
    colored = ("calibration_illuminant", "color_matrix")
    dropped = {f"{name}_{number}": None for name in colored for number in (1, 2)}
    mono = {"cfa": "mono", "black_level": 512, "illuminants": None}
    noise = [{"iso": 100, "beta1": 1e-4, "beta2": 1e-6}]
    return profile_text(**{**dropped, **mono, "noise": noise, **fields})


def profile_of(camera, bits=14, **fields):
    """JSON text of a profile with the matrices of one of the NINE."""
    cm_a, cm_d65 = matrices(camera)
    fields = {
        "id": camera.lower(),
        "bits": bits,
        "black_level": [2**bits // 32] * 4,
        "white_level": 2**bits - 1,
        "color_matrix_1": cm_a.ravel().tolist(),
        "color_matrix_2": cm_d65.ravel().tolist(),
        **fields,
    }
    return profile_text(**fields)


def srgb_from_xyY(x, y, Y, white=adobe.D50):
    """Linear sRGB of a chromaticity and luminance seen under a white."""
    XYZ = Y * adobe.bradford(adobe.D65, white) @ adobe.xyz((x, y))
    return np.linalg.solve(adobe.xyz_d65_from_srgb(), XYZ)


def colorchecker():
    """Linear sRGB (24, 3) of the ColorChecker; cyan is outside sRGB."""
    return np.array(
        [
            srgb_from_xyY(float(row["x"]), float(row["y"]), float(row["Y"]))
            for row in rows_of("colorchecker_2005.csv")
        ]
    )
