# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The bundled sensors: the sources of their numbers, and that a camera could be so."""

import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import rawpy

import cg2raw

PROFILES = Path(__file__).parents[2] / "plugins" / "profiles"
SCRIPTS = Path(__file__).parents[2] / "scripts" / "sensors"
FIELDS = {
    path.stem: json.loads(path.read_text()) for path in sorted(PROFILES.glob("*.json"))
}
PAPER = (
    "canon-1ds-mark-iii canon-600d fujifilm-x-m1 nikon-d40 nikon-d5200 olympus-e-pl6 "
    "panasonic-gx1 samsung-nx2000 samsung-s20fe sony-a57"
).split()
NOISY = [name for name, fields in FIELDS.items() if fields["noise"]]
SAMPLED = [name for name, fields in FIELDS.items() if "illuminants" in fields]

every_sensor = pytest.mark.parametrize("name", FIELDS)
noisy_sensor = pytest.mark.parametrize("name", NOISY)


@pytest.mark.parametrize("name", SAMPLED)
def test_lights_can_be_drawn_of_a_mixture(name):
    drawn = [cg2raw.Sensor(name).illuminant(f"measured:{n}").neutral for n in range(60)]
    spread = np.std(drawn, axis=0)
    assert FIELDS[name]["illuminants"]["mixture"] and spread[0] > 0.02


def test_the_shelf_holds_the_papers_ten_and_more():
    assert set(PAPER) <= set(FIELDS)
    assert len(FIELDS) >= 18


@pytest.mark.slow
def test_same_tables_same_bytes(camera_data, tmp_path):
    script = SCRIPTS / "make_profiles.py"
    command = [sys.executable, script, "--data", camera_data, "--out", tmp_path]
    subprocess.run(list(map(str, command)), check=True)
    made = {path.stem: path.read_bytes() for path in tmp_path.glob("*.json")}
    assert sorted(made) == sorted(FIELDS)
    for name, text in made.items():
        assert text == (PROFILES / f"{name}.json").read_bytes(), name


@every_sensor
def test_it_loads_and_survives_a_round_trip(name):
    sensor = cg2raw.Sensor(name)
    assert sensor.id == name
    again = cg2raw.Sensor.from_json(sensor.to_json())
    assert again.to_json() == sensor.to_json()


@every_sensor
def test_every_number_has_a_source(name):
    fields = FIELDS[name]
    facts = {name for name, value in fields.items() if name != "effects" or value}
    facts -= {"schema", "id", "sources"}
    # A field that is absent for want of data says so among the sources.
    assert set(fields["sources"]) - facts <= {"illuminants"}
    assert facts <= set(fields["sources"])
    assert all(len(text) > 8 for text in fields["sources"].values())


@pytest.mark.parametrize(
    ("pattern", "corner", "seen"),
    [
        # Canon's light-sensitive area begins with red, whatever its masked border.
        ("GBRG", (142, 51), "RGGB"),
        ("GRBG", (45, 25), "GBRG"),
        ("GRBG", (8, 8), "GRBG"),
        ("RGGB", (1, 0), "GRBG"),
        ("RGGB", (0, 1), "GBRG"),
        # X-Trans holds no more than two greens in a row: from its third column on, one.
        ("GGRGGBGGBGGRBRGRBGGGBGGRGGRGGBRBGBRG", (2, 0), "RGGBGG"),
        ("GGRGGBGGBGGRBRGRBGGGBGGRGGRGGBRBGBRG", (6, 5), "RBGBRG"),
    ],
)
def test_a_cfa_is_seen_from_the_corner_of_the_active_area(
    pattern, corner, seen, monkeypatch
):
    monkeypatch.syspath_prepend(str(SCRIPTS))
    from shelf import tables

    letters = tables.phase_at(pattern, *corner)
    assert letters.startswith(seen) and sorted(letters) == sorted(pattern)


@pytest.mark.parametrize("name", [name for name in FIELDS if name.startswith("canon")])
def test_every_canon_begins_with_red(name):
    assert FIELDS[name]["cfa"] == "RGGB"


