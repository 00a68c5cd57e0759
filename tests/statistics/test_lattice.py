# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

import numpy as np
import pytest

from cg2raw.statistics.lattice import lattice_of

NOISE, STEP = 2.0, 3.0  # DN


def light(shape, pitch=None, row=0, column=0, seed=1):
    """Return (H, W) of noise, on a slope and rows of their own, with a lattice."""
    rng = np.random.default_rng(seed)
    found = NOISE * rng.standard_normal(shape) + np.linspace(0, 50, shape[1])
    found += 9 * rng.standard_normal(shape[0])[:, None]
    if pitch:
        found[row::pitch, column::pitch] -= STEP
    return found.astype(np.float32)


@pytest.mark.parametrize(
    ("shape", "pitch", "row", "column", "side"),
    [
        ((300, 480), 12, 5, 3, 2),
        ((270, 396), 9, 4, 8, 1),
        ((80, 2150), 16, 6, 1, 2),  # of which the middle 2048 columns tell
    ],
)
def test_a_planted_lattice_is_found_with_its_nats(shape, pitch, row, column, side):
    """Half a square of each pixel's step over its noise: by second differences down and
    across, 3/2 of the pixel's own. Of 640 pixels and more the square is known to 8 %.
    """
    found = lattice_of(light(shape, pitch, row, column), side)
    assert (found.pitch, found.row, found.column) == (pitch, row, column)
    pixels = (shape[0] // pitch) * (min(shape[1], 2048) // pitch)
    nats = pixels * (STEP / NOISE / 1.5) ** 2 / 2
    assert found.is_sure and found.nats == pytest.approx(nats, rel=0.2)
    samples = found.samples(shape)
    assert samples[row, column] and samples.mean() == pytest.approx(pitch**-2, rel=0.02)


def test_noise_has_no_sure_lattice_and_a_small_frame_none():
    """Of 4 to 64 px there are 89,426 lattices, one of which stands out most."""
    found = lattice_of(light((600, 600)), 2)
    assert not found.is_sure and found.tried == sum(n**2 for n in range(4, 65))
    assert all(lattice_of(light(shape), 2) is None for shape in ((4, 4), (6, 6)))
