# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

from itertools import chain

import numpy as np
import pytest

from calibration.test_bounds import found_with
from calibration.test_table import figure
from cg2raw.calibration import report
from cg2raw.calibration.fitting import Fitted
from cg2raw.calibration.flats import Linearity, PhotonTransfer, TransferPoints
from cg2raw.calibration.measured import Measured


def test_photon_transfer_is_drawn_by_gain_dark_noise_and_patterns(monkeypatch):
    """Variance is that of a dark and of light over the gain; signal to noise is theirs,
    and with patterns that of PRNU and DSNU, too."""
    drawn = []
    monkeypatch.setattr(report, "lines", lambda _, marks, *more: drawn.append(marks))
    figures = [
        figure("gain", "e-/DN", 2.0, 0.1),
        figure("read noise", "DN", 3.0, 0.1),
        figure("PRNU", "1", 0.01, 0.001),
        figure("DSNU", "DN", 3.0, 0.1),
    ]
    mean = np.array([[100.0, 400.0, 900.0]])
    one = TransferPoints(mean, 2 * mean, 0.1 * mean, 400.0, 1.0, 2, 0.0, False)
    found = found_with(fit=Fitted(figures), transfer=PhotonTransfer([one]))
    list(report.transfer(found, found.figure("gain")))
    marks = {mark.label or "": mark for mark in chain(*drawn)}
    x = marks["with shot noise"].x
    variance = 3**2 + 1 / 12 + x / 2
    assert x[-1] == pytest.approx(900) and len(drawn) == 2
    assert marks["with shot noise"].y == pytest.approx(variance)
    assert marks["in time"].y == pytest.approx(x / np.sqrt(variance))
    both = variance + (0.01 * x) ** 2 + 3**2
    assert marks["with patterns"].y == pytest.approx(x / np.sqrt(both))
    of_flats, ratios = (marks[-1] for marks in drawn)
    assert (of_flats.x, of_flats.y) == (
        pytest.approx(mean[0]),
        pytest.approx(2 * mean[0]),
    )
    assert ratios.y == pytest.approx(np.sqrt(mean[0] / 2))


def test_linearity_is_drawn_by_deviations_and_told_with_its_interval(monkeypatch):
    drawn = []
    monkeypatch.setattr(report, "lines", lambda _, marks, *more: drawn.extend(marks))
    error, loss = Measured(0.5, 0.1, "%"), Measured(0.02, 0.01, "1")
    levels, deviations = np.array([900.0, 100.0]), np.array([0.3, -0.3])
    line = Linearity(error, loss, None, 0.01, levels, deviations)
    card = next(report.cards(found_with(linearity=line)))
    assert (card.title, card.interval) == ("Linearity", "95 %: 0.30 to 0.70 %")
    zero, dots = drawn
    assert (list(zero.x), list(zero.y)) == ([100, 900], [0, 0])
    assert (list(dots.x), list(dots.y)) == ([900, 100], [0.3, -0.3])