def neutral(name, light):
    vector = cg2raw.Sensor(name).illuminant(light).neutral
    return np.array([vector[0], vector[2]]) / vector[1]


@every_sensor
@pytest.mark.parametrize("light", ["A", "D50", "D65"])
def test_white_is_seen_and_green_sees_most_of_it(name, light):
    # Silicon behind organic filters: red and blue of daylight are within a factor of
    # five below green, and red exceeds it only under tungsten light.
    red, blue = neutral(name, light)
    assert 0.2 < blue < 1.0
    assert 0.3 < red < (1.4 if light == "A" else 1.15)


@every_sensor
def test_warmer_light_is_redder(name):
    (red_a, blue_a), (red_d, blue_d) = neutral(name, "A"), neutral(name, "D65")
    assert red_a > red_d and blue_a < blue_d


def nearest_on_locus(name, mean):
    """Return how far (log) a neutral is from the sensor's black bodies, and which."""
    kelvins = range(2200, 9001, 50)
    locus = np.array([neutral(name, f"{kelvin}K") for kelvin in kelvins])
    distances = np.abs(np.log(locus / mean)).max(axis=1)
    return distances.min(), kelvins[distances.argmin()]


@pytest.mark.parametrize("name", SAMPLED)
def test_the_neutrals_lie_along_its_own_planckian_locus(name):
    # Matrices and neutrals are of independent origin, and real lights within 0.09 of
    # black bodies on average; white balance gains in their place are 1.1 off.
    mean = np.array(FIELDS[name]["illuminants"]["mean"])
    assert nearest_on_locus(name, mean)[0] < 0.1
    assert nearest_on_locus(name, 1 / mean)[0] > 1.0


@pytest.mark.parametrize("name", [name for name in PAPER if name != "samsung-s20fe"])
def test_nine_cameras_saw_the_same_lights(name):
    # They took the same scenes side by side: their means are of one temperature. Red
    # and blue exchanged would be below 3850 K or above 4950 K.
    mean = np.array(FIELDS[name]["illuminants"]["mean"])
    assert 4000 < nearest_on_locus(name, mean)[1] < 4800


@pytest.mark.parametrize("name", SAMPLED)
def test_the_mean_neutral_is_inside_the_hull(name):
    lights = FIELDS[name]["illuminants"]
    hull = np.array(lights["hull"])
    edges = np.roll(hull, -1, axis=0) - hull
    spokes = np.array(lights["mean"]) - hull
    assert np.all(edges[:, 0] * spokes[:, 1] - edges[:, 1] * spokes[:, 0] > 0)


@every_sensor
def test_sample_draws_a_light_or_says_why_not(name):
    sensor = cg2raw.Sensor(name)
    drawn = [sensor.illuminant(f"sample:{i}").neutral for i in range(20)]
    assert np.ptp(np.array(drawn)[:, 0]) > 0.05
    if name not in SAMPLED:
        assert "Planckian locus" in FIELDS[name]["sources"]["illuminants"]


def electrons(name):
    """Return [(ISO, full well, read noise)] in electrons, by photon transfer.

    With x in 0..1 above black the variance is beta1 x + beta2, so that saturation
    is 1 / beta1 electrons and read noise sqrt(beta2) / beta1."""
    return [
        (row["iso"], 1 / np.mean(row["beta1"]), math.sqrt(np.mean(row["beta2"])) / b)
        for row in FIELDS[name]["noise"]
        for b in [np.mean(row["beta1"])]
    ]


# Electrons at saturation, ISO 100. Small pixels (1.4 to 1.8 um): thousands. APS-C and
# full frame: 25000 to 80000 (4.1 to 6.5 um), the A7S II with 8.4 um more than 100000.
FULL_WELL = {
    "gopro-hero6-black": (4e3, 1e4),
    "samsung-s20fe": (4e3, 1e4),
    "canon-700d": (2e4, 4e4),
    "canon-70d": (2e4, 4e4),
    "nikon-d850": (3e4, 6e4),
    "canon-5d-mark-iv": (5e4, 9e4),
    "sony-a7s-ii": (1e5, 2e5),
}


