# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tables of study 2: PSNR and SSIM of frames, denoised as each source teaches.

Of each condition one table a measure; more is better in both."""

from collections.abc import Mapping, Sequence

import numpy as np

from studies.tables import table
from studies.tables_paired import BASELINES, FLOOR, OWN, REAL, Values, gain_rows

# condition: source: measure: (draws, frames)
Entry = Mapping[str, Mapping[str, Mapping[str, Sequence[Sequence[float]]]]]
MEASURES = {"psnr": ("PSNR, dB", 2, 3), "ssim": ("SSIM", 4, 4)}  # decimals of each cell
PAIRS = ((OWN, REAL), (FLOOR, REAL), *((OWN, baseline) for baseline in BASELINES))


def denoising_tables(found: Mapping[str, Entry], learner: str = "") -> str:
    """Return the tables of {camera: entry}. learner : its name in the heading."""
    first = next(iter(found.values()))
    draws, frames = np.shape(next(iter(first.values()))[REAL]["psnr"])
    parts = [
        f"### Denoising{learner}, {draws} draws, {frames} test frames a camera\n\n"
        "Means, and paired differences (SE over draws and frames). In *own exposure* "
        "the frames of ours and UPI are as bright as their methods leave them."
    ]
    for condition in first:
        for measure in MEASURES:
            cameras = {
                camera: {
                    source: values[measure]
                    for source, values in entry[condition].items()
                }
                for camera, entry in found.items()
            }
            parts.append(measure_table(condition, measure, cameras))
    return "\n\n".join(parts)


def measure_table(condition: str, measure: str, cameras: Mapping[str, Values]) -> str:
    """Return the table of one of MEASURES: means of sources, and PAIRS of them."""
    title, digits, more = MEASURES[measure]
    sources = next(iter(cameras.values()))
    rows = [
        [source, *(f"{np.mean(v[source]):.{digits}f}" for v in cameras.values())]
        for source in sources
    ]
    pairs = [pair for pair in PAIRS if set(pair) <= set(sources)]
    rows += gain_rows(pairs, list(cameras.values()), more)
    return table([f"{title}; {condition}", *cameras], rows)
