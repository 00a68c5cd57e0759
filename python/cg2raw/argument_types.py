# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What arguments that are no arrays must be: a message names the wrong one alone, where
the core's would list all and their types."""

import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from cg2raw.core_arguments import PLAIN, check_utf8, is_number, is_whole, shown

TEXT, TRUTH, NUMBER, WHOLE = (PLAIN[kind] for kind in ("str", "bool", "float", "int"))


def check_types(kind: str, arguments: Mapping[str, Any]) -> None:
    """Raise ValueError, with name and value, for the first argument of another kind.

    kind : TEXT, TRUTH, NUMBER or WHOLE; with " or None" behind it, None is one, too."""
    for name, value in arguments.items():
        if value is None and kind.endswith(" or None"):
            continue
        if not _is(kind.removesuffix(" or None"), value):
            raise ValueError(f"{name} {shown(value)} must be {kind}")


def path_text(path: str | os.PathLike[str]) -> str:
    """Return the text of a path. Raises ValueError for what is none."""
    text = path if isinstance(path, str) else getattr(path, "__fspath__", str)()
    if not isinstance(text, str) or not text:
        raise ValueError(f"path {shown(path)} must be the path of a file, a text")
    if "\0" in text:
        raise ValueError(f"path {shown(text)} holds a NUL character")
    check_utf8(text)
    return text


def thread_count(threads: int) -> int:
    """Return how many threads are asked for. Raises ValueError for no number."""
    check_types(WHOLE, {"threads": threads})
    return int(threads)


def effect_parameters(effect: str, parameters: Mapping[str, float]) -> dict[str, float]:
    """Return the parameters of an effect. Raises ValueError for other types."""
    check_types(TEXT, {"name": effect})
    if not isinstance(parameters, Mapping):
        raise ValueError(
            f"{effect}: parameters {shown(parameters)} must be a dict of numbers"
        )
    for name, value in parameters.items():
        if not is_number(value):
            raise ValueError(f"{effect}: {name} {shown(value)} must be a number")
    return dict(parameters)


def _is(kind: str, value: Any) -> bool:
    if kind == TEXT:
        return isinstance(value, str)
    if kind == TRUTH:
        return isinstance(value, bool | np.bool_)
    return is_whole(value) if kind == WHOLE else is_number(value)
