# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Derivatives of the mean against finite differences of the simulation."""

import numpy as np
import pytest

from cg2raw.diagnose.effects.catalogue import candidates
from cg2raw.diagnose.scenes.model import Model
from cg2raw.diagnose.scenes.nuisances import laplacian
from cg2raw.diagnose.scenes.point import (
    Excess,
    by_light,
    derivatives,
    mean_of,
    offsets_of,
    point_of,
    products_of,
    without_offsets,
)
from cg2raw.diagnose.scenes.view import views_of
from diagnose.planted import PLANTED, capture_of, frames_of, sensor_of, x_trans

RGGB = sensor_of()
SHAPE = (48, 60)


def at(given, model=None, kind="scene", excess=None, **more):
    [frame] = frames_of(given, [capture_of(kind, 2, shape=SHAPE, **more)])
    [view] = views_of([frame])
    return point_of(view, frame, model or Model(given), excess or Excess())


def smooth(given):
    """Return the effects of the mean; below its least value a filter is none."""
    every = [one for one in candidates(given.cfa) if one.predicted]
    return [one for one in every if one.name != "noise_reduction"]


@pytest.mark.parametrize(
    "given", [RGGB, sensor_of(cfa="GBRG"), x_trans()], ids=["RGGB", "GBRG", "X-Trans"]
)
def test_derivatives_are_those_of_the_prediction(given):
    """At the profile, and where an effect has a value; by a fifth of the step and both
    sides, in double precision of many of them."""
    for effect in smooth(given):
        for values in (
            effect.null,
            0.5 * np.array(PLANTED.get(effect.name, effect.null)),
        ):
            if len(values) != len(effect.null):
                continue
            model = Model(given).with_effect(effect, values)
            point = at(given, model)
            columns = derivatives(point, effect)
            assert len(columns) == len(effect.used)
            for k, column in zip(np.flatnonzero(effect.is_used), columns, strict=True):
                step = 2 * effect.step
                ends = []
                for sign in (-1, 1):
                    moved = values.copy()
                    moved[k] += sign * step
                    ends.append(mean_of(model.with_effect(effect, moved), point.frame))
                expected = (ends[1] - ends[0]) / (2 * step)
                scale = np.abs(expected).max() + 1e-3
                assert np.abs(column - expected).max() < 0.03 * scale, effect.name


def test_a_change_of_light_goes_through_the_chain():
    given = RGGB
    model = Model(given)
    for name in ("blur", "nonlinearity", "lens_shading"):
        effect = next(one for one in smooth(given) if one.name == name)
        model = model.with_effect(effect, 0.5 * np.array(PLANTED[name]))
    point = at(given, model)
    camera = point.frame.camera.astype(float)
    for change in (camera, laplacian(camera)):
        step = 0.02 * camera.max() / np.abs(change).max()
        expected = mean_of(model, point.frame, camera + step * change) - point.base
        # The bend of the response is all that a longer step adds.
        assert by_light(point, change) == pytest.approx(expected / step, abs=0.02)


def test_samples_near_white_glints_and_zero_are_left_out():
    bright = at(RGGB, kind="flat", level=4.0)
    assert not bright.root.any()
    assert at(RGGB, kind="flat", level=0.3).root.any()
    cut = sensor_of(black_level=[0.0] * 4)
    assert not at(cut, kind="dark").root.any()
    assert at(RGGB, kind="dark").root.any()


@pytest.mark.parametrize("name", ["shift", "texture", "patches"])
def test_any_deviation_is_an_excess(name):
    assert Excess(**{name: 0.01}) and not Excess(**{name: 0.0})


def test_excess_widens_edges_and_light():
    plain = at(RGGB)
    wide = at(RGGB, excess=Excess(0.1, 0.01))
    slope, _ = plain.frame.squared_slope_and_light
    light = np.maximum(plain.base, 0)
    assert wide.variance - plain.variance == pytest.approx(
        0.01 * slope + 1e-4 * light**2, rel=1e-4, abs=1e-12
    )
    assert wide.noise_variance == pytest.approx(plain.noise_variance)


def test_patterns_of_pixels_and_of_columns_are_shared():
    """As the covariance of a score whose weights know them."""
    patterns = {"column_fixed_pattern": {"sigma": 4e-3}, "prnu": {"sigma": 0.02}}
    point = at(sensor_of(effects=patterns))
    [columns] = offsets_of(point)
    used = point.root > 0
    a = np.random.default_rng(3).normal(size=(3, used.sum()))
    along = np.zeros((SHAPE[1], used.sum()))
    along[columns.labels[used], np.arange(used.sum())] = point.root[used]
    along *= columns.sigma
    share = (point.patterns["prnu"] * point.root**2)[used]
    assert products_of(a, point)[1].shape == (3, 3)
    score = np.linalg.solve(np.eye(used.sum()) + along.T @ along, a.T).T
    expected = (a * share) @ a.T + (score @ along.T) @ (score @ along.T).T
    assert products_of(a, point)[1] == pytest.approx(expected, rel=1e-6)
    assert products_of(a, at(sensor_of()))[1] == 0


def test_offsets_that_have_something_in_common_are_integrated_out_together():
    """Rows, columns and the whole frame all have the mean: as a covariance of all."""
    sigmas = {
        "row_noise": 4e-3,
        "column_fixed_pattern": 6e-3,
        "black_level_drift": 1e-2,
    }
    point = at(sensor_of(effects={n: {"sigma": x} for n, x in sigmas.items()}))
    used, every = point.root > 0, offsets_of(point)
    assert {one.name for one in every} == {"rows", "frame", "columns"}
    rng = np.random.default_rng(3)
    a = np.concatenate([np.ones((1, used.sum())), rng.normal(size=(2, used.sum()))])
    covariance = np.eye(used.sum())
    for one in every:
        label = one.labels[used]
        alike = label[:, None] == label
        covariance += (
            one.sigma**2 * alike * np.outer(point.root[used], point.root[used])
        )
    solved = np.linalg.solve(covariance, a.T)
    assert products_of(a, point)[0] == pytest.approx(a @ solved, rel=1e-6)
    left = [without_offsets(one, point) for one in a]
    assert np.array(left).T == pytest.approx(solved, rel=1e-6, abs=1e-9)


def test_offsets_of_rows_are_those_of_a_mean_of_frames():
    given = sensor_of(effects={"row_noise": {"sigma": 4e-3}})
    [rows] = offsets_of(at(given))
    assert (rows.name, rows.sigma) == ("rows", pytest.approx(4e-3, rel=1e-3))
    several = [capture_of("scene", 2, name=str(n), shape=SHAPE) for n in range(4)]
    frames = frames_of(given, several)
    [view] = views_of(frames)
    [of_mean] = offsets_of(point_of(view, frames[0], Model(given), Excess()))
    assert of_mean.sigma == pytest.approx(rows.sigma / 2)  # of four frames' mean
