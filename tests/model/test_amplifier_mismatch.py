# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Steps in the middle of frames, and mean images without them."""

import numpy as np
import pytest

from cg2raw.model.amplifier_mismatch import (
    Lines,
    amplifier_mismatch,
    parameter_names,
    unit_step,
)
from cg2raw.statistics.constant import PARTS, GroupInfo
from oracles.plain_statistics import plain_statistics

SPLITS = ("training", "validation", "test")
LEAST = 8.0
HORIZONTAL, SMOOTH = parameter_names(1), "bias_structure"


def statistics(axes, offset, response, ramp=0.0, seed=0):
    """Return those of darks and flats whose second half along each axis is above the
    first: by @offset, DN, and by the share @response of the light. ramp : DN from left
    to right."""
    rng = np.random.default_rng(seed)
    half = sum(np.indices((96, 120))[n] // (48, 60)[n] - 0.5 for n in axes)
    groups = []
    for split in SPLITS:
        for kind, light in (("dark", 0.0), ("flat", 800.0)):
            level = 300 + light + half * (offset + response * light)
            level = level + ramp * (np.arange(120) / 119 - 0.5)
            codes = np.rint(level + 4 * rng.standard_normal((3, 96, 120)))
            info = GroupInfo(kind, tuple("abc"), 0.0, None, split)
            groups.append((info, list(codes.astype(np.uint16))))
    return plain_statistics(groups, 2, 4095)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_step_is_measured_and_leaves_nothing(axis):
    """A step of 2 DN and of 1 %: what is left of the products is that of frames without
    one, but for the freedom that was taken off."""
    made, plain = statistics([axis], 2.0, 0.01), statistics([axis], 0.0, 0.0)
    found = amplifier_mismatch(made, SPLITS, LEAST, {})
    assert found.gain > 30
    steps = [found.steps[name] for name in parameter_names(axis)]
    for step, truth in zip(steps, (2.0, 0.01), strict=True):
        assert step.value == pytest.approx(truth, abs=3 * step.error)
    assert steps[0].error < 0.25 and steps[1].error < 4e-4
    nothing = amplifier_mismatch(plain, SPLITS, LEAST, {})
    assert (nothing.gain < LEAST, nothing.steps) == (True, {})
    rest = found.taken_off(made)
    back = found.given_back(rest).planes[3]
    assert back.products == pytest.approx(made.planes[3].products, rel=1e-9)
    left, without = (one.planes[3].products for one in (rest, plain))
    for part in range(len(PARTS)):
        assert left[part] == pytest.approx(without[part], rel=0.1, abs=12)
    shape = (2, 48, 120) if axis == 0 else (96, 2, 60)
    across = (1, 2) if axis == 0 else (0, 2)
    left, without = (
        np.diff(one.mean_of(3).reshape(shape).mean(axis=across))
        for one in (rest, plain)
    )
    assert left == pytest.approx(without, abs=0.8)


def test_steps_of_both_axes_gain_what_each_gains():
    """Lines of one axis have the other's step in their mean alone. Of steps that gain
    too little the gain is that of the better axis."""
    alone = [
        amplifier_mismatch(statistics([axis], 2.0, 0.01), SPLITS, LEAST, {}).gain
        for axis in (0, 1)
    ]
    both = statistics([0, 1], 2.0, 0.01)
    found = amplifier_mismatch(both, SPLITS, LEAST, {})
    assert len(found.steps) == 4 and found.gain == pytest.approx(sum(alone))
    small = amplifier_mismatch(both, SPLITS, 1e6, {})
    assert not small.steps and 30 < small.gain < min(alone)


def test_a_step_that_is_stated_gains_nothing_and_is_taken_off():
    made = statistics([1], 2.0, 0.01)
    found = amplifier_mismatch(
        made, SPLITS, LEAST, dict(zip(HORIZONTAL, (2.0, 0.01), strict=True))
    )
    assert (found.gain < LEAST, found.steps) == (True, {})
    left = amplifier_mismatch(found.taken_off(made), SPLITS, LEAST, {})
    assert left.gain < LEAST
    other = amplifier_mismatch(made, SPLITS, LEAST, {HORIZONTAL[0]: 5.0})
    assert other.gain > 30
    assert other.steps[HORIZONTAL[0]].value == pytest.approx(2.0, abs=0.4)


@pytest.mark.parametrize("ramp, alike", [(0.0, []), (0.6, [SMOOTH]), (5.0, [])])
def test_a_ramp_is_no_step_and_may_be_like_one(ramp, alike):
    """Weak ones may, of which the first polynomial alone is above the noise."""
    found = amplifier_mismatch(statistics([1], 0.0, 0.0, ramp), SPLITS, LEAST, {})
    assert (found.gain < LEAST, found.steps, [*found.alike]) == (True, {}, alike)


@pytest.mark.parametrize(("is_free", "ramp"), [(False, 0), (True, 0), (True, 3)])
def test_errors_are_those_of_draws(is_free, ramp):
    """Of 100 draws, with a ramp of 3 DN from edge to edge, too: then what is smooth
    says nothing."""
    deviates, errors, noise = [], [], 0.2
    for seed in range(100):
        rng = np.random.default_rng(seed)
        lines = noise * rng.standard_normal(60) + 0.5 * unit_step(60)
        lines += ramp * (np.arange(60) / 60 - 0.5)
        step = Lines.of(lines).step(is_free)
        errors.append(step.error)
        deviates.append((step.value - 0.5) / step.error)
    assert (np.mean(errors) < 0.08) == (ramp == 0)
    assert np.mean(np.abs(deviates) < 1.96) > 0.9
    assert 0.75 < np.std(deviates) < 1.25


def test_parts_that_are_not_noise_tell_a_step_by_student_s_law():
    """Whose variance is n / (n - 2) times as large: of lines that know nothing else."""
    lines = 0.2 * np.random.default_rng(1).standard_normal(60)
    known = Lines(lines, 0.0, np.inf, 1e-12)
    step = known.step()
    expected = 0.0
    for of_lines, of_step in known.parts:
        rest = of_lines - step.value * of_step
        variance, count = rest @ rest / len(rest), len(rest)
        expected += of_step @ of_step / (variance * count / (count - 2))
    assert step.error == pytest.approx(expected**-0.5)


def test_frames_without_noise_show_no_step():
    frame = np.full((96, 120), 300, np.uint16)
    groups = [
        (GroupInfo("dark", ("a", "b"), 0.0, None, split), [frame, frame])
        for split in SPLITS
    ]
    found = amplifier_mismatch(plain_statistics(groups, 2, 4095), SPLITS, LEAST, {})
    assert (found.gain, found.errors) == (0, {})


def test_few_lines_show_no_step():
    groups = [
        (GroupInfo("dark", ("a", "b"), 0.0, None, split), [frame, frame + 1])
        for split in SPLITS
        for frame in [np.arange(3072, dtype=np.uint16).reshape(48, 64) % 7]
    ]
    found = amplifier_mismatch(plain_statistics(groups, 2, 4095), SPLITS, 0.0, {})
    assert "vertical_offset" not in found.errors
