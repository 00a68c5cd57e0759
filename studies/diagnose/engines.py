# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Engines: what a suite asks to diagnose its sets. This is the one place that calls
them, so that two can answer the same sets."""

from collections.abc import Callable, Mapping
from typing import Any

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.diagnosis import (
    Diagnosis,
)

# Captures, and alpha, without and limits as of cg2raw.diagnose.diagnose.
Engine = Callable[..., Diagnosis]


def search(captures: CaptureSet, **options: Any) -> Diagnosis:
    """The diagnosis, in one thread."""
    from cg2raw.diagnose import diagnose

    return diagnose(captures, threads=1, details=False, **options)


ENGINES: Mapping[str, Engine] = {"search": search}
