# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tiers of tests: what only scripts/test --slow runs."""

import pytest


def slow(*values):
    """Return a row of pytest.mark.parametrize that is a slow test."""
    return pytest.param(*values, marks=pytest.mark.slow)
