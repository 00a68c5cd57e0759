# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The likelihood of frames: censored pixels, residuals, sums."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import kstest, norm

from cg2raw.diagnose.likelihood.censoring import LARGEST_Z, residuals, scores
from cg2raw.diagnose.likelihood.likelihood import Likelihood, log_density
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from cg2raw.diagnose.likelihood.workers import Workers
from diagnose.planted import (
    capture_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
)

SENSOR = sensor_of()


@pytest.fixture(scope="module")
def frames():
    captures = [capture_of(kind) for kind in ("dark", "flat", "scene")]
    made = drawn(frames_of(SENSOR, captures), Model(SENSOR), 1)
    return [without_steps(frame) for frame in made]


def without_steps(frame):
    """Return a frame whose DN are spread over their step: normal distributions are
    tested to less than that."""
    rng = np.random.default_rng(9)
    more = (rng.random(frame.signal.shape) - 0.5) / frame.range
    return replace(frame, signal=frame.signal + more)


def clipped(frame, black, white):
    """Return a frame whose ADC ends at two signals."""
    signal = np.clip(frame.signal, black, white)
    return replace(
        frame, signal=signal, at_zero=signal <= black, at_white=signal >= white
    )


def test_residuals_of_drawn_frames_are_standard_normal(frames):
    for frame in frames:
        _, z, _ = log_density(Model(SENSOR), frame)
        assert kstest(z[frame.keep], norm.cdf).pvalue > 1e-3


@pytest.mark.parametrize("end", ["black", "white"])
def test_residuals_of_censored_pixels_are_standard_normal(frames, end):
    """Half of a dark's, or a third of a flat's pixels reach an end of the ADC."""
    frame = frames[0] if end == "black" else frames[1]
    p = predict(Model(SENSOR), frame)
    level = p.mean.mean() + (0 if end == "black" else 0.5) * np.sqrt(p.variance.mean())
    cut = clipped(frame, level, 9) if end == "black" else clipped(frame, -9, level)
    assert 0.15 < cut.censored.mean() < 0.7
    z = residuals(p, cut)
    assert kstest(z[cut.keep], norm.cdf).pvalue > 1e-3
    unlike = np.where(cut.censored, (cut.signal - p.mean) / np.sqrt(p.variance), z)
    assert kstest(unlike[cut.keep], norm.cdf).pvalue < 1e-9


def test_probabilities_of_a_censored_pixel_add_up_to_one(frames):
    """Density between the ends, in DN, and what lies beyond them."""
    frame = frames[1]
    p = predict(Model(SENSOR), frame)
    spread = np.sqrt(p.variance)
    ends = p.mean - 0.7 * spread, p.mean + 1.1 * spread
    points = np.linspace(0, 1, 201)
    inside = []
    for point in points:
        signal = ends[0] + point * (ends[1] - ends[0])
        nowhere = np.zeros(signal.shape, bool)
        one = replace(frame, signal=signal, at_white=nowhere, at_zero=nowhere)
        inside.append(np.exp(log_density(Model(SENSOR), one)[0]))
    width = (ends[1] - ends[0]) * frame.range
    middle = np.trapezoid(inside, points, axis=0) * width
    beyond = 0.0
    for end, name in zip(ends, ("at_zero", "at_white"), strict=True):
        flags = {"at_zero": nowhere, "at_white": nowhere, name: ~nowhere}
        half = (0.5 if name == "at_white" else -0.5) / frame.range  # what is rounded
        one = replace(frame, signal=end + half, **flags)
        beyond = beyond + np.exp(log_density(Model(SENSOR), one)[0])
    assert (middle + beyond)[frame.keep] == pytest.approx(1, abs=1e-4)


def test_an_impossible_pixel_has_a_bounded_weight(frames):
    frame = frames[0]
    signal = frame.signal.copy()
    signal[0, 20, 20] = 1.0
    white = np.zeros(signal.shape, bool)
    white[0, 20, 20] = True
    density, z, _ = log_density(
        Model(SENSOR), replace(frame, signal=signal, at_white=white)
    )
    assert density[0, 20, 20] == -200
    assert np.isfinite(z).all()
    assert z[0, 20, 20] > LARGEST_Z


