# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""signal.h: noise, one effect, and DN, on a signal that is already there."""

import numpy as np
import pytest

import cg2raw
from oracles import cameras

EFFECTS = {effect["name"]: effect for effect in cg2raw.effects()}
SENSOR = "canon-5d-mark-iv"


@pytest.fixture(scope="module")
def sensor():
    return cg2raw.Sensor(SENSOR)


@pytest.fixture(scope="module")
def camera():
    """Camera RGB with some clipped sites."""
    return np.random.default_rng(7).uniform(0, 1.1, (150, 131, 3)).astype(np.float32)


@pytest.mark.parametrize("noise", ["gaussian", "physical"])
def test_noise_is_that_of_the_simulation(sensor, camera, noise):
    """None of its own: the profile here has no other effects."""
    assert sensor.effects == []
    key = {"iso": 1600, "noise": noise, "seed": 3, "frame": 4}
    expected = sensor.signal(camera, illuminant="A", camera_input=True, **key)
    clean = sensor.mosaic(camera)
    before = clean.copy()
    np.testing.assert_array_equal(sensor.add_noise(clean, **key), expected)
    np.testing.assert_array_equal(clean, before)
    assert (expected != clean).mean() > 0.8
    one, many = (sensor.add_noise(clean, threads=n, **key) for n in (1, 4))
    np.testing.assert_array_equal(one, many)


def test_noise_goes_where_it_is_asked_to(sensor, camera):
    clean = sensor.mosaic(camera)
    expected = sensor.add_noise(clean, iso=1600)
    out = np.empty_like(clean)
    assert sensor.add_noise(clean, iso=1600, out=out) is out
    np.testing.assert_array_equal(out, expected)
    assert sensor.add_noise(clean, iso=1600, out=clean) is clean
    np.testing.assert_array_equal(clean, expected)


def test_a_signal_stays_as_it_is_where_it_gets_no_noise(sensor, camera):
    clean = sensor.mosaic(camera)
    clean[100, 7] = np.nan
    before = clean.copy()
    with pytest.raises(ValueError, match="row 100, col 7 is not finite"):
        sensor.add_noise(clean, iso=1600, out=clean)
    np.testing.assert_array_equal(clean, before)


ROOM = np.zeros((12, 10), np.float32)


@pytest.mark.parametrize(
    ("out", "words"),
    [
        (np.zeros((10, 10)), "an array of native float32, not float64"),
        ([[0.0] * 10] * 10, "an array of native float32, not list"),
        (np.zeros((10, 12), np.float32), r"the shape \(10, 10\), not \(10, 12\)"),
        (np.zeros((10, 20), np.float32)[:, ::2], "C-contiguous and writeable"),
        (np.broadcast_to(np.float32(0), (10, 10)), "C-contiguous and writeable"),
        (ROOM[1:11], "shares memory with a part of signal"),
    ],
)
def test_noise_goes_nowhere_else(sensor, out, words):
    with pytest.raises(ValueError, match=words):
        sensor.add_noise(ROOM[:10], iso=1600, out=out)


