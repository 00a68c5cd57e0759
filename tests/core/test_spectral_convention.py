# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Convention spectral: the light's spectrum, reflectances, and what a sensor sees."""

import json
import re
import runpy

import numpy as np
import pytest

import cg2raw
from cg2raw.profile.illuminant_spectra import illuminant_spectrum
from cg2raw.profile.spectral_file import WAVELENGTHS
from oracles import cameras, spectral

BUNDLED = "canon-1ds-mark-iii canon-600d nikon-d850 sony-a7s-ii".split()
LIGHTS = ("A", "D65", "FL2", "FL11", "LED-B3", "HP1")
GREYS = np.repeat(np.geomspace(1e-6, 1e4, 41)[:, None], 3, axis=1).astype(np.float32)


@pytest.fixture(scope="module", params=BUNDLED)
def sensor(request):
    return cg2raw.Sensor(request.param)


def sensitivities(sensor):
    return sensor.spectral_sensitivities["rgb"]


def terms(rgb):
    """The seven terms, in float64."""
    r, g, b = np.maximum(rgb, 0.0).T
    mean = (r + g + b) / 3
    even = r * g * b / np.maximum(mean, 1e-30) ** 3
    roots = [np.sqrt(r * g), np.sqrt(g * b), np.sqrt(r * b)]
    return np.column_stack([rgb, *roots, mean * even**8])


def held_out():
    sets = spectral.held_out()
    return np.concatenate([sets["CIE 224"], sets["PMC"]])


@pytest.mark.parametrize("light", LIGHTS)
def test_white_and_greys_are_the_lights_neutral(sensor, light):
    camera = sensor.to_camera(GREYS[None], illuminant=light, convention="spectral")[0]
    neutral = np.array(sensor.illuminant(light).neutral)
    expected = GREYS * (neutral / neutral.max())
    assert camera == pytest.approx(expected, rel=2e-6)


@pytest.mark.parametrize("light", LIGHTS)
def test_pixels_are_the_matrix_times_the_terms(sensor, light):
    rng = np.random.default_rng(3)
    rgb = rng.uniform(-0.2, 1.0, (500, 3)) * 2.0 ** rng.uniform(-9, 4, (500, 1))
    rgb = rgb.astype(np.float32).astype(np.float64)
    transform = sensor.transform(light, "spectral")
    assert transform.uplift.sum(axis=1) == pytest.approx(np.ones(3), abs=1e-12)
    expected = np.maximum(terms(rgb) @ transform.uplift.T, 0.0) * transform.gains
    camera = sensor.to_camera(
        rgb.astype(np.float32)[None], illuminant=light, convention="spectral"
    )[0]
    scale = np.abs(terms(rgb) @ np.abs(transform.uplift.T)).max(axis=1, keepdims=True)
    assert np.abs((camera - expected) / np.maximum(scale, 1.0)).max() < 4e-6


def error_over_best_matrix(sensor, light):
    """Mean angle of balanced camera RGB over that of the best 3x3 matrix.

    The matrix is made of these colours, the uplift of others."""
    response = illuminant_spectrum(light)[:, None] * sensitivities(sensor)
    truth = held_out() @ response / response.sum(axis=0)
    rgb = spectral.rec709_under_d65(held_out())
    uplifted = terms(rgb) @ sensor.transform(light, "spectral").uplift.T
    best = rgb @ np.linalg.lstsq(rgb, truth, rcond=None)[0]
    uplift_error, best_error = (spectral.degrees(truth, c) for c in (uplifted, best))
    return uplift_error.mean() / best_error.mean()


@pytest.mark.parametrize("light", LIGHTS)
def test_held_out_reflectances_are_nearer_than_by_any_matrix(sensor, light):
    assert error_over_best_matrix(sensor, light) < 1.0


def test_on_average_its_error_is_below_nine_tenths_of_that():
    ratios = [
        error_over_best_matrix(cg2raw.Sensor(id), light)
        for id in BUNDLED
        for light in LIGHTS
    ]
    assert np.mean(ratios) < 0.87


def test_it_is_continuous_and_grows_with_exposure(sensor):
    def camera(rgb):
        rgb = np.asarray(rgb, np.float32)[None]
        return sensor.to_camera(rgb, illuminant="FL2", convention="spectral")[0]

    across = np.linspace(-0.05, 0.05, 20001)
    path = np.column_stack([across, np.full_like(across, 0.4), 0.1 - across])
    steps = np.abs(np.diff(camera(path), axis=0)).max()
    assert steps < 5e-3  # a root's slope is infinite at 0, its steps are not
    rng = np.random.default_rng(5)
    rgb = rng.uniform(-0.1, 1.0, (200, 3))
    levels = np.stack([camera(rgb * k) for k in (0.01, 0.5, 1.0, 2.0, 700.0)])
    assert (np.diff(levels, axis=0) >= 0.0).all()
    assert levels[4] == pytest.approx(levels[2] * 700.0, rel=1e-5, abs=1e-4)


def test_a_lamp_needs_no_matrix_where_there_are_sensitivities(sensor):
    for name in ("FL2", "LED-B3", "HP5", "lamp:fl11"):
        seen = illuminant_spectrum(name.replace("lamp:", "").upper())
        expected = seen @ sensitivities(sensor)
        found = sensor.illuminant(name).neutral
        assert found == pytest.approx(expected / expected[1], rel=6e-3)