@pytest.fixture
def both_ends(frames):
    """Return (frame that is cut at both ends, prediction some pixels of which lie up to
    6 standard deviations from what is shown)."""
    p = predict(Model(SENSOR), frames[1])
    spread = np.sqrt(p.variance)
    cut = clipped(frames[1], *(p.mean.mean() + x * spread.mean() for x in (-0.7, 0.8)))
    assert cut.at_white.mean() > 0.1 and cut.at_zero.mean() > 0.1
    far = np.linspace(-6, 6, p.mean.shape[-1])
    return cut, replace(p, mean=p.mean + far * spread)


def densities(frame, p, by_mean=0.0, by_log_variance=0.0):
    """Return log densities of pixels whose prediction has moved, the mean in standard
    deviations."""
    mean = p.mean + by_mean * np.sqrt(p.variance)
    at = replace(p, mean=mean, variance=p.variance * np.exp(by_log_variance))
    return log_density(Model(SENSOR), frame, at)[0]


def derivative(heights, step):
    return (heights(step) - heights(-step)) / (2 * step)


def test_scores_are_derivatives_of_the_log_density(both_ends):
    frame, p = both_ends
    z, square, weight = scores(p, frame)
    by_mean = derivative(lambda x: densities(frame, p, by_mean=x), 1e-4)
    by_variance = derivative(lambda x: densities(frame, p, by_log_variance=x), 1e-4)
    assert (z * weight)[frame.keep] == pytest.approx(by_mean[frame.keep], abs=1e-5)
    variance = (square / np.sqrt(2))[frame.keep]
    assert variance == pytest.approx(by_variance[frame.keep], abs=1e-4)


def test_the_weight_of_a_pixel_is_the_root_of_its_information(both_ends):
    frame, p = both_ends
    weight = scores(p, frame)[2]
    assert (weight[~frame.censored] == 1).all()
    middle = densities(frame, p)
    bend = 2 * middle - densities(frame, p, 1e-3) - densities(frame, p, -1e-3)
    told = (bend / 1e-6)[frame.censored]
    assert weight[frame.censored] ** 2 == pytest.approx(told, rel=1e-3, abs=1e-5)
    assert told.min() < 0.01 and told.max() > 0.9


def test_scores_of_drawn_frames_are_as_large_as_their_information(both_ends):
    """Under the true model their means are 0, and their squares the information."""
    frame, _ = both_ends
    p = predict(Model(SENSOR), frame)
    z, square, weight = (part[frame.keep] for part in scores(p, frame))
    error = 1 / np.sqrt(z.size)
    assert (z * weight).mean() == pytest.approx(0, abs=4 * error)
    assert ((z * weight) ** 2).mean() == pytest.approx((weight**2).mean(), abs=0.06)
    assert square.mean() == pytest.approx(0, abs=4 * error)


def test_density_is_in_dn(frames):
    """A pixel's density is that of its DN: the normal's over the range."""
    frame = frames[1]
    density, _, p = log_density(Model(SENSOR), frame)
    dn = frame.signal * frame.range
    expected = norm.logpdf(dn, p.mean * frame.range, np.sqrt(p.variance) * frame.range)
    assert density == pytest.approx(expected, abs=1e-9)


def test_sums_count_what_is_kept_alone(frames):
    model = model_of(SENSOR, row_noise=[0.2])
    whole = on(frames).total(model)
    keep = [f.keep.copy() for f in frames]
    keep[2][:, 20:30, 40:60] = False
    masked = [replace(f, keep=k) for f, k in zip(frames, keep, strict=True)]
    wild = frames[2].signal.copy()
    wild[:, 20:30, 40:60] = 0.9
    spoilt = [*masked[:2], replace(masked[2], signal=wild)]
    assert on(masked).total(model) != whole
    assert on(spoilt).total(model) == pytest.approx(on(masked).total(model))


def test_blocks_and_threads_add_up(frames):
    model = model_of(SENSOR, row_noise=[0.2])
    whole = on(frames).total(model)
    assert on(frames).in_blocks(model).sum() == pytest.approx(whole)
    assert Likelihood(frames, Workers(3)).total(model) == whole
    known = [predict(model, frame) for frame in frames]
    assert on(frames).total(model, known) == whole


def test_the_true_model_is_the_best(frames):
    best = on(frames).total(Model(SENSOR))
    others = (
        {"read_noise": [0.2]},
        {"shot_noise": [-0.2]},
        {"exposure": [0.01]},
        {"black_level": [1e-3] * 4},
        {"row_noise": [0.3]},
        {"heavy_tailed_noise": [0.05, 9.0]},
        {"noise_reduction": [0.1, 0.0]},
    )
    for terms in others:
        assert on(frames).total(model_of(SENSOR, **terms)) < best - 3, terms
