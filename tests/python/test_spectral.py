# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Profiles of spectral sensitivities: laws of colorimetry, tables, bad files."""

import json

import numpy as np
import pytest

import cg2raw
from cg2raw.profile import matrix_fit
from cg2raw.profile.illuminant_spectra import REAL_LIGHTS, illuminant_spectrum
from cg2raw.profile.spectral import color_matrices, neutral_under, profile_from_ssf
from cg2raw.profile.spectral_file import WAVELENGTHS, Sensitivities
from oracles import adobe, spectral
from python.spectra import SENSOR, camera_json, three_lobes
from tiers import first_fast

# Camera from XYZ of cameras that see as the CIE 1931 observer does: their sensitivities
# are linear combinations of its.
LUTHER = {
    "like an eye": [[0.4, 0.71, -0.08], [-0.23, 1.17, 0.05], [0.0, 0.0, 0.92]],
    "like sRGB": [[3.24, -1.54, -0.5], [-0.97, 1.88, 0.04], [0.06, -0.2, 1.06]],
    "broad": [[0.7, 0.3, 0.1], [0.1, 0.8, 0.2], [0.05, 0.1, 0.6]],
}


def luther(name):
    rgb = spectral.observer() @ np.transpose(LUTHER[name])
    return Sensitivities(file="luther.json", rgb=rgb)


@pytest.mark.parametrize(
    ("light", "xy"),
    [
        ("A", (0.44758, 0.40745)),
        ("D65", (0.31272, 0.32903)),
        ("FL2", (0.3721, 0.3751)),
        ("FL7", (0.3129, 0.3292)),
        ("FL11", (0.3805, 0.3769)),
        ("D5000K", (0.3457, 0.3585)),
    ],
)
def test_lights_have_their_published_chromaticity(light, xy):
    """CIE 015:2018, tables 3 and 10.1; they have 4 decimals, and other steps."""
    found = adobe.chromaticity(matrix_fit.xyz_under(illuminant_spectrum(light)))
    assert found == pytest.approx(xy, abs=1.2e-4)


def test_a_black_body_has_the_chromaticity_that_the_core_gives_it():
    found = adobe.chromaticity(matrix_fit.xyz_under(illuminant_spectrum("3200K")))
    assert found == pytest.approx(cg2raw.planckian_xy(3200.0), abs=5e-4)


@pytest.mark.parametrize("name", LUTHER)
@pytest.mark.parametrize("light", first_fast(["HP1", "FL11", "A", "D65"], 1))
def test_a_camera_that_sees_like_the_observer_is_fitted_exactly(name, light):
    camera, power = luther(name), illuminant_spectrum(light)
    fitted = matrix_fit.fit_xyz_d50_from_camera(camera.rgb, power)
    for objects in spectral.held_out().values():
        seen = matrix_fit.balanced_camera(camera.rgb, power, objects) @ fitted.T
        truth = spectral.truth_d50(power, objects)
        assert spectral.difference(seen, truth).max() < 1e-6
    matrix = matrix_fit.color_matrix(fitted, camera.rgb, power)
    expected = np.array(LUTHER[name])
    expected = expected / np.max(expected @ adobe.xyz(adobe.D50))
    assert matrix == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("light", REAL_LIGHTS)
def test_the_neutral_of_such_a_camera_is_its_matrix_times_white(light):
    white = spectral.xyz(illuminant_spectrum(light))
    expected = LUTHER["like an eye"] @ white
    found = neutral_under(luther("like an eye"), light)
    assert found == pytest.approx(expected / expected[1], rel=1e-12)


def test_no_white_preserving_matrix_near_the_fitted_one_is_better():
    camera, power = three_lobes(), illuminant_spectrum("A")
    objects = matrix_fit.training_reflectances()
    seen = matrix_fit.balanced_camera(camera.rgb, power, objects)
    truth = spectral.truth_d50(power, objects)
    fitted = matrix_fit.fit_xyz_d50_from_camera(camera.rgb, power)
    assert fitted.sum(axis=1) == pytest.approx(adobe.xyz(adobe.D50), abs=1e-12)
    least = spectral.difference(seen @ fitted.T, truth).mean()
    random = np.random.default_rng(1)
    for _ in range(200):
        step = random.normal(size=(3, 3))
        step -= step.mean(axis=1, keepdims=True)
        other = fitted + 0.01 * step / np.linalg.norm(step)
        assert spectral.difference(seen @ other.T, truth).mean() > least - 1e-4


