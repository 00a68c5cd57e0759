# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Exposure: stops, draws, the light meter, settings of a camera and brackets."""

import json
import math

import numpy as np
import pytest

import cg2raw
from match.match_sets import match_file

SENSOR = cg2raw.Sensor("samsung-s20fe")
GREY = np.full((8, 8, 3), 0.125, np.float32)
LIGHT = {"illuminant": "D65", "convention": "sensor"}


def settled(image=GREY, **run):
    return SENSOR.simulate(image, **LIGHT, **run).simulation.exposure


def stops(**run):
    return settled(**run)["stops"]


@pytest.mark.parametrize("convention", ["dng", "paper", "sensor", "spectral"])
def test_stops_are_a_gain_before_anything_clips(convention):
    scene = np.random.default_rng(1).uniform(0, 1.5, (16, 16, 3)).astype(np.float32)
    sensor = cg2raw.Sensor("nikon-d850")  # which has spectral sensitivities
    run = {"illuminant": "D65", "convention": convention}
    for given, gain in ((-2, 0.25), (1, 2), ("-0.5", 2**-0.5)):
        np.testing.assert_array_equal(
            sensor.simulate(scene, exposure=given, **run),
            sensor.simulate(scene * np.float32(gain), **run),
        )


def test_highlights_are_kept_after_the_exposure():
    white = np.full((4, 4, 3), 0.25, np.float32)
    raw = SENSOR.simulate(white, illuminant="A", exposure=2)
    assert (raw == SENSOR.simulate(4 * white, illuminant="A")).all()
    assert (raw == SENSOR.white_level).all()


def test_draws_follow_their_distributions():
    drawn = np.array(
        [
            [stops(exposure=rule, seed=7, frame=n) for n in range(400)]
            for rule in ("random:-1:3", "normal:0.5:0.25")
        ]
    )
    assert drawn[0].min() >= -1 and drawn[0].max() <= 3
    assert drawn[0].mean() == pytest.approx(1, abs=0.17)
    assert drawn[1].mean() == pytest.approx(0.5, abs=0.04)
    np.testing.assert_allclose(drawn.std(axis=1), [4 / 12**0.5, 0.25], rtol=0.12)
    again = stops(exposure="random:-1:3", seed=7, frame=0)
    assert again == drawn[0, 0] != stops(exposure="random:-1:3", seed=8, frame=0)


@pytest.mark.parametrize(
    ("level", "wanted"),
    [(-5, -3), (-6, -6), (-4.5, -2), (-7, -9), (-4, -1), (-20, -9), (3, -1)],
)
def test_a_matched_level_is_that_of_as_many_captures(tmp_path, level, wanted):
    """Levels within a tenth of a stop are alike, which draws in the ends."""
    image = np.full((10, 10, 3), 2.0**level, np.float32)
    pixels = image.reshape(-1, 3)
    pixels[:20] *= 100  # lamps, which a captured frame's median counts
    pixels[55:] /= 100
    found = settled(image=image, exposure=match_file(tmp_path))
    assert level + found["stops"] == pytest.approx(wanted, abs=0.2)


def test_renders_that_are_alike_get_the_median_level(tmp_path):
    levels = {"captures": [[0, -9], [0.5, -2.5], [1, -1]]}
    for renders in ([[0, -3], [1, -3]], [[0, -3.03], [0.1, -2.98], [1, -2.97]]):
        rule = match_file(tmp_path, levels=levels | {"renders": renders})
        assert stops(exposure=rule) == pytest.approx(0.5, abs=0.01)


def test_a_drawn_match_has_the_quantiles_of_the_file(tmp_path):
    rule = match_file(tmp_path, levels=None) + ":draw"
    drawn = [stops(exposure=rule, frame=n) for n in range(400)]
    assert -1 <= min(drawn) and max(drawn) <= 2
    np.testing.assert_allclose(
        np.quantile(drawn, [0.25, 0.5, 0.75]), [0, 1, 1.5], atol=0.2
    )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"sensor": "nikon-d40"}, "by sensor nikon-d40, and this one is samsung-s20fe"),
        ({"sensor": 1}, "names no sensor"),
        ({"levels": None}, "has no levels.captures"),
        ({"levels": {"captures": [[0, 1], [1, 2]]}}, "has no levels.renders"),
        ({"levels": {"captures": [[0, 1], 2]}}, "levels.captures must be pairs"),
        ({"exposure": {}}, "has no exposure.quantiles"),
        ({"exposure": {"quantiles": [[0, 1], [0.5, 0], [1, 2]]}}, "must rise"),
        ({"exposure": {"quantiles": [[0, 1], [0.9, 2]]}}, "from probability 0 to 1"),
        ({"exposure": {"quantiles": [[0, 1], [1, 1e9]]}}, "within -64 to 64 stops"),
    ],
)
def test_a_bad_match_file_is_refused(tmp_path, changes, message):
    drawn = ":draw" if "exposure" in changes else ""
    with pytest.raises(ValueError, match=message):
        stops(exposure=match_file(tmp_path, **changes) + drawn)


