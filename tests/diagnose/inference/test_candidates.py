# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Candidates: what counts as evidence for one, and which are fitted at all."""

import numpy as np
import pytest

from cg2raw.diagnose.inference import candidates
from cg2raw.diagnose.inference.candidates import Candidates, null_gain
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.inference.steps import Trial
from cg2raw.diagnose.likelihood.model import Model
from diagnose.planted import (
    BY_NAME,
    ONE,
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
