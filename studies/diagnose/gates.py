# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Gates: a row for each frozen suite, in which nothing may get worse.

    ./studies/run diagnose gates --json FILE --resume

The first sets of each, as many as COUNTS says, or --count."""

from collections.abc import Sequence

from studies.diagnose.frozen import decided_by
from studies.diagnose.scores import HEAD, Record, line

GATES = "gates"
# As they were answered first, by a search.
COUNTS = {
    "single": 40,
    "pairs": 1,
    "triples": 1,
    "none": 2,
    "low-none": 11,
    "nine": 1,
    "unknown": 2,
    "nuisance-none": 2,
    "real": 1,
    "cameras": 1,
}
OF_REAL_FRAMES = ("real", "cameras")


def table(records: Sequence[Record]) -> str:
    """Return a row of each suite that records are of; two of single."""
    rows: dict[str, list[Record]] = {}
    for one in records:
        name = one["suite"]
        if name == "single":
            name += f", by {decided_by(name, one['hidden'])}"
        rows.setdefault(name, []).append(one)
    lines = []
    for name, group in sorted(rows.items()):
        good = [one for one in group if "error" not in one]
        lines += [line(name, good)] if good else []
        failed = len(group) - len(good)
        lines += [f"{name}: {failed} failed"] if failed else []
    return "\n".join([HEAD, *lines])
