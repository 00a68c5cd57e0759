# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A sensor's colour effects are part of its RAW spaces, as the core applies them."""

import json

import numpy as np
import PyOpenColorIO as ocio
import pytest

import cg2raw
from cg2raw import _core
from cg2raw_ocio import color_effects, context, export, measure, names
from cg2raw_ocio.config import make_config
from cg2raw_ocio.spaces import Exposure, camera_transform
from ocio.pixels import kinds_of_pixels

FULL_SCALE_DN = 65535.0
MAX_DN = 0.25
LIGHTS = ("A", "D50", "D65", "2000K", "9000K", "sample:1")
VALUES = {
    "exposure": {"gain": 0.15},
    "white_balance": {"red": -0.08, "blue": 0.11},
    "color_matrix": {
        "rg": 0.06, "rb": -0.03, "gr": 0.02, "gb": 0.04, "br": -0.05, "bg": 0.09
    },
}  # fmt: skip
SETTINGS = [
    {"name": name, "parameters": values, "evidence": {}}
    for name, values in reversed(VALUES.items())  # the order of a list is no matter
]
SHADING = {
    "name": "lens_shading",
    "parameters": dict.fromkeys(
        ("r4", "r6", "tilt_x", "tilt_y", "tilt_x_r2", "tilt_y_r2"), 0.0
    )
    | {"r2": -0.3},
    "evidence": {},
}
LINEAR = names.SCENE_LINEAR


def with_effects(repository, sensor, effects):
    """Return the core profile of a bundled sensor with other effects."""
    text = (repository / "plugins" / "profiles" / f"{sensor}.json").read_text()
    fields = json.loads(text) | {"effects": effects}
    return _core.parse_profile(json.dumps(fields), sensor)