def test_the_scale_of_sensitivities_changes_nothing(written):
    rgb = three_lobes().rgb
    paths = [written(camera_json(rgb * k), f"at-{k}.json") for k in (1.0, 40.0)]
    first, *others = [profile_from_ssf(p, **SENSOR, lights=["FL2"]) for p in paths]
    step = pytest.approx(1e-4, rel=1e-6)
    for other in others:
        assert other["illuminants"] == first["illuminants"]
        for field in ("color_matrix_1", "color_matrix_2"):
            apart = np.max(np.abs(np.subtract(other[field], first[field])))
            assert apart == 0.0 or apart == step  # a decimal may round otherwise


def test_the_profile_is_legal_and_tells_its_sources(written):
    document = camera_json(three_lobes().rgb, license="Apache-2.0")
    profile = profile_from_ssf(written(document), **SENSOR, lights=["A", "FL2"])
    assert profile["id"] == "acme-lobes-3"
    assert profile["black_level"] == [1024] * 4
    assert set(profile) - set(profile["sources"]) == {
        "schema",
        "id",
        "unique_camera_model",
        "sources",
    }
    assert "camera.json (Apache-2.0)" in profile["sources"]["color_matrix_1"]
    assert "A, FL2" in profile["sources"]["illuminants"]
    sensor = cg2raw.Sensor.from_json(json.dumps(profile))
    neutrals = [neutral_under(three_lobes(), light) for light in ("A", "FL2")]
    assert sensor.neutrals == pytest.approx(
        [pytest.approx([n[0], n[2]], abs=1e-6) for n in neutrals]
    )


def test_numbers_have_the_steps_that_a_dng_keeps():
    """ColorMatrix 1e-4, AsShotNeutral 1e-6; measured curves no more than that."""
    profile = profile_from_ssf(three_lobes(), **SENSOR, lights=["A", "FL2"])
    curves = profile["spectral_sensitivities"]
    for values, decimals in (
        ([profile["color_matrix_1"], profile["color_matrix_2"]], 4),
        (profile["illuminants"]["neutrals"], 6),
        ([curves[name] for name in "RGB"], 6),
    ):
        np.testing.assert_array_equal(values, np.round(values, decimals))
        assert not np.array_equal(values, np.round(values, decimals - 1))


def test_an_id_is_made_of_the_cameras_name_and_cut():
    for model, id in (
        ("Lobes 3.1 (beta)", "acme-lobes-3.1-beta"),
        ("y" * 200, "acme-" + 95 * "y"),
        (94 * "y" + " and more", "acme-" + 94 * "y"),  # not with a - at its end
    ):
        mono = SENSOR | {"cfa": "mono"}  # which has no matrices to be fitted
        assert profile_from_ssf(three_lobes(), **mono, model=model)["id"] == id


def test_its_matrices_give_the_neutrals_that_the_sensitivities_give():
    """Within the matrices' four decimals, and A's 2856 K beside a DNG's 2850 K."""
    profile = profile_from_ssf(three_lobes(), **SENSOR)
    sensor = cg2raw.Sensor.from_json(json.dumps(profile))
    for light in ("A", "D65"):
        seen = neutral_under(three_lobes(), light)
        assert sensor.illuminant(light).neutral == pytest.approx(seen, abs=5e-4)


def test_what_is_missing_is_listed_at_once(written):
    path = written(camera_json(three_lobes().rgb))
    with pytest.raises(ValueError, match="do not tell cfa, height, white_level; give"):
        profile_from_ssf(path, width=10, bits=14, black_level=0)


def test_levels_are_checked_by_the_core():
    with pytest.raises(ValueError, match="lobes.json: white_level 15000 DN must be"):
        profile_from_ssf(three_lobes(), **{**SENSOR, "bits": 12}, lights=["A"])


def test_a_narrow_line_between_steps_is_seen_where_it_is(written):
    wavelengths = np.arange(380, 781)
    lines = [f"{w},{1.0 if w == 547 else 0.0}" for w in wavelengths]
    found = neutral_under(three_lobes(), written("\n".join(lines), "line.csv"))
    at_547 = [np.interp(547.0, WAVELENGTHS, c) for c in three_lobes().rgb.T]
    assert found == pytest.approx(np.array(at_547) / at_547[1], rel=1e-12)


@pytest.mark.parametrize("step", [0.5, 1, 2, 5, 10])
def test_a_light_of_any_step_is_the_same(written, step):
    """A straight line stays one; beyond the table its end values hold."""
    nm = np.arange(400, 701, step)
    lines = [f"{w},{1 + 0.01 * (w - 400)}" for w in nm]
    found = illuminant_spectrum(written("\n".join(lines), "line.csv"))
    inside = (WAVELENGTHS > 400) & (WAVELENGTHS < 700)
    assert found[inside] == pytest.approx(1 + 0.01 * (WAVELENGTHS[inside] - 400))
    near = 0.01 * 5  # of averages at the ends, half of which are beyond the table
    assert found[WAVELENGTHS <= 400] == pytest.approx(1, abs=near)
    assert found[WAVELENGTHS >= 700] == pytest.approx(4, abs=near)


