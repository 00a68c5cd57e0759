# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The folders of seeds that fuzzing starts from."""

from pathlib import Path


def write_seeds(folder, kinds):
    """Write {kind: {name: bytes or text}}, each kind to a folder of @folder."""
    for kind, seeds in kinds.items():
        place = Path(folder) / kind
        place.mkdir(parents=True, exist_ok=True)
        for name, seed in seeds.items():
            data = seed if isinstance(seed, bytes) else seed.encode()
            (place / name).write_bytes(data)
