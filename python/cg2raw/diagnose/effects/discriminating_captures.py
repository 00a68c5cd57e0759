# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Sentences on effects that were found, and on the frames in which two differ."""

from cg2raw.diagnose.effects.base import Estimates
from cg2raw.diagnose.effects.catalogue import effect, every, heading
from cg2raw.sensor import Sensor

# What both effects change (their signatures), and what then tells them apart; the most
# particular ones stand first.
BY_SIGNATURE = (
    (
        {"gain"},
        "Flats at three or more levels: level and radius are then told apart, and so "
        "are a gain, a curve and a clip.",
    ),
    (
        {"mixer"},
        "A chart with greys and saturated patches beside flats: white balance shows on "
        "greys, a colour matrix on saturated patches alone, crosstalk at edges too.",
    ),
    (
        {"softener"},
        "Flats and darks: noise reduction correlates the noise of neighbours, blur "
        "leaves it white, crosstalk also desaturates flats.",
    ),
    (
        {"offset"},
        "Darks of two exposure times: dark current grows with time, a black level does "
        "not, and glare is absent without light.",
    ),
    (
        {"noise"},
        "Darks, and flats from dim to bright: each noise grows with the signal in its "
        "own way.",
    ),
    ({"noise", "map"}, "Repeated frames: a fixed pattern repeats, noise does not."),
)
REPEATS = (
    "Repeated frames of one scene: what repeats is an error of the mean, what does not "
    "is noise."
)
GENERAL = "Flats at three levels, darks of two exposure times and two further scenes."


def discriminating_captures(first: str, second: str) -> str:
    """Return a sentence: the frames in which two effects differ."""
    for one, other in ((first, second), (second, first)):
        if one in every() and other in every()[one].told_apart:
            return every()[one].told_apart[other]
    signatures = [
        every()[name].signature if name in every() else frozenset()
        for name in (first, second)
    ]
    for changed, sentence in BY_SIGNATURE:
        if all(changed & signature for signature in signatures):
            return sentence
    return REPEATS if any("noise" in each for each in signatures) else GENERAL


def sentence(name: str, values: Estimates, sensor: Sensor) -> str:
    """Return one sentence of what was found."""
    return f"{heading(name)}: {effect(name).size_on(values, sensor)}."
