# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Findings and the verdict on them, alike for darks and flats and for images."""

import math
from collections.abc import Sequence

from cg2raw.diagnose.diagnosis import LARGEST_E, Alternative, Finding
from cg2raw.diagnose.effects.base import Estimates
from cg2raw.diagnose.effects.catalogue import effect, title
from cg2raw.diagnose.effects.discriminating_captures import (
    discriminating_captures,
    sentence,
)
from cg2raw.sensor import Sensor


def finding_of(
    name: str,
    values: Estimates,
    nats: float,
    sensor: Sensor,
    is_provisional: bool,
    ambiguous_with: Sequence[str] = (),
    instead: tuple[str, float] | None = None,
) -> Finding:
    """Return a finding.

    nats : that validation frames lose without it. instead : the best name in its place,
    and what that gains."""
    largest = nats >= math.log(LARGEST_E)
    return Finding(
        name=name,
        parameters=values,
        gain_nats=nats,
        e_value=LARGEST_E if largest else math.exp(nats),
        alternatives=[Alternative(*instead)] if instead else [],
        ambiguous_with=list(ambiguous_with),
        where=effect(name).where,
        sentence=sentence(name, values, sensor) if values else "",
        provisional=is_provisional,
        stated=any(one["name"] == name for one in sensor.effects or ()),
    )


def deciding_captures(findings: Sequence[Finding]) -> list[str]:
    """Return what to capture to tell findings from those that look alike."""
    return [
        f"To tell {title(one.name)} from {title(other)}: "
        f"{discriminating_captures(one.name, other)}"
        for one in findings
        for other in one.ambiguous_with
    ]


def verdict_of(findings: Sequence[Finding], is_left: bool) -> str:
    """Return the verdict on findings. is_left : something is unexplained."""
    if not findings:
        return "unexplained" if is_left else "consistent"
    if is_left:
        return "partially_explained"
    ambiguous = any(one.ambiguous_with for one in findings)
    return "ambiguous" if ambiguous else "explained"
