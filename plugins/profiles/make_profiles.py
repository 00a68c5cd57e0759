#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Make the bundled sensor profiles from published tables.

The tables are those of the test data (see its README for origins and licences); only
numbers enter a profile, and each names its source there. Same tables, same bytes.
"""

import argparse
import csv
import json
import re
import sys
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

S20FE_SOURCES = {
    "make, model, unique_camera_model": "Galaxy S20 FE 4G as Android's DNG writer "
    "names it (MODEL-MANUFACTURER-BRAND); which variant was measured is not public",
    "cfa, bits, black_level, white_level": "SamsungLabs graphics2raw and "
    "modular_neural_isp: S20 FE main camera, GRBG, black 64, white 1023",
    "width, height": "Galaxy S20 FE, main camera, 12 MP raw size",
    "calibration_illuminant_1, color_matrix_1": "SamsungLabs graphics2raw (ICCV 2023), "
    "table of ten D65 matrices, index 7; the table has none for A, so this profile has "
    "one matrix and nothing is interpolated",
    "illuminants": "SamsungLabs graphics2raw (ICCV 2023): the distribution of 105 grey "
    "cards shot at night",
    "digital_gain": "SamsungLabs graphics2raw, option --rgb_gain: N(0.8, 0.1)",
    "noise": "SamsungLabs modular_neural_isp, model h-gauss-s20-v1, ISO 100-3200, "
    "var = b1 DN + b2 with DN including black 64; beta1 = b1 / 959, beta2 = "
    "max(0, 64 b1 + b2) / 959^2; sites in raster order of GRBG. ISO 50 is not in the "
    "table: it is extrapolated by one stop",
}

D40_SOURCES = {
    "make, model, unique_camera_model, cfa, width, height, black_level, white_level": (
        "RawSpeed's table of cameras: crop 0,0,3038x2014 with phase BGGR, black 0, "
        "white 3880"
    ),
    "bits": "12-bit NEF",
    "calibration_illuminant_1, color_matrix_1, calibration_illuminant_2, "
    "color_matrix_2": "Adobe's matrices for A and D65, as SamsungLabs graphics2raw "
    "(ICCV 2023) lists them; equal to 1e-4 to those in dnglab's rawler",
    "illuminants": "NUS set, Nikon D40 (Cheng et al., JOSA A 2014): the distribution "
    "of 117 grey cards",
    "noise": "none is published of its raw data, so this sensor is simulated clean",
}


def significant(value, digits):
    return float(f"{value:.{digits}g}")


def per_field(sources):
    """{"a, b": text} -> {"a": text, "b": text}."""
    return {field: text for key, text in sources.items() for field in key.split(", ")}


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def illuminants_of(rows):
    """Mean, covariance (divisor N - 1) and convex hull of the rows' (R/G, B/G).

    A sampler needs no more, and no table of others is passed on."""
    neutrals = np.array(
        [[float(row[c]) / float(row["g"]) for c in "rb"] for row in rows]
    )
    hull = neutrals[ConvexHull(neutrals).vertices]
    return {
        "mean": neutrals.mean(axis=0).round(6).tolist(),
        "covariance": np.cov(neutrals.T).round(9).tolist(),
        "hull": np.roll(hull, -hull[:, 0].argmin(), axis=0).round(6).tolist(),
    }


def noise_from_dn(rows, black, white):
    """Noise rows from var = b1 DN + b2 with DN including black, one row per CFA site.

    In x = (DN - black) / (white - black): beta1 = b1 / (white - black) and
    beta2 = max(0, b1 black + b2) / (white - black)^2."""
    span = white - black
    noise = {}
    for row in sorted(
        rows, key=lambda r: (int(r["iso"]), int(r["bayer_pos_00_01_10_11"]))
    ):
        b1, b2 = float(row["beta1_DN"]), float(row["beta2_DN2"])
        at = noise.setdefault(int(row["iso"]), {"beta1": [], "beta2": []})
        at["beta1"].append(significant(b1 / span, 6))
        at["beta2"].append(significant(max(0.0, b1 * black + b2) / span**2, 6))
    return [{"iso": iso, **values} for iso, values in noise.items()]


def samsung_s20fe(data):
    tables = data / "tables"
    cst = json.loads((tables / "matrices/graphics2raw_NUS_S20FE_cst.json").read_text())
    matrix = cst["NUS_S20FE_CST_mats/7"]
    night = tables / "illuminants/samsung_s20fe_night_greycard_105.csv"
    noise = [
        row
        for row in rows_of(tables / "noise/samsung_pixel_model_params.csv")
        if row["model"] == "h-gauss-s20-v1"
    ]
    black, white = 64, 1023
    return {
        "schema": 1,
        "id": "samsung-s20fe",
        "make": "samsung",
        "model": "SM-G780F",
        "unique_camera_model": "SM-G780F-samsung-samsung",
        "sources": per_field(S20FE_SOURCES),
        "cfa": "GRBG",
        "width": 4032,
        "height": 3024,
        "bits": 10,
        "black_level": [black] * 4,
        "white_level": white,
        "calibration_illuminant_1": "D65",
        "color_matrix_1": [value for row in "012" for value in matrix[row]],
        "illuminants": illuminants_of(rows_of(night)),
        "digital_gain": {"mean": 0.8, "sigma": 0.1},
        "noise": noise_from_dn(noise, black, white),
        "effects": [],
    }


def nikon_d40(data):
    tables = data / "tables"
    cst = json.loads((tables / "matrices/graphics2raw_NUS_S20FE_cst.json").read_text())
    matrices = cst["NUS_CST_mats/NikonD40"]
    neutrals = [
        row
        for row in rows_of(tables / "illuminants/nus9_gt_illuminants.csv")
        if row["camera"] == "NikonD40"
    ]
    [sensor] = [
        row
        for row in rows_of(tables / "sensors/rawspeed_cameras.csv")
        if (row["model"], row["mode"]) == ("NIKON D40", "12bit-compressed")
    ]
    return {
        "schema": 1,
        "id": "nikon-d40",
        "make": sensor["make"],
        "model": sensor["model"],
        "unique_camera_model": sensor["id"],
        "sources": per_field(D40_SOURCES),
        "cfa": sensor["cfa"],
        "width": int(sensor["crop_w"]),
        "height": int(sensor["crop_h"]),
        "bits": 12,
        "black_level": [int(sensor["black"])] * 4,
        "white_level": int(sensor["white"]),
        "calibration_illuminant_1": "A",
        "calibration_illuminant_2": "D65",
        "color_matrix_1": matrices["cm_A"],
        "color_matrix_2": matrices["cm_D65"],
        "illuminants": illuminants_of(neutrals),
        "noise": [],
        "effects": [],
    }


def formatted(profile):
    """JSON text with every list of numbers on one line."""
    return (
        re.sub(
            r"\[[-+0-9.eE,\s]+\]",
            lambda numbers: (
                "[" + ", ".join(numbers.group()[1:-1].split()).replace(",,", ",") + "]"
            ),
            json.dumps(profile, indent=2),
        )
        + "\n"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder with tables/")
    parser.add_argument(
        "--out", type=Path, required=True, help="folder for the profiles"
    )
    arguments = parser.parse_args()
    if not (arguments.data / "tables").is_dir():
        sys.exit(f"make_profiles: {arguments.data} has no folder tables/")
    for make in (samsung_s20fe, nikon_d40):
        profile = make(arguments.data)
        (arguments.out / f"{profile['id']}.json").write_text(formatted(profile))


if __name__ == "__main__":
    main()
