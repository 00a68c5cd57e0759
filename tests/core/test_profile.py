# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""profile.h: the schema and its errors, the bundled sensors, noise between ISOs."""

import json

import numpy as np
import pytest

import cg2raw
from oracles import cameras


def load(**fields):
    return cg2raw.Sensor.from_json(cameras.profile_text(**fields), name="inline.json")


def test_a_legal_profile_is_read():
    sensor = load(cfa="GBRG", black_level=[60, 61.5, 62, 63])
    assert (sensor.id, sensor.make, sensor.model) == (
        "test-sensor",
        "cg2raw",
        "Test Sensor",
    )
    assert (sensor.cfa, sensor.width, sensor.height) == ("GBRG", 64, 48)
    assert (sensor.bits, sensor.white_level) == (14, 16383)
    assert list(sensor.black_level) == [60.0, 61.5, 62.0, 63.0]


REQUIRED = (
    "schema id make model unique_camera_model sources cfa width height bits "
    "black_level white_level calibration_illuminant_1 color_matrix_1"
).split()


@pytest.mark.parametrize("field", REQUIRED)
def test_no_field_has_a_silent_default(field):
    with pytest.raises(ValueError, match=rf"^inline.json: {field}\b.*missing"):
        load(**{field: None})


M = [0.7, -0.2, -0.1, -0.8, 1.5, 0.3, -0.1, 0.1, 0.8]
NOISE = {"iso": 100, "beta1": [1e-4] * 4, "beta2": [1e-6] * 4}
SHAPED = {**NOISE, "tukey_lambda": -0.1, "row_sigma": 5e-4}
# Field, what is wrong with it, what the message must say beside file and field.
WRONG = [
    ("schema", 2, "1"),
    ("schema", "1", "whole number"),
    ("id", "", "text"),
    ("id", "Nikon D40", "lower"),
    ("id", 5, "text"),
    ("id", "..", "begin with a letter or digit"),
    ("id", ".", "begin with a letter or digit"),
    ("id", "-x", "begin with a letter or digit"),
    ("id", "a/b", "lower-case"),
    ("id", "a" * 300, r"^.{0,330}100 characters, not 300$"),
    ("id", "A" * 300, r"^.{0,330}100 characters$"),
    ("make", "", "text"),
    ("sources", [], "object"),
    ("sources", {"noise": 3}, "text"),
    ("cfa", "RGBG", "RGGB.*16 or 36 letters"),
    ("cfa", "", "text"),
    ("cfa", "RRRR", "RGGB, GRBG, GBRG or BGGR"),
    ("cfa", "X-Trans", "36 letters.*phase differs"),
    ("cfa", "XTRANS", "36 letters.*phase differs"),
    ("cfa", cameras.X_TRANS[:35], "36 letters"),
    ("cfa", cameras.X_TRANS + "G", "36 letters"),
    ("cfa", cameras.X_TRANS.replace("B", "W"), "36 letters"),
    ("cfa", cameras.X_TRANS.replace("B", "G"), "each at least once"),
    ("cfa", "RGGBRGGBR", "16 or 36 letters"),
    ("width", 0, "1|2"),
    ("height", -4, "1|2"),
    ("width", 70000, "65535"),
    ("width", 64.5, "whole number"),
    ("width", 1e300, "whole number|65535"),
    ("bits", 7, "8 to 16"),
    ("bits", 17, "8 to 16"),
    ("bits", "14", "whole number"),
    ("black_level", "512", "number or a list of numbers"),
    ("black_level", [], "1 number .*3 .*4 .*not 0"),
    ("black_level", [512] * 2, "1 number .*3 .*4 .*not 2"),
    ("black_level", [512] * 5, "1 number .*3 .*4 .*not 5"),
    ("black_level", [512] * 36, "1 number .*3 .*4 .*not 36"),
    ("black_level", [512, 512, 512, -1], "0.*white_level"),
    ("black_level", [512, 512, 512, 16383], "white_level 16383"),
    ("black_level", [512, 512, 512, "512"], "number"),
    ("white_level", 0, "1 to 65535"),
    ("white_level", 16384, "1 to 16383"),
    ("white_level", 1e4 + 0.5, "whole number"),
    ("base_iso", 0, "base_iso 0 must be at least 1"),
    ("base_iso", "100", "number"),
    ("calibration_illuminant_1", "E", "A.*D65"),
    ("calibration_illuminant_2", "A", "differ"),
    ("calibration_illuminant_2", None, "missing"),
    ("color_matrix_1", M[:8], "9"),
    ("color_matrix_1", [0.0] * 9, "singular"),
    ("color_matrix_1", [1, 2, 3] * 3, "singular"),
    ("color_matrix_1", [-v for v in M], "white"),
    ("color_matrix_2", None, "_2.*matrix"),
    ("color_matrix_2", [M[:3], M[3:6], M[6:]], "9|number"),
    ("forward_matrix_1", [0.0] * 9, "singular|white|sum"),
    ("forward_matrix_1", [1, 2, 3] * 3, "singular"),
    ("forward_matrix_1", M[:4], "9"),
    ("forward_matrix_1", [1, 0, 0, 0, 1, 0, 0, 0, 1], "D50, 0.9643 1 0.8251"),
    ("forward_matrix_1", [0.9771, 0, 0, 0, 1, 0, 0, 0, 0.825], "within 0.01272"),
    ("illuminants", {}, "mean|neutrals"),
    ("illuminants", {"neutrals": [[0.5]]}, "2|R/G"),
    ("illuminants", {"neutrals": [[0.5, 0.0]]}, "0.01"),
    ("illuminants", {"neutrals": [[0.5, 101]]}, "100"),
    ("illuminants", {"neutrals": [], "seed": 1}, "unknown.*neutrals"),
    ("illuminants", {"mean": [0.5, 0.5], "hull": []}, "covariance"),
    ("digital_gain", {"mean": 0.8}, "sigma"),
    ("digital_gain", {"mean": -0.8, "sigma": 0.1}, "mean"),
    ("digital_gain", {"mean": 0.8, "sigma": -0.1}, "sigma"),
    ("digital_gain", 0.8, "object"),
    ("noise", {}, "list"),
    ("noise", [{**NOISE, "beta1": [1e-4] * 2}], "beta1.*1 number .*3 .*4 .*not 2"),
    ("noise", [{**NOISE, "beta2": [1e-6] * 36}], "beta2.*3 .*4 .*not 36"),
    ("noise", [{**NOISE, "beta1": [1e-4, 1e-4, 1e-4, -1e-4]}], "0"),
    ("noise", [{**NOISE, "iso": 0}], "iso"),
    ("noise", [{**NOISE, "gain": 1}], "unknown.*beta1"),
    ("noise", [{"iso": 100, "beta1": [1e-4] * 4}], "beta2"),
    ("noise", [NOISE, NOISE], "rise"),
    ("noise", [{**NOISE, "row_sigma": 1e-4}], "tukey_lambda.*missing"),
    ("noise", [{**NOISE, "tukey_lambda": 0.1}], "row_sigma.*missing"),
    ("noise", [{**SHAPED, "tukey_lambda": -0.5}], "tukey_lambda -0.5.*-0.4 to 0.5"),
    ("noise", [{**SHAPED, "tukey_lambda": 0.6}], "tukey_lambda 0.6.*-0.4 to 0.5"),
    ("noise", [{**SHAPED, "tukey_lambda": "x"}], "tukey_lambda.*number"),
    ("noise", [{**SHAPED, "row_sigma": 0.0011}], "row_sigma 0.0011.*0 to 0.001,"),
    ("noise", [{**SHAPED, "row_sigma": -1e-4}], "row_sigma -1e-04.*0 to 0.001,"),
    ("noise", [SHAPED, {**NOISE, "iso": 200}], "iso 200.*tukey_lambda.*missing"),
    ("noise", [NOISE, {**SHAPED, "iso": 200}], "iso 200.*tukey_lambda.*given.*none"),
    ("effects", {}, "list"),
    ("effects", [{}], "name"),
]


