# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Cross fit: tails come back beside maps, which follow outliers of their own frames."""

import numpy as np
import pytest

from cg2raw.diagnose.inference.coordinate_search import fit_transform
from cg2raw.diagnose.inference.cross_fit import fit_beside_maps
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from diagnose.planted import (
    READ,
    captures_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
    tails_of,
)

SENSOR = sensor_of()
SHAPE = (128, 160)
SHARE, RATIO = 0.05, 12.0
OFFSETS = READ * np.random.default_rng(3).standard_normal(SHAPE)


def tails_and_offsets(frame, rng):
    """Read noise of which a share is wider, and offsets that pixels have in all."""
    return OFFSETS[None] + tails_of(SHARE, RATIO)(frame, rng)


@pytest.fixture(scope="module")
def shown():
    darks = frames_of(
        SENSOR, captures_of(["dark"] * 3 + ["flat"] * 5, "fit", shape=SHAPE)
    )
    silent = model_of(SENSOR, read_noise=[-40.0])
    return on(drawn(darks, silent, 8, tails_and_offsets))


@pytest.fixture(scope="module")
def begun(shown):
    model = fit_patterns(model_of(SENSOR, dsnu=[READ]), shown)
    start = model_of(SENSOR, heavy_tailed_noise=[0.01, 9.0]).terms[0]
    return model.with_term(start)


def test_tails_are_those_of_the_noise(shown, begun):
    found = fit_beside_maps(begun, "heavy_tailed_noise", shown)
    share, ratio = found.term("heavy_tailed_noise").values
    assert share == pytest.approx(SHARE, rel=0.15)
    assert ratio == pytest.approx(RATIO, rel=0.15)


def test_frames_that_made_maps_would_tell_other_tails(shown, begun):
    """That is what it is for."""
    crosswise = fit_beside_maps(begun, "heavy_tailed_noise", shown)
    own, _ = fit_transform(begun, "heavy_tailed_noise", shown)
    errors = [abs(m.terms[-1].values[0] - SHARE) for m in (crosswise, own)]
    assert errors[0] < 0.5 * errors[1]


def test_without_maps_all_frames_tell(shown):
    model = model_of(SENSOR, heavy_tailed_noise=[0.01, 9.0])
    expected, _ = fit_transform(model, "heavy_tailed_noise", shown)
    found = fit_beside_maps(model, "heavy_tailed_noise", shown)
    assert (found.terms[0].values == expected.terms[0].values).all()
