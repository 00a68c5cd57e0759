# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Pictures of frames of any shape."""

from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.assessment.figures import Canvas
from cg2raw.diagnose.captures.consistency import LEAST_SIDE


def one_tile(shape):
    """Return a frame that is one tile, as a piece of itself."""
    rows, columns = np.mgrid[: shape[0], : shape[1]][:, None]
    tiles = SimpleNamespace(shape=shape, rows_and_columns=lambda: (rows, columns))
    signal = np.full((1, *shape), 0.25, np.float32)
    every = np.ones(signal.shape, bool)
    return SimpleNamespace(
        tiles=tiles,
        signal=signal,
        keep=every,
        censored=~every,
        neutral=(1.0, 1.0, 1.0),
        capture=SimpleNamespace(name="a", kind="flat"),
    )


@pytest.mark.parametrize("cfa", ["MONO", "RGGB"])
@pytest.mark.parametrize("shape", [(LEAST_SIDE, 4096), (4096, 5), (64, 48), (600, 600)])
def test_a_frame_of_few_rows_has_a_picture(shape, cfa):
    frame = one_tile(shape)
    canvas = Canvas(frame, cfa)
    canvas.mount(frame, frame.signal, frame.signal, frame.signal, frame.signal)
    picture = canvas.picture()
    assert np.nanmax(np.abs(picture.measured - 0.25)) < 1e-6
    assert np.isfinite(picture.measured).mean() >= 0.5
    assert np.isfinite(picture.z_after).mean() >= 0.5
