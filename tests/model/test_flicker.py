# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A planted wave of mains light: its amplitude and period, of chance phases."""

import numpy as np
import pytest

from cg2raw.model.fit import fit
from cg2raw.model.flicker import flicker
from cg2raw.statistics.constant import GroupInfo
from cg2raw.statistics.frame_statistics import frame_statistics

SHAPE = (240, 80)


def flats_of(amplitude, period, side=1, frames=4, lights=(1000.0, 2500.0), seed=1):
    """Return the fit of darks and flats whose noise is 4 DN and light's, 1 DN^2 a DN;
    rows of the frames differ as well, alike in all flats."""
    rng = np.random.default_rng(seed)
    rows = np.arange(SHAPE[0])
    shade = 1 + 0.01 * rng.standard_normal((SHAPE[0], 1)) + 0.1 * (rows / 240)[:, None]
    groups = []
    for split in ("training", "validation"):
        for light in (0.0, *lights):
            made = []
            for _ in range(frames):
                turns = rows / period + rng.random()
                wave = 1 + amplitude * np.cos(2 * np.pi * turns)[:, None]
                mean = light * shade * wave
                noise = np.sqrt(16 + mean) * rng.standard_normal(SHAPE)
                made.append(np.rint(200 + mean + noise).astype(np.uint16))
            kind = "flat" if light else "dark"
            names = tuple(f"{split} {light} {n}" for n in range(frames))
            info = GroupInfo(kind, names, 0.1 * (light > 0), split=split)
            groups.append((info, [lambda f=f: f for f in made]))
    return fit(frame_statistics(groups, side, 65535))


@pytest.mark.parametrize("side", [1, 2])
@pytest.mark.parametrize(("amplitude", "period"), [(0.03, 36.8), (0.01, 61.3)])
def test_planted_waves(amplitude, period, side):
    """Within 95 % intervals, and these are narrow: by 16 phases the amplitude is known
    to some per cent, the period to a fraction of a row."""
    found = {
        name: numbers for name, *numbers in flicker(flats_of(amplitude, period, side))
    }
    for name, truth in (("amplitude", amplitude), ("period", period)):
        value, low, high = found[name]
        assert low < truth < high, (name, value, low, high)
        assert high - low < 0.5 * value
    assert found["period"][2] - found["period"][1] < 2


def test_one_mean_image_has_no_period():
    first = flats_of(0.03, 36.8, lights=(1000.0,)).likelihood.means.statistics
    assert list(flicker(fit(first.only([0, 1])))) == []
