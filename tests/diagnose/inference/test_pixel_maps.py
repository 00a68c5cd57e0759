# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Maps of the same pixels are told apart, and what is wrong with one cancels."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import READ, SHAPE, capture_of, drawn, frames_of, model_of, on
from diagnose.planted import sensor_of as made

SENSOR = made()
TILE = (1, *SHAPE)
OFFSET, GAIN = READ, 0.02  # standard deviations of what is planted


def planted(seed=3, darks=6, flats=6, offset=OFFSET):
    """Return (frames, offsets, gains) of pixels that differ in both."""
    rng = np.random.default_rng([1, seed])
    offsets = offset * rng.standard_normal(TILE)
    gains = GAIN * rng.standard_normal(TILE)

    def extra(frame, _):
        return offsets + gains * predict(Model(SENSOR), frame).exposed

    captures = [
        capture_of(kind, n, name=f"{kind}{n}", level=level)
        for kind, level, count in (("dark", 0, darks), ("flat", 0.3, flats))
        for n in range(count)
    ]
    frames = drawn(frames_of(SENSOR, captures), Model(SENSOR), seed, extra)
    return frames, offsets, gains


def fitted(frames):
    model = fit_patterns(model_of(SENSOR, prnu=[0.0], dsnu=[0.0]), on(frames))
    return model.term("prnu"), model.term("dsnu")


def test_offsets_and_gains_of_the_same_pixels_are_told_apart():
    frames, offsets, gains = planted()
    keep = frames[0].keep
    for term, truth, sigma in zip(
        fitted(frames), (gains, offsets), (GAIN, OFFSET), strict=True
    ):
        assert term.values[0] == pytest.approx(sigma, rel=0.05)
        alike = np.corrcoef(term.sensor_map.mean[keep], truth[keep])[0, 1]
        assert alike > 0.8


def test_errors_of_two_maps_have_the_covariance_that_is_stated():
    """Flats of one level tell the sum of both: what the offset has too much, the gain
    has too little."""
    frames, offsets, gains = planted(seed=5, darks=1, flats=12)
    keep = frames[0].keep
    gain, offset = fitted(frames)
    of_gain = (gain.sensor_map.mean - gains)[keep]
    of_offset = (offset.sensor_map.mean - offsets)[keep]
    stated = gain.sensor_map.covariance["dsnu"][keep]
    assert (stated < 0).all()
    assert np.mean(of_gain * of_offset) == pytest.approx(stated.mean(), rel=0.15)
    light = predict(Model(SENSOR), frames[-1]).exposed[keep]
    of_frame = of_offset + light * of_gain
    of_each = (one.sensor_map.variance[keep] for one in (offset, gain))
    alone = next(of_each) + light**2 * next(of_each)
    together = alone + 2 * light * stated
    assert np.mean(of_frame**2 / together) == pytest.approx(1, abs=0.08)


def test_the_order_of_terms_does_not_matter():
    frames, _, _ = planted(darks=3, flats=3)
    one = fit_patterns(model_of(SENSOR, prnu=[0.0], dsnu=[0.0]), on(frames))
    other = fit_patterns(model_of(SENSOR, dsnu=[0.0], prnu=[0.0]), on(frames))
    for name in ("prnu", "dsnu"):
        assert one.term(name).values == pytest.approx(other.term(name).values, rel=5e-3)


def test_pixels_that_no_dark_tells_are_as_unsure_as_is_stated():
    """Offsets are told by darks; where all of a pixel's were set aside, its gain is as
    unsure as its offset is, and no gain near it is moved."""
    frames, _, gains = planted(seed=7, offset=5 * OFFSET)
    apart = np.zeros(TILE, bool)
    apart[:, 3::6, 3::6] = True
    masked = [
        replace(f, keep=f.keep & ~apart) if f.capture.kind == "dark" else f
        for f in frames
    ]
    (gain, offset), (unmasked, _) = fitted(masked), fitted(frames)
    there, elsewhere = apart & frames[0].keep, ~apart & frames[0].keep
    moved = (gain.sensor_map.mean - unmasked.sensor_map.mean)[elsewhere]
    assert np.std(moved) < 0.05 * GAIN
    error = (gain.sensor_map.mean - gains)[there]
    assert np.mean(error**2 / gain.sensor_map.variance[there]) == pytest.approx(1, 0.25)
    assert (
        gain.sensor_map.variance[there].min()
        > gain.sensor_map.variance[elsewhere].max()
    )
    both = gain.sensor_map.covariance["dsnu"], offset.sensor_map.covariance["prnu"]
    np.testing.assert_allclose(*both, rtol=1e-6)


