# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Detection limits, by the law of chi-square; of whole sets: test_constant.py."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.verdict.limits import _variance_seen

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
