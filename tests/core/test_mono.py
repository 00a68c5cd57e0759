# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A sensor without filters, from its profile to its DN: luminance at every pixel."""

import json

import numpy as np
import pytest

import cg2raw
from cg2raw import _core
from cg2raw.profile.illuminant_spectra import illuminant_spectrum
from oracles import cameras, spectral

# Relative luminance of linear Rec.709. Source: ITU-R BT.709-6, item 3.2.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
FOUR_DIGITS = 1e-4  # as BT.709 prints them; the core derives them from primaries
NOISE = {"iso": 100, "beta1": 2e-4, "beta2": 4e-7}


def sensor_of(**fields):
    return cg2raw.Sensor.from_json(cameras.mono_text(**fields), "mono.json")


def scene_of(shape=(33, 45)):
    return np.random.default_rng(3).uniform(0, 0.9, (*shape, 3)).astype(np.float32)


def test_the_profile_has_one_site_and_no_colours():
    sensor = sensor_of(cfa="Mono", black_level=[500.5], noise=[NOISE])
    assert (sensor.cfa, sensor.black_level) == ("MONO", [500.5])
    assert (sensor.calibrations, sensor.neutrals) == ([], [])
    assert sensor.noise == [{"iso": 100, "beta1": [2e-4], "beta2": [4e-7]}]
    again = cg2raw.Sensor.from_json(sensor.to_json())
    assert again.to_json() == sensor.to_json()


MATRIX = [0.7, -0.2, -0.1, -0.8, 1.5, 0.3, -0.1, 0.1, 0.8]
WITHOUT_MEANING = {
    "color_matrix_1": MATRIX,
    "color_matrix_2": MATRIX,
    "forward_matrix_1": MATRIX,
    "calibration_illuminant_1": "D65",
    "illuminants": {"neutrals": [[0.5, 0.5]]},
    "lamps": [{"name": "FL2", "neutral": [0.5, 0.5], "color_matrix": MATRIX}],
}


@pytest.mark.parametrize("field", WITHOUT_MEANING)
def test_what_speaks_of_colours_is_refused(field):
    words = rf"^mono.json: {field} has no meaning with cfa mono.*leave it out$"
    with pytest.raises(ValueError, match=words):
        sensor_of(**{field: WITHOUT_MEANING[field]})


@pytest.mark.parametrize("field", ["black_level", "beta1", "beta2"])
@pytest.mark.parametrize("count", [0, 3, 4])
def test_one_site_has_one_number(field, count):
    values = [1e-3] * count
    given = {"black_level": values}
    if field != "black_level":
        given = {"noise": [{**NOISE, field: values}]}
    with pytest.raises(ValueError, match=rf"{field} must be 1 number.*not {count}$"):
        sensor_of(**given)


def test_the_signal_is_the_scene_s_luminance():
    sensor, scene = sensor_of(), scene_of()
    expected = scene @ LUMINANCE
    np.testing.assert_allclose(sensor.signal(scene), expected, atol=FOUR_DIGITS)
    camera = sensor.to_camera(scene)
    assert (camera == camera[..., :1]).all()
    grey = np.full((4, 5, 3), 0.25, np.float32)
    np.testing.assert_allclose(sensor.signal(grey), 0.25, rtol=1e-6)


def test_white_and_what_is_brighter_clips_at_white():
    sensor = sensor_of()
    bright = np.full((2, 3, 3), 1.7, np.float32)
    assert (sensor.simulate(bright) == sensor.white_level).all()
    light = sensor.signal(bright, convention="sensor")
    np.testing.assert_allclose(light, 1.7, rtol=1e-6)


@pytest.mark.parametrize("word", ["A", "D65", "3200K", "xy:0.3:0.35", "neutral:1:1"])
def test_named_lights_are_all_alike(word):
    sensor, scene = sensor_of(), scene_of()
    np.testing.assert_array_equal(
        sensor.simulate(scene, illuminant=word), sensor.simulate(scene)
    )
    assert sensor.illuminant(word).neutral == [1.0, 1.0, 1.0]


@pytest.mark.parametrize("word", ["sample:3", "neutral:0.5:0.6"])
def test_there_are_no_neutrals_to_name_or_to_draw(word):
    with pytest.raises(ValueError, match=r"monochrome and has no neutrals: name a"):
        sensor_of().simulate(scene_of(), illuminant=word)


def test_other_sensors_still_need_a_light():
    with pytest.raises(ValueError, match='illuminant "".*it may be: A, D50'):
        cg2raw.Sensor("nikon-d40").simulate(scene_of())


