# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tiers of tests: what only scripts/test --slow runs."""

import pytest


def slow(*values):
    """Return a row of pytest.mark.parametrize that is a slow test."""
    return pytest.param(*values, marks=pytest.mark.slow)


def first_fast(values, count):
    """Return values of pytest.mark.parametrize of which all but some are slow tests."""
    rows = [value if isinstance(value, tuple) else (value,) for value in values]
    return [*values[:count], *(slow(*row) for row in rows[count:])]


# Of the fixture oiiotool: the wheel's, and with --slow the system's, whose start takes
# 0.3 CPU seconds.
WHEEL_FAST = ["oiio-wheel", slow("oiio-system")]
