# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""UPI: the laws of what it draws, and DNGs that say what was drawn."""

import numpy as np
import pytest
import rawpy
from scipy import stats

import cg2raw
from cg2raw import _core
from cg2raw.upi import PAPER_SENSORS, Upi, d65_matrix, drawn_noise, gain_ranges
from oracles.de2000 import between_linear_srgb

SEEDS = range(1000)
# Each test of a distribution fails once in a thousand sets of seeds, and this is one.
LEAST_P = 1e-3


@pytest.fixture(scope="module")
def draws():
    upi = Upi("nikon-d40", noise="upi")
    return [upi.draw(seed) for seed in SEEDS]


def column(draws, name):
    return np.array([getattr(draw, name) for draw in draws])


def uniform_p(values, low, high):
    return stats.kstest(values, stats.uniform(low, high - low).cdf).pvalue


def test_gains_are_uniform_and_independent(draws):
    red, blue = column(draws, "red_gain"), column(draws, "blue_gain")
    assert uniform_p(red, 1.9, 2.4) > LEAST_P
    assert uniform_p(blue, 1.5, 1.9) > LEAST_P
    assert stats.spearmanr(red, blue).pvalue > LEAST_P


def test_the_digital_gain_is_the_inverse_of_upis(draws):
    gains = column(draws, "digital_gain")
    assert stats.kstest(gains, stats.norm(0.8, 0.1).cdf).pvalue > LEAST_P


def test_weights_are_convex_and_uniforms_over_their_sum(draws):
    weights = column(draws, "weights")
    assert weights.shape == (len(SEEDS), 10)
    assert (weights >= 0).all()
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-12)
    uniforms = np.random.default_rng(5).random((20000, 10))
    expected = uniforms / uniforms.sum(axis=1, keepdims=True)
    for sensor in range(10):
        p = stats.ks_2samp(weights[:, sensor], expected[:, sensor]).pvalue
        assert p > LEAST_P / 10, PAPER_SENSORS[sensor]


def test_noise_has_the_published_law(draws):
    shot, read = column(draws, "shot_noise"), column(draws, "read_noise")
    assert uniform_p(np.log(shot), np.log(1e-4), np.log(1.2e-2)) > LEAST_P
    rest = np.log(read) - (2.18 * np.log(shot) + 1.20)
    assert stats.kstest(rest, stats.norm(0, 0.26).cdf).pvalue > LEAST_P
    assert stats.spearmanr(rest, shot).pvalue > LEAST_P
    assert stats.spearmanr(abs(rest), shot).pvalue > LEAST_P
    assert drawn_noise(7) == (draws[7].shot_noise, draws[7].read_noise)


def test_the_matrix_is_the_mixture_of_the_sensors_matrices(draws):
    matrices = np.stack([d65_matrix(cg2raw.Sensor(id)) for id in PAPER_SENSORS])
    for draw in draws[:20]:
        mixture = np.tensordot(draw.weights, matrices, 1)
        np.testing.assert_allclose(draw.camera_from_xyz, mixture, atol=5.0001e-5)
        assert (draw.camera_from_xyz >= matrices.min(axis=0) - 5.0001e-5).all()
        assert (draw.camera_from_xyz <= matrices.max(axis=0) + 5.0001e-5).all()


def test_a_set_of_one_is_that_sensor():
    draw = Upi("samsung-s20fe", matrices=["nikon-d40"]).draw(3)
    assert draw.weights == (1.0,)
    matrix = d65_matrix(cg2raw.Sensor("nikon-d40"))
    np.testing.assert_array_equal(draw.camera_from_xyz, matrix)
    assert draw.sensor.cfa == "GRBG" and draw.sensor.white_level == 1023


@pytest.mark.parametrize("id", PAPER_SENSORS)
def test_gains_of_a_camera_are_those_of_its_neutrals(id):
    sensor = cg2raw.Sensor(id)
    hull = np.array(sensor.illuminants["hull"])
    (red_low, red_high), (blue_low, blue_high) = gain_ranges(sensor)
    found = [1 / red_high, 1 / red_low, 1 / blue_high, 1 / blue_low]
    expected = [*np.ravel([hull[:, 0].min(), hull[:, 0].max()])]
    expected += [hull[:, 1].min(), hull[:, 1].max()]
    np.testing.assert_allclose(found, expected)
    upi = Upi(sensor, gains="camera")
    drawn = [upi.draw(seed) for seed in range(100)]
    assert uniform_p(column(drawn, "red_gain"), red_low, red_high) > LEAST_P / 10


