# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Sentences on effects that were found."""

from collections.abc import Sequence

from cg2raw.diagnose.diagnosis import Gap
from cg2raw.diagnose.effects.base import Estimates
from cg2raw.diagnose.effects.catalogue import effect, heading, title
from cg2raw.diagnose.effects.discriminating_captures import discriminating_captures
from cg2raw.sensor import Sensor


def sentence(name: str, values: Estimates, gap: Gap, sensor: Sensor) -> str:
    """Return one sentence of what was found, and what adding it does."""
    found = effect(name)
    return (
        f"{heading(name)}: {found.size_on(values, sensor)}; with all that was found, "
        f"held-out chi-square goes from {gap.chi2_before:.4g} to {gap.chi2_after:.4g}."
    )


def deciding_captures(name: str, others: Sequence[str]) -> list[str]:
    """Return what to capture to tell an effect from those that look alike."""
    return [
        f"To tell {title(name)} from {title(other)}: "
        f"{discriminating_captures(name, other)}"
        for other in others
    ]
