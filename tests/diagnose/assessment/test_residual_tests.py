# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Residual tests: silent without a gap, and each rings for what it asks."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import kstest

from cg2raw.diagnose.assessment.residual_tests import residual_tests
from cg2raw.diagnose.captures.splits import third
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    READ,
    capture_of,
    captures_of,
    cut_at_zero,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
)

SENSOR = sensor_of()
ALARM = 1e-3 / 36


KINDS = ("dark", "dark", "flat", "flat", "scene", "scene")


@pytest.fixture(scope="module")
def frames():
    return frames_of(SENSOR, captures_of(KINDS, "report"))


def p_values(frames, model=None):
    tests = residual_tests(model or Model(SENSOR), on(frames), on([]))
    return {test.name: test.p_value for test in tests}


def test_p_values_of_frames_without_a_gap_are_uniform(frames):
    """All tests of 12 sets; the few that share pixels hardly depend on each other."""
    every = [p_values(drawn(frames, Model(SENSOR), seed)) for seed in range(12)]
    for name in every[0]:
        several = [one[name] for one in every]
        assert min(several) > 1e-5, name
        assert kstest(several, "uniform").pvalue > 1e-4, name
    together = np.concatenate([list(one.values()) for one in every])
    assert kstest(together, "uniform").pvalue > 1e-3


def test_statistics_without_a_gap_have_the_variance_they_say(frames):
    """Those that are in standard deviations, of 60 sets: within 5 errors of 1."""
    scalar = ("skewness", "kurtosis", "autocorrelation", "edge", "fixed")
    found = {}
    for seed in range(60):
        shown = drawn(frames, Model(SENSOR), 100 + seed)
        for test in residual_tests(Model(SENSOR), on(shown), on([])):
            if test.name.startswith(scalar):
                found.setdefault(test.name, []).append(test.statistic)
    assert len(found) == 17
    for name, statistics in found.items():
        assert np.var(statistics) == pytest.approx(1, abs=0.85), name


def site(frame, wanted):
    return (frame.site == wanted)[None]


