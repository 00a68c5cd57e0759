# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Fitting finds what was planted, and knows how well."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.inference.coordinate_search import climb, fit_transform
from cg2raw.diagnose.inference.fisher_scoring import (
    Linearisation,
    free_parameters,
    moved,
    one_step,
    solve,
)
from cg2raw.diagnose.inference.fitting import first_guess, fit
from cg2raw.diagnose.inference.intervals import estimates, standard_errors
from cg2raw.diagnose.likelihood.likelihood import Likelihood
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.diagnose.likelihood.nuisance import Nuisance
from cg2raw.diagnose.likelihood.prediction import predict
from cg2raw.diagnose.likelihood.workers import Workers
from diagnose.planted import (
    BY_NAME,
    ONE,
    SHAPE,
    capture_of,
    captures_of,
    drawn,
    frames_of,
    model_of,
    on,
    sensor_of,
    tails_of,
)

SENSOR = sensor_of()
PLANTED = {
    "exposure": [0.03],
    "white_balance": [0.03, -0.02],
    "color_matrix": [0.03, -0.02, 0.01, 0.02, -0.03, 0.02],
    "lateral_chromatic_aberration": [0.4, -0.3, 0.1, 0.05],
    "blur": [0.12, 0.03, *[0.0] * 8, 0.1, -0.1],
    "veiling_glare": [0.02, 0.02],
    "lens_shading": [-0.2, -0.05, 0.02, 0.01, -0.02, 0.0, 0.01],
    "color_shading": [0.03, -0.02, 0.01, 0.0, -0.03, 0.01, 0.0, 0.01],
    "crosstalk": [0.01, 0.015, 0.02, 0.005],
    "gr_gb_imbalance": [0.01, -0.01],
    "nonlinearity": [0.05, 0.02],
    "black_level": [5e-4, -3e-4, 2e-4, 1e-4],
    "shot_noise": [0.2],
    "read_noise": [-0.3],
}


@pytest.fixture(scope="module")
def frames():
    """Return frames that have no pixels yet: two of each kind."""
    captures = [
        capture_of("dark", 1, exposure_time=0.5),
        capture_of("dark", 2, exposure_time=4.0),
        capture_of("flat", 3, level=0.2),
        capture_of("flat", 4, level=0.6),
        capture_of("scene", 5),
        capture_of("scene", 6),
    ]
    return frames_of(SENSOR, captures)


def planted(frames, seed, **terms):
    return drawn(frames, model_of(SENSOR, **terms), seed)


@pytest.mark.parametrize("name", PLANTED)
def test_planted_values_are_found_within_their_errors(frames, name):
    true = np.array(PLANTED[name])
    shown = planted(frames, 1, **{name: true})
    start = Model(SENSOR).with_effect(BY_NAME[name])
    found = fit(start, on(shown))
    errors = standard_errors(found, on(shown))
    effect = BY_NAME[name]
    free = [i for i, p in enumerate(effect.parameters) if p in effect.used]
    true = true[free]
    sigma = np.array([errors[name, i] for i in free])
    assert (sigma > 0).all()
    away = (found.terms[0].values[free] - true) / sigma
    assert np.abs(away).max() < 4
    assert (
        on(shown).total(found) > on(shown).total(model_of(SENSOR, **{name: true})) - 1
    )
    strongest = np.abs(true / sigma).max()
    assert strongest > 3, "the data show it"


def test_what_a_light_of_free_colour_hides_rests():
    """Both greens alike are green light: what flats tell of that is less than the sums
    are exact to, and nothing follows it."""
    captures = [
        capture_of("flat", n, scene=None, raw=lambda: np.full(SHAPE, 8000, np.uint16))
        for n in (1, 2, 3)
    ]
    frames = frames_of(SENSOR, captures)
    light = Nuisance(0.005, 0.0, 0.0, 0.0, frozenset({"light"}))
    true = model_of(SENSOR, gr_gb_imbalance=[0.01, -0.01])
    shown = drawn(frames, replace(true, nuisance=light), 3)
    start = replace(Model(SENSOR), nuisance=light)
    found = fit(start.with_effect(BY_NAME["gr_gb_imbalance"]), on(shown))
    gr, gb = found.terms[0].values
    assert gr - gb == pytest.approx(0.02, abs=0.001)
    assert abs(gr + gb) < 1e-3


