# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tables of study 3: how near each source's neural ISP comes to the renderer."""

from collections.abc import Mapping, Sequence

import numpy as np

from studies.tables import table
from studies.tables_paired import BASELINES, FLOOR, OWN, REAL, error_rows, extent

Entry = Mapping[str, Mapping[str, Sequence[Sequence[float]]]]  # source: measure: (d, n)


def isp_tables(found: Mapping[str, Entry]) -> str:
    """Return the tables of {camera: errors}."""
    first = next(iter(found.values()))
    size = extent(entry[REAL]["difference"] for entry in found.values())
    rows = [
        [source, *(cell(found[camera][source]) for camera in found)] for source in first
    ]
    pairs = (
        (OWN, REAL),
        (FLOOR, REAL),
        *((baseline, REAL) for baseline in BASELINES),
        *((OWN, baseline) for baseline in BASELINES),
        (OWN, "ours, paper"),
    )
    differences = [
        {source: measures["difference"] for source, measures in entry.items()}
        for entry in found.values()
    ]
    apart = error_rows(pairs, differences)
    return (
        f"### Neural ISP, {size}\n\n"
        "CIEDE2000 +- sd over draws; PSNR in dB.\n\n"
        f"{table(['trained on', *found], rows)}\n\n"
        "Paired differences of CIEDE2000 (SE over draws and frames).\n\n"
        f"{table(['difference', *found], apart)}"
    )


def cell(measures: Mapping[str, Sequence[Sequence[float]]]) -> str:
    """Return a source's measures in one cell."""
    of_draws = np.mean(measures["difference"], axis=1)
    psnr = np.mean(measures["psnr"])
    return f"{of_draws.mean():.2f} +- {of_draws.std(ddof=1):.2f}; {psnr:.2f}"
