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
    # One whose neutrals nobody published.
    with pytest.raises(ValueError, match="has no measured neutrals.*nor a mixture"):
        cg2raw.Sensor("canon-70d").illuminant("measured:0")


MIXTURE = [
    {"weight": 0.75, "mean": [0.45, 0.75], "covariance": [[4e-4, 0.0], [0.0, 1e-4]]},
    {"weight": 0.25, "mean": [0.9, 0.3], "covariance": [[9e-4, -3e-4], [-3e-4, 4e-4]]},
]
SUMMED = {
    "mean": [0.56, 0.64],
    "covariance": [[0.04, -0.03], [-0.03, 0.04]],
    "hull": [[0.3, 0.5], [0.8, 0.1], [1.1, 0.4], [0.6, 1.0], [0.3, 0.9]],
}


def test_a_mixture_stands_for_neutrals_that_are_not_listed():
    text = cameras.profile_text(illuminants={**SUMMED, "mixture": MIXTURE})
    sensor = cg2raw.Sensor.from_json(text)
    drawn = drawn_by("measured", sensor, 2000)
    warm = drawn[:, 0] > 0.68
    assert warm.mean() == pytest.approx(0.25, abs=0.03)
    for part, group in zip(MIXTURE, (drawn[~warm], drawn[warm]), strict=True):
        assert group.mean(axis=0) == pytest.approx(np.array(part["mean"]), abs=5e-3)
        assert np.cov(group.T) == pytest.approx(np.array(part["covariance"]), abs=1e-4)
    assert np.array_equal(drawn[:50], drawn_by("measured", sensor, 50))
    assert sensor.illuminants["mixture"][1]["mean"] == [0.9, 0.3]
    assert cg2raw.Sensor.from_json(sensor.to_json()).to_json() == sensor.to_json()


def test_sample_does_not_look_at_the_mixture():
    with_it, without = (
        cg2raw.Sensor.from_json(cameras.profile_text(illuminants={**SUMMED, **more}))
        for more in ({"mixture": MIXTURE}, {})
    )
    assert np.array_equal(
        drawn_by("sample", with_it, 20), drawn_by("sample", without, 20)
    )


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"weight": 0.5}, "sum of weights 0.75 must be 1"),
        ({"weight": 0.0}, "weight 0 must be above 0"),
        ({"mean": [0.2, 0.2]}, "must lie in the hull"),
        ({"mean": [0.9, -1.0]}, "must be within 0.01 to 100"),
        ({"covariance": [[1e-4, 1.0], [1.0, 1e-4]]}, "positive semi-definite"),
        ({"covariance": [[9.0, 0.0], [0.0, 1e-4]]}, "the square of the hull's range"),
        ({"covariance": [[9.0, 0.0]]}, "[[rr, rb], [rb, bb]]"),
    ],
)
def test_a_mixture_that_no_draw_can_be_made_of_is_refused(change, said):
    parts = [{**MIXTURE[0], **change}, MIXTURE[1]]
    with pytest.raises(ValueError, match="mixture") as error:
        cg2raw.Sensor.from_json(
            cameras.profile_text(illuminants={**SUMMED, "mixture": parts})
        )
    assert said in str(error.value)


def test_a_mixture_beside_neutrals_or_of_too_many_is_refused():
    for illuminants, said in (
        ({"neutrals": TWO_GROUPS, "mixture": MIXTURE}, "mixture is unknown"),
        ({**SUMMED, "mixture": 17 * MIXTURE[:1]}, "at most 16"),
    ):
        with pytest.raises(ValueError, match=said):
            cg2raw.Sensor.from_json(cameras.profile_text(illuminants=illuminants))