@pytest.mark.parametrize(("field", "value", "says"), WRONG)
def test_a_wrong_field_is_named_with_what_is_allowed(field, value, says):
    with pytest.raises(ValueError, match=says) as error:
        load(**{field: value})
    message = str(error.value)
    assert message.startswith("inline.json: ") and "\n" not in message
    if value is not None:
        assert field.removesuffix("_1").removesuffix("_2") in message


@pytest.mark.parametrize("count", [0, 2, 4, 35, 37])
def test_a_wrong_count_for_x_trans_is_named_with_those_allowed(count):
    says = rf"^inline.json: black_level .*1 number .*3 .*36 .*not {count}"
    with pytest.raises(ValueError, match=says):
        load(cfa=cameras.X_TRANS, black_level=[512] * count)


@pytest.mark.parametrize("cfa", ["RGGB", "bggr", cameras.QUAD, cameras.X_TRANS.lower()])
def test_a_cfa_is_spelt_in_either_case(cfa):
    sensor = load(cfa=cfa)
    assert sensor.cfa == cfa.upper()
    assert json.loads(sensor.to_json())["cfa"] == cfa.upper()


SITES = list(range(100, 136))
BY_COLOR = [{"R": 60, "G": 61.5, "B": 62}[color] for color in cameras.X_TRANS]


