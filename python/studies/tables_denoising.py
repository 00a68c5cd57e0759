# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tables of study 2: PSNR of frames that were denoised as each source teaches."""

from collections.abc import Mapping, Sequence

import numpy as np

from studies.tables import table
from studies.tables_paired import BASELINES, FLOOR, OWN, REAL, decibel_rows

Entry = Mapping[
    str, Mapping[str, Sequence[Sequence[float]]]
]  # condition: source: (d, n)


def denoising_tables(found: Mapping[str, Entry]) -> str:
    """Return the tables of {camera: PSNR in dB}."""
    first = next(iter(found.values()))
    sources = next(iter(first.values()))
    draws, frames = np.shape(sources[REAL])
    parts = [
        f"### Denoising, {draws} draws, {frames} test frames a camera\n\n"
        "PSNR in dB, and paired differences (SE over draws and frames)."
    ]
    pairs = (
        (OWN, REAL),
        (FLOOR, REAL),
        *((OWN, baseline) for baseline in BASELINES),
    )
    for condition in first:
        rows = [
            [source, *(f"{np.mean(e[condition][source]):.2f}" for e in found.values())]
            for source in sources
        ]
        rows += decibel_rows(pairs, [entry[condition] for entry in found.values()])
        parts.append(table([condition, *found], rows))
    return "\n\n".join(parts)
