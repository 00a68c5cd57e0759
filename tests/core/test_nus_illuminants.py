# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""illuminant.h on the NUS set: 1853 neutrals of nine real cameras."""

import csv

import numpy as np
import pytest

import cg2raw
from oracles import cameras
from tiers import first_fast

# Names in the table of matrices that tests/data/nine_cameras.csv is taken from.
PUBLISHED_AS = {
    "Canon1DsMkIII": "Canon EOS-1Ds Mark III",
    "Canon600D": "Canon EOS 600D",
    "FujifilmXM1": "Fujifilm X-M1",
    "NikonD40": "Nikon D40",
    "NikonD5200": "Nikon D5200",
    "OlympusEPL6": "Olympus E-PL6",
    "PanasonicGX1": "Panasonic DMC-GX1",
    "SamsungNX2000": "Samsung NX2000",
    "SonyA57": "Sony SLT-A57",
}


@pytest.fixture(scope="module")
def nus_neutrals(camera_data):
    """Neutrals (N, 3) of each of the nine cameras, by name."""
    path = camera_data / "tables/illuminants/nus9_gt_illuminants.csv"
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 1853
    return {
        name: np.array(
            [[float(row[c]) for c in "rgb"] for row in rows if row["camera"] == name]
        )
        for name in cameras.NINE
    }


@pytest.mark.parametrize("name", first_fast(list(cameras.NINE), 2))
def test_all_nus_neutrals_are_seen_as_adobe_sees_them(camera_data, nus_neutrals, name):
    path = camera_data / "tables/illuminants/nus9_cct_tint_summary.csv"
    with open(path, newline="") as file:
        summary = {row["camera"]: row for row in csv.DictReader(file)}
    sensor = cg2raw.Sensor.from_json(cameras.profile_of(name))
    oracle, seen = cameras.oracle(name), []
    for neutral in nus_neutrals[name]:
        xy, passes, converged = sensor.xy_from_neutral(neutral)
        expected = oracle.xy_from_neutral(neutral)
        assert xy == pytest.approx(expected[0], abs=1e-9)
        assert (passes, converged) == expected[1:]
        assert sensor.camera_from_xyz(xy) == pytest.approx(
            oracle.camera_from_xyz(expected[0]), abs=1e-9
        )
        seen.append(cg2raw.temperature_from_xy(xy, table="adobe"))
    check_summary(np.array(seen), summary[name])


def test_median_nus_light_of_each_camera_is_4739_to_5614_kelvin(nus_neutrals):
    medians = {}
    for name, neutrals in nus_neutrals.items():
        sensor = cg2raw.Sensor.from_json(cameras.profile_of(name))
        kelvin = [
            cg2raw.temperature_from_xy(sensor.xy_from_neutral(n)[0], table="adobe")[0]
            for n in neutrals
        ]
        medians[name] = round(float(np.median(kelvin)))
    assert min(medians.values()) == medians["PanasonicGX1"] == 4739
    assert max(medians.values()) == medians["SamsungNX2000"] == 5614


@pytest.mark.parametrize("name", cameras.NINE)
def test_matrices_of_the_nine_are_those_of_the_published_table(camera_data, name):
    path = camera_data / "tables/matrices/rawler_color_matrices.csv"
    with open(path, newline="") as file:
        published = {
            (row["clean_make"] + " " + row["clean_model"], row["illuminant"]): row
            for row in csv.DictReader(file)
        }
    for light, matrix in zip(("A", "D65"), cameras.matrices(name), strict=True):
        words = published[PUBLISHED_AS[name], light]["matrix"].split()
        assert matrix.ravel().tolist() == [float(word) for word in words]


def check_summary(seen, row):
    """Percentiles of (CCT, Duv) are those of the published table, to its last digit."""
    assert len(seen) == int(row["n"]) and row["nonconverged"] == "0"
    for column, values in (("cct", seen[:, 0]), ("tint", 3000.0 * seen[:, 1])):
        for percentile in (5, 50, 95):
            expected = float(row[f"{column}_p{percentile}"])
            assert np.percentile(values, percentile) == pytest.approx(
                expected, abs=0.0501
            )
