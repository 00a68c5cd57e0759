# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What frames say of maps: darks of what is none of light."""

import numpy as np
import pytest

from cg2raw.diagnose.inference.map_evidence import evidence_of, told_by_darks
from cg2raw.diagnose.inference.map_prior import MixedPrior, mixed_prior_of
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    BY_NAME,
    READ,
    SHAPE,
    capture_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
)

SENSOR = sensor_of()


@pytest.mark.parametrize(
    ("name", "darks", "flats", "told"),
    [
        ("dsnu", 3, 3, True),
        ("dsnu", 0, 3, False),
        ("prnu", 3, 3, False),
        ("hot_pixels", 2, 2, True),
    ],
)
def test_darks_tell_what_is_none_of_light(name, darks, flats, told):
    captures = [capture_of("dark", n, name=f"d{n}") for n in range(darks)]
    captures += [capture_of("flat", n, name=f"f{n}") for n in range(flats)]
    frames = frames_of(SENSOR, captures)
    assert told_by_darks(BY_NAME[name], frames) is told


def test_wrong_light_is_no_offset():
    """Flats that are 5 % off leave no trace in maps of offsets that darks tell."""
    captures = [
        capture_of(kind, n, name=f"{kind}{n}")
        for kind in ("dark", "flat")
        for n in range(3)
    ]

    def stained(frame, _):
        return 0.015 * frame.capture.shows.light * np.ones(SHAPE)

    frames = drawn(frames_of(SENSOR, captures), Model(SENSOR), 4, stained)
    effects = [BY_NAME["dsnu"], BY_NAME["prnu"]]
    evidence = evidence_of(effects, Model(SENSOR), on(frames))
    offset, gain = (
        evidence.score[k][known] / evidence.information[k, k][known]
        for k, known in enumerate(map(evidence.known, range(2)))
    )
    assert abs(offset.mean()) < 0.1 * READ
    assert gain.mean() > 0.04


def test_a_wide_pixel_keeps_its_value_where_the_others_do_not_differ():
    """The normal prior of a mixture that is narrow to nothing would take it."""
    rng = np.random.default_rng(5)
    values = np.zeros(20_000)
    values[:40] = 30 * rng.standard_normal(40)
    estimate, error = values + rng.standard_normal(20_000), np.ones(20_000)
    mixed = mixed_prior_of(estimate**2, error)
    mean, variance = mixed.posterior(estimate, error)
    far = np.abs(values) > 10
    assert mean[far] == pytest.approx(estimate[far], rel=0.03)
    assert variance[far] == pytest.approx(1, abs=0.1)
    assert np.abs(mean[40:]).max() < 1
    assert np.mean((mean - values) ** 2) < 1.2 * variance.mean()


def test_a_mixture_of_one_kind_is_a_normal_prior():
    estimate, error = np.array([-2.0, 0.5, 3.0]), np.full(3, 2.0)
    mean, variance = MixedPrior(0.3, 4.0, 4.0).posterior(estimate, error)
    assert mean == pytest.approx(estimate * 4 / 6)
    assert variance == pytest.approx(np.full(3, 8 / 6))


@pytest.mark.parametrize("name", ["prnu", "dsnu"])
def test_a_pixel_that_may_be_full_tells_of_no_map(name):
    """Its signal is not straight in what a map adds: a gain that is a percent less
    empties a pixel that was expected full by more than that."""
    (frame,) = frames_of(SENSOR, [capture_of("scene", level=1.5)])
    light = predict(Model(SENSOR), frame).exposed
    model = model_of(SENSOR, full_well=[1 - float(np.median(light))])
    evidence = evidence_of([BY_NAME[name]], model, on([frame]))
    told = evidence.information[0, 0] > 0
    chance = predict(model, frame).well.below
    assert not told[chance < 0.99].any()
    assert told[(chance > 0.9999) & frame.keep].all()
    assert (chance < 0.99).any() and told.any()
