# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Notes say what frames could not show, and nothing else."""

from types import SimpleNamespace

import numpy as np
import pytest

from calibration.test_bounds import found_with
from calibration.test_table import figure
from cg2raw.calibration.darks import Tails
from cg2raw.calibration.fitting import Fitted
from cg2raw.calibration.flats import Light, Linearity, PhotonTransfer, TransferPoints
from cg2raw.calibration.measured import Measured
from cg2raw.calibration.notes import notes_on, of_flats
from cg2raw.calibration.sites import Sites

DARK = SimpleNamespace(cut=0.1, frame=SimpleNamespace(name="bias-1"))
DRIFT, NOISE = (
    figure(name, "DN", 0.3, 0.1)
    for name in ("black level drift", "temporal dark noise")
)
TAILS = Tails(None, None, np.zeros(128), 2, np.ones((1, 64)), np.ones(64))
NO_FLATS = "gain, PRNU, shading, linearity"


@pytest.mark.parametrize(
    ("fields", "subjects"),
    [
        ({"frames": (0, 0), "dark": None}, ["black level", "read noise"]),
        (
            {"dark": None},
            ["read noise", "black level drift", "dark current, hot pixels, glow"],
        ),
        ({}, ["read noise", "black level drift", "doubling temperature"]),
        ({"dark": None, "fit": Fitted(lost="cut")}, ["darks"]),
        (
            {"dark": None, "fit": Fitted(lost="coarse")},
            ["read noise", "dark current, hot pixels, glow"],
        ),
        (
            {"fit": Fitted([DRIFT, NOISE]), "tails": TAILS},
            ["tails of the read noise", "doubling temperature"],
        ),
        (
            {"fit": Fitted([DRIFT], misfit=2.0), "tails": TAILS},
            ["doubling temperature", "black level"],
        ),
        (
            {"fit": Fitted([DRIFT], misfit=1.4), "sites": Sites(("",), step=4)},
            ["codes", "read noise", "doubling temperature"],
        ),
    ],
)
def test_darks_that_lack_something_say_what(fields, subjects):
    found = found_with(**fields)
    said = [note.split(":")[0] for note in notes_on(found, [DARK])]
    assert sorted(said) == sorted(["ISO", *subjects, NO_FLATS])


def test_a_note_has_the_numbers_that_it_is_about():
    found = found_with(
        sites=Sites(("",), step=4),
        transfer=PhotonTransfer(clipped=3),
        excluded={"dark-7": "its level is off"},
        fit=Fitted(lost="cut", misfit=2.0),
    )
    said = " / ".join(notes_on(found, [DARK]))
    for words in (
        "dark-7: its level is off: excluded",
        "steps of 4 DN",
        "rounding adds 4^2 / 12 DN^2",
        "3 flats have more than 0.2% of pixels at white",
        "10.0% of the pixels of bias-1: black level and read noise are by the law",
        "by 2.0 times their drift",
    ):
        assert words in said, said


def transfer(is_coarse=False, **more):
    """Return photon transfer of one group of two flats."""
    one = np.ones((1, 1))
    point = TransferPoints(one, one, one, 99.0, 1.0, 2, 0.0, is_coarse)
    return PhotonTransfer([point], **more)


GAIN = figure("gain", "e-/DN", 2.0, 0.1)
LIGHT = Light({}, Measured(0.1, 0.01, "1"), 0.0, np.ones((2, 2)))
FULL = transfer(saturation=Measured(999.0, 1.0, "DN"))


def line(bend, error=0.001):
    """Return linearity with a loss of 0.1, of such an error."""
    loss = Measured(0.1, error, "1")
    return Linearity(loss, loss, None, bend, np.ones(3), np.zeros(3))


@pytest.mark.parametrize(
    ("fields", "beginnings"),
    [
        ({"frames": (4, 0)}, ["gain, PRNU, shading, linearity: no flats"]),
        ({}, ["gain: ", "PRNU, shading: ", "linearity: needs flats of three"]),
        (
            {"fit": Fitted([GAIN]), "transfer": transfer(True), "light": LIGHT},
            ["2 flats vary by less than 0.49 DN", "full well: ", "linearity: needs"],
        ),
        (
            {"fit": Fitted([GAIN]), "transfer": FULL, "linearity": line(0.004)},
            ["PRNU, shading: ", "linearity: levels are off"],
        ),
        (
            {"frames": (0, 2), "fit": Fitted([GAIN]), "transfer": FULL, "light": LIGHT}
            | {"linearity": line(0.006)},
            ["PRNU: without darks"],
        ),
        (
            {"fit": Fitted([GAIN]), "transfer": FULL, "light": LIGHT}
            | {"linearity": line(0.3, error=0.1)},
            [
                "linearity: levels are off proportional to exposure time by 30.00% in "
                "the mean, but by no curve"
            ],
        ),
        (
            {"fit": Fitted([GAIN]), "transfer": FULL, "light": LIGHT}
            | {"linearity": line(0.004, error=0.1)},
            [],
        ),
    ],
)
def test_flats_that_lack_something_say_what(fields, beginnings):
    said = list(of_flats(found_with(**{"frames": (4, 2)} | fields)))
    assert len(said) == len(beginnings), said
    assert all(map(str.startswith, said, beginnings)), said
