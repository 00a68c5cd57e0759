# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Registry: the effects that the core simulates, as it describes them."""

from collections.abc import Mapping
from functools import cache
from typing import Any

from cg2raw import _core
from cg2raw.cfa import is_mono


@cache
def registered(cfa: str | None = None) -> Mapping[str, Mapping[str, Any]]:
    """Return the registry's effects by name, in the order in which they act.

    cfa : only what a monochrome sensor has, with its parameters. Others have all: what
    the registry lacks of larger repeats, the prediction adds."""
    of = cfa if cfa is not None and is_mono(cfa) else None
    return {effect["name"]: effect for effect in _core.effects(of)}
