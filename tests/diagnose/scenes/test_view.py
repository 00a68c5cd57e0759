# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Views: which frames repeat each other, what they differ by, and patches of charts."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.scenes.model import Model
from cg2raw.diagnose.scenes.view import views_of
from diagnose.planted import capture_of, drawn, frames_of, sensor_of

SENSOR = sensor_of()


OTHER = [{"set": "another"}, {"group": "report"}, {"kind": "flat"}]
OTHER += [{"exposure_time": 2.0}, {"mask": lambda: np.eye(64, 96) == 0}]


@pytest.mark.parametrize(
    ("changed", "frames"), [({}, [3]), *((other, [2, 1]) for other in OTHER)]
)
def test_frames_of_one_light_and_one_setting_are_a_view(changed, frames):
    captures = [capture_of(), capture_of(), capture_of(**changed)]
    assert [view.n for view in views_of(frames_of(SENSOR, captures))] == frames


def test_a_frame_that_is_brighter_is_away_by_nothing():
    """And what each has besides has nothing of the light."""
    [frame] = drawn(frames_of(SENSOR, [capture_of()]), Model(SENSOR), 1)
    lit = [replace(frame, signal=frame.signal * gain) for gain in (0.9, 1.0, 1.2)]
    assert views_of(lit)[0].away == pytest.approx(0, abs=1e-12)
    [view] = views_of([frame, replace(frame, signal=frame.signal + 0.1)])
    assert np.abs(view.away).max() > 0.01
    assert (view.away * view.signal).sum((1, 2, 3)) == pytest.approx(0, abs=1e-9)


def test_patches_of_a_chart_are_told_by_their_colour_and_filter():
    """Wherever its tiles lie."""
    shape, colors = (320, 480), np.array([(0.5, 0.2, 0.1), (0.1, 0.3, 0.1)])
    which = (np.mgrid[: shape[0], : shape[1]] // 100).sum(0) % 2
    scene = colors[which].astype(np.float32)
    capture = replace(capture_of(shape=shape, scene=lambda: scene), kind="chart")
    [view] = views_of(frames_of(SENSOR, [capture], 16384))
    here = view.frame.tiles.cut(which)
    every = np.broadcast_arrays(view.patches, here, view.frame.color)
    seen = {*zip(*map(np.ravel, every), strict=True)}
    assert len(seen) == len({patch for patch, *_ in seen}) == 6
