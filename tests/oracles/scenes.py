# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Scenes in which nothing is dark, and nothing clips."""

import numpy as np


def scene(height=40, width=60):
    """Return (H, W, 3) colours that have nothing to do with their neighbours."""
    rng = np.random.default_rng(8)
    return rng.uniform(0.1, 0.6, (height, width, 3)).astype(np.float32)
