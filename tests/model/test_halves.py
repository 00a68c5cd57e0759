# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Steps in the middle of frames, and mean images without them."""

import numpy as np
import pytest

from cg2raw.model.halves import halves_of, without_halves
from cg2raw.statistics.constant import PARTS, GroupInfo
from oracles.plain_statistics import plain_statistics

SPLITS = ("training", "validation")


def statistics(axis, offset, response, seed=0):
    """Return those of darks and flats whose second half is above the first: by @offset,
    DN, and by the share @response of the light."""
    rng = np.random.default_rng(seed)
    half = np.zeros((96, 120))
    half[(slice(48, None), slice(None)) if axis == 0 else np.s_[:, 60:]] = 1.0
    groups = []
    for split in SPLITS:
        for kind, light in (("dark", 0.0), ("flat", 800.0)):
            level = 300 + light + half * (offset + response * light)
            codes = np.rint(level + 4 * rng.standard_normal((3, 96, 120)))
            info = GroupInfo(kind, tuple("abc"), 0.0, None, split)
            groups.append((info, list(codes.astype(np.uint16))))
    return plain_statistics(groups, 2, 4095)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_step_is_measured_and_leaves_nothing(axis):
    """A step of 2 DN and of 1 %: what is left of the products is that of frames without
    one, but for the freedom that was taken off."""
    found = halves_of(made := statistics(axis, 2.0, 0.01), SPLITS, axis)
    assert found.nats > 30
    assert found.offset == pytest.approx(2.0, abs=0.4)
    assert found.response == pytest.approx(0.01, abs=0.0005)
    plain = statistics(axis, 0.0, 0.0)
    assert halves_of(plain, SPLITS, axis).nats < 8
    each = [without_halves(one, axis).planes[3] for one in (made, plain)]
    for part in range(len(PARTS)):
        products = [one.products[part] for one in each]
        assert products[0] == pytest.approx(products[1], rel=0.1, abs=12)
    lost = plain.planes[3].freedom - each[1].freedom
    name = "columns" if axis else "rows"
    assert [PARTS[n] for n in np.flatnonzero(lost)] == [
        f"{speed}_{name}" for speed in ("smooth", "slow", "fast")
    ]
    assert lost.sum() == 3


def test_few_lines_have_no_halves():
    groups = [
        (GroupInfo("dark", ("a", "b"), 0.0, None, split), [frame, frame + 1])
        for split in SPLITS
        for frame in [np.arange(3072, dtype=np.uint16).reshape(48, 64) % 7]
    ]
    assert halves_of(plain_statistics(groups, 2, 4095), SPLITS, 0).nats == 0
