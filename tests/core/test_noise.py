# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""random.h and the noise of a simulation: planted values come back."""

import math

import numpy as np
import pytest

import cg2raw
from oracles import cameras, philox
from tiers import slow

SIDE = 2048  # 4 MP, a million pixels per CFA site
BETA1 = [2.0e-4, 1.0e-4, 1.5e-4, 3.0e-4]
BETA2 = [4.0e-6, 1.0e-5, 6.0e-6, 2.0e-5]
# From 8 sigma above black to 8 sigma below white: nothing clips.
LEVELS = (0.04, 0.08, 0.3, 0.6, 0.85)


def sensor_of(**fields):
    noise = [
        {"iso": 100, "beta1": BETA1, "beta2": BETA2},
        {
            "iso": 1600,
            "beta1": [16 * b for b in BETA1],
            "beta2": [64 * b for b in BETA2],
        },
    ]
    fields = {"noise": noise, "black_level": [512, 520, 530, 540], **fields}
    return cg2raw.Sensor.from_json(cameras.profile_text(**fields))


def flat(level, side=SIDE):
    return np.full((side, side, 3), level, np.float32)


def sites(raw):
    return [np.asarray(raw, float)[r::2, c::2] for r in (0, 1) for c in (0, 1)]


@pytest.mark.parametrize(("counter", "key", "words"), philox.KNOWN_ANSWERS)
def test_philox_known_answers(counter, key, words):
    assert tuple(cg2raw.philox_words(counter=counter, key=key)) == words


def test_philox_equals_the_oracle():
    rng = np.random.default_rng(2)
    for _ in range(200):
        drawn = [int(v) for v in rng.integers(0, 2**32, 6)]
        seen = tuple(cg2raw.philox_words(counter=drawn[:4], key=drawn[4:]))
        assert seen == philox.words(drawn[:4], drawn[4:])


def measured(sensor, iso):
    """Per CFA site: levels x (mean, variance) above black, as measured on the DN."""
    span = sensor.white_level - np.array(sensor.black_level)
    table = np.empty((4, len(LEVELS), 2))
    for i, level in enumerate(LEVELS):
        raw = sensor.simulate(
            flat(level), illuminant="A", iso=iso, seed=i, camera_input=True
        )
        assert raw.min() > 0 and raw.max() < sensor.white_level, "a clipped pixel"
        for site, dn in enumerate(sites(raw)):
            rounding = 1.0 / 12.0  # variance of the quantisation, DN^2
            table[site, i, 0] = (dn.mean() - sensor.black_level[site]) / span[site]
            table[site, i, 1] = (dn.var() - rounding) / span[site] ** 2
    return table


def fitted(mean, variance):
    """beta1, beta2 of variance = beta1 mean + beta2; a variance's own error is
    in proportion to it."""
    design = np.stack([mean, np.ones_like(mean)], axis=1) / variance[:, None]
    return np.linalg.lstsq(design, np.ones_like(mean), rcond=None)[0]


@pytest.mark.parametrize("cfa", ["GBRG", slow("RGGB")])
def test_flats_give_back_beta1_and_beta2_per_site(cfa):
    table = measured(sensor_of(cfa=cfa), iso=100)
    for site in range(4):
        mean, variance = table[site].T
        sd = np.sqrt(variance / (SIDE / 2) ** 2)
        assert (np.abs(mean - LEVELS) < 5.0 * sd + 2e-7).all(), "biased"
        beta1, beta2 = fitted(mean, variance)
        assert beta1 == pytest.approx(BETA1[site], rel=0.01)
        assert beta2 == pytest.approx(BETA2[site], rel=0.01)