@noisy_sensor
def test_the_full_well_is_that_of_its_pixel(name):
    iso, full_well, _ = electrons(name)[0]
    low, high = FULL_WELL[name]
    assert iso == 100 and low < full_well < high


@noisy_sensor
def test_read_noise_is_a_cameras(name):
    # CMOS reads at 0.8 electrons at best; 12 is a DSLR at base ISO with a slow ADC.
    noise = [read for _, _, read in electrons(name)]
    assert all(0.8 < read < 12.0 for read in noise)


@noisy_sensor
def test_noise_rises_with_iso(name):
    rows = FIELDS[name]["noise"]
    for lower, higher in zip(rows, rows[1:], strict=False):
        assert lower["iso"] < higher["iso"]
        assert np.all(np.array(lower["beta1"]) < np.array(higher["beta1"]))
        # Over sites: at low ISO, quantisation hides the read noise of single ones.
        assert np.mean(lower["beta2"]) < np.mean(higher["beta2"])
        # Shot noise in DN goes with the system gain, that with ISO.
        gain = np.array(higher["beta1"]) / np.array(lower["beta1"])
        assert gain == pytest.approx(higher["iso"] / lower["iso"], rel=0.08)


def test_two_fits_of_one_read_noise_agree(camera_data, monkeypatch):
    """The meaning given to the fields of Wei et al. makes their two fits one."""
    monkeypatch.syspath_prepend(str(SCRIPTS))
    from shelf import noise

    path = camera_data / "tables" / "noise" / "eld_camera_params.json"
    for name, camera in json.loads(path.read_text()).items():
        assert camera["Kmax"] / camera["Kmin"] == pytest.approx(64, rel=1e-9)
        profiles = [key for key in camera if key.startswith("Profile-")]
        apart = [
            min(noise.eld_disagreement(camera, key, stop) for key in profiles)
            for stop in range(7)
        ]
        assert np.mean(apart) < 0.13 and max(apart) < 0.26, name


@pytest.mark.parametrize("name", [n for n in NOISY if "row_sigma" in str(FIELDS[n])])
def test_a_dark_frame_has_the_noise_of_pixels_and_of_rows(name):
    sensor = cg2raw.Sensor(name)
    row = FIELDS[name]["noise"][-1]
    span = sensor.white_level - sensor.black_level[0]
    dark = np.zeros((400, 600, 3), np.float32)
    drawn = sensor.simulate(dark, illuminant="D50", iso=row["iso"], noise="physical")
    x = (np.asarray(drawn, float) - sensor.black_level[0]) / span
    # Three deviations of 240000 heavy-tailed draws, and of 400 rows seen through them.
    assert x.var() == pytest.approx(row["beta2"][0], rel=0.03)
    of_pixels = row["beta2"][0] - row["row_sigma"] ** 2
    of_rows = x.mean(axis=1).var() - of_pixels / x.shape[1]
    assert of_rows == pytest.approx(row["row_sigma"] ** 2, rel=0.25)


@pytest.mark.parametrize("colour", range(3), ids=("red", "green", "blue"))
@every_sensor
def test_a_reader_finds_each_colour_where_it_was_put(name, colour, tmp_path):
    sensor = cg2raw.Sensor(name)
    image = np.zeros((24, 36, 3), np.float32)
    image[..., colour] = 0.4
    raw = sensor.simulate(image, illuminant="D50", camera_input=True, highlights=False)
    path = tmp_path / "colour.dng"
    cg2raw.write_dng(path, raw)
    with rawpy.imread(str(path)) as read:
        seen = np.asarray(read.raw_image_visible, float)
        colours = np.where(read.raw_colors_visible == 3, 1, read.raw_colors_visible)
        levels = np.array(read.black_level_per_channel)
    assert np.array_equal(seen, raw)
    bright = seen > np.max(FIELDS[name]["black_level"]) + 10
    assert np.array_equal(bright, colours == colour)
    assert levels == pytest.approx(np.mean(FIELDS[name]["black_level"]), abs=1)