def test_intervals_hold_the_truth_as_often_as_they_say():
    """95 % of 80 values: 0.85 to 1 holds but for a chance of 1e-3."""
    true = np.array([0.004, -0.003])
    captures = [capture_of("flat", 1, shape=(40, 48))]
    frames = frames_of(SENSOR, captures)
    inside = []
    for seed in range(40):
        shown = planted(frames, seed, gr_gb_imbalance=true)
        found = fit(Model(SENSOR).with_effect(BY_NAME["gr_gb_imbalance"]), on(shown))
        of_term = estimates(found, on(shown))["gr_gb_imbalance"]
        for value, estimate in zip(true, of_term.values(), strict=True):
            inside.append(estimate.ci95[0] < value < estimate.ci95[1])
    assert 0.85 <= np.mean(inside) <= 1.0


def test_intervals_of_offsets_know_that_rows_move():
    """Row noise hides an offset: one over rows times pixels alone is too sure."""
    captures = [capture_of("dark", 1, shape=(40, 48))]
    frames = frames_of(SENSOR, captures)
    away = []
    for seed in range(30):
        shown = planted_rows(frames, seed, 0.5)
        start = model_of(SENSOR, row_noise=[0.5], black_level=[0.0] * 4)
        found = fit_smooth(start, shown)
        errors = standard_errors(found, on(shown))
        values = found.term("black_level").values
        away += [values[i] / errors["black_level", i] for i in range(4)]
    assert 0.8 < np.std(away) < 1.25


def fit_smooth(model, frames):
    current = on(frames).total(model)
    for _ in range(3):
        model, gain = one_step(model, Linearisation(model, on(frames)), current)
        current += gain
    return model


def planted_rows(frames, seed, sigma):
    def rows(frame, rng):
        size = sigma * np.sqrt(frame.beta2.mean())
        return size * rng.standard_normal((1, frame.tiles.size[0], 1))

    return drawn(frames, Model(SENSOR), seed, rows)


@pytest.mark.parametrize("name", ["exposure", "black_level", "read_noise", "crosstalk"])
def test_information_is_the_bend_of_the_likelihood(frames, name):
    true = PLANTED[name]
    shown = planted(frames, 2, **{name: true})
    model = model_of(SENSOR, **{name: true})
    parameters, _, information = Linearisation(model, on(shown)).system(model)
    for number, (_, index) in enumerate(parameters):
        step = 1.0 / np.sqrt(information[number, number])
        heights = []
        for delta in (-step, 0.0, step):
            values = np.array(true, float)
            values[index] += delta
            heights.append(on(shown).total(model.with_values(name, values)))
        bend = (2 * heights[1] - heights[0] - heights[2]) / step**2
        assert bend == pytest.approx(information[number, number], rel=0.15)


def test_score_is_the_slope_of_the_likelihood(frames):
    shown = planted(frames, 3, exposure=[0.01], read_noise=[0.1])
    model = model_of(SENSOR, exposure=[0.0], read_noise=[0.0])
    parameters, score, _ = Linearisation(model, on(shown)).system(model)
    assert parameters == [("exposure", 0), ("read_noise", 0)]
    for (name, _), slope in zip(parameters, score, strict=True):
        heights = [
            on(shown).total(model.with_values(name, np.array([delta])))
            for delta in (-1e-4, 1e-4)
        ]
        assert slope == pytest.approx((heights[1] - heights[0]) / 2e-4, rel=0.02)


def test_solving_leaves_directions_without_information_alone():
    information = np.array([[4.0, 0.0, 2.0], [0.0, 0.0, 0.0], [2.0, 0.0, 9.0]])
    step, promised = solve(np.array([8.0, 0.0, 4.0]), information)
    expected = np.linalg.solve(information[::2, ::2], [8.0, 4.0])
    assert step == pytest.approx([expected[0], 0, expected[1]])
    assert promised == pytest.approx(0.5 * expected @ [8.0, 4.0])


def test_steps_end_at_the_bounds():
    model = model_of(SENSOR, full_well=[0.1], exposure=[0.0])
    parameters = free_parameters(model)
    assert parameters == [("full_well", 0), ("exposure", 0)]
    there = moved(model, parameters, np.array([-5.0, 0.01]))
    assert there.term("full_well").values == [0.0]
    assert there.term("exposure").values == [0.01]


def test_two_effects_are_told_apart(frames):
    shown = planted(frames, 4, lens_shading=PLANTED["lens_shading"], exposure=[0.02])
    start = model_of(SENSOR, exposure=[0.0], lens_shading=[0.0] * 7)
    found = fit(start, on(shown))
    errors = standard_errors(found, on(shown))
    assert abs(found.term("exposure").values[0] - 0.02) < 4 * errors["exposure", 0]


def guessed(name, frames):
    """Return what a search begins with."""
    return first_guess(BY_NAME[name], Linearisation(Model(SENSOR), on(frames)))


