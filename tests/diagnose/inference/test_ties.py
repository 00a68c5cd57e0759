# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Ties: which of effects that explain the same frames alike is named."""

import numpy as np

from cg2raw.diagnose.inference.steps import Trial
from cg2raw.diagnose.inference.ties import simplest_of_ties
from cg2raw.diagnose.likelihood.model import Model
from diagnose.planted import BY_NAME, sensor_of

BLOCKS = 400
GAIN = 180.0
THRESHOLD = 8.0
BARE = Model(sensor_of())


def trial(name, gain, model, scatter=0.0):
    """Return a trial whose gain is spread over blocks, which differ by chance."""
    noise = np.random.default_rng(1).standard_normal(BLOCKS)
    blocks = gain / BLOCKS + scatter * (noise - noise.mean())
    return Trial(name, gain, blocks, model, gain)


def named(model, lead, best="lens_shading", other="exposure", scatter=0.4):
    """Return what is taken of two effects, and what is as good."""
    trials = [trial(best, GAIN, model, scatter), trial(other, GAIN - lead, model)]
    taken, others = simplest_of_ties(
        trials[0], trials, list(BY_NAME.values()), THRESHOLD
    )
    return taken.name, others


def test_neither_is_one_of_more_than_a_twentieth():
    assert named(BARE, 9.5) == ("lens_shading", [])


def test_held_out_frames_know_nothing_of_what_was_fitted():
    assert named(BARE, 4.0) == ("exposure", ["lens_shading"])
    assert named(BARE, 6.5) == ("lens_shading", ["exposure"])


def test_a_lead_that_all_blocks_have_is_no_tie():
    assert named(BARE, 6.5, scatter=0.0) == ("lens_shading", [])


def test_noise_wins_no_tie_against_an_effect_of_the_mean():
    taken, others = named(BARE, 1.0, best="lens_shading", other="row_noise")
    assert (taken, others) == ("lens_shading", ["row_noise"])
