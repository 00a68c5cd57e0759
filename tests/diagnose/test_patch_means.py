# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tables of patch means show a black level that is wrong, and nothing that is not."""

import numpy as np
import pytest

from cg2raw.diagnose.captures.reader import read_captures
from cg2raw.diagnose.pipeline import diagnose
from diagnose.patch_tables import SENSOR, SPAN, write_tables


def offsets(found):
    """Return the offsets of black_level, of white, at the four sites."""
    [effect] = found.effects
    assert effect.name == "black_level"
    return [estimate.value for estimate in effect.parameters.values()]


@pytest.mark.parametrize("threshold", [0.0, 0.06])
def test_a_black_level_is_found_alone(tmp_path, threshold):
    """Also where means below a threshold, a tenth of all, are missing."""
    path = write_tables(tmp_path, offset=0.02, threshold=threshold)
    captures = read_captures(path)
    cut = [(c.means.side < 0).mean() for c in captures.captures]
    assert (np.mean(cut) > 0.09) == (threshold > 0)
    found = diagnose(captures, details=False)
    assert offsets(found) == pytest.approx([0.02] * 4, rel=0.05)


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_the_errors_of_a_chart_are_no_effect(tmp_path, seed):
    found = diagnose(read_captures(write_tables(tmp_path, seed=seed)), details=False)
    assert (found.verdict, list(found.effects)) == ("consistent", [])


def test_what_needs_pixels_is_not_nameable(tmp_path):
    found = diagnose(read_captures(write_tables(tmp_path, frames=3)), details=False)
    limits = {one.name: one.strength for one in found.detection_limits}
    named = {name for name, strength in limits.items() if strength is not None}
    assert named <= {"black_level", "exposure", "full_well", "gr_gb_imbalance"}
    assert {"black_level", "gr_gb_imbalance"} <= named
    for name in ("prnu", "read_noise", "blur", "noise_reduction", "lens_shading"):
        assert limits[name] is None


def test_tables_and_frames_together(tmp_path):
    """Darks say the same of black, in pixels; details are drawn of these alone."""
    lines = []
    planted = round(0.02 * SPAN)
    for index in range(6):
        dark = SENSOR.simulate(
            np.zeros((96, 128, 3), np.float32), illuminant="D65", iso=100, frame=index
        )
        np.save(tmp_path / f"{index}.npy", np.asarray(dark) + planted)
        lines.append(
            f"{{file: {index}.npy, kind: dark, exposure_time: {1 + index % 2}}}"
        )
    path = write_tables(
        tmp_path, offset=round(0.02 * SPAN) / SPAN, frames=3, more=lines
    )
    found = diagnose(read_captures(path))
    assert "black_level" in [effect.name for effect in found.effects]
    values = found.effects[0].parameters.values()
    assert [v.value for v in values] == pytest.approx([0.02] * 4, rel=0.01)
