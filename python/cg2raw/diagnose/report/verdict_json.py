# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""verdict.json: a Diagnosis as text.

First what a program asks for: verdict, effects, gap, unexplained, seconds; then all
else that a Diagnosis holds but what is drawn and the profile, which has its own file. A
number that is not finite is null.
"""

import dataclasses
import math
from collections.abc import Sequence
from types import NoneType
from typing import Any

from cg2raw.diagnose.diagnosis import Diagnosis, Gap, ResidualTest
from cg2raw.io.json_text import formatted

FIRST = ("verdict", "effects", "gap", "unexplained", "seconds")
DRAWN = (
    *("pictures", "curves", "charts"),
    *("histogram_before", "histogram_after", "profile_json"),
)
GAP_UNIT = "nats/pixel"
SMALLEST_NORMAL = 1e-300  # what a reader of JSON in another language may not hold


def verdict_json(diagnosis: Diagnosis, files: Sequence[str] = ()) -> str:
    """Return the text of verdict.json. files : names of those of the same report."""
    fields = {name: plain(getattr(diagnosis, name)) for name in FIRST}
    for field in dataclasses.fields(diagnosis):
        if field.name not in (*FIRST, *DRAWN):
            fields[field.name] = plain(getattr(diagnosis, field.name))
    return formatted({**fields, "files": list(files)})


def plain(value: Any) -> Any:
    """Return what JSON holds of a value of a Diagnosis."""
    if dataclasses.is_dataclass(value):
        fields = {
            renamed(type(value), field.name): plain(getattr(value, field.name))
            for field in dataclasses.fields(value)
        }
        if isinstance(value, Gap):
            fields["unit"] = GAP_UNIT
        return fields
    if isinstance(value, str | bool | NoneType | int):
        return value
    if hasattr(value, "items"):
        return {str(key): plain(item) for key, item in value.items()}
    if hasattr(value, "__iter__"):
        return [plain(item) for item in value]
    number = float(value)
    if not math.isfinite(number):
        return None
    return 0.0 if abs(number) < SMALLEST_NORMAL else number


def renamed(owner: Any, name: str) -> str:
    """Return what verdict.json calls a field."""
    return "test" if owner is ResidualTest and name == "name" else name
