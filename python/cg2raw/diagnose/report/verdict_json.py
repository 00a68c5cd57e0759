# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""verdict.json: a Diagnosis as text, and back.

First what a program asks for: verdict, effects, gap, unexplained, seconds; then all
else that a Diagnosis holds but what is drawn and the profile, which has its own file. A
number that is not finite is null.
"""

import dataclasses
import json
import math
from collections.abc import Sequence
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

from cg2raw.diagnose.diagnosis import VERDICTS, Diagnosis, Gap, ResidualTest
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


def read_verdict(text: str, name: str = "verdict.json") -> Diagnosis:
    """Return the Diagnosis of verdict.json, without what is drawn.

    name : of the file, for the message of the ValueError that says what is wrong."""
    try:
        fields = json.loads(text)
    except ValueError as error:
        raise ValueError(f"{name}: is no JSON: {error}") from None
    if not isinstance(fields, dict) or fields.get("verdict") not in VERDICTS:
        raise ValueError(
            f"{name}: is no verdict: its field verdict must be one of "
            f"{', '.join(VERDICTS)}"
        )
    fields = {key: value for key, value in fields.items() if key != "files"}
    diagnosis: Diagnosis = built(Diagnosis, fields, name)
    return diagnosis


def built(kind: Any, value: Any, path: str) -> Any:
    """Return a value of a type from what JSON holds of it. Raises ValueError."""
    if dataclasses.is_dataclass(kind):
        return built_fields(kind, value, path)
    origin, inner = get_origin(kind), get_args(kind)
    if origin in (Union, UnionType):
        if value is None:
            return None
        return built(next(arg for arg in inner if arg is not NoneType), value, path)
    if kind is float:
        return math.nan if value is None else float(value)
    if origin is tuple and isinstance(value, list):
        return tuple(built(inner[0], item, path) for item in value)
    if inner and isinstance(value, dict):
        return {
            key: built(inner[1], item, f"{path}.{key}") for key, item in value.items()
        }
    if inner and isinstance(value, list):
        return [built(inner[0], item, f"{path}[{i}]") for i, item in enumerate(value)]
    if isinstance(kind, type) and not isinstance(value, kind):
        raise ValueError(f"{path}: is {value!r}; must be {kind.__name__}")
    return value


def built_fields(kind: Any, value: Any, path: str) -> Any:
    """Return a dataclass of a JSON object. Raises ValueError."""
    if not isinstance(value, dict):
        raise ValueError(f"{path}: is {value!r}; must be an object")
    hints = get_type_hints(kind)
    fields = {}
    for field in dataclasses.fields(kind):
        key = renamed(kind, field.name)
        needed = field.default is field.default_factory is dataclasses.MISSING
        if key in value:
            fields[field.name] = built(hints[field.name], value[key], f"{path}: {key}")
        elif needed:
            raise ValueError(f"{path}: has no {key}")
    return kind(**fields)