def test_the_paper_s_method_is_refused():
    with pytest.raises(ValueError, match=r"convention paper.*monochrome.*say dng"):
        sensor_of().simulate(scene_of(), convention="paper")


def test_dn_have_one_black_level():
    sensor = sensor_of(bits=12, black_level=100.25, white_level=4000)
    raw = np.asarray(sensor.simulate(scene_of()))
    expected = 100.25 + scene_of() @ LUMINANCE * (4000 - 100.25)
    assert np.abs(raw - expected).max() < 0.5 + 4000 * FOUR_DIGITS
    signal = sensor.signal_from_raw(raw)
    np.testing.assert_array_equal(sensor.raw_from_signal(signal), raw)


@pytest.mark.parametrize("noise", ["gaussian", "physical"])
def test_noise_is_drawn_as_it_is_predicted(noise):
    """150,000 pixels know a variance within 1.5 % (four standard errors)."""
    row = {**NOISE, "tukey_lambda": -0.05, "row_sigma": 0.0}
    sensor = sensor_of(bits=16, white_level=65535, noise=[row])
    grey = np.full((300, 500, 3), 0.4, np.float32)
    run = {"iso": 100, "noise": noise, "convention": "sensor"}
    mean, variance = sensor.predict(grey, **run)
    np.testing.assert_allclose(variance, 2e-4 * 0.4 + 4e-7, rtol=1e-5)
    drawn = sensor.signal(grey, seed=5, **run) - mean
    assert drawn.var() == pytest.approx(variance[0, 0], rel=0.015)
    neighbours = (drawn[:, 1:] * drawn[:, :-1]).mean() / drawn.var()
    assert abs(neighbours) < 4 / np.sqrt(drawn.size)


def test_an_offset_is_one_number():
    effect = {"name": "black_level", "parameters": {"offset_00": 0.01}}
    plain, offset = sensor_of(), sensor_of(effects=[effect])
    shift = offset.signal(scene_of((5, 7))) - plain.signal(scene_of((5, 7)))
    np.testing.assert_allclose(shift, 0.01, atol=1e-6)


def test_parameters_of_other_sites_are_unknown():
    four = {f"offset_{site}": 0.01 for site in ("00", "01", "10", "11")}
    sensor = sensor_of(effects=[{"name": "black_level", "parameters": four}])
    with pytest.raises(ValueError, match=r"offset_01 is unknown; known: offset_00$"):
        sensor.simulate(scene_of())


COLORED = {
    "white_balance",
    "color_matrix",
    "color_shading",
    "lateral_chromatic_aberration",
    "gr_gb_imbalance",
    "noise_reduction",
}


# Where a hundredth of the way is none in a scene so small, or no whole number.
VISIBLE = {
    "dust": {"density": 5000.0},
    "pdaf_pixels": {"pitch": 7, "row": 3, "column": 5},
}
# Nothing is near white; there is no read noise besides.
HIDDEN_HERE = ("full_well", "read_noise_correlation")


def parameters_of(effect):
    values = {
        p["name"]: p["null"] + 0.01 * (p["max"] - p["null"])
        for p in effect["parameters"]
    }
    return {**values, **VISIBLE.get(effect["name"], {})}


@pytest.mark.parametrize("effect", _core.effects(), ids=lambda effect: effect["name"])
def test_effects_act_unless_they_tell_colours_apart(effect):
    name = effect["name"]
    ours = {one["name"]: one for one in _core.effects("mono")}
    assert (name in ours) == (name not in COLORED)
    parameters = parameters_of(ours.get(name, effect))
    setting = {"name": name, "parameters": parameters}
    sensor = sensor_of(effects=[setting])
    run = {"exposure_time": 1.0, "convention": "sensor", "seed": 4}
    if name in COLORED:
        words = rf"effect {name}: tells the colours.*monochrome: leave the effect out$"
        with pytest.raises(ValueError, match=words):
            sensor.simulate(scene_of(), **run)
        return
    seen, plain = (s.signal(scene_of(), **run) for s in (sensor, sensor_of()))
    assert np.isfinite(seen).all()
    assert (seen != plain).any() or name in HIDDEN_HERE


@pytest.mark.parametrize("name", ["blur", "crosstalk", "lens_shading", "veiling_glare"])
def test_optics_are_those_of_green(name):
    """The plane of a Bayer sensor's green, of a scene that is grey."""
    effect = next(e for e in _core.effects("MONO") if e["name"] == name)
    parameters = parameters_of(effect)
    scene = scene_of().mean(axis=-1, keepdims=True).repeat(3, -1)
    sensor = sensor_of(effects=[{"name": name, "parameters": parameters}])
    seen = sensor.signal(scene, convention="sensor")
    bayer = next(e for e in _core.effects("RGGB") if e["name"] == name)
    whole = {p["name"]: parameters.get(p["name"], 0.0) for p in bayer["parameters"]}
    other = cg2raw.Sensor.from_json(cameras.profile_text())
    if name == "crosstalk":  # of the mosaic, which knows no colours
        expected = other.apply_effect(sensor_of().signal(scene), name, whole)
    else:
        planes = sensor_of().to_camera(scene, convention="sensor")
        expected = other.apply_effect(planes, name, whole)[..., 1]
    np.testing.assert_allclose(seen, expected, atol=1e-6)


