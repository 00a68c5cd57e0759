# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A profile's JSON as people read it, checked by the core."""

import json
import re
from collections.abc import Mapping
from typing import Any

from cg2raw import _core


def formatted(fields: Any) -> str:
    """Return JSON text of @fields with every list of numbers on one line."""

    def on_one_line(numbers: re.Match[str]) -> str:
        return "[" + ", ".join(re.split(r"[,\s]+", numbers.group(1).strip())) + "]"

    text = json.dumps(fields, indent=2)  # no text of it has a line end of its own
    return re.sub(r"\[(\n[-+0-9.eE,\s]+)\]", on_one_line, text) + "\n"


def checked(fields: Mapping[str, Any], name: str) -> tuple[_core.SensorProfile, str]:
    """Return (SensorProfile, JSON text) of @fields.

    name : leads the message of the ValueError that says which field is wrong."""
    profile = _core.parse_profile(json.dumps(fields), name)
    return profile, formatted(json.loads(profile.to_json()))