def scene(lamps, white=0.2, shape=(100, 100)):
    """A ramp up to @white, and a share of lamps a hundred times as bright."""
    values = np.linspace(white / 100, white, math.prod(shape))
    values[: round(lamps * len(values))] = 100 * white
    return np.repeat(values.reshape(*shape, 1), 3, axis=2).astype(np.float32)


def test_the_meter_puts_a_percentile_at_its_level():
    image = scene(0)
    assert stops(image=image, exposure="auto") == pytest.approx(
        math.log2(0.8 / (0.98 * 0.2)), abs=0.01
    )
    assert stops(image=image, exposure="auto:50:0.1") == pytest.approx(
        math.log2(0.1 / 0.101), abs=0.02
    )
    assert stops(image=4 * image, exposure="auto") == pytest.approx(
        stops(image=image, exposure="auto") - 2, abs=1e-9
    )


@pytest.mark.parametrize(("percent", "light"), [(10, 0.1), (50, 0.2), (67, 0.4)])
def test_a_percentile_is_that_of_the_pixels_up_to_it(percent, light):
    """Of three pixels: the first whose share of all is as large."""
    image = np.repeat(np.float32([[[0.1], [0.2], [0.4]]]), 3, axis=2)
    assert stops(image=image, exposure=f"auto:{percent}:0.1") == pytest.approx(
        math.log2(0.1 / light), abs=0.02
    )


def test_a_drawn_gain_is_above_0():
    profile = json.loads(SENSOR.to_json())
    profile["digital_gain"] = {"mean": 0.1, "sigma": 1.0}
    sensor, gains = cg2raw.Sensor.from_json(json.dumps(profile)), []
    for frame in range(64):
        run = {"digital_gain": "sample", "frame": frame}
        gains.append(sensor.simulate(GREY, **LIGHT, **run).simulation.digital_gain)
    assert min(gains) > 0 and max(gains) > 1


@pytest.mark.parametrize("share", [0.001, 0.02, 0.1, 0.2])  # a quarter at most
def test_lamps_do_not_change_what_the_meter_reads(share):
    assert stops(image=scene(share), exposure="auto") == pytest.approx(
        stops(image=scene(0), exposure="auto"), abs=0.1
    )


def test_what_is_not_light_is_not_metered():
    image = scene(0)
    padded = np.pad(image, ((30, 0), (0, 0), (0, 0)))
    padded[0, 0] = np.nan
    padded[0, 1] = np.inf
    padded[0, 2] = -1
    for threads in (1, 2, 3):
        read = SENSOR.metered(padded, cg2raw.Run(exposure="auto"), threads=threads)
        assert read.meter == SENSOR.metered(image, cg2raw.Run(exposure="auto")).meter


def test_a_black_scene_has_exposure_0():
    found = settled(image=0 * GREY, exposure="auto")
    assert (found["stops"], found["meter"]) == (0, 0)


def test_spectra_are_metered_by_what_white_is():
    run = {"illuminant": "A", "camera_input": True, "exposure": "auto:100:1"}
    light = SENSOR.illuminant("A")
    white = 0.1 * np.array(light.neutral) / max(light.neutral)
    image = np.broadcast_to(white, (4, 4, 3)).astype(np.float32)
    found = SENSOR.simulate(image, convention="sensor", **run).simulation.exposure
    assert found["stops"] == pytest.approx(math.log2(10), abs=0.01)


def test_settings_make_white_where_iso_12232_has_it():
    """H = 0.65 L t / N^2 is saturation at 78 / S lx s; ISO 12232:2019."""
    for seconds, f_number, iso in (
        (1 / 60, 2, 3200),
        (1 / 8000, 1.4, 100),
        (1, 16, 50),
    ):
        luminance = 78 / iso * f_number**2 / (0.65 * seconds)
        run = {"exposure_time": seconds, "f_number": f_number, "iso": iso}
        found = settled(scene_luminance=luminance, **run)
        assert found["stops"] == pytest.approx(0, abs=1e-9)
        dimmed = settled(scene_luminance=luminance, nd_filter=3, exposure=0.5, **run)
        assert dimmed["stops"] == pytest.approx(-2.5, abs=1e-9)
    without = settled(iso=3200, exposure_time=1 / 60, f_number=2)
    assert without["stops"] == 0


def test_below_its_base_iso_a_sensor_saturates_as_there():
    text = json.loads(SENSOR.to_json()) | {"base_iso": 100}
    sensor = cg2raw.Sensor.from_json(json.dumps(text))
    found = [
        sensor.simulation(
            (2, 2),
            **LIGHT,
            iso=iso,
            exposure_time=0.01,
            f_number=2,
            scene_luminance=100,
            effects=False,
        ).exposure["stops"]
        for iso in (50, 100, 200)
    ]
    np.testing.assert_allclose(np.diff(found), [0, 1], atol=1e-12)


