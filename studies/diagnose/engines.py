# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Engines: what a suite asks to diagnose its sets. This is the one place that calls
them, so that two can answer the same sets."""

import math
import time
from collections.abc import Callable, Mapping
from typing import Any

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.darks_and_flats import DarksAndFlats, darks_and_flats
from cg2raw.diagnose.diagnosis import (
    Diagnosis,
    Estimate,
    Finding,
    Gap,
    ResidualTest,
)

# Captures, and alpha, without and limits as of cg2raw.diagnose.diagnose.
Engine = Callable[..., Diagnosis]


def search(captures: CaptureSet, **options: Any) -> Diagnosis:
    """The search that docs/diagnose.md describes, in one thread."""
    from cg2raw.diagnose import diagnose

    return diagnose(captures, threads=1, details=False, **options)


def likelihood(captures: CaptureSet, *, alpha: float = 0.01, **_: Any) -> Diagnosis:
    """One model of darks and flats, which looks at nothing else."""
    start = time.monotonic()
    found = darks_and_flats(captures, alpha)
    values: dict[str, dict[str, Estimate]] = {}
    for one in found.values:
        given = values.setdefault(one.effect, {})
        given[one.parameter] = Estimate(one.value, "", (one.low, one.high))
    nowhere = Gap(math.nan, math.nan, math.nan, math.nan, None, None, [])
    gains = found.selection.gains
    return Diagnosis(
        verdict=_verdict(found),
        sensor_id=captures.sensor.id,
        effects=[
            Finding(name, values.get(name, {}), gains[name], 0.0, [], [], "", "")
            for name in found.names
        ],
        gap=nowhere,
        tests_before=[],
        tests_after=[],
        unexplained=[
            ResidualTest(where, math.nan, math.nan, math.nan, where)
            for where in found.unexplained
        ],
        ladder=[],
        detection_limits=[],
        next_captures=[],
        notes=[],
        groups={},
        seconds=time.monotonic() - start,
    )


def _verdict(found: DarksAndFlats) -> str:
    if found.unexplained:
        is_named = bool(found.names)
        return "partially_explained" if is_named else "unexplained"
    return "explained" if found.names else "consistent"


ENGINES: Mapping[str, Engine] = {"search": search, "likelihood": likelihood}
