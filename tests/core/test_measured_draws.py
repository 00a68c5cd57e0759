# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""measured:n draws near a profile's own neutrals, where sample:n has their Gaussian."""

import numpy as np
import pytest

import cg2raw
from oracles import cameras

TWO_GROUPS = [
    [0.40 + 0.01 * i, 0.80 - 0.01 * i + 0.003 * (i % 3)] for i in range(12)
] + [[0.90 + 0.01 * i, 0.30 - 0.005 * i + 0.004 * (i % 2)] for i in range(12)]


def drawn_by(word, sensor, count):
    """Return (R/G, B/G) of the first draws of a word."""
    lights = [sensor.illuminant(f"{word}:{i}").neutral for i in range(count)]
    return np.array(lights)[:, [0, 2]]


def test_measured_draws_lie_between_a_neutral_and_one_of_its_nearest():
    text = cameras.profile_text(illuminants={"neutrals": TWO_GROUPS})
    sensor = cg2raw.Sensor.from_json(text)
    known, drawn = np.array(TWO_GROUPS), drawn_by("measured", sensor, 400)
    assert np.array_equal(
        drawn, drawn_by("measured", cg2raw.Sensor.from_json(text), 400)
    )
    apart = np.linalg.norm(known[:, None] - known[None], axis=2)
    ends = np.argsort(apart, axis=1)[:, 1:6]  # of each its five nearest
    a, b = known.repeat(5, axis=0), known[ends.ravel()]
    way = ((drawn[:, None] - a) * (b - a)).sum(axis=2) / ((b - a) ** 2).sum(axis=1)
    foot = a + way.clip(0.0, 1.0)[..., None] * (b - a)
    assert np.linalg.norm(drawn[:, None] - foot, axis=2).min(axis=1).max() < 2e-6


def test_measured_draws_keep_groups_apart_that_a_gaussian_joins():
    sensor = cg2raw.Sensor.from_json(
        cameras.profile_text(illuminants={"neutrals": TWO_GROUPS})
    )
    between = [
        ((drawn[:, 0] > 0.55) & (drawn[:, 0] < 0.85)).mean()
        for drawn in (
            drawn_by("measured", sensor, 400),
            drawn_by("sample", sensor, 400),
        )
    ]
    assert between[0] == 0.0 and between[1] > 0.2
    assert (drawn_by("measured", sensor, 400)[:, 0] < 0.6).mean() == pytest.approx(
        0.5, abs=0.1
    )


@pytest.mark.parametrize(
    ("neutrals", "said"),
    [([], "no measured"), ([[0.5, 0.6], [0.7, 0.4]], "fewer than 3 measured")],
)
def test_measured_draws_need_the_neutrals_themselves(neutrals, said):
    sensor = cg2raw.Sensor.from_json(
        cameras.profile_text(illuminants={"neutrals": neutrals})
    )
    with pytest.raises(ValueError, match=f"{said} neutrals.*sample:N, or make") as e:
        sensor.illuminant("measured:0")
    assert "\n" not in str(e.value)
    # A bundled sensor has their mean, covariance and hull alone.
    with pytest.raises(ValueError, match="has no measured neutrals"):
        cg2raw.Sensor("samsung-s20fe").illuminant("measured:0")
