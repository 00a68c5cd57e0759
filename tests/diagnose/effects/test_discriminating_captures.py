# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Discriminating captures: a sentence for any two effects, whichever comes first."""

import pytest

from cg2raw.diagnose.effects.catalogue import every, names
from cg2raw.diagnose.effects.discriminating_captures import (
    GENERAL,
    discriminating_captures,
)

EFFECTS = names()


def test_the_effects_that_are_told_apart_exist():
    for effect in every().values():
        assert set(effect.told_apart) <= set(EFFECTS) - {effect.name}


@pytest.mark.parametrize("first", EFFECTS)
def test_what_separates_two_effects_does_not_depend_on_their_order(first):
    for second in EFFECTS:
        assert discriminating_captures(first, second) == discriminating_captures(
            second, first
        )


@pytest.mark.parametrize(
    ("first", "second", "word"),
    [
        ("prnu", "shot_noise", "repeats in every frame"),
        ("lens_shading", "exposure", "falls off from the middle"),
        ("nonlinearity", "exposure", "three or more levels"),
        ("blur", "noise_reduction", "leaves it white"),
        ("black_level", "dark_current", "two exposure times"),
        ("lens_shading", "read_noise", "Repeated frames of one scene"),
        ("blur", "prnu", GENERAL),
    ],
)
def test_what_separates_effects_that_look_alike(first, second, word):
    assert word in discriminating_captures(first, second)
