# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""YAML whose values keep their line numbers, for error messages."""

import difflib
import math
import os
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn, TypeVar

from cg2raw.core_arguments import has_surrogates
from cg2raw.near_words import one_line

Word = TypeVar("Word", bound=str)

MISSING = "PyYAML is not installed: pip install 'cg2raw[diagnose]'"
KINDS = {"mapping": "fields", "sequence": "a list", "scalar": "one value"}


@dataclass(frozen=True)
class Value:
    """A value of a YAML file.

    node : of PyYAML. file : its name. field : what it is called, as frames[2].gain."""

    node: Any
    file: str
    field: str = ""

    @property
    def line(self) -> int:
        """Its line, from 1."""
        return int(self.node.start_mark.line) + 1

    @property
    def is_list(self) -> bool:
        """Whether it is a list."""
        return bool(self.node.id == "sequence")

    def fail(self, message: str) -> NoReturn:
        """Raise ValueError with file, line and field before a message."""
        field = f"{self.field} " if self.field else ""
        raise ValueError(one_line(f"{self.file}:{self.line}: {field}{message}"))

    def _need(self, kind: str) -> None:
        if self.node.id != kind:
            self.fail(f"is {KINDS[self.node.id]}; must be {KINDS[kind]}")

    def fields(
        self, allowed: Sequence[str], required: Sequence[str] = ()
    ) -> dict[str, "Value"]:
        """Return {name: Value}. Raises ValueError for unknown, double, missing ones."""
        self._need("mapping")
        found: dict[str, Value] = {}
        for key, node in self.node.value:
            name = key.value if key.id == "scalar" else "a list as a field's name"
            path = f"{self.field}.{name}" if self.field else name
            if name not in allowed:
                close = difflib.get_close_matches(name, allowed, 1)
                hint = f"; did you mean {close[0]}?" if close else ""
                Value(key, self.file, path).fail(
                    f"is no field; must be one of {', '.join(allowed)}{hint}"
                )
            if name in found:
                Value(key, self.file, path).fail(
                    f"is there twice, first in line {found[name].line}; remove one"
                )
            found[name] = Value(node, self.file, path)
        for name in required:
            if name not in found:
                self.fail(f"has no {name}: add it")
        return found

    def items(self) -> list["Value"]:
        """Return the values of a list. Raises ValueError."""
        self._need("sequence")
        return [
            Value(node, self.file, f"{self.field}[{index}]")
            for index, node in enumerate(self.node.value)
        ]

    def text(self) -> str:
        """Return a word or path. Raises ValueError if there is none."""
        self._need("scalar")
        if not self.node.value or self.node.tag.endswith(":null"):
            self.fail("is empty; give a value, or leave the field out")
        text = str(self.node.value)
        if has_surrogates(text):
            self.fail(f"is {text!r}; must be Unicode: half of a pair is none")
        return text

    def word(self, allowed: Collection[Word]) -> Word:
        """Return one of the allowed words. Raises ValueError."""
        text = self.text()
        for word in allowed:
            if word == text:
                return word
        close = difflib.get_close_matches(text, list(allowed), 1)
        hint = f"; did you mean {close[0]}?" if close else ""
        self.fail(f'is "{text}"; must be one of {", ".join(allowed)}{hint}')

    def number(self, low: float, high: float, unit: str = "") -> float:
        """Return a number in low..high. Raises ValueError."""
        self._need("scalar")
        try:
            number = float(self.node.value)
        except ValueError:
            number = math.nan
        quoted = self.node.style is not None
        if quoted or not low <= number <= high or not math.isfinite(number):
            self.fail(
                f"is {self.node.value!r}; must be a number, {low:g} to {high:g}"
                + (f" {unit}" if unit else "")
            )
        return number

    def numbers(self, count: int, low: float, high: float) -> tuple[float, ...]:
        """Return a list of so many numbers. Raises ValueError."""
        values = self.items()
        if len(values) != count:
            self.fail(f"has {len(values)} values; must have {count}")
        return tuple(value.number(low, high) for value in values)


def existing(value: Value, manifest: str | os.PathLike[str]) -> str:
    """Return the path of a file that is named relative to the manifest."""
    path = os.path.join(os.path.dirname(os.fspath(manifest)), value.text())
    if not os.path.exists(path):
        value.fail(f'is "{value.text()}"; there is no file {path}')
    if os.path.isdir(path):
        value.fail(f'is "{value.text()}", a folder; name one file')
    if not os.path.isfile(path):  # nobody may ever write to a pipe
        value.fail(f'is "{value.text()}", no regular file; name one that is')
    return path


def read_yaml(path: str | os.PathLike[str]) -> Value:
    """Return the root of a YAML file.

    Raises ValueError naming the line of what is no YAML, OSError."""
    try:
        import yaml
    except ImportError:
        raise ValueError(MISSING) from None
    name = os.fspath(path)
    with open(name, encoding="utf-8") as file:
        try:
            node = yaml.compose(file, yaml.SafeLoader)
        except UnicodeDecodeError:
            raise ValueError(f"{name}: is no text in UTF-8") from None
        except yaml.MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            line = f":{mark.line + 1}" if mark else ""
            why = one_line(f"{name}{line}: is no YAML: {error.problem}")
            raise ValueError(why) from None
        # PyYAML makes characters and versions of numbers that are none.
        except (yaml.YAMLError, RecursionError, ValueError, OverflowError) as error:
            text = " ".join(str(error).split())
            raise ValueError(one_line(f"{name}: is no YAML: {text}")) from None
    if node is None:
        raise ValueError(f"{name}: is empty")
    return Value(node, name)
