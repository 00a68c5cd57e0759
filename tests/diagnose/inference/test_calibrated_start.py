# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A profile that states what its sensor has is believed, until captures disagree."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.inference.baseline import Baseline
from cg2raw.diagnose.inference.calibrated_start import (
    is_calibrated,
    without_transients,
)
from cg2raw.diagnose.inference.model_selection import Search
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model, Term
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    BY_NAME,
    ONE,
    SHAPE,
    captures_of,
    drawn,
    frames_of,
    model_of,
    sensor_of,
)

PATTERNS = [e for e in BY_NAME.values() if e.estimator == "fixed pattern"]


@pytest.mark.parametrize(("stated", "calibrated"), [(0, False), (1, False), (7, True)])
def test_most_fixed_patterns_have_to_be_stated(stated, calibrated):
    model = Model(sensor_of())
    for effect in PATTERNS[:stated]:
        model = model.with_term(Term(effect, effect.null, calibration=True))
    assert is_calibrated(model, list(BY_NAME.values())) == calibrated
    assert not is_calibrated(model, [BY_NAME["exposure"]])


@pytest.mark.slow
@pytest.mark.parametrize(("loss", "found"), [(-0.3, True), (0.0, False)])
def test_shading_that_no_lamp_has_is_there_from_the_start(loss, found):
    """Flats that nobody measured, of a lamp with a stain of 3 %."""
    sensor = sensor_of()
    rows, columns = np.mgrid[: SHAPE[0], : SHAPE[1]]
    stain = 0.03 * np.exp(-((rows - 30) ** 2 + (columns - 50) ** 2) / 800)
    shading = model_of(sensor, lens_shading=[loss, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])

    def stained(frame, _):
        return -stain * predict(shading, frame).exposed

    kinds = ("dark",) * 3 + ("flat",) * 3
    captures = [c for group in GROUPS for c in captures_of(kinds, group, level=0.5)]
    frames = [
        replace(frame, level_free=frame.capture.kind == "flat")
        for frame in frames_of(sensor, [replace(c, set=c.name) for c in captures])
    ]
    splits = Splits(drawn(frames, shading, 3, stained), ONE)
    model = Model(sensor)
    for effect in PATTERNS:
        model = model.with_term(Term(effect, effect.null, calibration=True))
    search = Search(Baseline(model, splits), list(BY_NAME.values()), 0.01, 6)
    assert search._start_calibrated()
    assert search._reached.found_names == (["lens_shading"] if found else [])
    # What is found is compared with the profile beside the same maps.
    assert search.compared.model.found_names == []
    of_search = {term.name: known for term, _, known in search._reached.maps}
    for term, _, known in search.compared.model.maps:
        assert known is of_search.pop(term.name)
    assert not of_search


@pytest.mark.parametrize(
    ("fraction", "often", "left"),
    [(0.0, False, False), (0.0, True, True), (0.02, True, False)],
)
def test_outliers_that_a_dark_has_are_set_aside(fraction, often, left):
    """Of one frame alone, or by a profile that states hot pixels, of all frames."""
    hot = {"name": "hot_pixels", "parameters": {"fraction": fraction, "rate": 0.05}}
    sensor = sensor_of(effects=[hot] if fraction else [])
    frames = frames_of(sensor, captures_of(("dark",) * 3))
    place = (0, 30, 40)

    def ray(frame, _):
        signal = np.zeros(frame.signal.shape)
        signal[place] = 0.05 * (often or frame is frames[0])
        return signal

    splits = Splits(drawn(frames, Model(sensor), 1, ray), ONE)
    shown = without_transients(Model(sensor), splits)
    assert [frame.keep[place] for frame in shown.frames][0] == left
    counts = [
        f.keep.sum() - g.keep.sum() for f, g in zip(frames, shown.frames, strict=True)
    ]
    assert max(counts) <= 1
