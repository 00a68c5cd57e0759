# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Exposures that are known are found, whatever tone, colour, light and sensor are."""

import numpy as np
import pytest

from cg2raw.match import compare
from match.match_sets import MEDIAN, SPREAD, sets

SENSORS = ("canon-700d", "samsung-s20fe", "nikon-d40", "fujifilm-x-m1", "sony-a7s-ii")


def test_it_is_found_of_shared_scenes_whatever_the_tone():
    captures, renders, exposures = sets(
        np.random.default_rng(1), count=30, scenes=1, shared=True
    )
    found = compare("canon-700d", captures, renders)
    assert found.scenes > 24
    assert found.exposure.median == pytest.approx(np.median(exposures), abs=0.1)
    assert found.exposure.spread == pytest.approx(exposures.std(), abs=0.1)
    assert "contrast of captures is 1.2" in " ".join(found.notes)


def test_it_is_found_of_other_scenes():
    """Within what the scenes' own levels allow: 0.3 stops between scenes."""
    captures, renders, _ = sets(np.random.default_rng(2), count=30)
    found = compare("canon-700d", captures, renders)
    assert found.scenes == 0
    low, high = found.exposure.median_range
    assert low < MEDIAN < high and high - low < 1
    low, high = found.exposure.spread_range
    assert low < SPREAD < high and high - low < 1


@pytest.mark.slow
@pytest.mark.parametrize("draw", range(20))
@pytest.mark.parametrize(
    ("shared", "scenes", "spread"),
    [(True, 1.0, 0.7), (False, 0.2, 0.3)],
    ids=["shared scenes", "other scenes"],
)
def test_it_is_found_in_each_draw_of_200(draw, shared, scenes, spread):
    """The level of 200 other scenes is known within 3 * scenes * (2 / 200)**0.5, and
    the median of 200 exposures is that far from their mean: docs/match.md."""
    sensor = SENSORS[draw % len(SENSORS)]
    captures, renders, exposures = sets(
        np.random.default_rng(100 + draw),
        sensor,
        scenes=scenes,
        shared=shared,
        spread=spread,
    )
    found = compare(sensor, captures, renders)
    assert (found.scenes > 180) == shared
    assert found.exposure.median == pytest.approx(np.median(exposures), abs=0.1)
    assert found.exposure.spread == pytest.approx(exposures.std(), abs=0.15)
