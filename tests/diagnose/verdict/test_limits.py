# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Detection limits, by the law of chi-square; of whole sets: test_constant.py."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.verdict import limits
from cg2raw.diagnose.verdict.limits import _seen_from, _variance_seen
from cg2raw.model.values import Value
from cg2raw.normal import ABOVE95

LEAST = 8.0  # nats


@pytest.mark.parametrize("freedom", [12, 200, 5000])
@pytest.mark.parametrize(("name", "ways"), [("dsnu", 2), ("black_level_drift", 1)])
def test_a_variance_is_named_in_95_of_100_sets(freedom, name, ways):
    """Of squares that noise of 4 DN^2 makes, whose error grows with what is beyond it:
    both ways of two splits decide, but for a drift."""
    noise = 4.0

    def error_at(name, variance):
        return (noise + variance) * np.sqrt(2 / freedom)

    validation = SimpleNamespace(
        of=lambda name: (0.0, error_at(name, 0.0)), error_at=error_at
    )
    selection = SimpleNamespace(validation=validation)
    found = SimpleNamespace(selection=selection, least=LEAST)
    ratio = _variance_seen(found, name) / noise
    drawn = np.random.default_rng(1).chisquare(ways * freedom, 100_000)
    squares = drawn / ways * (1 + ratio)  # of a split, over the noise
    # The likelihood of a normal law, with it and without.
    gained = (squares - squares / (1 + ratio) - freedom * np.log1p(ratio)) / 2
    assert (gained > LEAST).mean() == pytest.approx(0.95, abs=0.005)


def test_a_variance_of_unknown_error_is_never_seen():
    validation = SimpleNamespace(of=lambda name: (0.0, np.inf))
    found = SimpleNamespace(
        selection=SimpleNamespace(validation=validation), least=LEAST
    )
    assert np.isnan(_variance_seen(found, "dsnu"))


def test_a_limit_of_dark_current_is_errors_away_in_shares_of_white(monkeypatch):
    """Of an error of 3 DN/s, whatever its interval, which is Student's."""
    value = Value("dark_current", "rate", 0.0, -1.0, 1.0)
    monkeypatch.setattr(limits, "effect_values", lambda *_: [value])
    monkeypatch.setattr(limits, "limits_of_levels", lambda _: [])
    monkeypatch.setattr(limits, "of_amplifiers", lambda *_: [])
    found = SimpleNamespace(
        captures=SimpleNamespace(sensor=SimpleNamespace(signal_range=1000.0)),
        selection=SimpleNamespace(
            validation=SimpleNamespace(of=lambda name: (0.0, 3.0)), unsure={}
        ),
        statistics=SimpleNamespace(of_splits=lambda _: None),
        amplifiers=SimpleNamespace(errors={}),
        profile=None,
        least=LEAST,
    )
    [(_, strength)] = _seen_from(found)
    assert strength == pytest.approx((4 + ABOVE95) * 3.0 / 1000)