def camera_oracle(rgb, draw):
    """Camera RGB as the paper describes it, from the drawn parameters."""
    matrix = draw.camera_from_xyz @ _core.xyz_d65_from_srgb()
    balanced = rgb @ (matrix / matrix.sum(axis=1, keepdims=True)).T
    balanced = np.clip(balanced, 0, 1)
    gains = np.array([1 / draw.red_gain, 1, 1 / draw.blue_gain]) * draw.digital_gain
    gray = balanced.mean(axis=-1, keepdims=True)
    mask = (np.maximum(gray - 0.9, 0) / 0.1) ** 2
    return balanced * np.maximum(mask + (1 - mask) * gains, gains)


@pytest.mark.parametrize("seed", range(5))
def test_pixels_are_what_the_paper_describes(seed):
    rgb = np.random.default_rng(seed).random((200, 1, 3)).astype(np.float32)
    rgb[:50] = 0.9 + 0.1 * rgb[:50]
    draw = Upi("nikon-d40").draw(seed)
    camera = draw.sensor.to_camera(
        rgb, illuminant=draw.illuminant, digital_gain=draw.digital_gain
    )
    # The ForwardMatrix has four decimals, as the file has.
    np.testing.assert_allclose(camera, camera_oracle(rgb, draw), atol=4e-4)


def flat_patches():
    """Return a (24 x 40)-pixel-patch image of 12 colours in the gamut of cameras."""
    colors = 0.1 + 0.5 * np.random.default_rng(2).random((12, 3))
    return np.repeat(np.repeat(colors.reshape(3, 4, 3), 40, 0), 40, 1).astype(
        np.float32
    )


def centres(image):
    """Return the (12, 3) means of the patches' middles."""
    patches = image.reshape(3, 40, 4, 40, 3)[:, 12:28, :, 12:28]
    return patches.mean(axis=(1, 3)).reshape(12, 3)


@pytest.mark.parametrize("seed", range(6))
def test_a_reader_gives_the_render_back(seed, tmp_path):
    """LibRaw knows the ColorMatrix and the neutral that the file states, no more."""
    path, scene = tmp_path / "upi.dng", flat_patches()
    upi = Upi("nikon-d40", digital_gain=1.0)
    cg2raw.write_dng(path, upi.simulate(scene, seed=seed))
    with rawpy.imread(str(path)) as raw:
        picture = raw.postprocess(
            use_camera_wb=True, no_auto_bright=True, output_bps=16, gamma=(1, 1)
        )
    assert picture.shape == scene.shape
    difference = between_linear_srgb(centres(picture / 65535), centres(scene))
    assert difference.max() < 0.3, difference


def test_the_file_states_what_was_drawn(tmp_path):
    path = tmp_path / "upi.dng"
    upi = Upi("nikon-d40", noise="upi")
    draw = upi.draw(11)
    cg2raw.write_dng(path, upi.simulate(flat_patches(), seed=11))
    stated = cg2raw.read_dng_metadata(str(path))
    neutral = [1 / draw.red_gain, 1, 1 / draw.blue_gain]
    np.testing.assert_allclose(stated.as_shot_neutral, neutral, atol=1e-6)
    (calibration,) = stated.calibrations
    assert calibration["light_source"] == 21  # D65
    np.testing.assert_allclose(
        calibration["camera_from_xyz"], draw.camera_from_xyz, atol=1e-9
    )
    assert stated.unique_camera_model.endswith(" UPI")
    np.testing.assert_allclose(
        stated.noise_profile, [[draw.shot_noise, draw.read_noise]] * 3, rtol=1e-12
    )
    assert stated.shot["iso"] is None


def test_the_drawn_noise_is_in_the_pixels():
    upi = Upi("nikon-d40", noise="upi")
    draw = upi.draw(4)
    grey = np.full((256, 256, 3), 0.4, np.float32)
    run = {"illuminant": draw.illuminant, "digital_gain": draw.digital_gain}
    mean, variance = draw.sensor.predict(grey, **run)
    np.testing.assert_allclose(
        variance, draw.shot_noise * mean + draw.read_noise, rtol=1e-5
    )
    signal = draw.sensor.signal(grey, **run)
    z = (signal - mean) / np.sqrt(variance)
    assert abs(z.var() - 1) < 5 * np.sqrt(2 / z.size)


def test_draws_are_pure_functions_of_the_seed():
    upi, again = Upi("nikon-d40", noise="upi"), Upi("nikon-d40", noise="upi")
    scene = flat_patches()
    first = upi.simulate(scene, seed=5)
    upi.simulate(scene, seed=6)
    np.testing.assert_array_equal(again.simulate(scene, seed=5, threads=1), first)
    np.testing.assert_array_equal(upi.simulate(scene), upi.simulate(scene, seed=0))
    other = upi.simulate(scene, seed=5, frame=1)
    assert (other != first).any()
    assert other.simulation.illuminant.neutral == first.simulation.illuminant.neutral
    assert upi.draw(6).red_gain != upi.draw(5).red_gain


