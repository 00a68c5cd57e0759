# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""How a frame was quantised shows in the codes that it has."""

import numpy as np
import pytest

from cg2raw.statistics import codes


def counts_of(values):
    """Return how many values have each DN, of values rounded and cut off at 0."""
    rounded = np.maximum(np.rint(values), 0).astype(np.int64)
    return np.bincount(rounded.ravel())


def pixels_at(many):
    """Return the counts of {DN: how many pixels}."""
    return counts_of(np.repeat([*many], [*many.values()]))


def noise(sigma, size=100_000, seed=1):
    """Return normal noise around 64.3 DN."""
    return np.random.default_rng(seed).normal(64.3, sigma, size)


def picture(seed=1):
    """Return greys of a picture, 0 to 4000 DN, with noise of 4 DN."""
    rng = np.random.default_rng(seed)
    return rng.uniform(0, 4000, 200_000) + rng.normal(0, 4, 200_000)


# Codes 1 to 3, 6 and 7 never occur, as in a dark of a real camera.
MISSING = np.array([0, 0, 4, 4, 4, 5, 8, 8, *range(8, 200)])


@pytest.mark.parametrize(
    ("values", "least", "most"),
    [
        (MISSING[np.maximum(np.rint(noise(2.5) - 62), 0).astype(int)], 0.3, 0.6),
        (np.floor(picture()) // 8 * 8 + np.floor(picture()) % 5, 0.36, 0.38),
        (noise(0.3), 0, 0),
        (noise(2.5), 0, 0),
        (picture(), 0, 0),
        (np.concatenate([noise(1), noise(1) + 40]), 0, 0),  # two greys of a chart
    ],
)
def test_missing_codes(values, least, most):
    assert least <= codes.gaps(counts_of(values)) <= most


@pytest.mark.parametrize("seed", range(200))
def test_chance_leaves_no_gap_and_no_isolated_code(seed):
    counts = counts_of(np.random.default_rng(seed).normal(30, 4, 2000))
    assert codes.gaps(counts) == 0 and codes.isolated(counts) == 0


@pytest.mark.parametrize(
    ("values", "alone"),
    [
        (np.rint(noise(3) / 16) * 16, 1.0),
        (
            4000 * (np.rint(255 * (picture() / 4000).clip(0, 1) ** 0.45) / 255) ** 2.2,
            0.9,
        ),
        (noise(0.35), 0.0),
        (picture(), 0.0),
        (np.array([3, 9]), 0.0),  # too few
        (noise(0.35) - 64.3, 0.0),  # most at 0, which the ADC cuts off
    ],
)
def test_codes_without_neighbours(values, alone):
    assert codes.isolated(counts_of(values)) == pytest.approx(alone, abs=0.1)


@pytest.mark.parametrize(
    ("values", "piles"),
    [
        (np.minimum(picture(), 255), True),
        (picture() / 4000 * 255, False),
        (np.minimum(picture(), 256), False),
        (np.append(np.minimum(picture(), 255), 256), False),
        (np.minimum(noise(20) + 150, 255), True),
        (noise(2), False),
    ],
)
def test_white_of_eight_bits(values, piles):
    assert codes.piles_up_at_byte(counts_of(values)) == piles


@pytest.mark.parametrize(
    ("highest", "bits", "white", "words"),
    [
        (1023, 10, 1023, ""),
        (1024, 10, 1023, "1024 DN does not fit into 10 bits (1023): give the sensor"),
        (255, 8, 255, ""),
        (
            255,
            10,
            1023,
            "nothing is above 255 DN, where pixels pile up, and white is 1",
        ),
    ],
)
def test_what_a_camera_does_not_write(highest, bits, white, words):
    found = codes.misfit(counts_of(np.minimum(picture(), highest)), bits, white)
    assert found.startswith(words) and bool(found) == bool(words)


@pytest.mark.parametrize(
    ("counts", "share"),
    [
        ([0, 0, 30, 200, 300, 200, 30], 0),  # no code is cut
        ([3, 0, 0, 0, 0, 200, 300, 200], 0),  # dead pixels
        ([500, 80, 79, 70, 50, 20], 500 / 799),
        ([900, 90, 0, 0], 900 / 990),  # most are at 0
        ([0, 900, 90, 3], 0),  # quiet, with hot pixels
        ([0, 900, 60, 5], 0),  # of which a few are far
        ([0, 500, 80, 79, 70, 50, 20], 500 / 799),
    ],
)
def test_the_share_of_noise_that_is_cut(counts, share):
    assert codes.cut_share(np.array(counts)) == pytest.approx(share)


@pytest.mark.parametrize(
    ("many", "step", "spacing"),
    [
        ({64: 1000}, (0, 1), 0),
        ({64: 5000, 68: 10000, 72: 5000}, (4, 3), 4),
        ({64: 5000, 66: 1, 68: 10000, 72: 5000}, (2, 4), 4),  # in the middle 98 %
        ({64: 50000, 68: 100000, 72: 50000, 74: 200}, (4, 3), 4),  # hot pixels
        ({64: 50000, 68: 100000, 72: 50000, 74: 201}, (2, 4), 4),  # 0.1 %: no chance
        ({10: 20, 12: 20}, (2, 2), 2),
        ({10: 19, 12: 90}, (2, 2), 0),  # of 19, none may be in between by chance
        ({10: 100, 11: 100, 14: 30, 17: 30, 20: 30}, (1, 5), 1),
        ({10: 80, 11: 80, 14: 30, 17: 30, 20: 30}, (1, 5), 3),  # of most pixels
    ],
)
def test_steps_and_distances_of_codes(many, step, spacing):
    counts = pixels_at(many)
    assert (codes.step_of(counts), codes.spacing(counts)) == (step, spacing)


@pytest.mark.parametrize(
    ("near", "far", "words"),
    [(1, 2, ""), (0, 3, ""), (3, 1, ""), (1, 3, "b: its codes are 3 DN apart, at 40")],
)
def test_codes_of_light_that_lie_farther_apart_are_companded(near, far, words):
    found = codes.companded([("b", 4000.0, far), ("a", 100.0, near)])
    assert found.startswith(words) and bool(found) == bool(words)
    assert ("and 1 DN at 100 DN" in found) == bool(words)


@pytest.mark.parametrize("step", [1, 4])
def test_rounding_hides_noise_whose_variance_with_it_is_below_that_of_emva(step):
    """EMVA 1288, R4.0: 0.49 of a step, rounding with its 1 / 12 included."""
    assert codes.hidden(step) == pytest.approx(
        step * (0.49**2 - 1 / 12) ** 0.5, rel=0.01
    )
