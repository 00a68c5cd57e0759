# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A PyTorch Dataset of what `cg2raw dataset --format npy --iso clean,...` has made.

Each item is a noisy packed RAW, the clean one of the same scene, and the light.
"""

from pathlib import Path

import numpy as np
import pyarrow.parquet
import torch

COLUMNS = ["path", "clean_path", "neutral", "sensor", "iso"]


class RawPairs(torch.utils.data.Dataset):
    """Noisy files and their clean ones.

    folder : the data set. Items are dicts: "noisy" and "clean", (4, h, w) float32
    planes R, G1, G2, B, 0..1 above black; "neutral", (3,) camera RGB of the light,
    G = 1; "sensor"; "iso"."""

    def __init__(self, folder):
        self.folder = Path(folder)
        table = pyarrow.parquet.read_table(
            self.folder / "manifest.parquet", columns=COLUMNS
        )
        # An Arrow table is shared by the loader's processes; a list would be copied.
        self.rows = table.filter(table["clean_path"].is_valid())

    def __len__(self):
        return len(self.rows)

    def __getitem__(self, index):
        (row,) = self.rows.slice(index, 1).to_pylist()
        return {
            "noisy": self.planes(row["path"]),
            "clean": self.planes(row["clean_path"]),
            "neutral": torch.tensor(row["neutral"], dtype=torch.float32),
            "sensor": row["sensor"],
            "iso": row["iso"],
        }

    def planes(self, path):
        """Return the (4, h, w) float32 planes of a packed file."""
        planes = np.load(self.folder / path)
        if planes.dtype == np.uint16:
            planes = planes / np.float32(65535)
        return torch.from_numpy(planes)
