# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A table of patch means as a frame says what the table says, no more and no less."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.captures.chart_table import places_of
from cg2raw.diagnose.captures.patch_means import COLOR_OF_SITE, PatchMeans
from cg2raw.diagnose.effects.catalogue import every
from cg2raw.diagnose.frames.noise_model import NoiseModel
from cg2raw.diagnose.frames.patch_frame import on_sites, patch_frame_of
from cg2raw.diagnose.scenes.model import Model
from cg2raw.diagnose.scenes.point import Excess, offsets_of, point_of
from cg2raw.diagnose.scenes.predict import predict
from cg2raw.diagnose.scenes.view import views_of
from diagnose.planted import capture_of, sensor_of

SENSOR = sensor_of()
RANGE = SENSOR.white_level - SENSOR.black_level[0]
NOISE = NoiseModel((2e-4,), (1e-6,))
GREYS = np.array([[0.8] * 3, [0.2] * 3, [0.02] * 3])


def means_of(mean, side=0, count=400.0, known=True):
    """Return the means of three greys."""
    mean = np.broadcast_to(np.asarray(mean, float), (3, 4)).copy()
    return PatchMeans(
        names=("white", "grey", "black"),
        colors=GREYS,
        mean=mean,
        side=np.broadcast_to(side, (3, 4)).copy(),
        count=np.full(3, count),
        level_known=known,
    )


def frame_of(means, drawn=None, nuisances=frozenset()):
    """Return the frame of means."""
    capture = replace(capture_of("flat", shape=means.mean.shape), kind="chart")
    capture = replace(capture, means=means, scene=None)
    noise = replace(NOISE, drawn=drawn or {})
    return patch_frame_of(CaptureSet(SENSOR, [capture], nuisances), capture, noise)


@pytest.mark.parametrize("cfa", ["RGGB", "GRBG", "GBRG", "BGGR"])
def test_means_are_at_their_sites(cfa):
    planes = on_sites(np.array([[1.0, 2.0, 3.0, 4.0]]), cfa)
    letters = np.array(list(cfa)).reshape(2, 2)
    assert planes[0][letters == "R"] == 1 and planes[0][letters == "B"] == 4
    row = np.flatnonzero((letters == "R").any(axis=1))[0]
    assert planes[0, row][letters[row] == "G"] == 2  # the green beside red
    assert planes[0].ravel()[list(places_of(cfa))].tolist() == [1, 2, 3, 4]


def test_the_variance_is_that_of_one_pixel_divided():
    one, many = (frame_of(means_of(500, count=n)) for n in (1.0, 400.0))
    first, second = (predict(Model(SENSOR), frame) for frame in (one, many))
    np.testing.assert_allclose(first.variance, 400 * second.variance)
    expected = 2e-4 * first.mean + 1e-6 + 1 / 12 / RANGE**2
    np.testing.assert_allclose(first.variance, expected, rtol=1e-5)
    np.testing.assert_allclose(first.mean, second.mean)


def test_rows_add_what_a_square_of_them_shares():
    plain = predict(Model(SENSOR), frame_of(means_of(500)))
    rows = predict(Model(SENSOR), frame_of(means_of(500), {"row_noise": (0.5,)}))
    added = 0.25 * 1e-6 / 20  # 400 pixels lie in 20 rows
    np.testing.assert_allclose(rows.variance - plain.variance, added)


def test_what_is_missing_does_not_count():
    mean = np.full((3, 4), 500.0)
    mean[1, 2] = np.nan
    keep = frame_of(means_of(mean)).keep
    assert keep.sum() == 11 and not keep[1].all()


@pytest.mark.parametrize("offset", [0, 30])
def test_an_unknown_brightness_is_told_by_bright_patches(offset):
    camera = frame_of(means_of(500)).camera[:, :, 0, 0]
    dn = SENSOR.black_level[0] + RANGE * 0.4 * camera[:, COLOR_OF_SITE] + offset
    frame = frame_of(means_of(dn, known=False))
    assert frame.level_free
    seen = frame.camera[0, 1, 0, 0] / camera[0, 1]
    # 30 DN of offset are 0.03 of a range of 1000, on 0.2 to 0.3 of the brightest.
    assert seen == pytest.approx(0.4, rel=0.2 if offset else 1e-5)
    declared = frame_of(means_of(500), nuisances=frozenset({"exposure"}))
    assert declared.level_free and not frame_of(means_of(500)).level_free


def test_patches_of_a_chart_have_errors_of_their_own():
    frame = frame_of(means_of(500))
    [view] = views_of([frame])
    point = point_of(view, frame, Model(SENSOR), Excess(patches=0.01))
    point.charts = 3  # of the same patches, that share these errors
    [offset] = offsets_of(point)
    assert offset.sigma == pytest.approx(0.01 * np.sqrt(3))
    assert len(np.unique(offset.labels)) == 9, "both greens of a patch have one"


@pytest.mark.parametrize("name", ["blur", "crosstalk", "lens_shading", "veiling_glare"])
def test_a_patch_has_its_own_light_around_it_and_no_place(name):
    """What the profile has of neighbours and places does not mix the patches."""
    effect = every()[name]
    strong = effect.clipped(np.full(len(effect.null), 0.05))
    frame, model = frame_of(means_of(500)), Model(SENSOR)
    ratio = predict(model.with_effect(effect, strong), frame).mean
    ratio /= predict(model, frame).mean
    if name == "veiling_glare":  # that of the whole chart, on dark patches most
        assert (ratio[2] > ratio[0]).all()
    elif name == "crosstalk":  # of sites of one patch alone
        assert np.ptp(ratio, axis=0).max() < 1e-3
    else:
        np.testing.assert_allclose(ratio, 1, atol=2e-3)
