# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The colour and the dashes of each source, the same in all figures."""

from collections.abc import Iterable

from cg2raw.io.figure import BLACK, BLUE, GREEN, ORANGE, RED, SKY

FAMILIES = {  # by the beginning of a source's name
    "real": BLACK,
    "ours, match": BLUE,
    "ours, dng": BLUE,
    "ours, paper": SKY,
    "ours, spectral": GREEN,
    "ours, captures": GREEN,
    "ours": SKY,
    "upi": ORANGE,
    "translation": RED,
}
OTHERS = "#888888"
Dashes = str | tuple[int, tuple[int, ...]]  # as matplotlib has them
DASHES: tuple[Dashes, ...] = (  # of the first, second, ... of a family
    "-",
    "--",
    ":",
    "-.",
    (0, (6, 2, 1, 2, 1, 2)),
    (0, (1, 3)),
)
Style = tuple[str, Dashes]  # colour, dashes


def styles(names: Iterable[str]) -> dict[str, Style]:
    """Return the Style of each source; those of one family differ in dashes."""
    found: dict[str, Style] = {}
    met: dict[str, int] = {}
    for name in names:
        fit = [color for start, color in FAMILIES.items() if name.startswith(start)]
        color = fit[0] if fit else OTHERS
        found[name] = color, DASHES[met.get(color, 0) % len(DASHES)]
        met[color] = met.get(color, 0) + 1
    return found
