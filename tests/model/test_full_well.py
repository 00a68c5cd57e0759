# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Wells are full where more light brings less noise; a law that is off is not that."""

from functools import partial

import numpy as np
import pytest

from cg2raw.model.evaluation import Parameters
from cg2raw.model.full_well import full_well
from cg2raw.statistics.constant import GroupInfo
from cg2raw.statistics.frame_statistics import frame_statistics

SHAPE, WHITE, BLACK, READ, GAIN = (96, 128), 4095, 200, 3.0, 0.5
SPLITS = ("fit", "select")
LIGHTS = (500.0, 1000.0, 2000.0, 3000.0)
LEAST = 8.0


def profile(gain=GAIN):
    parameters = Parameters(1)
    found = np.zeros(len(parameters))
    for name, value in (
        ("black_level", BLACK),
        ("read_noise", READ**2),
        ("gain", gain),
    ):
        found[parameters.of(name)] = value
    return found


def frame(light, full, seed, averaged=1):
    """A frame whose charge ends at a level; the mean of several."""
    rng = np.random.default_rng([seed, int(light)])
    charge = np.minimum(rng.poisson(light / GAIN, (averaged, *SHAPE)) * GAIN, full)
    read = READ * rng.standard_normal((averaged, *SHAPE))
    mean = (charge + read).mean(axis=0)
    return np.clip(np.rint(BLACK + mean), 0, WHITE).astype(np.uint16)


def found(full, lights=LIGHTS, has_noise=True, averaged=1, given=GAIN, excluded=None):
    groups = []
    for light in (0.0, *lights):
        for number, split in enumerate(SPLITS):
            names = tuple(f"{light} {split} {n}" for n in range(2))
            info = GroupInfo("flat" if light else "dark", names, 0.1, None, split)
            own = averaged if light else 1
            readers = [
                partial(frame, light, full, 10 * number + n, own) for n in range(2)
            ]
            groups.append((info, readers))
    statistics = frame_statistics(groups, 1, WHITE, excluded=excluded)
    return full_well(statistics, SPLITS, profile(given), has_noise, LEAST), statistics


@pytest.mark.parametrize("has_noise", [False, True])
@pytest.mark.parametrize("full", [1200.0, 2500.0])
def test_flats_above_it_are_full(full, has_noise):
    well, statistics = found(full, has_noise=has_noise)
    above = {light for light in LIGHTS if light > full}
    assert {
        float(statistics.groups[g].frames[0].split()[0]) for g in well.groups
    } == above
    assert well.level == pytest.approx(full, abs=1.0)
    assert well.nats > 1000


@pytest.mark.parametrize("share", [0.0, 0.5], ids=["whole", "half masked"])
def test_flats_of_one_light_are_full_by_a_profile_alone(share):
    excluded = np.arange(SHAPE[0])[:, None] < share * SHAPE[0] * np.ones(SHAPE)
    given = {"lights": (2000.0,), "excluded": excluded}
    assert found(900.0, has_noise=False, **given)[0] is None
    well, _ = found(900.0, **given)
    assert well.level == pytest.approx(900.0, abs=1.0)


@pytest.mark.parametrize(
    "more",
    [{}, {"lights": (3000.0,)}, {"given": 4 * GAIN}, {"averaged": 16}],
    ids=["as stated", "one light", "another gain", "means of frames"],
)
def test_no_well_is_full(more):
    """Less shot noise than a profile says is another gain, or a mean of frames."""
    assert found(1e9, **more)[0] is None


def test_what_only_one_split_shows_is_no_name():
    """Flats of the one split alone are full: they are left out, and nothing is said."""
    _, statistics = found(1200.0)
    names = [
        g
        for g, one in enumerate(statistics.groups)
        if one.split == "fit" or not one.frames[0].startswith(("2", "3"))
    ]
    well = full_well(statistics.only(names), SPLITS, profile(), True, LEAST)
    assert well.groups and well.nats == 0.0


@pytest.mark.parametrize("light", [WHITE - BLACK, WHITE - BLACK + 60.0])
def test_flats_that_are_clipped_at_white_have_no_full_well(light):
    """Half of the pixels and more, which leaves a third of their noise and less."""
    assert found(np.inf, lights=(500.0, 2000.0, float(light)))[0] is None
