# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What all tests of a match need."""

import pytest


@pytest.fixture(autouse=True)
def few_draws(monkeypatch):
    """Let a bootstrap draw 100 times, the fewest that tell a chance of 1 %."""
    monkeypatch.setattr("cg2raw.match.shift.DRAWS", 100)
