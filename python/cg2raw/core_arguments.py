# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Arguments that the core does not take: a TypeError names them, and what they may be.

pybind11 itself lists signatures and prints all arguments, images too. Once this module
is imported, every function, method and class of _core says it in one line."""

import ast
import difflib
import functools
import inspect
import re
import reprlib
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

import cg2raw.near_words  # which may be what imports this
from cg2raw import _core
from cg2raw.short_messages import NO_MEMORY

LONGEST = 80  # letters of a value in a message
REFUSED = re.compile(r"incompatible (function|constructor) arguments")
# How pybind11 writes types, and what stands for them here.
WORDS = (
    (r"typing\.SupportsFloat \| typing\.SupportsIndex", "float"),
    (r"typing\.SupportsInt \| typing\.SupportsIndex", "int"),
    (r"typing\.Annotated\[(numpy\.typing\.)?ArrayLike, numpy\.\w+\]", "ndarray"),
    (r"numpy\.typing\.NDArray\[numpy\.\w+\]", "ndarray"),
    (r'typing\.Annotated\[((?:[^][]|\[[^][]*\])*), "FixedSize\((\d)\)"\]', r"Of\2[\1]"),
    (r"(cg2raw\._core|collections\.abc|typing|numpy)\.", ""),
)
PLAIN = {
    "str": "a text",
    "int": "a whole number",
    "float": "a number",
    "bool": "True or False",
    "ndarray": "an array",
    "None": "None",
}
SURROGATES = re.compile("[\ud800-\udfff]")
MANY = {"str": "texts", "int": "whole numbers", "float": "numbers"}
_short = reprlib.Repr()
_short.maxstring = _short.maxother = _short.maxlong = LONGEST


def shown(value: object) -> str:
    """Return a value as a message shows it, on one short line."""
    if isinstance(value, np.ndarray):
        return f"an array {value.shape} of {value.dtype}"
    try:
        words = _short.repr(value)
    except (ValueError, RecursionError):  # a whole number of thousands of digits
        words = f"of type {type(value).__name__}"
    words = " ".join(words.split())
    return words if len(words) <= 2 * LONGEST else f"{words[:LONGEST]} ..."


def is_whole(value: object) -> bool:
    """Return whether the core takes a value for a whole number."""
    return hasattr(value, "__index__")


def is_number(value: object) -> bool:
    """Return whether the core takes a value for a number."""
    return hasattr(value, "__float__") or is_whole(value)


def _wrapped(function: Callable[..., Any], name: str) -> Callable[..., Any]:
    """Return a function of the core whose TypeErrors are about arguments alone."""

    @functools.wraps(function)
    def _call(*args: Any, **named: Any) -> Any:
        try:
            # pybind11 aborts the process where a name has a lone surrogate.
            if not named or all(map(str.isascii, named)):
                return function(*args, **named)
        except TypeError as error:
            if not REFUSED.search(str(error)):
                raise
        except MemoryError:
            raise MemoryError(NO_MEMORY) from None
        raise TypeError(_refusal(function, name, args, named))

    return _call


def _refusal(
    function: Callable[..., Any],
    name: str,
    args: tuple[Any, ...],
    named: Mapping[str, Any],
) -> str:
    """Return what is wrong with the arguments of a function of the core."""
    text = (function.__doc__ or "").splitlines()[0]
    for pattern, words in WORDS:
        text = re.sub(pattern, words, text)
    declared = ast.parse(f"def {text}: ...").body[0]
    assert isinstance(declared, ast.FunctionDef)
    types = {
        each.arg: each.annotation
        for each in (*declared.args.args, *declared.args.kwonlyargs)
    }
    places = [each.arg for each in declared.args.args]
    given = dict(zip(places, args, strict=False)) | dict(named)
    unknown = sorted(given.keys() - types.keys())
    if unknown or len(args) > len(places):
        takes = [each for each in types if each != "self"]
        excess = shown(unknown[0]) if unknown else f"{len(args)} arguments"
        near = difflib.get_close_matches(unknown[0][:LONGEST] if unknown else "", takes)
        hint = f"it takes {', '.join(takes) or 'none'}"
        hint = cg2raw.near_words.did_you_mean(near) if near else hint
        return f"{name}() does not take {excess}; {hint}"
    missing = places[len(args) : len(places) - len(declared.args.defaults)]
    missing = [each for each in missing if each not in given]
    if missing:
        return f"{name}() needs {', '.join(missing)}"
    wrong = [each for each in given if not _fits(types[each], given[each])]
    doubt = "" if wrong else "a number out of range, or a wrong type: "
    of = wrong or [each for each in given if each != "self"]
    said = (f"{each} {shown(given[each])} must be {_words(types[each])}" for each in of)
    lone = any(map(has_surrogates, given.values()))
    end = " (no Unicode: it has lone surrogates)" if lone else ""
    return f"{name}(): {doubt}{'; '.join(said)}"[: 20 * LONGEST] + end


def has_surrogates(value: object) -> bool:
    """Return whether a value is a text with half of a pair, which no UTF-8 has: Python
    has one in the place of each byte of a file's name that is not UTF-8 (PEP 383)."""
    return isinstance(value, str) and SURROGATES.search(value) is not None


