# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What differs between repeats is noise: what a mean lacks is none of it."""

import numpy as np
import pytest

from cg2raw.diagnose.inference.repeats import difference, evidence_of_noise, repeats
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.likelihood import log_density
from cg2raw.diagnose.likelihood.model import Model
from diagnose.planted import ONE, READ, SHAPE, capture_of, drawn, frames_of, model_of
from diagnose.planted import sensor_of as made

SENSOR = made()
BARE = Model(SENSOR)
# Neighbours correlate by it as by a coefficient of 0.03: slow waves across columns.
WAVE = np.broadcast_to(0.25 * READ * np.sin(np.arange(SHAPE[1]) / 5), (1, *SHAPE))


def splits_of(extra, darks=12):
    """Return select frames of noise, with something besides."""
    captures = [
        capture_of("dark", n, name=f"dark{n}", group="select") for n in range(darks)
    ]
    frames = drawn(frames_of(SENSOR, captures), BARE, 5, extra)
    return Splits(frames, ONE)


def gains(splits, coefficient=0.03):
    """Return (nats that the frames gain by a correlation, what repeats say of that)."""
    model = model_of(SENSOR, read_noise_correlation=[coefficient])
    gain = splits.select.total(model) - splits.select.total(BARE)
    return gain, evidence_of_noise(model, BARE, splits)


def test_a_difference_has_the_noise_of_one_frame_and_no_structure():
    frames = splits_of(WAVE).select.frames
    wavy, flat = (
        log_density(BARE, frame)[1][0]
        for frame in (frames[0], difference(BARE, (frames[0], frames[1])))
    )
    assert np.var(flat) == pytest.approx(1, abs=0.05)
    across = np.std(wavy.mean(0)), np.std(flat.mean(0))
    assert across[0] > 1.5 * across[1]
    assert across[1] == pytest.approx(1 / np.sqrt(SHAPE[0]), rel=0.25)


def test_structure_that_a_mean_lacks_is_no_correlation():
    gain, evidence = gains(splits_of(WAVE))
    assert gain > 15
    assert evidence < 0


def shared_by_neighbours(frame, rng):
    """Return noise that adds 0.12 to the variance of read noise, and half of that to
    the covariance of neighbours."""
    own = np.sqrt(0.06) * READ * rng.standard_normal((1, SHAPE[0], SHAPE[1] + 1))
    return own[..., 1:] + own[..., :-1]


def test_noise_that_correlates_is_seen_in_differences():
    """As much as in the frames, but for chance."""
    gain, evidence = gains(splits_of(shared_by_neighbours), 0.055)
    assert gain > 60
    assert evidence == pytest.approx(gain, rel=0.35)


def test_frames_that_nothing_repeats_count_as_they_are():
    splits = splits_of(WAVE, darks=1)
    assert [len(members) for members in repeats(splits.select.frames)] == [1]
    assert gains(splits)[1] is None
    three = splits_of(WAVE, darks=3)
    gain, evidence = gains(three)
    alone = gains(Splits([three.select.frames[2]], ONE))[0]
    pair = evidence - alone
    assert alone < gain
    assert pair < gain - alone