@pytest.mark.parametrize("kelvin", [1000, 3200, 25000])
def test_a_black_body_has_plancks_law(kelvin):
    found = illuminant_spectrum(f"{kelvin}K")
    metres = WAVELENGTHS * 1e-9  # second radiation constant: CIE 015:2018
    law = metres**-5 / np.expm1(1.4388e-2 / (metres * kelvin))
    assert found / found[30] == pytest.approx(law / law[30], rel=1e-5)


@pytest.mark.parametrize("word", ["D4000K", "D25000K", "d5500k"])
def test_daylight_has_the_chromaticity_of_its_temperature(word):
    xy = adobe.chromaticity(matrix_fit.xyz_under(illuminant_spectrum(word)))
    kelvin = float(word[1:-1])
    # CIE 015:2018, equations 4.9 and 4.10.
    if kelvin <= 7000:
        x = -4.6070e9 / kelvin**3 + 2.9678e6 / kelvin**2 + 99.11 / kelvin + 0.244063
    else:
        x = -2.0064e9 / kelvin**3 + 1.9018e6 / kelvin**2 + 247.48 / kelvin + 0.237040
    assert xy == pytest.approx((x, -3 * x**2 + 2.87 * x - 0.275), abs=3e-4)


@pytest.mark.parametrize(
    ("light", "message"),
    [
        ("Z9", "light 'Z9' is unknown; it may be a name"),
        ("999.9K", "must be 1000 to 25000 K"),
        ("25000.1K", "must be 1000 to 25000 K"),
        ("D3999K", "must be 4000 to 25000 K"),
        ("ISO 7589 Sensitometric Printer", "350 to 560 nm must cover"),
        ("./none.csv", "none.csv: No such file"),
    ],
)
def test_an_unknown_light_is_refused(light, message):
    with pytest.raises(ValueError, match=message):
        neutral_under(three_lobes(), light)


def test_each_channel_must_see_the_light():
    blind = Sensitivities("blind.json", three_lobes().rgb * [1, 1, 0])
    with pytest.raises(ValueError, match=r"blind.json: under light 'A' grey is .* 0.0"):
        neutral_under(blind, "A")


def test_neutrals_need_a_light():
    with pytest.raises(ValueError, match="lobes.json: lights is empty; name at least"):
        profile_from_ssf(three_lobes(), **SENSOR, lights=[])


def test_channels_that_see_the_same_have_no_matrix():
    rgb = three_lobes().rgb
    same = Sensitivities("grey.json", np.column_stack([rgb[:, 1]] * 3))
    with pytest.raises(ValueError, match="grey.json: A: no colour matrix fits"):
        color_matrices(same)


@pytest.mark.parametrize("light", first_fast(["FL2", "FL4", "LED-B4", "HP1"], 1))
def test_a_lamps_matrix_is_nearly_the_best_there_is(light):
    """Mean angle of camera RGB, over reflectances that no fit has seen."""
    measured = three_lobes()
    given = {**SENSOR, "make": "Acme", "model": "One", "lights": ["A"]}
    profile = profile_from_ssf(measured, **given, lamps=[light])
    with_lamp = cg2raw.Sensor.from_json(json.dumps(profile))
    del profile["lamps"], profile["sources"]["lamps"]
    without = cg2raw.Sensor.from_json(json.dumps(profile))
    sets = spectral.held_out()
    reflectances = np.concatenate([sets["CIE 224"], sets["PMC"]])
    rgb = spectral.rec709_under_d65(reflectances)
    response = illuminant_spectrum(light)[:, None] * measured.rgb
    truth = reflectances @ response
    red, _, blue = with_lamp.illuminant(light).neutral

    def degrees(sensor, word):
        asked = {"illuminant": word, "convention": "sensor", "highlights": False}
        camera = sensor.to_camera(rgb.astype(np.float32)[None], **asked)[0]
        return spectral.degrees(truth, camera.astype(float)).mean()

    best = rgb @ np.linalg.lstsq(rgb, truth, rcond=None)[0]
    least = spectral.degrees(truth, best).mean()
    assert degrees(with_lamp, light) < 1.4 * least
    assert degrees(without, f"neutral:{red}:{blue}") > 1.8 * least
