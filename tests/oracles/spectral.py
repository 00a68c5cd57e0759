# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a DNG renderer makes of a camera whose spectral sensitivities are known.

Objects are lit by a spectrum and seen by the sensitivities; the camera RGB goes through
the DNG's matrices as oracles.adobe has them; the result is compared with what the CIE
1931 observer sees of the same objects under the same light, adapted to D50 alike.
Rows of arrays are objects or wavelengths, 380 to 780 nm in steps of 5.
"""

import csv
import functools
import warnings

import colour
import numpy as np

from . import adobe, de2000

SHAPE = colour.SpectralShape(380, 780, 5)
ACES = colour.RGB_COLOURSPACES["ACES2065-1"]


def on_grid(table):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return table.copy().align(SHAPE).values


@functools.cache
def observer():
    return on_grid(colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"])


@functools.cache
def light(name):
    return on_grid(colour.SDS_ILLUMINANTS[name])


@functools.cache
def held_out():
    """Reflectances that no fit has seen, by name of the set.

    CIE 224's 99 samples, PhotoResearch's 30, and the ColorChecker of ISO 17321-1."""
    from colour.quality.cfi2017 import load_TCS_CIE2017

    def chart(name):
        patches = colour.SDS_COLOURCHECKERS[name].values()
        return np.array([on_grid(patch) for patch in patches])

    return {
        "CIE 224": load_TCS_CIE2017(SHAPE).values.T,
        "PMC": chart("PMC"),
        "ColorChecker": chart("ISO 17321-1"),
    }


def xyz(power, reflectances=None):
    """XYZ of objects, or of the light itself; white has Y = 1."""
    reflectances = np.ones((1, len(power))) if reflectances is None else reflectances
    seen = reflectances @ (power[:, None] * observer())
    seen = seen / (power @ observer()[:, 1])
    return seen[0] if len(seen) == 1 else seen


def rec709_under_d65(reflectances):
    """Linear Rec.709 (n, 3) of objects under D65, white exactly 1, 1, 1."""
    to_rgb = np.linalg.inv(
        [
            [0.4123908, 0.3575843, 0.1804808],
            [0.2126390, 0.7151687, 0.0721923],
            [0.0193308, 0.1191948, 0.9505322],
        ]
    )
    return xyz(light("D65"), reflectances) @ to_rgb.T / (to_rgb @ xyz(light("D65")))


def degrees(a, b):
    """The angles (n,) between vectors (n, 3)."""
    cosine = (a * b).sum(1) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))


def to_d50(white):
    return adobe.bradford(adobe.D50, adobe.chromaticity(white))


def truth_d50(power, reflectances):
    return xyz(power, reflectances) @ to_d50(xyz(power)).T


def difference(xyz_d50, other):
    """CIEDE2000 of XYZ relative to D50."""
    lab = [colour.XYZ_to_Lab(x, adobe.D50) for x in (xyz_d50, other)]
    return de2000.de2000(*lab)


def neutral(rgb, power):
    response = power @ rgb
    return response / response[1]


def xyz_d50_from_raw(camera, rgb, power, reflectances, forward=None):
    """XYZ D50 that a DNG renderer gives of objects; white is exposed to Y = 1.

    camera : adobe.Camera. forward : [warm, cool] ForwardMatrices, or None."""
    response = reflectances @ (power[:, None] * rgb) / (power @ rgb)
    as_shot = adobe.rounded_neutral(neutral(rgb, power))
    xy = camera.xy_from_neutral(as_shot)[0]
    if forward is not None:
        weight = camera.warm_weight(xy)
        matrix = weight * forward[0] + (1.0 - weight) * forward[1]
        return response @ matrix.T
    camera_from_d50 = camera.camera_from_xyz(xy) @ adobe.bradford(xy, adobe.D50)
    rendered = np.linalg.solve(camera_from_d50, (response * as_shot).T).T
    return rendered / np.linalg.solve(camera_from_d50, as_shot)[1]


def rawtoaces_xyz_d50_from_balanced(rgb, power):
    """XYZ D50 from balanced camera RGB as rawtoaces v1 fits it (colour.matrix_idt).

    Its 3x3 gives ACES RGB adapted by CAT02; undone, then adapted by Bradford. The
    channels are balanced beforehand: it exposes by the one with the highest peak, which
    is not for every camera the one that sees most of the light."""
    sensitivities = colour.characterisation.RGB_CameraSensitivities(
        rgb / (power @ rgb), SHAPE.wavelengths
    )
    spectrum = colour.SpectralDistribution(power, SHAPE.wavelengths)
    aces_from_balanced, _ = colour.matrix_idt(sensitivities, spectrum)
    white = xyz(power)
    to_light = colour.adaptation.matrix_chromatic_adaptation_VonKries(
        colour.xy_to_XYZ(ACES.whitepoint), white, "CAT02"
    )
    return to_d50(white) @ to_light @ ACES.matrix_RGB_to_XYZ @ aces_from_balanced


def published_camera(table, clean_model):
    """adobe.Camera of a row pair (A, D65) of the published ColorMatrices."""
    with open(table, newline="") as file:
        matrices = {
            row["illuminant"]: np.array(row["matrix"].split(), float)
            for row in csv.DictReader(file)
            if row["clean_model"] == clean_model
        }
    return adobe.Camera([2850.0, 6500.0], [matrices["A"], matrices["D65"]])