def site_of(cfa):
    """Return where R, G and B first are in a 2x2 CFA: slices of a mosaic."""
    return [np.s_[cfa.index(c) // 2 :: 2, cfa.index(c) % 2 :: 2] for c in "RGB"]


def camera_by_the_core(profile, rgb, **run):
    """Return (N, 3) camera RGB, after the effects, of the sites of 2x2 equal pixels."""
    sensor = cg2raw.Sensor.from_profile(profile)
    scene = np.repeat(np.repeat(rgb[None], 2, axis=0), 2, axis=1)
    signal = sensor.signal(scene, threads=1, **run)
    return np.stack([signal[site][0] for site in site_of(sensor.cfa)], axis=-1)


def converted(config, to_space, rgb, source=LINEAR):
    """Return (N, 3) float32 pixels converted by a config on the CPU."""
    processor = config.getProcessor(source, to_space).getDefaultCPUProcessor()
    out = np.array(rgb, np.float32, order="C")
    processor.applyRGB(out)
    return out


@pytest.mark.parametrize("highlights", [True, False])
@pytest.mark.parametrize("convention", ["dng", "paper"])
@pytest.mark.parametrize("sensor", ["nikon-d40", "samsung-s20fe"])
def test_a_raw_space_is_what_the_core_simulates(
    repository, sensor, convention, highlights
):
    profile = with_effects(repository, sensor, SETTINGS)
    exposure = Exposure(convention, 0.93, highlights)
    config = make_config([profile], LIGHTS, exposure)
    rgb = np.concatenate(list(kinds_of_pixels(700).values()))
    for light in LIGHTS:
        how = {"convention": convention, "digital_gain": 0.93, "highlights": highlights}
        expected = camera_by_the_core(profile, rgb, illuminant=light, **how)
        plain = camera_by_the_core(profile, rgb, illuminant=light, effects=False, **how)
        assert np.abs(expected - plain).max() * FULL_SCALE_DN > 1000
        seen = converted(config, names.raw_space(sensor, light)[0], rgb)
        assert np.abs(seen - expected).max() * FULL_SCALE_DN <= MAX_DN, light


@pytest.mark.parametrize("name", [n for n, (s, _) in color_effects.ORDER.items()
                                  if s == "color"])  # fmt: skip
def test_every_color_effect_is_a_matrix(repository, name):
    """Else a RAW space could not hold it: doubled and added pixels, black, HDR."""
    known = next(e for e in cg2raw.effects() if e["name"] == name)
    parameters = {
        p["name"]: 0.02 * (1 + number) for number, p in enumerate(known["parameters"])
    }
    setting = {"name": name, "parameters": parameters, "evidence": {}}
    profile = with_effects(repository, "nikon-d40", [setting])
    rgb = 10 * np.random.default_rng(2).standard_normal((500, 3))
    seen = color_effects.applied(profile, "2856K", rgb)
    expected = rgb @ color_effects.matrix(profile, "2856K").T
    assert np.abs(seen - rgb).max() > 0.1
    np.testing.assert_allclose(seen, expected, atol=2e-5)


def test_white_stays_white_in_a_color_matrix_of_each_light(repository):
    [setting] = [s for s in SETTINGS if s["name"] == "color_matrix"]
    profile = with_effects(repository, "nikon-d40", [setting])
    for light in LIGHTS:
        neutral = np.array(profile.illuminant(light).neutral)
        matrix = color_effects.matrix(profile, light)
        np.testing.assert_allclose(matrix @ neutral, neutral, rtol=1e-6)


def test_a_raw_space_has_a_way_back_and_a_twin(repository):
    """Of colours that do not clip: the effects are undone, in both spaces."""
    profile = with_effects(repository, "nikon-d40", SETTINGS)
    config = make_config([profile], ["2856K"])
    rgb = np.random.default_rng(5).uniform(0.3, 0.5, (500, 3)).astype(np.float32)
    raw, twin = (
        of("nikon-d40", "2856K")[0] for of in (names.raw_space, names.unbounded_space)
    )
    camera = converted(config, raw, rgb)
    np.testing.assert_allclose(converted(config, twin, rgb), camera, atol=4e-6)
    for space in (raw, twin):
        back = converted(config, LINEAR, camera, space)
        np.testing.assert_allclose(back, rgb, atol=2e-5)


def test_files_of_one_pair_have_them(repository, tmp_path):
    profile = with_effects(repository, "nikon-d40", SETTINGS)
    exposure = Exposure()
    pixels = measure.random_pixels()[:20000]
    plain = _core.to_camera(
        camera_transform(profile, "A", exposure), np.ascontiguousarray(pixels[None])
    )[0]
    exact = measure.exact_camera(profile, "A", exposure, pixels)
    assert measure.error(exact, plain).max_dn > 1000
    files = context.chain_files(profile, "A", exposure)
    texts = {
        ".ctf": export.ctf(profile, "A", exposure)[0],
        ".clf": export.clf(profile, "A", exposure)[0],
    }
    assert files["nikon-d40_A.ctf"] == texts[".ctf"]
    below = measure.below_highlights(camera_transform(profile, "A", exposure), pixels)
    for ending, text in texts.items():
        path = tmp_path / f"one{ending}"
        path.write_text(text)
        seen = measure.applied(ocio.FileTransform(str(path)), pixels)
        kept = below if ending == ".clf" else slice(None)
        assert measure.error(seen[kept], exact[kept]).max_dn <= MAX_DN, ending


def test_the_config_says_what_is_left_to_the_writer(repository):
    shaded = with_effects(repository, "nikon-d40", [*SETTINGS, SHADING])
    plain = _core.load_profile("samsung-s20fe")
    config = make_config([shaded, plain], ["D65"])
    assert "nikon-d40 (lens_shading)" in config.getDescription()
    assert "samsung-s20fe" not in config.getDescription()
    [first, second] = (
        config.getColorSpace(names.raw_space(p.id, "D65")[0]).getDescription()
        for p in (shaded, plain)
    )
    assert "color_matrix, exposure, white_balance" in first
    assert "left to the RAW writer: lens_shading" in first
    assert "RAW writer" not in second and "with the sensor's" not in second
    [alike] = (
        c.getColorSpace(names.raw_space("nikon-d40", "D65")[0])
        for c in [
            make_config([with_effects(repository, "nikon-d40", SETTINGS)], ["D65"])
        ]
    )
    rgb = measure.random_pixels()[:100]
    np.testing.assert_array_equal(
        converted(config, "RAW - nikon-d40 - D65", rgb),
        measure.applied(alike.getTransform(ocio.COLORSPACE_DIR_FROM_REFERENCE), rgb),
    )


BAD = {
    "no way back": (
        [{"name": "color_matrix", "evidence": {}, "parameters": {
            "rg": 1.0, "rb": 0.0, "gr": 0.0, "gb": 0.0, "br": 0.0, "bg": 0.0}}],
        "under A camera RGB cannot be had back from its effects color_matrix",
    ),
    "twice": ([SETTINGS[0]] * 2, "effect color_matrix would act twice"),
    "unknown": (
        [{"name": "fog", "parameters": {}, "evidence": {}}], 'effect "fog" is unknown'
    ),
    "out of bounds": (
        [{"name": "exposure", "parameters": {"gain": 11.0}, "evidence": {}}],
        "gain 11 is outside",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", BAD)
def test_effects_that_cannot_be(repository, what):
    effects, message = BAD[what]
    with pytest.raises(ValueError, match=message):
        profile = with_effects(repository, "nikon-d40", effects)
        make_config([profile], ["A"])
