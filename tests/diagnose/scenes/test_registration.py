# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A render that lies elsewhere and is brighter is found, and is no effect."""

from contextlib import nullcontext
from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.scenes.model import Model
from cg2raw.diagnose.scenes.nuisances import nuisances_of
from cg2raw.diagnose.scenes.registration import first_guess, warped
from diagnose.planted import capture_of, drawn, frames_of
from diagnose.scenes.test_decide import SENSOR, decided, images

FREE = frozenset({"registration", "exposure", "light", "radiance"})
AFFINE = np.array([[2.3, 0.2, -0.1], [-1.6, 0.1, 0.15]])


@pytest.mark.parametrize("shift", [(0, 0), (2, -4), (-4, 2), (12, 4), (-6, -20)])
def test_a_first_guess_is_the_best_correlation(shift):
    rng = np.random.default_rng(1)
    image = rng.normal(size=(1, 64, 80)).cumsum(1).cumsum(2)
    moved = np.roll(image, shift, (1, 2))
    usable = np.ones(image.shape, bool)
    assert first_guess(moved, image, usable).tolist() == [-shift[0], -shift[1]]


def test_a_smooth_error_of_light_is_of_products_of_legendre_polynomials():
    [frame] = frames_of(SENSOR, [capture_of()])
    asked = CaptureSet(SENSOR, [], frozenset({"radiance"}))
    of_light = {n.name: n.down * n.across for n in nuisances_of(asked, frame, 1)}
    down, across = of_light["field 1 0"], of_light["field 0 1"]
    assert of_light["field 1 2"] == pytest.approx(down * (3 * across**2 - 1) / 2)


def displaced(affine, nuisances=FREE):
    """Return a capture set, and its frames, whose renders lie elsewhere and are 1.1
    times as bright as they are."""
    capture_set, frames = images(Model(SENSOR), nuisances=nuisances)
    truth = [
        replace(
            frame,
            camera=(1.1 * warped(frame.camera, frame, affine)).astype(np.float32),
            memo={},
        )
        if frame.capture.shows.render
        else frame
        for frame in frames
    ]
    seen = drawn(truth, Model(SENSOR), 3)
    return capture_set, [
        replace(frame, signal=other.signal, at_white=other.at_white)
        for frame, other in zip(frames, seen, strict=True)
    ]


@pytest.mark.parametrize(
    ("down", "nuisances"),
    [(-6.5, FREE), (9.0, FREE), (9.0, frozenset({"exposure"}))],
)
def test_a_render_too_far_from_its_capture_is_refused(down, nuisances):
    """Declared or not: it would be the lens's distortion, and its blur."""
    affine = np.array([[down, 0.0, 0.0], [0.0, 0.0, 0.0]])
    with pytest.raises(ValueError, match=r"px down, .* takes up 4 px|not correspond"):
        decided(*displaced(affine, nuisances))


@pytest.mark.parametrize(("down", "is_refused"), [(-0.6, True), (0.1, False)])
def test_a_render_beside_its_capture_needs_registration(down, is_refused):
    affine = np.array([[down, 0.0, 0.0], [0.0, 0.0, 0.0]])
    refused = pytest.raises(ValueError, match="add registration to nuisance")
    with refused if is_refused else nullcontext():
        decided(*displaced(affine, frozenset({"exposure"})))


def test_what_is_displaced_and_brighter_is_found():
    found = decided(*displaced(AFFINE))
    assert found.chosen.names == []
    for view in found.views:
        if view.frame.capture.shows.render:
            placement = found.placements[view.frame.capture.set]
            assert placement.affine == pytest.approx(AFFINE, abs=0.05)
            assert placement.gain == pytest.approx(np.full(3, 1.1), abs=0.02)
