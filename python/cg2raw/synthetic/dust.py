# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Dust on the cover glass: opaque flakes whose shadows are blurred by the aperture."""

import numpy as np
from numpy.random import Generator
from scipy.ndimage import gaussian_filter

from cg2raw.synthetic.camera import Plane
from cg2raw.synthetic.light import Hidden

AROUND = 2.0  # largest radii beyond the frame where flakes may lie


def transmission(rng: Generator, shape: tuple[int, int], hidden: Hidden) -> Plane:
    """Return (H, W) the share of light that dust lets through.

    Discs of half to one and a half times the mean radius, all as dark, blurred by a
    penumbra; at least one of them in the frame."""
    if "dust" not in hidden:
        return np.ones(shape)
    v = hidden["dust"]
    rows, cols = np.indices(shape)
    lost = np.zeros(shape)
    margin = AROUND * v["radius_px"]
    area = (shape[0] + 2 * margin) * (shape[1] + 2 * margin)
    count = max(int(rng.poisson(v["per_megapixel"] * area / 1e6)), 1)
    for number in range(count):
        beyond = 0.0 if number == 0 else margin
        row, col = (rng.uniform(-beyond, length + beyond) for length in shape)
        radius = v["radius_px"] * rng.uniform(0.5, 1.5)
        disc = np.clip(radius + 0.5 - np.hypot(rows - row, cols - col), 0, 1)
        lost = 1 - (1 - lost) * (1 - disc)
    blurred: Plane = 1 - v["loss"] * gaussian_filter(lost, v["soft_px"], mode="nearest")
    return blurred