def test_there_is_nothing_to_interpolate():
    signal = scene_of()[..., 0]
    planes = cg2raw.demosaic(signal, "MONO")
    np.testing.assert_array_equal(planes, signal[..., None].repeat(3, -1))
    np.testing.assert_array_equal(cg2raw.mosaic(planes, "mono"), signal)


def test_the_way_back_is_grey():
    sensor, scene = sensor_of(), scene_of()
    camera = sensor.to_camera(scene, highlights=False)
    back = sensor.to_scene(camera)
    np.testing.assert_allclose(back, camera, atol=1e-6)


def test_whole_frames_and_rows_are_the_same(tmp_path):
    """Blur holds the frame; its null does not: both ways lead to the same DN."""
    null = {p["name"]: 0.0 for p in parameters_named("blur")}
    held = sensor_of(effects=[{"name": "blur", "parameters": null}])
    scene = scene_of((300, 270))
    for threads in (1, 3):
        np.testing.assert_array_equal(
            held.simulate(scene, iso=100, threads=threads),
            sensor_of(effects=[]).simulate(scene, iso=100),
        )


def parameters_named(name):
    return next(e for e in _core.effects("mono") if e["name"] == name)["parameters"]


def test_a_matrix_is_asked_of_it_in_vain():
    with pytest.raises(ValueError, match="is monochrome and has no colour matrix"):
        sensor_of().camera_from_xyz([0.3, 0.3])


def test_a_made_up_profile_of_another_word_says_that_mono_is_one():
    with pytest.raises(ValueError, match=r'cfa "grey" must be .*, or mono$'):
        cg2raw.Sensor.from_json(json.dumps({**cameras.profile(), "cfa": "grey"}))


CURVE = {
    "wavelengths": list(range(380, 781, 10)),
    "mono": np.exp(-0.5 * ((np.arange(380, 781, 10) - 600) / 90.0) ** 2).tolist(),
}


def seen_by_curve(light):
    """Relative signal of 129 reflectances, white 1, and their Rec.709 under D65."""
    sets = spectral.held_out()
    reflectances = np.concatenate([sets["CIE 224"], sets["PMC"]])
    curve = np.interp(spectral.SHAPE.wavelengths, CURVE["wavelengths"], CURVE["mono"])
    weights = curve * illuminant_spectrum(light)
    return reflectances @ weights / weights.sum(), spectral.rec709_under_d65(
        reflectances
    )


@pytest.mark.parametrize("light", ["A", "D65", "FL2", "HP1"])
def test_convention_spectral_weighs_colours_as_the_sensitivity_does(light):
    sensor = sensor_of(spectral_sensitivities=CURVE)
    truth, rgb = seen_by_curve(light)
    scene = rgb.astype(np.float32)[None]
    found = {
        name: sensor.to_camera(
            scene, illuminant=light, convention=name, highlights=False
        )[0]
        for name in ("sensor", "spectral")
    }
    assert np.ptp(found["spectral"], axis=1).max() < 1e-6
    error = {name: np.abs(v[:, 0] - truth).mean() for name, v in found.items()}
    assert error["spectral"] < 0.5 * error["sensor"]
    white = np.ones((2, 2, 3), np.float32)
    one = sensor.to_camera(white, illuminant=light, convention="spectral")
    assert one == pytest.approx(1.0, abs=1e-6)
    raw = sensor.simulate(white * 0.5, illuminant=light, convention="spectral")
    plain = sensor.simulate(white * 0.5, illuminant=light)
    assert np.array_equal(raw, plain)


@pytest.mark.parametrize("word", ["", "xy:0.3:0.3", "neutral:1:1"])
def test_convention_spectral_needs_a_spectrum(word):
    sensor = sensor_of(spectral_sensitivities=CURVE)
    with pytest.raises(ValueError, match="name the light, as A, D65, 3200K or FL2"):
        sensor.simulate(scene_of(), illuminant=word, convention="spectral")
    with pytest.raises(ValueError, match="no spectral_sensitivities"):
        sensor_of().simulate(scene_of(), illuminant="A", convention="spectral")
