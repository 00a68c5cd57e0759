# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Table of what the frames of each source show."""

from collections.abc import Mapping, Sequence

import numpy as np

from studies.tables import table
from studies.tables_paired import between
from studies.tasks.content import MEASURES

Entry = Mapping[str, Mapping[str, Sequence[float]]]  # source: measure: of each draw


def content_tables(found: Mapping[str, Entry]) -> str:
    """Return the table of {camera: entry}."""
    draws = [len(next(iter(entry.values()))[MEASURES[0]]) for entry in found.values()]
    rows = [
        [source, *(cell(entry[source]) for entry in found.values())]
        for source in next(iter(found.values()))
    ]
    return (
        f"### What frames show, {between(draws)} draws\n\n"
        "Medians over frames, balanced and exposed alike: the median green of white 1; "
        "the median saturation; in stops, the step that nine of ten neighbours in "
        f"green do not reach.\n\n{table(['frames of', *found], rows)}"
    )


def cell(measures: Mapping[str, Sequence[float]]) -> str:
    """Return a source's measures in one cell: means over draws."""
    return "; ".join(f"{np.mean(measures[name]):.2f}" for name in MEASURES)
