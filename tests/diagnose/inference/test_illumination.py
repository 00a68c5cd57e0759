# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The light of a lamp that nobody measured: what is slow in flats, and no pixel's."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.inference.illumination import (
    as_lit,
    illumination,
    lit,
    unmeasured,
    without_unsure_shading,
)
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.prediction import predict
from diagnose.planted import (
    ONE,
    SHAPE,
    capture_of,
    drawn,
    frames_of,
    model_of,
    sensor_of,
)

SENSOR = sensor_of()
ROWS, COLUMNS = np.mgrid[: SHAPE[0], : SHAPE[1]]
# A stain of 3 %, a good deal wider than what is a pixel's own.
STAIN = 1 - 0.03 * np.exp(-((ROWS - 30) ** 2 + (COLUMNS - 50) ** 2) / (2 * 20.0**2))


def flats(group, count, light=STAIN, lamp="", seed=1):
    """Return frames of flats that a lamp lights so, and that nobody measured."""
    captures = [
        capture_of("flat", n, name=f"{lamp}{n}{group}", group=group, level=0.5)
        for n in range(count)
    ]
    captures = [replace(c, set=lamp or c.name) for c in captures]
    frames = frames_of(SENSOR, captures)
    frames = [replace(frame, level_free=True) for frame in frames]
    field = np.broadcast_to(light, (1, 3, *SHAPE))
    shown = drawn([lit(frame, field) for frame in frames], Model(SENSOR), seed)
    return [
        replace(frame, signal=one.signal, at_white=one.at_white)
        for frame, one in zip(frames, shown, strict=True)
    ]


def chi2(frame):
    p = predict(Model(SENSOR), frame)
    return float(
        np.mean(((frame.signal - p.mean)[frame.keep]) ** 2 / p.variance.mean())
    )


def test_it_is_what_is_slow_in_flats():
    found = illumination(Model(SENSOR), flats("fit", 6))
    error = (found / STAIN - 1)[0, :, 8:-8, 8:-8]
    # Six flats of 0.5 of full well, 25 pixels and more around each of a colour's.
    assert np.sqrt(np.mean(error**2)) < 0.003
    assert np.abs(error).max() < 0.015


def test_what_varies_from_pixel_to_pixel_is_none():
    gains = 1 + 0.02 * np.random.default_rng(3).standard_normal(SHAPE)
    found = illumination(Model(SENSOR), flats("fit", 4, gains))
    assert np.std(found[0, 1]) < 0.003


def test_held_out_flats_have_it_too():
    frames = flats("fit", 4) + flats("select", 2, seed=2)
    before, after = Splits(frames, ONE), as_lit(Model(SENSOR), Splits(frames, ONE))
    for old, new in zip(before.select.frames, after.select.frames, strict=True):
        assert chi2(old) > 1.1
        assert chi2(new) == pytest.approx(1, abs=0.06)


def test_lamps_of_named_sets_are_apart():
    frames = flats("fit", 3, lamp="left") + flats("fit", 3, 1 / STAIN, lamp="right")
    assert [[f.capture.set for f in lamp] for lamp in unmeasured(frames)] == [
        ["left"] * 3,
        ["right"] * 3,
    ]
    left, right = (illumination(Model(SENSOR), lamp) for lamp in unmeasured(frames))
    assert (left / right)[0, 1, 30, 50] < 0.96


def test_one_flat_and_flats_of_known_light_are_as_they_were():
    one = flats("fit", 1)
    known = [replace(frame, level_free=False) for frame in flats("fit", 4)]
    assert unmeasured(one + known) == []
    frames = one + known
    lit_ones = as_lit(Model(SENSOR), Splits(frames, ONE)).frames
    assert all(a is b for a, b in zip(frames, lit_ones, strict=True))


@pytest.mark.parametrize(("r2", "named"), [(-0.2, True), (-0.01, False)])
def test_a_shading_as_weak_as_light_is_uneven_may_be_the_lamp_s(r2, named):
    """Of light that nobody measured; where it is known, any shading shows."""
    shading = model_of(SENSOR, lens_shading=[r2, 0, 0, 0, 0, 0, 0])
    u, v = flats("fit", 1)[0].tiles.field()
    frames = flats("fit", 4, light=STAIN * (1 + r2 * (u**2 + v**2)[0]))
    left = without_unsure_shading(shading, frames)
    assert (left.names == ["lens_shading"]) == named
    known = [replace(frame, level_free=False) for frame in frames]
    for others in (known, [*frames, *known]):
        assert without_unsure_shading(shading, others) is shading
