# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Each leaf of a tree of data classes, and the tree with one of them replaced."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace

import numpy as np


def children(node):
    """Return [(key, child)] of a data class, mapping or sequence; none of a leaf."""
    if is_dataclass(node):
        return [(field.name, getattr(node, field.name)) for field in fields(node)]
    if isinstance(node, Mapping):
        return list(node.items())
    if isinstance(node, (list, tuple)):
        return list(enumerate(node))
    return []


def leaves(node, path=()):
    """Yield (path, value) of each leaf."""
    below = children(node)
    for key, child in below:
        yield from leaves(child, (*path, key))
    if not below and not isinstance(node, (list, tuple, Mapping)):
        yield path, node


def with_leaf(node, path, value):
    """Return the tree with @value at @path; nothing of @node is changed."""
    if not path:
        return value
    key, *rest = path
    child = with_leaf(dict(children(node))[key], rest, value)
    if is_dataclass(node):
        return replace(node, **{key: child})
    if isinstance(node, Mapping):
        return {**node, key: child}
    return type(node)(child if n == key else old for n, old in enumerate(node))


def paths_of_strings(tree):
    """Return the paths of all strings, in order."""
    return [path for path, value in leaves(tree) if isinstance(value, str)]


def with_mapping_keys(mapping, text):
    """Return a mapping with text(n) as its n-th key."""
    return {text(n): value for n, value in enumerate(mapping.values())}


def is_number(value):
    """Whether a leaf is a number; an array or truth value is none."""
    return isinstance(value, (int, float)) and not isinstance(value, (bool, np.bool_))