@pytest.mark.parametrize(
    ("cfa", "said", "sites", "written"),
    [
        ("GRBG", 60, [60] * 4, [60] * 4),
        ("GRBG", [60], [60] * 4, [60] * 4),
        ("GRBG", [60, 61, 62], [61, 60, 62, 61], [61, 60, 62, 61]),
        ("GRBG", [60, 61, 62, 63], [60, 61, 62, 63], [60, 61, 62, 63]),
        (cameras.QUAD, [60] * 16, [60] * 16, 60),
        (cameras.X_TRANS, 60, [60] * 36, 60),
        (cameras.X_TRANS, [60.25], [60.25] * 36, 60.25),
        (cameras.X_TRANS, [60, 60, 60], [60] * 36, 60),
        (cameras.X_TRANS, [60, 61.5, 62], BY_COLOR, [60, 61.5, 62]),
        (cameras.X_TRANS, BY_COLOR, BY_COLOR, [60, 61.5, 62]),
        (cameras.X_TRANS, SITES, SITES, SITES),
    ],
)
def test_numbers_per_site_are_said_once_per_colour_or_per_site(
    cfa, said, sites, written
):
    beta1, beta2 = (np.multiply(said, scale).tolist() for scale in (1e-5, 1e-8))
    noise = [{"iso": 100, "beta1": beta1, "beta2": beta2}]
    sensor = load(cfa=cfa, black_level=said, noise=noise)
    assert list(sensor.black_level) == sites
    assert sensor.noise_at(100)["beta1"] == pytest.approx(np.multiply(sites, 1e-5))
    assert sensor.noise_at(100)["beta2"] == pytest.approx(np.multiply(sites, 1e-8))
    again = json.loads(sensor.to_json())
    assert again["black_level"] == written
    row = again["noise"][0]
    assert np.shape(row["beta1"]) == np.shape(row["beta2"]) == np.shape(written)
    assert cg2raw.Sensor.from_json(sensor.to_json()).to_json() == sensor.to_json()


OF_BAYER_SITES = (
    "shot_noise", "poisson_shot_noise", "read_noise", "heavy_tailed_noise",
    "gr_gb_imbalance", "black_level", "noise_reduction",
)  # fmt: skip


@pytest.mark.parametrize("name", OF_BAYER_SITES)
@pytest.mark.parametrize("cfa", [cameras.QUAD, cameras.X_TRANS])
def test_an_effect_of_the_four_bayer_sites_is_refused_on_other_cfas(cfa, name):
    known = next(effect for effect in cg2raw.effects() if effect["name"] == name)
    parameters = {p["name"]: 1e-4 for p in known["parameters"]}
    sensor = load(cfa=cfa, effects=[{"name": name, "parameters": parameters}])
    side = 6 if cfa == cameras.X_TRANS else 4
    says = rf"test-sensor: effect {name}: .* 2 x 2.*{side} x {side}: leave the effect"
    with pytest.raises(ValueError, match=says):
        sensor.simulate(np.zeros((8, 8, 3), np.float32), illuminant="A")


@pytest.mark.parametrize(
    ("effect", "says"),
    [
        ({"name": "no_such_effect", "parameters": {}}, "no_such_effect.*lens_shading"),
        ({"name": "lens_shading", "parameters": {}}, "r2.*missing"),
        ({"name": "lens_shading", "parameters": {"r2": "x"}}, "r2.*number"),
        ({"name": "lens_shading", "kind": "x"}, "kind.*unknown"),
    ],
)
def test_a_wrong_effect_is_named_with_what_is_allowed(effect, says):
    rgb = np.zeros((2, 2, 3), np.float32)
    with pytest.raises(ValueError, match=says):
        load(effects=[effect]).simulate(rgb, illuminant="A")


def test_unknown_fields_are_errors():
    with pytest.raises(
        ValueError, match=r"inline.json: blacklevel .*unknown.*black_level"
    ):
        load(blacklevel=[512] * 4)


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "null", '{"schema": NaN}', "\x00", "1e999"]
)
def test_what_is_no_profile_is_an_error(text):
    with pytest.raises(ValueError, match=r"^inline.json: "):
        cg2raw.Sensor.from_json(text, name="inline.json")


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999"])
@pytest.mark.parametrize("field", ["color_matrix_1", "black_level", "white_level"])
def test_numbers_that_are_none_are_errors(field, number):
    text = cameras.profile_text(**{field: "HERE"})
    value = number if field == "white_level" else f"[{', '.join([number] * 9)}]"
    with pytest.raises(ValueError, match=r"^inline.json: "):
        cg2raw.Sensor.from_json(text.replace('"HERE"', value), name="inline.json")


