# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Find where simulation and measurement disagree, name the effect, add it.

    captures = cg2raw.diagnose.read_captures("captures.yaml")
    found = cg2raw.diagnose.diagnose(captures)
    cg2raw.diagnose.write_report(found, "report")

The way of the data:

captures         files become a CaptureSet: what was measured, what was before the lens
effects          what can be named: one file for each
darks_and_flats  their statistics name noise, patterns and offsets (cg2raw.model)
frames, scenes   images name what happens to light, by one matrix of normal equations
verdict          test frames become evidence: residual tests, gap, intervals, profile
report           a Diagnosis becomes files

pipeline is diagnose(), all of these in their order; diagnosis holds its result.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cg2raw.diagnose.captures.capture import Capture, CaptureSet
    from cg2raw.diagnose.captures.reader import read_captures
    from cg2raw.diagnose.diagnosis import Diagnosis
    from cg2raw.diagnose.pipeline import diagnose
    from cg2raw.diagnose.report import write_report

__all__ = [
    "Capture",
    "CaptureSet",
    "Diagnosis",
    "diagnose",
    "read_captures",
    "write_report",
]

_HOMES = {
    "Capture": "captures.capture",
    "CaptureSet": "captures.capture",
    "Diagnosis": "diagnosis",
    "diagnose": "pipeline",
    "read_captures": "captures.reader",
    "write_report": "report",
}


def __getattr__(name: str) -> Any:
    """Import what is asked for, so that `import cg2raw` needs no SciPy."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    except ModuleNotFoundError as missing:
        raise ModuleNotFoundError(
            f"{missing}: the diagnosis needs more packages: "
            'pip install "cg2raw[diagnose]"',
            name=missing.name,
        ) from missing