@pytest.mark.parametrize("missing", ["exposure_time", "f_number", "iso"])
def test_auto_finds_the_setting_that_is_missing(missing):
    run = {"exposure_time": 1 / 60, "f_number": 2.0, "iso": 400, "exposure": "auto"}
    del run[missing]
    found = settled(scene_luminance=800, **run)
    metered = 0.125 * 2 ** found["stops"]
    assert metered == pytest.approx(0.8, rel=0.01)
    for name, value in run.items():
        assert name == "exposure" or found[name] == value


@pytest.mark.parametrize(
    ("missing", "limits", "found"),
    [
        ("exposure_time", {"time_limits": "1/8000:1/1000"}, 1 / 1000),
        ("f_number", {"f_number_limits": (11, 22)}, 11),
        ("iso", {"iso_limits": "100:200"}, 200),
    ],
)
def test_what_is_found_stays_within_its_limits(missing, limits, found):
    run = {"exposure_time": 1 / 60, "f_number": 2.0, "iso": 400, "exposure": "auto"}
    del run[missing]
    settings = settled(scene_luminance=1, **run, **limits)
    assert settings[missing] == pytest.approx(found)
    assert 0.125 * 2 ** settings["stops"] < 0.8


def test_frames_of_a_bracket_differ_in_time_and_noise(tmp_path):
    frames = [
        SENSOR.simulate(GREY, **LIGHT, bracket=b, exposure_time="1/60", iso=800)
        for b in (-1, 0, 1)
    ]
    levels = [frame.mean() - np.mean(SENSOR.black_level) for frame in frames]
    np.testing.assert_allclose(np.diff(np.log2(levels)), 1, atol=0.15)
    dark = [
        SENSOR.simulate(0 * GREY, **LIGHT, bracket=b, exposure_time=0.1, iso=800)
        for b in (-1, 1)
    ]
    assert (dark[0] != dark[1]).any()
    for frame, bias in zip(frames, (-1, 0, 1), strict=True):
        cg2raw.write_dng(tmp_path / "a.dng", frame)
        shot = cg2raw.read_dng_metadata(tmp_path / "a.dng").shot
        assert (shot["exposure_bias"], shot["exposure_mode"]) == (bias, 2)
        assert shot["exposure_time"] == pytest.approx(2**bias / 60, rel=1e-4)


@pytest.mark.parametrize(
    ("run", "exif"),
    [
        ({}, (None, None, None, None, None, None)),
        ({"exposure": 1.5, "iso": 800.5}, (None, None, 801, 1.5, None, None)),
        ({"exposure": "auto"}, (None, None, None, 0, 0, None)),
        ({"exposure_time": "1/4", "f_number": 2}, (0.25, 2, None, None, None, None)),
        (
            {"exposure_time": 1, "f_number": 2, "iso": 100, "scene_luminance": 1},
            (1, 2, 100, None, 1, None),
        ),
        # 0.1 of 0.8 / 0.125 of white at H = 78 / 100 lx s; Bv of Exif 2.3, annex C
        (
            {
                "exposure_time": 1,
                "f_number": 2,
                "exposure": "auto:100:0.125",
                "scene_luminance": 4 * 0.78 / 0.65,
                "iso_limits": "50:800",
            },
            (1, 2, 100, 0, 0, round(math.log2(4 / 32), 2)),
        ),
    ],
)
def test_exif_says_what_is_known_and_no_more(tmp_path, run, exif):
    frame = SENSOR.simulate(GREY, **LIGHT, **run)
    cg2raw.write_dng(tmp_path / "a.dng", frame)
    shot = cg2raw.read_dng_metadata(tmp_path / "a.dng").shot
    names = ("exposure_time", "f_number", "iso")
    names += ("exposure_bias", "exposure_mode", "brightness")
    assert tuple(shot[name] for name in names) == exif


@pytest.mark.parametrize(
    ("run", "message"),
    [
        ({"exposure": "bright"}, "must be stops from -64 to 64, auto"),
        ({"exposure": math.nan}, "must be stops"),
        ({"exposure": [1]}, "exposure .* must be a number, a text or None"),
        ({"exposure": "random:1"}, "random:LOW:HIGH"),
        ({"exposure_time": "1/0"}, "seconds above 0"),
        ({"f_number": -1}, "f_number -1 must be above 0"),
        ({"scene_luminance": 1, "f_number": 2, "iso": 100}, "without exposure_time"),
        (
            {"nd_filter": 3},
            "nd_filter is given without scene_luminance: add scene_luminance=100",
        ),
        ({"iso_limits": "low"}, "iso_limits .* must be LOW:HIGH"),
        ({"bracket": 1}, "add exposure_time=1/60"),
        ({"bracket": 99, "exposure_time": 1}, "-64 to 64"),
    ],
)
def test_bad_exposures_are_refused(run, message):
    with pytest.raises(ValueError, match=message):
        settled(**run)


def test_a_simulation_without_an_image_cannot_be_metered():
    with pytest.raises(ValueError, match="needs the whole image"):
        SENSOR.simulation((4, 4), **LIGHT, exposure="auto")
