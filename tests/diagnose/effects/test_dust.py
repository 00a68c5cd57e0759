# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Dust: its spots are found and measured, and no other pattern is taken for them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from cg2raw import Sensor
from cg2raw.diagnose import diagnose
from cg2raw.diagnose.effects.dust import SPOT_WIDTH, Spots
from cg2raw.diagnose.inference.fixed_patterns import fit_patterns
from cg2raw.diagnose.likelihood.model import Model
from diagnose.planted import (
    captures_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
    shot_by_registry,
)

SENSOR = sensor_of()
NAME = "dust"
SHAPE = (112, 144)


def spot(row, col, depth, radius):
    """Return (H, W) the loss of one spot."""
    rows, cols = np.mgrid[: SHAPE[0], : SHAPE[1]]
    return depth * 2.0 ** (-((rows - row) ** 2 + (cols - col) ** 2) / radius**2)


@pytest.mark.parametrize(("depth", "radius"), [(0.1, 3.0), (0.03, 6.0), (0.2, 10.0)])
def test_a_spot_of_a_map_is_measured_as_it_was(depth, radius):
    """Of the map that smoothing makes of it, and that has most of its depth."""
    loss = spot(50.3, 70.6, depth, radius)
    once = gaussian_filter(loss, SPOT_WIDTH)
    smooth = once + gaussian_filter(loss - once, SPOT_WIDTH)
    spots = Spots.of(np.where(smooth > 0.1 * depth, smooth, 0)[None])
    assert spots.count == 1
    assert spots.depths == pytest.approx([depth], rel=0.08)
    assert spots.radii == pytest.approx([radius], rel=0.08)


def test_a_spot_that_the_edge_cuts_counts_and_is_not_measured():
    loss = spot(2, 70, 0.1, 5) + spot(60, 70, 0.1, 5)
    spots = Spots.of(np.where(loss > 0.01, loss, 0)[None])
    assert spots.count == 2 and spots.depths.size == 1


def flats(group="fit"):
    captures = captures_of(("flat",) * 4, group, level=0.6, shape=SHAPE)
    return frames_of(SENSOR, captures)


def fitted(extra):
    frames = drawn(flats(), Model(SENSOR), 5, extra=extra)
    return fit_patterns(model_of(SENSOR, dust=[0.0]), on(frames)).term(NAME)


def shaded_by(loss):
    """Return what a loss (H, W) of light adds to a frame."""
    return lambda frame, rng: -loss[None] * frame.of_site(frame.camera.astype(float))


def test_a_map_has_spots_and_nothing_else():
    loss = spot(40, 50, 0.05, 5) + spot(80, 110, 0.1, 4)
    sensor_map = fitted(shaded_by(loss)).sensor_map
    found, seen = -sensor_map.mean[0], -(sensor_map.mean * sensor_map.share)[0]
    near = loss > 0.02
    assert np.sqrt(np.mean((found - loss)[near] ** 2)) < 0.004
    # Noise beside a spot is as likely below the rest as above it.
    beside = seen[loss < 1e-4]
    assert (beside != 0).mean() < 0.02
    assert np.sqrt(np.mean(beside**2)) < 4e-4
    faint = found[loss < 1e-4]  # with what may fade around it, unseen
    assert (faint != 0).mean() < 0.08
    assert np.sqrt(np.mean(faint**2)) < 5e-4


def test_spots_that_cover_much_of_a_frame_are_found_to_their_edges():
    """Nine, and 38 % of the frame loses more than 1 %: their own spread is larger than
    that of the rest."""
    places = [(r, c) for r in (20, 56, 92) for c in (24, 72, 120)]
    loss = sum(spot(row, col, 0.15, 9) for row, col in places)
    found = -fitted(shaded_by(loss)).sensor_map.mean[0]
    inner = np.s_[8:-8, 8:-8]
    assert (loss > 0.01).mean() > 0.35
    assert np.sqrt(np.mean((found - loss)[inner] ** 2)) < 0.01


def test_edges_too_faint_to_be_seen_are_not_taken_for_a_darker_rest():
    places = [(r, c) for r in (30, 82) for c in (30, 72, 114)]
    loss = sum(spot(row, col, 0.1, 6) for row, col in places)
    found = -fitted(shaded_by(loss)).sensor_map.mean[0]
    assert abs(np.mean(found - loss)) < 0.02 * np.mean(loss)