def check_utf8(word: str) -> None:
    """Raise ValueError for a word that is not UTF-8; the core takes no other."""
    if has_surrogates(word):
        raise ValueError(f"{word}: is not UTF-8; rename the file or folder")


def _fits(node: ast.expr | None, value: object) -> bool:
    """Return whether a value may be of the type, as far as can be told."""
    if isinstance(node, ast.BinOp):  # A | B
        return _fits(node.left, value) or _fits(node.right, value)
    if isinstance(node, ast.Subscript):
        return _fits_in(ast.unparse(node.value), node.slice, value)
    kind = "" if node is None else ast.unparse(node)
    if kind == "str":
        return isinstance(value, str) and not has_surrogates(value)
    if kind == "int":
        return is_whole(value)
    if kind == "float":
        return is_number(value)
    if kind == "None":
        return value is None
    if kind == "ndarray":
        return isinstance(value, np.ndarray)
    known = getattr(_core, kind, None)
    return isinstance(value, known) if inspect.isclass(known) else True


def _fits_in(kind: str, inner: ast.expr, value: object) -> bool:
    """Return whether a value may be a Sequence, a Mapping, a tuple or one OfN."""
    if kind == "Mapping":
        return isinstance(value, Mapping)
    if isinstance(value, str) or not isinstance(value, Sequence | np.ndarray):
        return False
    if kind.startswith("Of"):
        sequence = inner.slice if isinstance(inner, ast.Subscript) else inner
        same = len(value) == int(kind[2:])
        return same and all(_fits(sequence, each) for each in value)
    return kind != "Sequence" or all(_fits(inner, each) for each in value)


def _words(node: ast.expr | None) -> str:
    """Return what a type is called in a message."""
    if isinstance(node, ast.BinOp):
        return f"{_words(node.left)} or {_words(node.right)}"
    if isinstance(node, ast.Subscript):
        kind, inner = ast.unparse(node.value), node.slice
        if kind.startswith("Of") and isinstance(inner, ast.Subscript):
            return f"{kind[2:]} {MANY.get(ast.unparse(inner.slice), 'values')}"
        if kind == "Sequence":
            return f"a sequence of {MANY.get(ast.unparse(inner), 'values')}"
        return "a dict" if kind == "Mapping" else f"a {kind}"
    kind = "" if node is None else ast.unparse(node)
    article = "an" if kind[:1] in "AEIO" else "a"
    return PLAIN.get(kind, f"{article} {kind}")


def _cannot_be_handed_on(self: object) -> Any:
    """Raise what pickle and copy say of an object of the core that they cannot take."""
    raise TypeError(
        f"{type(self).__name__} cannot be copied or pickled: hand on what it was made "
        "of, and make it there"
    )


def _wrap_class(cls: type) -> None:
    if "__reduce__" not in vars(cls):
        cls.__reduce__ = _cannot_be_handed_on  # type: ignore[assignment]
    for name, value in list(vars(cls).items()):
        is_init = name == "__init__" and SIGNED in (value.__doc__ or "")
        if callable(value) and (name[0] != "_" or is_init):
            setattr(cls, name, _wrapped(value, cls.__name__ if is_init else name))


SIGNED = "(self: cg2raw._core."  # no class without a constructor says so
for _name, _thing in list(vars(_core).items()):
    if not inspect.isclass(_thing):
        if callable(_thing) and _name[0] != "_":
            setattr(_core, _name, _wrapped(_thing, _name))
    elif not issubclass(_thing, Exception):
        _wrap_class(_thing)
