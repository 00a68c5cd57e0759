# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Maps come where a sensor has them: a full pixel shows nothing of what filled it."""

import numpy as np
import pytest

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.inference.drawn_frames import drawn_frames
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.likelihood import log_density
from cg2raw.diagnose.likelihood.model import Term
from cg2raw.diagnose.likelihood.prediction import predict, shot_noise_left_out
from diagnose.planted import (
    BY_NAME,
    ONE,
    READ,
    SHAPE,
    capture_of,
    captures_of,
    frames_of,
    model_of,
    sensor_of,
)

WELL = 0.55
TAILS = {"heavy_tailed_noise": [0.03, 20.0]}
BLENDED = {"noise_reduction": [0.3, 0.02]}


@pytest.mark.parametrize(
    ("name", "fills"),
    [
        ("prnu", True),
        ("dust", True),
        ("dark_current_nonuniformity", True),
        ("hot_pixels", True),
        ("dsnu", False),
        ("column_fixed_pattern", False),
    ],
)
def test_a_full_pixel_shows_no_map_of_what_fills_it(name, fills):
    dim, bright = frames_of(
        sensor_of(), [capture_of("flat", level=level, seed=n) for n, level in
                      enumerate((0.1, 1.5))]
    )  # fmt: skip
    known = SensorMap(np.full((1, *SHAPE), 0.01), np.zeros((1, *SHAPE)))
    bare = model_of(sensor_of(), full_well=[1 - WELL])
    model = bare.with_term(Term(BY_NAME[name], np.array([0.01]), sensor_map=known))
    shift = {}
    for frame in (dim, bright):
        at = predict(model, frame).mean - predict(bare, frame).mean
        exposed = predict(bare, frame).exposed
        shift[frame is bright] = np.abs(
            at[exposed > 0.7 if frame is bright else at < 1]
        )
    assert shift[False].min() > 1e-4
    assert (shift[True].max() < 1e-6) == fills


def test_of_a_pixel_that_may_be_full_a_map_follows_no_noise():
    """Its charge is cut, whatever its noise was: all of the noise is left."""
    (frame,) = frames_of(sensor_of(), [capture_of("scene", group="fit", level=1.5)])
    doubt = SensorMap(np.zeros((1, *SHAPE)), np.full((1, *SHAPE), 1e-4))
    term = Term(BY_NAME["prnu"], np.array([0.02]), sensor_map=doubt)
    bare = model_of(sensor_of()).with_term(term)
    level = float(np.median(predict(bare, frame).exposed))
    model = model_of(sensor_of(), full_well=[1 - level]).with_term(term)
    p = predict(model, frame)
    kept = np.broadcast_to(p.kept, p.mean.shape)
    full = (p.well.below > 0.01) & (p.well.below < 0.99)
    free = p.exposed < 0.6 * level
    assert full.any() and (kept[full] == 1).all()
    assert free.any() and (kept[free] < 0.99).all()


@pytest.mark.parametrize("kind", ["dark", "flat"])
def test_a_frame_that_made_a_map_tells_of_noise_what_the_map_left(kind):
    """Its residual is that of noise times one less its leverage."""
    (frame,) = frames_of(sensor_of(), [capture_of(kind, group="fit")])
    noise = predict(model_of(sensor_of()), frame).variance - 1 / 12 / frame.range**2
    leverage = 0.7
    none = np.zeros((1, *SHAPE))
    known = SensorMap(none, leverage * noise, noise_gains=(1.0, 1.0))
    term = Term(BY_NAME["dsnu"], np.array([0.01]), sensor_map=known)

    def variance(**terms):
        return predict(model_of(sensor_of(), **terms).with_term(term), frame).variance

    now = variance() - 1 / 12 / frame.range**2
    np.testing.assert_allclose(now, (1 - leverage) * noise, rtol=1e-5)
    larger = variance(read_noise=[0.1], shot_noise=[0.1]) - variance()
    np.testing.assert_allclose(
        larger, (1 - leverage) ** 2 * np.expm1(0.1) * noise, rtol=1e-3
    )


def test_it_is_not_in_doubt_how_much_charge_is_hot_or_of_a_law_together():
    """A pixel of a known rate may be either: what one has less, the other has more."""
    (frame,) = frames_of(sensor_of(), [capture_of("dark", group="select")])
    rate = np.full((1, *SHAPE), 0.01)
    law = SensorMap(0.5 * rate, 0.25 * rate**2, chance=np.full((1, *SHAPE), 0.5))
    laws = Term(BY_NAME["dark_current_nonuniformity"], np.array([0.01]), law)
    hot = Term(BY_NAME["hot_pixels"], np.array([0.1]), SensorMap(0.5 * rate, 0 * rate))
    bare, alone = model_of(sensor_of()), model_of(sensor_of()).with_term(laws)
    both = alone.with_term(hot)
    shot = frame.seconds * rate * frame.beta1
    known, unsure = (predict(model, frame).variance for model in (both, alone))
    np.testing.assert_allclose(known - predict(bare, frame).variance, shot, rtol=1e-4)
    doubt = (frame.seconds * 0.5 * rate) ** 2
    np.testing.assert_allclose(unsure - known, doubt - 0.5 * shot, rtol=1e-4)
    none = Term(hot.effect, hot.values, SensorMap(0 * rate, 0 * rate))
    as_unsure = predict(alone.with_term(none), frame).variance
    np.testing.assert_allclose(as_unsure, unsure)


def test_shot_noise_of_a_rate_is_left_out_of_frames_that_made_its_map():
    """They have it alike in all pixels. A pixel without any charge lacks that of the
    mean charge, and no more."""
    rate = np.full((1, *SHAPE), 0.01)
    rate[:, ::2] = -0.01
    law = SensorMap(rate, np.zeros_like(rate))
    term = Term(BY_NAME["dark_current_nonuniformity"], np.array([0.01]), law)
    mean = 0.002
    model = model_of(sensor_of(), dark_current=[mean]).with_term(term)
    for group, share in (("fit", 1), ("select", 0)):
        (frame,) = frames_of(sensor_of(), [capture_of("dark", group=group)])
        p = predict(model, frame)
        charge = frame.seconds * np.where(rate > 0, rate, -mean)
        expected = share * np.sqrt(p.kept) * charge * frame.beta1
        found = shot_noise_left_out(model, frame, p)
        np.testing.assert_allclose(found, expected, rtol=1e-4)


@pytest.mark.parametrize("terms", [{}, TAILS, BLENDED, {**TAILS, **BLENDED}])
def test_residuals_of_frames_that_made_a_map_are_white(terms):
    """Of noise with tails a map follows the narrow part, which tells of means; of noise
    that a camera blended it follows what that was before. Residuals of the tails, which
    a map hardly follows, are taken for smaller than they are: 5 % of chi-square."""
    sensor = sensor_of(effects=[{"name": "dsnu", "parameters": {"sigma": READ}}])
    model = model_of(sensor, **terms)
    splits = Splits(frames_of(sensor, captures_of(("dark",) * 4, shape=(96, 144))), ONE)
    drawn = drawn_frames(model, splits, 4).fit
    known = model.with_term(Term(BY_NAME["dsnu"], np.zeros(1), calibration=True))
    for _ in range(3):
        known = fit_patterns(known, drawn)
    z = [log_density(known, frame)[1][frame.counted] for frame in drawn.frames]
    assert np.square(z).mean() == pytest.approx(1, abs=0.06)
