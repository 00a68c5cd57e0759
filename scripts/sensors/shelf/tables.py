# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Rows of the published tables, and what a profile takes from them.

The tables are those of the test data (see its README for origins and licences). Only
single facts and distributions leave them, and no list of measurements but spectral
sensitivities under a licence that allows it.
"""

import csv
import functools
import json

import numpy as np
from scipy.spatial import ConvexHull

from cg2raw.profile.neutral_mixture import mixture_of


@functools.cache
def rows_of(path):
    """Return the rows of a CSV file as dicts of text."""
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def one_row(rows, path, **wanted):
    """Return the only row with these values; ValueError if there is none or several."""
    found = [row for row in rows if all(row[k] == v for k, v in wanted.items())]
    if len(found) != 1:
        raise ValueError(f"{path.name}: {len(found)} rows with {wanted}; one is needed")
    return found[0]


def rawspeed_row(tables, model, mode):
    """Return RawSpeed's facts of a camera: make, model, id, cfa, crop, levels."""
    path = tables / "sensors" / "rawspeed_cameras.csv"
    return one_row(rows_of(path), path, model=model, mode=mode)


def rawler_row(tables, model, illuminant):
    """Return rawler's facts of a camera, with its matrix under one illuminant."""
    path = tables / "matrices" / "rawler_color_matrices.csv"
    return one_row(rows_of(path), path, model=model, illuminant=illuminant)


def phase_at(pattern, x, y):
    """Return a CFA's letters as seen from column x, row y; pattern is square.

    RawSpeed and rawler state the pattern of the uncropped raw file and shift it by
    their crop: both give GRBG for the Samsung NX2000, whose crops there start at odd
    (45, 25) and at (0, 0)."""
    side = round(len(pattern) ** 0.5)
    return "".join(
        pattern[(y + row) % side * side + (x + column) % side]
        for row in range(side)
        for column in range(side)
    )


def graphics2raw_matrices(tables, key):
    """Return {illuminant: 9 numbers, XYZ to camera} of the paper's public tables."""
    path = tables / "matrices" / "graphics2raw_NUS_S20FE_cst.json"
    entry = json.loads(path.read_text())[key]
    if "cm_A" in entry:
        return {"A": entry["cm_A"], "D65": entry["cm_D65"]}
    return {"D65": [value for row in "012" for value in entry[row]]}


def rawler_matrices(tables, model):
    """Return {illuminant: 9 numbers, XYZ to camera} as rawler lists Adobe's."""
    return {
        light: [float(v) for v in rawler_row(tables, model, light)["matrix"].split()]
        for light in ("A", "D65")
    }


def rawtoaces_sensitivities(tables, camera):
    """Return (the field spectral_sensitivities, file, who measured) of a camera."""
    file = f"{camera}_380_780_5.json"
    path = tables / "ssf" / "rawtoaces-data" / "data" / "camera" / file
    document = json.loads(path.read_text())
    header, data = document["header"], document["spectral_data"]
    if header["license"] != "Apache-2.0" or data["index"]["main"] != ["R", "G", "B"]:
        raise ValueError(f"{file}: must be R, G and B under Apache-2.0")
    rows = np.array(list(data["data"]["main"].values()))
    peak = float(rows.max())
    curves = (rows / peak).round(6) + 0.0
    field = {
        "unit": "energy",
        "scale": peak,
        "wavelengths": [int(wavelength) for wavelength in data["data"]["main"]],
        **{name: curves[:, i].tolist() for i, name in enumerate("RGB")},
    }
    return field, file, header["document_creator"]


def neutrals_of(tables, file, camera):
    """Return (N, 2) ratios R/G, B/G of the grey cards of one camera, or of all."""
    rows = rows_of(tables / "illuminants" / file)
    chosen = [row for row in rows if camera is None or row["camera"] == camera]
    if not chosen:
        raise ValueError(f"{file}: no row of camera {camera}")
    return np.array([[float(row[c]) / float(row["g"]) for c in "rb"] for row in chosen])


def distribution_of(neutrals):
    """Return mean, covariance (divisor N - 1), hull and mixture of (N, 2) ratios.

    Samplers need no more, and no table of others is passed on."""
    hull = neutrals[ConvexHull(neutrals).vertices]
    return {
        "mean": neutrals.mean(axis=0).round(6).tolist(),
        "covariance": np.cov(neutrals.T).round(9).tolist(),
        "hull": np.roll(hull, -hull[:, 0].argmin(), axis=0).round(6).tolist(),
        "mixture": mixture_of(neutrals),
    }
