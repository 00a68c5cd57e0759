# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Values of what is named, with the errors of their own parameters."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.verdict.values import _of_levels
from cg2raw.normal import CI95


def test_effects_of_levels_have_the_value_and_error_of_each_parameter():
    """Of crosstalk, both neighbours along a line have half."""
    numbers = np.array([0.1, 0.2, 0.3, 0.4, 0.5])
    levels = SimpleNamespace(
        fitted=lambda names: numbers,
        covariance_of=lambda names, values: np.diag((numbers / 10) ** 2),
    )
    found = SimpleNamespace(
        statistics=SimpleNamespace(of_splits=lambda splits: None),
        both=None,
        levels_of=lambda *_: levels,
    )
    named = ("crosstalk", "white_balance", "exposure")
    values = {(v.effect, v.parameter): v[2:] for v in _of_levels(found, named)}
    expected = {
        ("exposure", "gain"): 0.1,
        ("white_balance", "red"): 0.2,
        ("white_balance", "blue"): 0.3,
        **{("crosstalk", way): 0.2 for way in ("left", "right")},
        **{("crosstalk", way): 0.25 for way in ("up", "down")},
    }
    assert values.keys() == expected.keys()
    for key, value in expected.items():
        ends = (value, value * (1 - CI95 / 10), value * (1 + CI95 / 10))
        assert values[key] == pytest.approx(ends)
