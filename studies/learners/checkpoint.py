# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A file in which a training stands still, to go on or to be used. It needs PyTorch."""

import os
import pickle
from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Checkpoint:
    """A file of a state: tensors, numbers, words, and lists and dicts of them."""

    path: Path
    key: str  # tells what is trained: a file of another key is no state of it

    def read(self) -> dict[str, Any] | None:
        """Return the state; None without a file of this key.

        Raises ValueError for a file that is no checkpoint."""
        import torch

        if not self.path.exists():
            return None
        try:
            found = torch.load(self.path, map_location="cpu", weights_only=True)
            key, state = found["key"], dict(found["state"])
        except (
            EOFError,
            KeyError,
            RuntimeError,
            TypeError,
            pickle.UnpicklingError,
        ) as error:
            raise ValueError(f"{self.path}: is no checkpoint: {error}") from None
        return state if key == self.key else None

    def write(self, state: dict[str, Any]) -> None:
        """Write the state: the file is the earlier one or the new one, never a part."""
        import torch

        self.path.parent.mkdir(parents=True, exist_ok=True)
        part = self.path.with_suffix(f".{os.getpid()}.part")
        torch.save({"key": self.key, "state": state}, part)
        os.replace(part, self.path)
