# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Table of what the exposure of renders is worth, for the ISP and for denoising."""

from collections.abc import Mapping, Sequence

import numpy as np

from studies.tables import table
from studies.tables_paired import REAL, error_rows, extent, gain_rows
from studies.tasks.exposure import ISP

# ISP or condition: source: measure: (draws, frames)
Entry = Mapping[str, Mapping[str, Mapping[str, Sequence[Sequence[float]]]]]


def exposure_tables(found: Mapping[str, Entry]) -> str:
    """Return the tables of {camera: entry}."""
    entries = list(found.values())
    parts = [
        f"### Exposure, {extent(entry[ISP][REAL]['psnr'] for entry in entries)}\n\n"
        "The camera's own frames, and differences to them (SE over draws and frames)."
    ]
    for part in sorted(entries[0], key=lambda part: part != ISP):
        measure = "difference" if part == ISP else "psnr"
        values = [
            {source: measures[measure] for source, measures in entry[part].items()}
            for entry in entries
        ]
        pairs = [(source, REAL) for source in values[0] if source != REAL]
        if part == ISP:
            unit, rows = "CIEDE2000", error_rows(pairs, values)
        else:
            unit, rows = "PSNR, dB", gain_rows(pairs, values, 2)
        first = [REAL, *(f"{np.mean(of[REAL]):.2f}" for of in values)]
        parts.append(table([f"{part}: {unit}", *found], [first, *rows]))
    return "\n\n".join(parts)
