# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Candidates: what counts as evidence for one, and which are fitted at all."""

import numpy as np
import pytest

from cg2raw.diagnose.inference import candidates
from cg2raw.diagnose.inference.candidates import Candidates, null_gain
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.inference.steps import Trial
from cg2raw.diagnose.likelihood.model import Model
from diagnose.planted import (
    BY_NAME,
    ONE,
    captures_of,
    drawn,
    frames_of,
    model_of,
    on,
)
from diagnose.shaded import SENSOR, SHADING, groups_of, shaded

THRESHOLD = 8.0
EFFECTS = list(BY_NAME.values())


def candidates_of(splits, model=None):
    model = model or Model(SENSOR)
    return Candidates(model, EFFECTS, splits, 1, THRESHOLD, lambda text: None)


def splits_of(groups=((), ())):
    return Splits([*groups[0], *groups[1]], ONE)


def weighed(monkeypatch, gain, of_null, own=0.0):
    """Return (evidence over the threshold, models whose own gain was asked for)."""
    asked = []

    def gain_of(model, splits, but=""):
        asked.append((model, but))
        return own if but else of_null

    monkeypatch.setattr(candidates, "null_gain", gain_of)
    trial = Trial("blur", THRESHOLD + gain, np.zeros(1), Model(SENSOR))
    evidence = candidates_of(splits_of())._weighed(trial).evidence
    return evidence - THRESHOLD, asked[1:]


def test_strict_evidence_suffices(monkeypatch):
    evidence, asked = weighed(monkeypatch, gain=5.0, of_null=4.0, own=9.0)
    assert evidence == pytest.approx(1) and not asked


@pytest.mark.parametrize("gain", [3.0, -3.0])
def test_what_both_share_may_move_on_both_sides(monkeypatch, gain):
    evidence, asked = weighed(monkeypatch, gain, of_null=4.0, own=6.5)
    assert evidence == pytest.approx(gain - 4 + 6.5)
    assert asked == [(Model(SENSOR), "blur")]


def test_too_small_a_gain_is_not_helped(monkeypatch):
    evidence, asked = weighed(monkeypatch, gain=-6.0, of_null=0.0, own=100.0)
    assert evidence == pytest.approx(-6) and not asked


def test_parameters_gain_one_nat_each_by_chance():
    """Half a nat for their error on the frames that they were fitted to, and half for
    what is best on the others: chi-square of 7, of 12 sets of frames."""
    gains = []
    for seed in range(12):
        groups = groups_of(seed)
        gains.append(null_gain(shaded(groups), splits_of(groups)))
    assert np.mean(gains) == pytest.approx(7, abs=3 * np.sqrt(14 / 12))


@pytest.mark.slow
@pytest.mark.parametrize("mapped", [False, True])
def test_beside_maps_it_is_the_select_frames_that_screen(mapped):
    """The frames that maps were made of would have the noise of these again."""
    groups = groups_of(2)
    splits, model = splits_of(groups), shaded(groups)
    if mapped:
        model = fit_patterns(model.with_effect(BY_NAME["dsnu"]), splits.fit)
    screened = candidates_of(splits, model)._screened(EFFECTS)
    for one in screened:
        select = splits.select.total(one.start) - splits.select.total(model)
        if mapped or one.effect.estimator == "fixed pattern":
            assert one.score == pytest.approx(select)
        else:
            fitted = splits.fit.total(one.start) - splits.fit.total(model)
            assert one.score == pytest.approx(fitted, abs=1e-3)
    assert len(screened) > 10


def test_a_term_that_rests_gains_nothing():
    groups = groups_of(1)
    splits, model = splits_of(groups), shaded(groups)
    both = fit(model_of(SENSOR, **SHADING, exposure=[0.0]), on(groups[0]))
    assert null_gain(model, splits, "lens_shading") == 0
    assert null_gain(model_of(SENSOR, row_noise=[0.1]), splits) == 0
    rested = [null_gain(both, splits, but) for but in ("lens_shading", "exposure", "")]
    assert 0 <= rested[0] < rested[1] <= rested[2] + 0.1


JUMPS = "random_telegraph_noise"
OF_TAILS, OF_FEW = "the tails of all pixels", "the same few pixels"


@pytest.mark.parametrize("widened", [OF_TAILS, OF_FEW])
def test_a_map_of_variance_is_told_by_its_pixels(widened):
    """Of noise whose tails are farther out than a model has them, a law of jumps
    describes the shape. That gains on held-out frames, wherever its map has them."""
    groups = [
        frames_of(SENSOR, captures_of(("dark",) * 6, group))
        for group in ("fit", "select")
    ]
    few = np.random.default_rng(3).random(groups[0][0].signal.shape) < 0.01

    def jumps(frame, rng):
        hit = few if widened == OF_FEW else rng.random(few.shape) < 0.01
        side = np.sign(rng.standard_normal(few.shape))
        return hit * side * 4 * np.sqrt(frame.beta2)

    fitted, held = (
        on(drawn(frames, Model(SENSOR), seed, jumps))
        for seed, frames in enumerate(groups)
    )
    model = fit_patterns(model_of(SENSOR, **{JUMPS: [0.0]}), fitted)
    gain = held.total(model) - held.total(model.without(JUMPS))
    told = candidates.told_by_pixels(model, JUMPS, held)
    assert gain > 5 * THRESHOLD
    assert told > gain / 2 if widened == OF_FEW else told < 0


def test_what_is_no_map_of_variance_needs_no_pixels():
    model = model_of(SENSOR, prnu=[0.01], read_noise=[0.1])
    for name in model.names:
        assert candidates.told_by_pixels(model, name, on([])) == np.inf