def test_noise_has_the_variance_of_the_profile(sensor):
    level, at = 0.3, sensor.noise_at(800)
    clean = np.full((1000, 1000), level, np.float32)
    drawn = sensor.add_noise(clean, iso=800)
    for site in range(4):
        pixels = drawn[site // 2 :: 2, site % 2 :: 2].astype(float)
        variance = at["beta1"][site] * level + at["beta2"][site]
        sigma = np.sqrt(2 / pixels.size)
        assert pixels.var() / variance == pytest.approx(1, abs=5 * sigma)
        assert pixels.mean() == pytest.approx(level, abs=5 * np.sqrt(variance) / 500)


def test_noise_alone_leaves_the_profiles_effects_out():
    noise = [{"iso": 100, "beta1": [1e-4] * 4, "beta2": [1e-6] * 4}]
    plain = cameras.profile_text(noise=noise)
    effects = [{"name": "row_noise", "parameters": {"sigma": 0.1}}]
    banded = cameras.profile_text(noise=noise, effects=effects)
    clean = np.full((64, 64), 0.5, np.float32)
    drawn = [
        cg2raw.Sensor.from_json(t).add_noise(clean, iso=100) for t in (plain, banded)
    ]
    np.testing.assert_array_equal(*drawn)


WHOLE = {"pitch": 7, "row": 3, "column": 5}  # numbers of pixels
OF_OTHER_NOISE = "read_noise_correlation"  # which is not there


def strong(name):
    """Every parameter a tenth of the way from null to a bound."""

    def tenth(p):
        bound = p["max"] if p["max"] != p["null"] else p["min"]
        return p["null"] + 0.1 * (bound - p["null"])

    values = {p["name"]: tenth(p) for p in EFFECTS[name]["parameters"]}
    return {**values, **(WHOLE if name == "pdaf_pixels" else {})}


def given_to(name, camera):
    """What an effect works on: camera RGB or a mosaic."""
    is_camera = EFFECTS[name]["stage"] in ("color", "optics")
    return camera if is_camera else cg2raw.mosaic(camera, "RGGB")


@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_is_that_of_a_profile_that_lists_it(name, camera):
    parameters = strong(name)
    effects = [{"name": name, "parameters": parameters}]
    listing = cg2raw.Sensor.from_json(cameras.profile_text(effects=effects))
    without = cg2raw.Sensor.from_json(cameras.profile_text())
    light = {"illuminant": "A", "exposure_time": 0.5}
    how = {**light, "camera_input": True}
    image = given_to(name, camera)
    seen = without.apply_effect(image, name, parameters, seed=5, frame=6, **light)
    mean, variance = without.predict_effect(image, name, parameters, **light)
    if image.ndim == 3:
        seen, mean = without.mosaic(seen), without.mosaic(mean)
    expected = listing.signal(camera, seed=5, frame=6, **how)
    np.testing.assert_array_equal(seen, expected)
    means, variances = listing.predict(camera, **how)
    np.testing.assert_array_equal(mean, means)
    np.testing.assert_array_equal(variance, variances)
    assert seen.dtype == mean.dtype == variance.dtype == np.float32
    assert (seen != without.mosaic(camera)).any() or name == OF_OTHER_NOISE


def test_an_effect_says_what_it_works_on(sensor, camera):
    flat = np.full((8, 8), 0.5, np.float32)
    with pytest.raises(ValueError, match="lens_shading is of stage optics"):
        sensor.apply_effect(flat, "lens_shading", strong("lens_shading"))
    with pytest.raises(ValueError, match="row_noise is of stage readout"):
        sensor.predict_effect(camera, "row_noise", {"sigma": 0.1})
    with pytest.raises(ValueError, match="sigma 2 is outside 0 to 1"):
        sensor.apply_effect(flat, "row_noise", {"sigma": 2.0})
    with pytest.raises(ValueError, match="unknown; known: "):
        sensor.apply_effect(flat, "flare", {})


def test_a_signal_that_is_not_finite_is_told_where(sensor):
    bad = np.full((8, 8), 0.5, np.float32)
    bad[3, 5] = np.nan
    with pytest.raises(ValueError, match="row 3, col 5 is not finite"):
        sensor.add_noise(bad, iso=800)
    with pytest.raises(ValueError, match="row 3, col 5 is not finite"):
        sensor.apply_effect(bad, "row_noise", {"sigma": 0.1})


def test_noise_needs_a_profile_that_knows_it():
    clean = np.full((8, 8), 0.5, np.float32)
    with pytest.raises(ValueError, match="noise"):
        cg2raw.Sensor("nikon-d40").add_noise(clean, iso=800)
    with pytest.raises(ValueError, match="None must be|iso"):
        cg2raw.Sensor(SENSOR).add_noise(clean, iso=None)


@pytest.mark.parametrize("cfa", ["GRBG", cameras.QUAD, cameras.X_TRANS])
def test_dn_and_signal_are_inverse(cfa):
    """Every DN comes back, and lies where black and white say."""
    black = [100.0 + 20.25 * site for site in range(len(cfa))]
    sensor = cg2raw.Sensor.from_json(
        cameras.profile_text(cfa=cfa, bits=12, black_level=black, white_level=4000)
    )
    raw = np.arange(4001, dtype=np.uint16)[: 60 * 66].reshape(60, 66)
    raw = np.vstack([raw, raw[::-1] + 40])
    signal = sensor.signal_from_raw(raw)
    side = {4: 2, 16: 4, 36: 6}[len(cfa)]
    rows, cols = np.indices(raw.shape)
    b = np.array(black)[rows % side * side + cols % side]
    assert np.abs(signal - (raw - b) / (4000 - b)).max() < 1e-6
    np.testing.assert_array_equal(sensor.raw_from_signal(signal), raw)
    assert sensor.raw_from_signal(np.full((2, 2), 9.0)).max() == 4000
    assert sensor.raw_from_signal(np.full((2, 2), -9.0)).max() == 0


def test_raw_is_uint16_and_nothing_else(sensor):
    for bad in (np.ones((4, 4)), np.ones((4, 4), np.int32), np.ones(4, np.uint16)):
        with pytest.raises(ValueError, match="uint16"):
            sensor.signal_from_raw(bad)