def test_spots_that_cover_most_of_a_row_are_found():
    """The middle of such a row is dark, and the rest of it no brighter than others."""
    loss = sum(spot(56, col, 0.15, 9) for col in (16, 52, 90, 128))
    found = -fitted(shaded_by(loss)).sensor_map.mean[0]
    inner = np.s_[8:-8, 8:-8]
    assert np.median(loss[56]) > 0.02
    assert np.sqrt(np.mean((found - loss)[inner] ** 2)) < 0.01


def test_a_spot_is_as_deep_where_wells_are_full_beside_it():
    """Greens are a tenth above the full well, and below it in the spot."""
    loss = spot(56, 72, 0.3, 9)
    model, well = model_of(SENSOR, full_well=[0.45], dust=[0.0]), 0.55

    def shaded(frame, rng):
        light = frame.of_site(frame.camera.astype(float))
        return np.minimum(light * (1 - loss), well) - np.minimum(light, well)

    frames = drawn(flats(), model.without(NAME), 5, extra=shaded)
    for _ in range(3):
        model = fit_patterns(model, on(frames))
    found = -model.term(NAME).sensor_map.mean[0]
    near = loss > 0.1
    assert abs(np.mean((found - loss)[near])) < 0.003


def test_a_lamp_that_flickers_hides_no_spot():
    """Rows differ by 1 %, otherwise in each frame; the spot is 5 % deep."""
    loss = spot(40, 50, 0.05, 5)

    def flickering(frame, rng):
        bands = 0.014 * np.sin(np.arange(SHAPE[0]) / 8 + rng.uniform(0, 6.28))
        light = bands[:, None] - loss
        return light[None] * frame.of_site(frame.camera.astype(float))

    found = -fitted(flickering).sensor_map.mean[0]
    near = loss > 0.02
    assert np.sqrt(np.mean((found - loss)[near] ** 2)) < 0.01


@pytest.mark.parametrize("sign", [1.0, 0.0])
def test_what_is_no_dark_spot_leaves_no_map(sign):
    """A bright spot, and nothing at all."""
    loss = spot(40, 50, 0.1, 5)

    def lit(frame, rng):
        return sign * loss[None] * frame.of_site(frame.camera.astype(float))

    assert fitted(lit).values == pytest.approx([0.0], abs=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("density", "depth", "radius", "seed"), [(400, 0.1, 6, 1), (800, 0.05, 4, 2)]
)
def test_it_is_found_in_what_the_registry_simulates(density, depth, radius, seed):
    """Of 0.016 megapixels: 6 and 13 spots, some of which the edge cuts."""
    planted = {"density": density, "depth": depth, "radius": radius}
    captures = shot_by_registry(SENSOR, {NAME: planted}, seed)
    found = diagnose(captures, threads=1, details=False)
    assert found.verdict == "explained"
    (one,) = found.effects
    assert one.name == NAME
    (entry,) = Sensor.from_json(found.profile_json, "found").effects
    values = entry["parameters"]
    # Depths differ by 29 %, of a few spots; a radius is the same for all.
    assert values["depth"] == pytest.approx(depth, rel=0.35)
    assert values["radius"] == pytest.approx(radius, rel=0.15)
    # A Poisson number, less those that touch another.
    pixels = SHAPE[0] * SHAPE[1] / 1e6
    count, expected = values["density"] * pixels, density * pixels
    far = 3 * np.sqrt(expected)
    assert expected - far - 2 < count < expected + far


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("prnu", {"sigma": 0.01}),
        ("lens_shading", {"r2": -0.2, "tilt_x": 0.03}),
    ],
)
def test_what_looks_alike_is_not_taken_for_it(name, values):
    null = dict.fromkeys(("r2", "r4", "r6", "tilt_x", "tilt_y"), 0.0)
    null |= {"tilt_x_r2": 0.0, "tilt_y_r2": 0.0}
    parameters = {**null, **values} if name == "lens_shading" else values
    found = diagnose(
        shot_by_registry(SENSOR, {name: parameters}), threads=1, details=False
    )
    assert [one.name for one in found.effects] == [name]


@pytest.mark.slow
def test_a_profile_that_lists_it_has_no_gap():
    """Its map is each sensor's own, and is made anew."""
    values = {"density": 400.0, "depth": 0.08, "radius": 6.0}
    captures = shot_by_registry(SENSOR, {NAME: values}, 3)
    known = sensor_of(effects=[{"name": NAME, "parameters": values}])
    found = diagnose(replace(captures, sensor=known), threads=1, details=False)
    assert found.verdict == "consistent"