@pytest.mark.parametrize("cfa", [cameras.QUAD, cameras.X_TRANS])
@pytest.mark.parametrize("shape", [(1200, 1200), (1203, 1199)])
def test_each_site_of_a_larger_cfa_has_its_own_noise(cfa, shape):
    random = np.random.default_rng(7)
    beta1, beta2 = (
        random.uniform(low, 5 * low, len(cfa)).tolist() for low in (1e-4, 1e-5)
    )
    noise = [{"iso": 100, "beta1": beta1, "beta2": beta2}]
    sensor = sensor_of(cfa=cfa, black_level=512, noise=noise)
    side = math.isqrt(len(cfa))
    for level in (0.05, 0.6):
        rgb = np.full((*shape, 3), level, np.float32)
        seen = sensor.signal(rgb, illuminant="A", iso=100, camera_input=True)
        for site in range(len(cfa)):
            x = np.asarray(seen, float)[site // side :: side, site % side :: side]
            variance = beta1[site] * level + beta2[site]
            error = 5.0 * np.sqrt(2.0 / x.size)
            assert x.mean() == pytest.approx(
                level, abs=5.0 * np.sqrt(variance / x.size)
            )
            assert x.var() == pytest.approx(variance, rel=error), site


def test_a_larger_repeat_of_bayer_is_bayer():
    """The same sensor said in 2 x 2 and in 4 x 4 and 6 x 6: the same bytes."""
    rows = {}
    for times in (1, 2, 3):

        def tiled(sites, times=times):
            return np.tile(np.reshape(sites, (2, 2)), (times, times)).ravel().tolist()

        noise = [{"iso": 100, "beta1": tiled(BETA1), "beta2": tiled(BETA2)}]
        sensor = sensor_of(
            cfa="".join(tiled(list("GRBG"))),
            black_level=tiled([512, 520, 530, 540]),
            noise=noise,
        )
        rows[times] = small(sensor, seed=2)
    assert (rows[1] == rows[2]).all() and (rows[1] == rows[3]).all()


def test_noise_of_an_iso_between_the_calibrated_ones():
    sensor = sensor_of()
    expected = sensor.noise_at(400)
    assert expected["beta1"] == pytest.approx([4 * b for b in BETA1])
    assert expected["beta2"] == pytest.approx([8 * b for b in BETA2])
    for level in (0.2, 0.6):
        rgb = flat(level)
        raw = sensor.signal(rgb, illuminant="A", iso=400, camera_input=True)
        for site, x in enumerate(sites(raw)):
            variance = expected["beta1"][site] * level + expected["beta2"][site]
            assert x.var() == pytest.approx(variance, rel=0.01)


@pytest.fixture(scope="module")
def normals():
    """Noise over its standard deviation, (1024, 1024), all sites alike."""
    noise = [{"iso": 100, "beta1": [0.0] * 4, "beta2": [1e-4] * 4}]
    sensor = sensor_of(noise=noise)
    rgb = flat(0.5, 1024)
    seen = sensor.signal(rgb, illuminant="A", iso=100, seed=3, camera_input=True)
    return (np.asarray(seen, float) - 0.5) / 1e-2


def test_noise_is_gaussian(normals):
    n = normals.size
    assert abs(normals.mean()) < 5.0 / np.sqrt(n)
    assert normals.var() == pytest.approx(1.0, abs=5.0 * np.sqrt(2.0 / n))
    assert (normals**3).mean() == pytest.approx(0.0, abs=5.0 * np.sqrt(15.0 / n))
    assert (normals**4).mean() == pytest.approx(3.0, abs=5.0 * np.sqrt(96.0 / n))
    assert 4.2 < np.abs(normals).max() < 6.5
    # Quantiles of a normal. Source: any table of the error function.
    for sigma, share in [(1.0, 0.158655), (2.0, 0.022750), (3.0, 0.0013499)]:
        for tail in ((normals > sigma).mean(), (normals < -sigma).mean()):
            assert tail == pytest.approx(share, abs=5.0 * np.sqrt(share / n))


def test_noise_is_white(normals):
    """No correlation with any neighbour, nor along rows or columns."""
    n = normals.size
    for row in range(0, 4):
        for col in range(-4, 5):
            if (row, col) <= (0, 0):
                continue
            other = np.roll(normals, (row, col), (0, 1))
            assert abs((normals * other).mean()) < 5.0 / np.sqrt(n), (row, col)
    for axis in (0, 1):
        means = normals.mean(axis=axis)
        assert means.var() * normals.shape[axis] == pytest.approx(1.0, abs=0.25)


def small(sensor, **run):
    rgb = np.random.default_rng(1).uniform(0, 0.9, (301, 403, 3)).astype(np.float32)
    return np.asarray(sensor.simulate(rgb, illuminant="A", iso=100, **run))


def test_bytes_do_not_depend_on_the_threads():
    sensor = sensor_of()
    one = small(sensor, seed=9, threads=1)
    for threads in (2, 8, 0):
        assert small(sensor, seed=9, threads=threads).tobytes() == one.tobytes()


def test_noise_of_a_pixel_does_not_depend_on_the_image_around_it():
    sensor = sensor_of()
    large = np.random.default_rng(1).uniform(0, 0.9, (64, 600, 3)).astype(np.float32)
    whole = sensor.simulate(large, illuminant="A", iso=100, seed=4)
    part = sensor.simulate(large[:33, :421], illuminant="A", iso=100, seed=4)
    assert (np.asarray(whole)[:33, :421] == np.asarray(part)).all()


def test_seed_frame_and_sensor_key_the_noise():
    sensor, other = sensor_of(), sensor_of(id="another-sensor")
    base = small(sensor, seed=1, frame=1)
    assert (base == small(sensor, seed=1, frame=1)).all()
    for different in (
        small(sensor, seed=2, frame=1),
        small(sensor, seed=1, frame=2),
        small(sensor, seed=2**40 + 1, frame=1),
        small(sensor, seed=1, frame=2**40 + 1),
        small(other, seed=1, frame=1),
    ):
        assert (base == different).mean() < 0.1


def test_frames_are_independent():
    sensor = sensor_of()
    rgb = flat(0.5, 512)
    frames = [
        np.asarray(
            sensor.signal(rgb, illuminant="A", iso=100, frame=f, camera_input=True),
            float,
        )
        - 0.5
        for f in (0, 1)
    ]
    correlation = (frames[0] * frames[1]).mean() / (frames[0].std() * frames[1].std())
    assert abs(correlation) < 5.0 / 512.0


def test_no_iso_no_noise():
    sensor = sensor_of()
    rgb = flat(0.5, 64)
    seen = np.asarray(sensor.signal(rgb, illuminant="A", camera_input=True))
    assert (seen == np.float32(0.5)).all()


def test_dark_pixels_have_read_noise_only():
    sensor = sensor_of()
    dark = flat(0.0, 1024)
    seen = sensor.signal(dark, illuminant="A", iso=100, camera_input=True)
    for site, x in enumerate(sites(seen)):
        assert x.var() == pytest.approx(BETA2[site], rel=0.02)
        assert x.min() < 0.0, "noise is not clamped before the levels"


def test_negative_signal_has_read_noise_only():
    sensor = sensor_of()
    seen = sensor.signal(flat(-0.5, 512), illuminant="A", iso=100, camera_input=True)
    for site, x in enumerate(sites(seen)):
        assert x.var() == pytest.approx(BETA2[site], rel=0.05)


@pytest.mark.parametrize("level", [1.0, 1.5, 50.0])
def test_saturated_pixels_are_white_whatever_the_noise(level):
    raw = sensor_of().simulate(flat(level), illuminant="A", iso=3200, seed=3)
    assert (raw == sensor_of().white_level).all()


def test_noise_of_the_paper_falls_on_white_too():
    run = {"illuminant": "A", "iso": 3200, "seed": 3, "convention": "paper"}
    seen = sensor_of().signal(flat(2.0), **run)
    assert 0.3 < (seen < 1.0).mean() < 0.7


def test_noise_begins_just_below_the_signal_that_is_clipped():
    """At 0.99999, the bound, a site stays; at the number before it, it does not."""
    bound = np.float32(0.99999)
    sensor = cg2raw.Sensor("canon-5d-mark-iv")
    for level, stays in ((bound, True), (np.nextafter(bound, np.float32(0)), False)):
        flat = np.full((8, 8), level, np.float32)
        assert np.array_equal(sensor.add_noise(flat, iso=800), flat) == stays
