# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Which scene an index stands for: kinds and layouts take turns."""

from . import interior, square, street, waterfront

COUNT = 292  # frames of the paper's set of night scenes
KINDS = {
    "street": street,
    "square": square,
    "waterfront": waterfront,
    "interior": interior,
}


def kind_and_layout(index):
    """Return the names of kind and layout: all 32 occur in 32 indices in a row."""
    kinds = tuple(KINDS)
    kind = kinds[index % len(kinds)]
    layouts = tuple(KINDS[kind].LAYOUTS)
    return kind, layouts[index // len(kinds) % len(layouts)]


def scene(index):
    """Return the description of scene @index, 0 or more, the same each time."""
    if index < 0:
        raise ValueError(f"index {index} must not be below 0")
    kind, layout = kind_and_layout(index)
    return KINDS[kind].choose(index, layout)
