# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tails: residuals count as wide as they likely are."""

import numpy as np
import pytest

from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from cg2raw.diagnose.likelihood.tails import Tails, tails_in
from diagnose.planted import capture_of, frames_of, model_of, sensor_of

SENSOR = sensor_of()
SHARE, RATIO = 0.05, 16.0


def test_noise_without_tails_has_none():
    [frame] = frames_of(SENSOR, [capture_of("dark", 1)])
    assert tails_in(Model(SENSOR), frame, predict(Model(SENSOR), frame)) is None


def test_both_kinds_together_have_the_variance_of_all():
    model = model_of(SENSOR, heavy_tailed_noise=[SHARE, RATIO])
    [frame] = frames_of(SENSOR, [capture_of("flat", 1)])
    p = predict(model, frame)
    tails = tails_in(model, frame, p)
    whole = (1 - tails.outlying) * tails.narrow + tails.outlying * tails.wide
    assert whole == pytest.approx(p.variance)


@pytest.mark.parametrize(("away", "kind"), [(0.0, "narrow"), (20.0, "wide")])
def test_what_lies_far_out_counts_as_wide(away, kind):
    tails = Tails(SHARE, np.ones(5), np.full(5, RATIO))
    counted = tails.variance_of(np.full(5, away))
    assert counted == pytest.approx(getattr(tails, kind), rel=0.02)


def test_noise_of_charge_that_is_known_is_no_tail():
    """A residual of 6 is far out of noise of 1, and not out of such with 20 more."""
    tails = Tails(SHARE, np.ones(5), np.full(5, RATIO))
    away = np.full(5, 6.0)
    assert tails.variance_of(away) == pytest.approx(tails.wide, rel=0.05)
    assert tails.variance_of(away, 20.0) == pytest.approx(tails.narrow, rel=0.1)
    assert tails.variance_of(np.zeros(5), -2.0) == pytest.approx(tails.narrow, rel=0.1)


def test_means_of_what_counts_so_are_nearer_than_plain_ones():
    rng = np.random.default_rng(8)
    shape = (8, 20_000)
    wide = rng.random(shape) < SHARE
    x = rng.standard_normal(shape) * np.where(wide, np.sqrt(RATIO), 1.0)
    weight = 1 / Tails(SHARE, np.ones(1), np.full(1, RATIO)).variance_of(x)
    mean = (weight * x).sum(0) / weight.sum(0)
    assert mean.var() < 0.75 * x.mean(0).var()
