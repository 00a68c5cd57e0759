# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tables of study 2: PSNR and SSIM of frames, denoised as each source teaches.

Of each camera one table a measure, a column for each condition; more is better."""

from collections.abc import Mapping, Sequence

import numpy as np

from studies.tables import table
from studies.tables_paired import BASELINES, FLOOR, OWN, REAL, extent, gain_rows

# condition: source: measure: (draws, frames)
Entry = Mapping[str, Mapping[str, Mapping[str, Sequence[Sequence[float]]]]]
MEASURES = {"psnr": ("PSNR, dB", 2, 3), "ssim": ("SSIM", 4, 4)}  # decimals of each cell
PAIRS = ((OWN, REAL), (FLOOR, REAL), *((OWN, baseline) for baseline in BASELINES))


def denoising_tables(found: Mapping[str, Entry], learner: str = "") -> str:
    """Return the tables of {camera: entry}. learner : its name in the heading."""
    ofs = [next(iter(entry.values()))[REAL]["psnr"] for entry in found.values()]
    parts = [
        f"### Denoising{learner}, {extent(ofs)}\n\n"
        "Means, and paired differences (SE over draws and frames). In *own exposure* "
        "the frames of ours and UPI are as bright as their methods leave them."
    ]
    parts += [
        measure_table(measure, camera, entry)
        for measure in MEASURES
        for camera, entry in found.items()
    ]
    return "\n\n".join(parts)


def measure_table(measure: str, camera: str, entry: Entry) -> str:
    """Return the table of one of MEASURES: of sources, then of PAIRS, by conditions."""
    title, digits, more = MEASURES[measure]
    conditions = [
        {source: values[measure] for source, values in of_sources.items()}
        for of_sources in entry.values()
    ]
    rows = [
        [source, *(f"{np.mean(values[source]):.{digits}f}" for values in conditions)]
        for source in conditions[0]
    ]
    pairs = [pair for pair in PAIRS if set(pair) <= set(conditions[0])]
    rows += gain_rows(pairs, conditions, more)
    return table([f"{title}; {camera}", *entry], rows)
