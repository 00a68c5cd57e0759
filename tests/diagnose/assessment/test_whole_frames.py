# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Frames that are larger than what is looked at, gone through from edge to edge."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.assessment import pieces as pieces_module
from cg2raw.diagnose.assessment.pieces import Pieces
from cg2raw.diagnose.assessment.whole_frames import WholeFrames
from cg2raw.diagnose.frames.reader import read_frames
from cg2raw.diagnose.inference.noise_level import noise_models
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.synthetic.captures import simulate_captures
from diagnose.planted import model_of, on, sensor_of

SHAPE = 506, 1264  # 3 x 6 tiles, two batches
SENSOR = sensor_of(20_000.0)
BASE = Model(SENSOR)
reads, truths = Counter(), Counter()


def counted(capture):
    """Return a capture that counts how often it is read, and its true density made."""

    def raw():
        reads[capture.name] += 1
        return capture.raw()

    def log_density():
        truths[capture.name] += 1
        return capture.log_density()

    return replace(capture, raw=raw, log_density=log_density)


def is_light(frame):
    return frame.capture.kind != "dark"


@pytest.fixture(scope="module")
def looked_at():
    """Return the whole frames of some captures, of which the module counts reads."""
    made = simulate_captures(SENSOR, {}, seed=4, shape=SHAPE, groups=("fit", "report"))
    captures = replace(made, captures=[counted(one) for one in made.captures])
    frames = read_frames(captures, noise_models(captures), 6000, lambda *given: None)
    groups = {
        group: on([f for f in frames if f.capture.group == group and is_light(f)])
        for group in ("fit", "report")
    }
    pieces = Pieces(captures, BASE, None, groups["fit"])
    assert len(list(pieces.batches(frames[0].tiles))) > 1
    return WholeFrames(groups["report"], BASE, pieces, details=False)


@pytest.mark.slow
def test_frames_that_need_no_other_are_read_once(looked_at, monkeypatch):
    """However many they are: none is kept."""
    monkeypatch.setattr(pieces_module, "KEPT_BYTES", 0)
    for counts in (reads, truths):
        counts.clear()
    look = looked_at.look_at(model_of(SENSOR, read_noise=[0.3]))
    assert set(reads) == {f.capture.name for f in looked_at.report.frames}
    assert set(reads.values()) == {1}
    assert truths == reads
    everything = len(looked_at.report.frames) * np.prod(SHAPE)
    assert 0.9 * everything < look.after.pixels <= everything  # few are clipped


@pytest.mark.slow
def test_maps_are_made_by_batches_of_tiles(looked_at, monkeypatch):
    """All that learnt them is read for each, unless there is room to keep it."""
    model = model_of(SENSOR, prnu=[0.0])
    reads.clear()
    kept = replace(looked_at, pieces=looked_at.pieces.afresh()).look_at(model)
    assert set(reads.values()) == {1}
    monkeypatch.setattr(pieces_module, "KEPT_BYTES", 0)
    again = replace(looked_at, pieces=looked_at.pieces.afresh()).look_at(model)
    assert max(reads.values()) > 1
    assert again.before.loss == kept.before.loss
    assert again.after.loss == kept.after.loss