def blobs(frame, rng):
    rows, cols = frame.tiles.rows_and_columns()
    return ((rows // 16 + cols // 24) % 2 - 0.5) * np.ones(frame.signal.shape)


def coarse(frame, rng):
    """Noise of same-colour neighbours: (z + its neighbour) without new variance."""
    noise = rng.standard_normal(frame.signal.shape)
    return noise + np.roll(noise, 2, -1)


def skewed(frame, rng):
    return rng.exponential(1.0, frame.signal.shape) - 1.0


def tails(frame, rng):
    return rng.standard_t(5, frame.signal.shape)


def radial(frame, rng):
    u, v = frame.tiles.field()
    return u * u + v * v


def edge(axis):
    def slope(frame, rng):
        green = frame.camera[:, 1].astype(float)
        return np.gradient(green, axis=axis) / READ

    return slope


def bend(down, across, right):
    """Return a sum of second derivatives."""

    def bends(frame, rng):
        slopes = np.gradient(frame.camera[:, 1].astype(float), axis=(1, 2))
        (dd, dr), (_, rr) = (np.gradient(slope, axis=(1, 2)) for slope in slopes)
        return (down * dd + across * dr + right * rr) / READ

    return bends


def towards_the_corner(frame, rng):
    u, v = frame.tiles.field()
    return edge(1)(frame, rng) * v + edge(2)(frame, rng) * u


def one_pattern(shape_of):
    def fixed(frame, rng):
        same = np.random.default_rng(77)
        return same.standard_normal(shape_of(frame))

    return fixed


def anew(shape_of):
    return lambda frame, rng: rng.standard_normal(shape_of(frame))


# What is added, in read noises, and the tests that ring for it.
STRUCTURES = {
    "channel mean": (lambda f, r: site(f, 2) * 1.0, 0.3),
    "radius mean": (radial, 0.5),
    "level mean": (lambda f, r: f.camera[:, 1] > 0.2, 0.5),
    "tile mean": (blobs, 0.4),
    "tile mean, each frame": (lambda f, r: blobs(f, r) * r.choice([-1, 1]), 0.5),
    "row mean": (one_pattern(lambda f: (1, f.tiles.size[0], 1)), 0.3),
    "row mean, each frame": (anew(lambda f: (1, f.tiles.size[0], 1)), 0.3),
    "column mean": (one_pattern(lambda f: (1, 1, f.tiles.size[1])), 0.3),
    "frame mean": (anew(lambda f: ()), 0.2),
    "channel variance": (lambda f, r: site(f, 1) * r.normal(size=f.signal.shape), 1.0),
    "radius variance": (lambda f, r: radial(f, r) * r.normal(size=f.signal.shape), 2.0),
    "level variance": (
        lambda f, r: (f.camera[:, 1] < 0.01) * r.normal(size=f.signal.shape),
        0.7,
    ),
    "row variance": (
        lambda f, r: (np.arange(64)[:, None] % 16 == 5) * r.normal(size=f.signal.shape),
        2.0,
    ),
    "frame variance": (
        lambda f, r: (f.capture.kind == "dark") * r.normal(size=f.signal.shape),
        0.7,
    ),
    "autocorrelation (0, 2)": (coarse, 0.7),
    "skewness": (skewed, 1.5),
    "kurtosis": (tails, 1.5),
    "edge: vertical": (edge(1), 0.02),
    "edge: horizontal": (edge(2), 0.02),
    "edge: Laplacian": (bend(1, 0, 1), 0.05),
    "edge: upright blur": (bend(1, 0, -1), 0.05),
    "edge: diagonal blur": (bend(0, 1, 0), 0.1),
    "edge: radial": (towards_the_corner, 0.08),
    "fixed pattern: the same pixel in all frames": (
        one_pattern(lambda f: f.signal.shape),
        0.5,
    ),
}


def test_pixels_that_should_be_at_white_and_are_not_ring():
    frames = frames_of(SENSOR, captures_of(KINDS, "report"))
    name = "white: pixels that should have reached it"
    bright = model_of(SENSOR, exposure=[2.0])
    assert name not in p_values(drawn(frames, bright, 4), bright)
    clipped = model_of(SENSOR, exposure=[2.0], full_well=[0.1])
    assert p_values(drawn(frames, clipped, 4), bright)[name] < ALARM


@pytest.mark.parametrize("name", STRUCTURES)
def test_a_structure_rings_its_test(frames, name):
    structure, size = STRUCTURES[name]

    def extra(frame, rng):
        return size * READ * structure(frame, rng)

    ringing = p_values(drawn(frames, Model(SENSOR), 40, extra))
    assert ringing[name] < ALARM


def bright(frame, rng):
    return 2.0 * (predict(Model(SENSOR), frame).exposed > 0.16) - 1


@pytest.mark.parametrize(
    ("name", "structure", "sites"),
    [("radius", radial, (3, 0)), ("tile", blobs, (3, 0)), ("level", bright, (1, 2))],
)
def test_opposite_signs_at_two_sites_ring_by_channel(frames, name, structure, sites):
    """Such as a red that falls towards the corners and a blue that rises."""

    def extra(frame, rng):
        sign = 1.0 * site(frame, sites[0]) - site(frame, sites[1])
        spread = np.sqrt(predict(Model(SENSOR), frame).variance)
        return 0.3 * spread * sign * structure(frame, rng)

    found = p_values(drawn(frames, Model(SENSOR), 51, extra))
    assert found[f"{name} by channel mean"] < ALARM
    assert found[f"{name} mean"] > 1e-3


def test_every_test_says_where(frames):
    for test in residual_tests(Model(SENSOR), on(frames), on([])):
        assert test.where != test.name
        assert ("by site of the CFA" in test.where) == ("by channel" in test.name)


def test_every_autocorrelation_has_its_lag(frames):
    for down, right in ((0, 1), (1, 0), (1, 1), (2, 0), (2, 2)):

        def shifted(frame, rng, down=down, right=right):
            noise = rng.standard_normal(frame.signal.shape)
            return 0.7 * READ * (noise + np.roll(noise, (down, right), (1, 2)))

        found = p_values(drawn(frames, Model(SENSOR), 41, shifted))
        name = f"autocorrelation ({down}, {right})"
        assert found[name] < ALARM
        others = [n for n in found if n.startswith("autocorrelation") and n != name]
        assert min(found[n] for n in others) > 1e-4


def test_row_noise_that_the_model_has_is_silent(frames):
    def rows(frame, rng):
        return 0.5 * READ * rng.standard_normal((1, frame.tiles.size[0], 1))

    shown = drawn(frames, Model(SENSOR), 43, rows)
    assert min(p_values(shown).values()) < 1e-9
    assert min(p_values(shown, model_of(SENSOR, row_noise=[0.5])).values()) > ALARM


def test_frames_of_another_shape_are_tested_too(frames):
    """Masked borders come first in a list; their frames are not all there is."""
    border = capture_of("dark", 9, shape=(64, 20), group="report")
    mixed = [*frames_of(SENSOR, [border]), *frames]

    def at_site(frame, rng):
        wide = frame.tiles.shape[1] > 20
        return 0.3 * READ * wide * site(frame, 2)

    assert p_values(drawn(mixed, Model(SENSOR), 44, at_site))["channel mean"] < ALARM

    def in_border(frame, rng):
        narrow = frame.tiles.shape[1] == 20
        return 1.5 * READ * narrow * site(frame, 2)

    assert p_values(drawn(mixed, Model(SENSOR), 45, in_border))["channel mean"] < ALARM
    assert min(p_values(drawn(mixed, Model(SENSOR), 46)).values()) > ALARM


def test_pixels_that_do_not_count_are_not_asked():
    mask = third((64, 96), "report")
    made = frames_of(SENSOR, captures_of(KINDS, "report", mask=lambda: mask))
    shown = drawn(made, Model(SENSOR), 47)
    spoilt = [replace(f, signal=np.where(f.keep, f.signal, 0.4)) for f in shown]
    assert p_values(spoilt) == pytest.approx(p_values(shown), rel=1e-9)
    assert min(p_values(shown).values()) > ALARM


def test_a_first_frame_with_another_mask_hides_no_pattern():
    """Pixels that the first frame lacks are compared between the others."""
    empty = capture_of(
        "dark", 60, group="report", mask=lambda: np.zeros((64, 96), bool)
    )
    made = frames_of(SENSOR, [empty, *captures_of(KINDS, "report")])
    pattern = READ * np.random.default_rng(5).standard_normal(made[0].signal.shape)
    shown = drawn(made, Model(SENSOR), 48, lambda frame, rng: pattern)
    assert p_values(shown)["fixed pattern: the same pixel in all frames"] < 1e-9


@pytest.mark.parametrize("black", [0.0, 4.0])
def test_darks_that_are_clipped_at_zero_are_no_structure(black):
    """A camera without a pedestal shows half of a dark's noise."""
    sensor = sensor_of(black_level=[black] * 4)
    made = frames_of(sensor, captures_of(KINDS, "report"))
    shown = cut_at_zero(drawn(made, Model(sensor), 49), black)
    assert shown[0].at_zero.mean() > 0.2
    tests = residual_tests(Model(sensor), on(shown), on([]))
    assert min(test.p_value for test in tests) > ALARM


def test_noise_that_is_too_large_is_no_fixed_pattern(frames):
    def more(frame, rng):
        return READ * rng.standard_normal(frame.signal.shape)

    found = p_values(drawn(frames, Model(SENSOR), 50, more))
    assert found["frame variance"] < ALARM
    assert found["fixed pattern: the same pixel in all frames"] > 1e-4
