# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Profiles of real cameras' sensitivities, beside what others measured of them."""

import csv
import json

import numpy as np
import pytest
from scipy.spatial import Delaunay

import cg2raw
from cg2raw.profile.illuminant_spectra import REAL_LIGHTS
from cg2raw.profile.matrix_fit import balanced_camera
from cg2raw.profile.spectral import color_matrices, neutral_under, profile_from_ssf
from cg2raw.profile.spectral_file import read_sensitivities
from oracles import adobe, spectral

# Camera of the published matrices: file of sensitivities, camera of the grey cards.
CAMERAS = {
    "EOS-1Ds Mark III": ("Canon_EOS-1Ds_Mark_III", "Canon1DsMkIII"),
    "EOS 600D": ("Canon_EOS_600D", "Canon600D"),
}
SENSOR = {
    "cfa": "RGGB",
    "width": 5184,
    "height": 3456,
    "bits": 14,
    "black_level": 2048,
    "white_level": 15000,
}


@pytest.fixture(scope="module")
def folder(camera_data):
    return camera_data / "tables/ssf/rawtoaces-data/data/camera"


@pytest.fixture(scope="module", params=CAMERAS)
def camera(request, folder, camera_data):
    """Return (measured, fitted, published, grey cards' (R/G, B/G)) of a camera."""
    file, name = CAMERAS[request.param]
    measured = read_sensitivities(folder / f"{file}_380_780_5.json")
    table = camera_data / "tables/matrices/rawler_color_matrices.csv"
    cards = camera_data / "tables/illuminants/nus9_gt_illuminants.csv"
    with open(cards, newline="") as rows:
        rgb = np.array(
            [
                [float(row[c]) for c in "rgb"]
                for row in csv.DictReader(rows)
                if row["camera"] == name
            ]
        )
    published = spectral.published_camera(table, request.param)
    return measured, fitted(measured), published, rgb[:, [0, 2]] / rgb[:, 1:2]


def fitted(measured):
    matrices = color_matrices(measured)
    return adobe.Camera([2850.0, 6500.0], [matrices["A"], matrices["D65"]])


def error(camera, rgb, light, objects):
    """Mean CIEDE2000 of what a DNG renderer gives of objects."""
    power = spectral.light(light)
    rendered = spectral.xyz_d50_from_raw(camera, rgb, power, objects)
    truth = spectral.truth_d50(power, objects)
    return spectral.difference(rendered, truth).mean()


def rawtoaces_error(rgb, light, objects):
    power = spectral.light(light)
    matrix = spectral.rawtoaces_xyz_d50_from_balanced(rgb, power)
    rendered = balanced_camera(rgb, power, objects) @ matrix.T
    return spectral.difference(rendered, spectral.truth_d50(power, objects)).mean()


def all_objects():
    return np.concatenate(list(spectral.held_out().values()))


@pytest.mark.parametrize("light", ["A", "D65"])
def test_a_chart_is_rendered_nearer_to_truth_than_by_the_published_matrices(
    camera, light
):
    """Those stand for other copies of the camera; docs/spectral.md has the table."""
    measured, ours, published, _ = camera
    chart = spectral.held_out()["ColorChecker"]
    assert error(ours, measured.rgb, light, chart) < 1.0
    assert error(published, measured.rgb, light, chart) > 1.2
    power = spectral.light(light)
    pair = [
        spectral.xyz_d50_from_raw(c, measured.rgb, power, chart)
        for c in (ours, published)
    ]
    assert spectral.difference(*pair).mean() < 1.8


@pytest.mark.parametrize(("light", "xy"), [("A", (0.4476, 0.4074)), ("D65", adobe.D65)])
def test_neutrals_are_near_those_of_the_published_matrices(camera, light, xy):
    measured, _, published, _ = camera
    ours = neutral_under(measured, light)
    assert published.neutral_from_xy(xy) == pytest.approx(ours, rel=0.1)


def test_the_matrices_give_back_the_neutrals(camera):
    measured, *_ = camera
    profile = profile_from_ssf(measured, **SENSOR)
    sensor = cg2raw.Sensor.from_json(json.dumps(profile))
    for light in ("A", "D65"):
        neutral = neutral_under(measured, light)
        assert sensor.illuminant(light).neutral == pytest.approx(neutral, abs=3e-4)


def test_photographed_neutrals_lie_among_those_of_the_lights(camera):
    """The grey cards are those of the NUS set (Cheng et al., JOSA A 2014)."""
    measured, _, _, cards = camera
    lights = np.array([neutral_under(measured, light) for light in REAL_LIGHTS])
    inside = Delaunay(lights[:, [0, 2]]).find_simplex(cards) >= 0
    assert inside.mean() > 0.8
    assert lights[:, [0, 2]].mean(axis=0) == pytest.approx(cards.mean(axis=0), abs=0.1)


@pytest.mark.parametrize("light", ["A", "D65"])
def test_held_out_objects_are_rendered_better_than_by_rawtoaces(camera, light):
    measured, ours, *_ = camera
    mean = error(ours, measured.rgb, light, all_objects())
    assert mean < rawtoaces_error(measured.rgb, light, all_objects())


def test_files_of_other_collections_are_read(camera_data):
    """The D40 by a monochromator: Jiang et al., WACV 2013; 400 to 720 nm, step 10."""
    tables = camera_data / "tables"
    path = tables / "ssf/ssf-data/Nikon/D40/camspec/Nikon_D40.csv"
    profile = profile_from_ssf(path, **SENSOR, make="Nikon", model="D40", lights=["A"])
    sensor = cg2raw.Sensor.from_json(json.dumps(profile))
    published = spectral.published_camera(
        tables / "matrices/rawler_color_matrices.csv", "D40"
    )
    ours = sensor.illuminant("A").neutral
    assert published.neutral_from_xy((0.4476, 0.4074)) == pytest.approx(ours, rel=0.15)


def test_the_academys_studio_tungsten_is_a_light(camera_data, folder):
    """ISO 7589: 3200 K."""
    measured = read_sensitivities(folder / "Canon_EOS_600D_380_780_5.json")
    path = camera_data / "tables/ssf/rawtoaces-data/data/illuminant"
    found = neutral_under(measured, path / "iso7589_stutung_380_780_5.json")
    assert found == pytest.approx(neutral_under(measured, "3200K"), rel=0.06)


@pytest.mark.slow
def test_every_camera_is_fitted_and_none_worse_than_by_rawtoaces(folder):
    files = sorted(folder.glob("*.json"))
    assert len(files) >= 52
    errors = []
    for file in files:
        rgb = (measured := read_sensitivities(file)).rgb
        ours = fitted(measured)
        for light in ("A", "D65"):
            mean = error(ours, rgb, light, all_objects())
            errors.append((mean, rawtoaces_error(rgb, light, all_objects())))
    ours, theirs = np.transpose(errors)
    assert np.all(ours < theirs)
    assert np.max(ours) < 2.3
    assert np.median(ours[0::2]) < 1.25  # A; docs/spectral.md: 1.23
    assert np.median(ours[1::2]) < 1.0  # D65: 0.97


@pytest.mark.slow
def test_every_table_of_the_other_collection_makes_a_profile(camera_data):
    files = sorted((camera_data / "tables/ssf/ssf-data").rglob("*.csv"))
    assert len(files) == 32
    for file in files:
        names = {"make": "Acme", "model": file.stem}
        profile = profile_from_ssf(file, **SENSOR, **names)
        assert profile["id"].startswith("acme-")