def test_where_charge_clips_is_found(frames):
    true = model_of(SENSOR, full_well=[0.55])
    shown = planted(frames, 5, full_well=[0.55])
    start, _ = guessed("full_well", shown)
    assert start.terms[0].values[0] == pytest.approx(0.55, abs=0.03)
    found = fit(start, on(shown))
    assert found.terms[0].values[0] == pytest.approx(0.55, abs=0.005)
    assert on(shown).total(found) > on(shown).total(true) - 10
    clean = planted(frames, 6)
    assert guessed("full_well", clean) is None


def test_charge_clips_above_where_a_profile_says(frames):
    """The well is what its maker promised least, and the change has to be below 0."""
    shown = planted(frames, 5, full_well=[0.4])
    known = [{"name": "full_well", "parameters": {"below_white": 0.5}}]
    doubted = sensor_of(effects=known)
    base = Linearisation(Model(doubted), on(shown))
    start, _ = first_guess(BY_NAME["full_well"], base)
    found = fit(start, on(shown)).term("full_well").values[0]
    assert found == pytest.approx(-0.1, abs=0.005)


def test_row_noise_is_found(frames):
    shown = planted_rows(frames, 7, 0.4)
    start = model_of(SENSOR, row_noise=[0.03])
    found, height = fit_transform(start, "row_noise", on(shown))
    assert found.terms[0].values[0] == pytest.approx(0.4, rel=0.1)
    assert height == pytest.approx(on(shown).total(found))
    of_term = estimates(found, on(shown))["row_noise"]["sigma"]
    read_noise = np.sqrt(frames[0].beta2.mean())
    assert of_term.ci95[0] < 0.4 * read_noise < of_term.ci95[1]


def test_heavy_tails_are_found(frames):
    darks = frames_of(SENSOR, [capture_of("dark", n) for n in range(6)])
    share, ratio = 0.03, 16.0
    silent = model_of(SENSOR, read_noise=[-40.0])
    shown = drawn(darks, silent, 8, tails_of(share, ratio))
    start = model_of(SENSOR, heavy_tailed_noise=[0.01, 9.0])
    found, _ = fit_transform(start, "heavy_tailed_noise", on(shown))
    values, errors = found.terms[0].values, standard_errors(found, on(shown))
    for index, true in enumerate((share, ratio)):
        assert abs(values[index] - true) < 4 * errors["heavy_tailed_noise", index]


def test_coordinate_search_climbs_a_ridge():
    effect = BY_NAME["heavy_tailed_noise"]

    def score(values):
        x, y = values[0] / 0.05 - 1, values[1] / 20 - 1
        return -(x * x) - y * y - x * y

    start = np.array([0.02, 10.0])
    values, height = climb(effect, start, score(start), score)
    assert values == pytest.approx([0.05, 20], rel=0.05)
    assert height > -0.01


def test_threads_change_nothing(frames):
    shown = planted(frames, 9, crosstalk=PLANTED["crosstalk"])
    start = Model(SENSOR).with_effect(BY_NAME["crosstalk"])
    one, three = (
        fit(start, Likelihood(shown, workers)) for workers in (ONE, Workers(3))
    )
    assert (one.terms[0].values == three.terms[0].values).all()


def test_predictions_do_not_depend_on_tiles():
    """A large frame's tiles are what the whole frame is."""
    shape = (320, 420)
    capture = capture_of("scene", 7, shape=shape)
    (whole,) = frames_of(SENSOR, [capture], 10**9)
    (cut,) = frames_of(SENSOR, [capture], 32768)
    assert len(cut.tiles.origins) > 1 and SHAPE < shape
    for name in ("lens_shading", "lateral_chromatic_aberration", "crosstalk", "blur"):
        model = model_of(SENSOR, **{name: PLANTED[name]})
        expected = cut.tiles.cut(predict(model, whole).mean[0])
        assert predict(model, cut).mean == pytest.approx(expected, abs=2e-6)


def test_noise_reduction_leaves_the_noise_of_a_mean_as_it_was():
    """Pixels look quieter, and share what they have left."""
    flats = frames_of(SENSOR, [capture_of("flat", 1)])
    known = []
    for more in ({}, {"noise_reduction": [0.3, 0.0]}):
        model = model_of(SENSOR, exposure=[0.0], **more)
        parameters, _, information = Linearisation(model, on(flats)).system(model)
        at = parameters.index(("exposure", 0))
        known.append(information[at, at])
    assert known[1] == pytest.approx(known[0], rel=0.03)


def test_noise_reduction_never_sharpens():
    frames = frames_of(SENSOR, captures_of(("scene",)))
    sharper = model_of(SENSOR, noise_reduction=[-0.05])
    assert on(frames).total(sharper) == on(frames).total(Model(SENSOR))
