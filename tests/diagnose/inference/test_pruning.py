# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Pruning: what a few tiles of large frames miss, all of them miss."""

import numpy as np
import pytest

from cg2raw.diagnose.inference import pruning
from cg2raw.diagnose.inference.fitting import fit
from cg2raw.diagnose.inference.pruning import missed_beside, missed_by_few, pruned
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.likelihood import log_density
from diagnose.planted import (
    ONE,
    READ,
    captures_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
)

SENSOR = sensor_of()
SHAPE = (240, 320)
PIXELS = 20000  # 25 tiles of a frame
THRESHOLD = 8.0
TRUE = model_of(SENSOR, lens_shading=[0, -0.05, -0.05, 0, 0, 0, 0], read_noise=[1.0])


@pytest.fixture(scope="module")
def splits():
    kinds = ("dark", "flat", "dark", "flat")
    frames = [
        frame
        for group in ("fit", "select")
        for frame in drawn(
            frames_of(SENSOR, captures_of(kinds, group, shape=SHAPE), PIXELS), TRUE, 5
        )
    ]
    return Splits(frames, ONE)


@pytest.fixture(scope="module")
def model(splits):
    more = {"row_noise": [0.02], "black_level": [1e-3 * READ] * 4}
    start = model_of(SENSOR, **more)
    for term in TRUE.terms:
        start = start.with_term(term)
    return fit(start, splits.fit)


def test_a_few_tiles_say_what_all_lose(splits, model):
    losses = missed_by_few(model, splits, model.found_names, THRESHOLD)
    assert set(losses) == {"lens_shading", "read_noise"}
    height = splits.select.total(model)
    for name, loss in losses.items():
        rest = fit(model.without(name), splits.fit)
        # Corners, of which a few tiles hold more, show most of the shading.
        least = 0.2 if name == "lens_shading" else 0.8
        assert least < (height - splits.select.total(rest)) / loss < 1.2, name


def test_small_frames_have_no_fewer_tiles():
    captures = captures_of(("dark", "flat"))
    splits = Splits(frames_of(SENSOR, captures), ONE)
    assert splits.few is None
    assert missed_by_few(model_of(SENSOR), splits, ["exposure"], THRESHOLD) == {}


def test_what_is_needed_is_kept_and_no_more(splits, model):
    left = pruned(model, splits, THRESHOLD)
    assert set(left.losses) == set(left.model.names) == {"lens_shading", "read_noise"}
    assert set(left.dropped) == {"row_noise", "black_level"}


def test_what_a_fit_leaves_at_none_goes_without_another(splits, model):
    said = []
    null = model.with_term(model_of(SENSOR, dsnu=[0.0]).terms[0])
    left = pruned(null, splits, THRESHOLD, said.append)
    assert left.dropped["dsnu"] == 0.0 and "is dsnu needed" not in said
    assert set(left.model.names) == {"lens_shading", "read_noise"}


@pytest.mark.parametrize("name", ["row_noise", "black_level"])
def test_what_is_missed_beside_others_alone_is_asked_for_again(
    splits, model, monkeypatch, name
):
    """As where effects stand in for each other, so that no fit without one of them gets
    to where the others would: once these are gone, it misses nothing."""

    def missed(model, splits, names, threshold, report=None):
        few = {"lens_shading", "read_noise"}
        few |= {name} if len(model.names) > 3 else set()
        return dict.fromkeys(few & set(names), 1e4)

    monkeypatch.setattr(pruning, "missed_by_few", missed)
    left = pruned(model, splits, THRESHOLD)
    assert set(left.losses) == set(left.model.names) == {"lens_shading", "read_noise"}
    assert set(left.dropped) == {"row_noise", "black_level"}


def test_the_newest_effect_may_stand_in(splits, model):
    """Exposure takes up a part of the shading, and no read noise: this is missed."""
    both = fit(model.with_term(model_of(SENSOR, exposure=[0]).terms[0]), splits.fit)
    names = ["lens_shading", "read_noise", "black_level"]
    assert missed_beside(both, splits, names, "exposure") == {
        "lens_shading",
        "read_noise",
    }


def test_the_corners_are_among_a_few_tiles(splits):
    frame = splits.frames[0]
    few = frame.of_few_tiles()
    rows, columns = few.tiles.origins.T
    last = np.subtract(SHAPE, few.tiles.size)
    assert len(few.signal) == 9 == len(few.tiles.origins)
    assert {(0, 0), (0, last[1]), (last[0], 0), tuple(last)} <= set(
        zip(rows, columns, strict=True)
    )
    assert on([few]).total(TRUE) == pytest.approx(
        sum_over(frame, frame.tiles.few), rel=1e-9
    )


def sum_over(frame, places):
    """Return the log-likelihood of some tiles of a frame."""
    density = log_density(TRUE, frame)[0]
    return float(density[places][frame.keep[places]].sum())
