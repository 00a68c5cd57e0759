# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Ties: which of effects that explain the same frames alike is named."""

import numpy as np
import pytest

from cg2raw.diagnose.effects.base import SensorMap
from cg2raw.diagnose.inference.steps import Trial
from cg2raw.diagnose.inference.ties import simplest_of_ties
from cg2raw.diagnose.likelihood.model import Model, Term
from diagnose.planted import BY_NAME, SHAPE, sensor_of

BLOCKS = 400
GAIN = 180.0
THRESHOLD = 8.0
NONE = SensorMap(np.zeros((1, *SHAPE)), np.zeros((1, *SHAPE)))
BARE = Model(sensor_of())
WITH_MAP = BARE.with_term(Term(BY_NAME["prnu"], np.array([0.01]), NONE))


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


@pytest.mark.parametrize("lead", [1.0, 6.5, 14.0])
def test_beside_a_map_more_parameters_gain_some_nats_by_chance(lead):
    assert named(WITH_MAP, lead) == ("exposure", ["lens_shading"])


def test_a_lead_of_two_standard_errors_is_no_tie():
    """Of 400 blocks that differ by 0.4 nats that is 16."""
    assert named(WITH_MAP, 17.0) == ("lens_shading", [])


def test_without_maps_neither_is_one_of_more_than_a_twentieth():
    assert named(BARE, 9.5) == ("lens_shading", [])


def test_a_map_that_leads_clearly_is_taken():
    assert named(WITH_MAP, 6.5, best="prnu") == ("prnu", ["exposure"])


def test_without_maps_held_out_frames_know_nothing_of_what_was_fitted():
    assert named(BARE, 4.0) == ("exposure", ["lens_shading"])
    assert named(BARE, 6.5) == ("lens_shading", ["exposure"])


@pytest.mark.parametrize("model", [BARE, WITH_MAP])
def test_a_lead_that_all_blocks_have_is_no_tie(model):
    assert named(model, 6.5, scatter=0.0) == ("lens_shading", [])


@pytest.mark.parametrize("lead", [1.0, 4.0])
def test_a_tie_goes_to_a_map_for_no_effect_with_more_parameters(lead):
    taken, others = named(WITH_MAP, lead, best="lens_shading", other="prnu")
    assert (taken, others) == ("lens_shading", ["prnu"])


def test_noise_wins_no_tie_against_an_effect_of_the_mean():
    taken, others = named(WITH_MAP, 1.0, best="lens_shading", other="row_noise")
    assert (taken, others) == ("lens_shading", ["row_noise"])