UNEVEN = "dark_current_nonuniformity"


@pytest.mark.parametrize("order", [("dsnu", UNEVEN), (UNEVEN, "dsnu")])
def test_offsets_and_rates_of_the_same_pixels_are_told_apart(order):
    """By biases and darks: normal offsets, log-normal rates with their shot noise, and
    errors of both that cancel in what they add up to."""
    rng = np.random.default_rng([2, 11])
    offsets = 0.5 * READ * rng.standard_normal(TILE)
    rates = 0.5 * READ * np.exp(0.8 * rng.standard_normal(TILE))

    def extra(frame, rng):
        charge = frame.seconds * rates
        return (
            offsets + charge + np.sqrt(frame.beta1 * charge) * rng.standard_normal(TILE)
        )

    captures = [
        capture_of("dark", n, exposure_time=seconds)
        for n, seconds in enumerate((0.0, 0.0, 0.0, 1.0, 4.0, 4.0))
    ]
    frames = drawn(frames_of(SENSOR, captures), Model(SENSOR), 8, extra)
    start = model_of(SENSOR, dark_current=[0.5 * READ], **dict.fromkeys(order, [0.0]))
    model = fit_patterns(start, on(frames))
    offset, rate = (model.term(name) for name in ("dsnu", UNEVEN))
    assert offset.values[0] == pytest.approx(0.5 * READ, rel=0.1)
    assert rate.values[0] == pytest.approx(0.5 * READ * np.sinh(0.8), rel=0.1)
    keep = frames[0].keep
    of_offset = (offset.sensor_map.mean - offsets)[keep]
    of_rate = (rate.sensor_map.mean - (rates - 0.5 * READ))[keep]
    for error, term in ((of_offset, offset), (of_rate, rate)):
        stated = term.sensor_map.variance[keep].mean()
        assert np.mean(error**2) == pytest.approx(stated, rel=0.15)
    stated = rate.sensor_map.covariance["dsnu"][keep].mean()
    assert stated < 0
    assert np.mean(of_offset * of_rate) == pytest.approx(stated, rel=0.2)


def test_shot_noise_of_a_rate_beside_offsets_that_darks_hardly_tell():
    """What charge adds to the doubt of a rate goes by the frames with charge, as much
    as each weighs: not by those that tell the offset."""
    rng = np.random.default_rng([3, 12])
    offsets = 2 * READ * rng.standard_normal(TILE)
    rates = READ * np.exp(1.2 * rng.standard_normal(TILE))

    def extra(frame, rng):
        charge = frame.seconds * rates
        shot = np.sqrt(frame.beta1 * charge) * rng.standard_normal(TILE)
        return offsets + charge + shot

    captures = [
        capture_of("dark", n, exposure_time=seconds)
        for n, seconds in enumerate((0.0, 0.0, 3.0, 3.0))
    ]
    frames = drawn(frames_of(SENSOR, captures), Model(SENSOR), 9, extra)
    maps = {"dsnu": [0.0], UNEVEN: [0.0]}
    model = fit_patterns(model_of(SENSOR, dark_current=[READ], **maps), on(frames))
    found = model.term(UNEVEN).sensor_map
    error = found.mean - (rates - READ)
    keep = frames[0].keep
    order = np.argsort(found.mean[keep])
    for part in np.array_split(order, 4):
        doubt = found.variance[keep][part].mean()
        assert np.mean(error[keep][part] ** 2) == pytest.approx(doubt, rel=0.15)