def test_gains_of_any_range():
    """Also of a sensor whose neutrals nobody has measured."""
    upi = Upi("sony-a7s-ii", gains=((2.0, 2.0), (1.25, 1.75)))
    draws = [upi.draw(seed) for seed in range(100)]
    assert {draw.red_gain for draw in draws} == {2.0}
    blue = [draw.blue_gain for draw in draws]
    assert uniform_p(blue, 1.25, 1.75) > LEAST_P
    ends = Upi("nikon-d40", gains=((0.01, 0.01), (100, 100))).draw(0)
    assert (ends.red_gain, ends.blue_gain) == (0.01, 100)  # bounds are legal
    named = Upi("nikon-d40", gains="graphics2raw")
    ranges = Upi("nikon-d40", gains=((1.0, 3.3), (1.3, 4.4)))
    assert [named.draw(s).illuminant for s in range(9)] == [
        ranges.draw(s).illuminant for s in range(9)
    ]


BAD = [
    ({"matrices": []}, {}, "at least one"),
    ({"matrices": ["gopro-hero6-black"]}, {}, "no colour matrix for D65"),
    ({"sensor": "blackmagic-pocket", "gains": "camera"}, {}, "fewer than 3"),
    ({"gains": "wide"}, {}, "published or graphics2raw or camera"),
    ({"gains": ((1, 2), (3,))}, {}, "must be .* of red and blue, 0.01 to 100"),
    ({"gains": (1, 2)}, {}, "must be .* of red and blue"),
    ({"gains": ((1, 2), (0, 3))}, {}, "must be .* of red and blue"),
    ({"gains": ((1, 2), (1, float("nan")))}, {}, "must be .* of red and blue"),
    ({"gains": ((1, 2), (1, 100.01))}, {}, "must be .* of red and blue, 0.01 to 100"),
    ({"gains": ((0.0099, 2), (1, 2))}, {}, "must be .* of red and blue, 0.01 to 100"),
    ({"gains": ((2, 1), (1, 2))}, {}, "from low to high"),
    ({"noise": "loud"}, {}, "sensor or upi"),
    ({"digital_gain": "sample"}, {}, "upi"),
    ({"noise": "upi"}, {"iso": 100}, "leave iso"),
    ({"noise": "upi"}, {"noise": "gaussian"}, "leave iso and noise out"),
    ({}, {"illuminant": "A"}, "UPI draws illuminant itself: leave it out"),
    ({}, {"digital_gain": 0.5}, "UPI draws digital_gain itself: leave it out"),
    ({}, {"iso": 100}, "no measured noise"),
    ({"sensor": "fujifilm-x-m1", "noise": "upi"}, {}, "Bayer"),
]


@pytest.mark.parametrize(("made", "run", "said"), BAD, ids=str)
def test_what_upi_refuses(made, run, said):
    with pytest.raises(ValueError, match=said):
        Upi(**{"sensor": "nikon-d40", **made}).simulate(flat_patches(), **run)


def test_the_core_counts_its_draws():
    """Rng by its own two words: a uniform is 52 bits of Philox, a normal is two."""
    rng = _core.Rng(3, "purpose", 9)
    uniforms = [rng.uniform(n) for n in range(4000)]
    assert uniform_p(uniforms, 0, 1) > LEAST_P
    assert _core.Rng(3, "purpose", 9).uniform(17) == uniforms[17]
    assert _core.Rng(3, "purpose", 8).uniform(17) != uniforms[17]
    radius = np.sqrt(-2 * np.log(uniforms[6]))
    assert rng.normal(3) == pytest.approx(radius * np.cos(2 * np.pi * uniforms[7]))


@pytest.mark.parametrize("id", PAPER_SENSORS)
def test_the_table_of_the_docs(id, repository):
    """docs/upi.md has the parameters of the ten cameras."""
    lines = (repository / "docs/upi.md").read_text().splitlines()
    (row,) = (line for line in lines if line.startswith(f"| `{id}` |"))
    _, _, matrix, red, blue, _ = row.split("|")
    sensor = cg2raw.Sensor(id)
    expected = d65_matrix(sensor).ravel()
    np.testing.assert_allclose(np.array(matrix.split(), float), expected, atol=5e-5)
    for text, gains in zip((red, blue), gain_ranges(sensor), strict=True):
        np.testing.assert_allclose(
            [float(t) for t in text.split("-")], gains, atol=5e-4
        )