def test_forward_matrices_may_be_rounded_to_128ths():
    """Three values are off by 1.5 / 128 together; a profile has no denominators."""
    diagonal = [0.9769, 0, 0, 0, 1, 0, 0, 0, 0.825]
    text = cameras.profile_text(forward_matrix_1=diagonal, forward_matrix_2=diagonal)
    found = cg2raw.Sensor.from_json(text, name="inline.json").calibrations
    assert found[0]["xyz_d50_from_camera"][0, 0] == 0.9769


FULL = {
    "cfa": "BGGR",
    "black_level": [500.25, 501, 502, 503],
    "base_iso": 64,
    "forward_matrix_1": [0.7, 0.2, 0.064, 0.28, 0.8, -0.08, 0.02, -0.1, 0.905],
    "forward_matrix_2": [0.72, 0.2, 0.044, 0.28, 0.8, -0.08, 0.02, -0.1, 0.905],
    "digital_gain": {"mean": 0.8, "sigma": 0.1},
    "effects": [
        {
            "name": "lens_shading",
            "parameters": {
                "r2": -0.3,
                "r4": 0.0,
                "r6": 0.0,
                "tilt_x": 0.0,
                "tilt_y": 0.0,
                "tilt_x_r2": 0.0,
                "tilt_y_r2": 0.0,
            },
            "evidence": {"frames": 3, "odds": 1e9},
        }
    ],
}


def test_a_profile_survives_a_round_trip_field_for_field():
    once = load(**FULL).to_json()
    assert json.loads(once) == cameras.profile(**FULL)
    assert cg2raw.Sensor.from_json(once).to_json() == once


def test_the_shape_of_noise_survives_a_round_trip():
    noise = [SHAPED, {**SHAPED, "iso": 200, "tukey_lambda": 0.25}]
    once = load(noise=noise).to_json()
    assert json.loads(once)["noise"] == noise


def test_a_distribution_survives_a_round_trip():
    stated = {
        "mean": [0.6, 0.5],
        "covariance": [[0.04, -0.02], [-0.02, 0.03]],
        "hull": [[0.4, 0.3], [0.9, 0.3], [0.6, 0.8]],
    }
    once = load(illuminants=stated).to_json()
    assert json.loads(once)["illuminants"] == stated


def test_bundled_profiles_are_installed_and_load():
    installed = cg2raw.installed_profiles()
    assert {"nikon-d40", "samsung-s20fe"} <= set(installed)
    assert installed == sorted(installed)
    for name in installed:
        assert cg2raw.Sensor(name).id == name


def test_an_unknown_sensor_lists_those_installed():
    with pytest.raises(ValueError, match="nikon-d41.*nikon-d40.*samsung-s20fe"):
        cg2raw.Sensor("nikon-d41")


def test_a_profile_is_found_by_path_and_by_search_path(tmp_path, monkeypatch):
    file = tmp_path / "mine.json"
    file.write_text(cameras.profile_text(id="mine"))
    assert cg2raw.Sensor(str(file)).id == "mine"
    monkeypatch.setenv("CG2RAW_PROFILE_PATH", str(tmp_path))
    assert cg2raw.Sensor("mine").id == "mine"
    assert {"mine", "nikon-d40"} <= set(cg2raw.installed_profiles())


@pytest.mark.parametrize("name", ["./missing.json", "/no/such/folder/x.json", "a/b"])
def test_a_missing_file_is_an_error_that_names_it(name):
    with pytest.raises(ValueError, match=name):
        cg2raw.Sensor(name)


def test_the_samsung_is_the_one_that_was_measured():
    sensor = cg2raw.Sensor("samsung-s20fe")
    assert (sensor.cfa, sensor.width, sensor.height) == ("GRBG", 4032, 3024)
    assert (sensor.bits, sensor.white_level) == (10, 1023)
    assert list(sensor.black_level) == [64.0] * 4
    # ISO 1600, top-left green: 2.24355796 DN^2 per DN, -134.138137 DN^2, DN with black.
    noise = sensor.noise_at(1600)
    for dn in (64.0, 300.0, 1023.0):
        x = (dn - 64.0) / 959.0
        variance = (noise["beta1"][0] * x + noise["beta2"][0]) * 959.0**2
        assert variance == pytest.approx(2.24355796 * dn - 134.138137, rel=1e-5)