SPECTRA = {
    "A": "A",
    "D50": "D50",
    "D75": "D75",
    "3200K": "3200K",
    "fl2": "FL2",
    "led_b3": "LED-B3",
    "lamp:HP1": "HP1",
}


@pytest.mark.parametrize(("word", "light"), SPECTRA.items(), ids=SPECTRA)
def test_spectra_are_those_of_the_cie(word, light):
    sensor = cg2raw.Sensor("canon-600d")
    found = sensor.spectrum(sensor.illuminant(word))
    assert found["wavelengths"].tolist() == WAVELENGTHS.tolist()
    power = illuminant_spectrum(light)
    shape = found["power"] / found["power"].max()
    assert shape == pytest.approx(power / power.max(), abs=2e-4)


def test_the_tables_are_what_the_script_makes(repository, tmp_path, monkeypatch):
    monkeypatch.setattr("sys.argv", ["spectra_tables.py", "--out", str(tmp_path)])
    runpy.run_path(repository / "scripts/spectra_tables.py", run_name="__main__")
    made = sorted(tmp_path.iterdir())
    assert [path.name for path in made] == [
        "illuminant_daylight_tables.h",
        "illuminant_lamp_tables.h",
        "transform_uplift_basis.h",
    ]
    for path in made:
        built = (repository / "plugins/core" / path.name).read_text()
        assert numbers(path.read_text()) == pytest.approx(
            numbers(built), rel=2e-5, abs=2e-6
        )


def numbers(text):
    """The numbers of a table; the last digit of a fit is one machine's."""
    body = text.partition("namespace cg2raw {")[2]
    return [float(word) for word in re.findall(r"(?<![\w.])-?[0-9]+\.[0-9e-]+", body)]


@pytest.mark.parametrize("lamp", ["FL2", "FL12", "LED-B1", "HP1"])
def test_a_neutral_is_that_of_the_nearest_light(sensor, lamp):
    red, _, blue = sensor.illuminant(lamp).neutral
    transform = sensor.transform(f"neutral:{red}:{blue}", "spectral")
    assert transform.spectrum == lamp


def test_a_neutral_between_lights_is_a_mixture():
    sensor = cg2raw.Sensor("canon-600d")
    spectra = [sensor.transform(f"sample:{n}", "spectral").spectrum for n in range(12)]
    assert any(" K" in name for name in spectra)
    assert any(name.startswith("half ") and ", half " in name for name in spectra)


def test_a_lamp_of_the_profile_has_its_own_power():
    line = [0.05 + 0.95 * (at == 545) for at in WAVELENGTHS]
    lamp = {
        "name": "line",
        "neutral": [0.5, 0.5],
        "color_matrix": [0.65, -0.16, 0.0, -0.36, 1.07, 0.34, -0.03, 0.09, 0.7],
        "power": {"wavelengths": WAVELENGTHS.tolist(), "values": line},
    }
    table = cg2raw.Sensor("canon-600d").spectral_sensitivities
    field = {
        "wavelengths": table["wavelengths"].tolist(),
        **{c: table["rgb"][:, i].tolist() for i, c in enumerate("RGB")},
    }
    text = cameras.profile_text(lamps=[lamp], spectral_sensitivities=field)
    sensor = cg2raw.Sensor.from_json(text)
    assert json.loads(sensor.to_json())["lamps"][0]["power"]["values"] == line
    transform = sensor.transform("lamp:line", "spectral")
    assert transform.spectrum == "line"
    flat = sensor.transform("neutral:0.5:0.5", "spectral")
    assert not np.allclose(flat.uplift, transform.uplift, atol=1e-2)


def lamp_with(**power):
    lamp = {
        "name": "x",
        "neutral": [0.5, 0.5],
        "color_matrix": [0.65, -0.16, 0.0, -0.36, 1.07, 0.34, -0.03, 0.09, 0.7],
        "power": {"wavelengths": [400, 500, 600], "values": [1, 1, 1], **power},
    }
    return cg2raw.Sensor.from_json(cameras.profile_text(lamps=[lamp]))


@pytest.mark.parametrize(
    ("power", "message"),
    [
        ({"values": [1, 1]}, "has 2 values; it needs one per wavelength, 3"),
        ({"wavelengths": [400, 600, 500]}, "power of x: .* they must rise"),
        ({"values": [1, -1, 1]}, "power of x: -1 must be 0 to"),
        ({"values": [0, 0, 0]}, "power of x is nowhere above 0"),
        ({"wavelengths": [], "values": []}, "power of x is nowhere above 0"),
    ],
)
def test_a_power_that_is_no_light_is_refused(power, message):
    with pytest.raises(ValueError, match=message):
        lamp_with(**power)


def test_what_cannot_be_is_said():
    asked = {"illuminant": "D65", "convention": "spectral"}
    image = np.ones((2, 2, 3), np.float32)
    with pytest.raises(
        ValueError, match="nikon-d40 has no spectral_sensitivities: use"
    ):
        cg2raw.Sensor("nikon-d40").simulate(image, **asked)
    mono = cg2raw.Sensor.from_json(cameras.mono_text())
    with pytest.raises(ValueError, match="sensor .* has no spectral_sensitivities"):
        mono.simulate(image, convention="spectral")
    with pytest.raises(ValueError, match="has no inverse: many spectra are one colour"):
        cg2raw.Sensor("canon-600d").to_scene(image, **asked)
