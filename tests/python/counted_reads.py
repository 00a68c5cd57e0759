# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""How much of its files this process has read."""

from pathlib import Path

import pytest


def bytes_read():
    """Return the bytes that all read calls of this process gave so far."""
    counts = Path("/proc/self/io")
    if not counts.exists():
        pytest.skip(f"no {counts}: reads are not counted here")
    return int(counts.read_text().split()[1])
