# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Find where simulation and measurement disagree, name the effect, add it.

    captures = cg2raw.diagnose.read_captures("captures.yaml")
    found = cg2raw.diagnose.diagnose(captures)
    cg2raw.diagnose.write_report(found, "report")

captures    what was measured, and what was in front of the lens; capture_set reads it
frames      captures in the units of the inference
vocabulary  the effects that can be named
prediction  models, and what they predict; likelihood and flows: how well
fitting     parameters; fixed_patterns: maps of the sensor
nuisances   what is wrong with a capture; registration: where a render lies on it
search      the loop; engine: from captures to a verdict
diagnosis   the verdict as objects; report: as a page
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cg2raw.diagnose.capture_set import read_captures
    from cg2raw.diagnose.captures import Capture, CaptureSet
    from cg2raw.diagnose.diagnosis import Diagnosis
    from cg2raw.diagnose.engine import diagnose
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
    "Capture": "captures",
    "CaptureSet": "captures",
    "Diagnosis": "diagnosis",
    "diagnose": "engine",
    "read_captures": "capture_set",
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
