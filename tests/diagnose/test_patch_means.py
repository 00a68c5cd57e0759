# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Tables of patch means of a chart whose colours are not quite as published: they show
a black level that is wrong, and nothing that is not."""

import numpy as np
import pytest

import cg2raw
from cg2raw.diagnose.captures.chart import (
    COLORCHECKER,
    COLORCHECKER_NAMES,
    rec709_from_xyz,
    xyz_from_lab,
)
from cg2raw.diagnose.captures.chart_table import places_of
from cg2raw.diagnose.captures.reader import read_captures
from cg2raw.diagnose.pipeline import diagnose

SENSOR = cg2raw.Sensor("canon-5d-mark-iv")
SPAN = SENSOR.white_level - SENSOR.black_level[0]
SIDE = 20  # px of one site along a patch
COLOR_ERROR = 0.01  # relative, of each patch and channel, in all frames of the chart
NOMINAL = np.maximum(rec709_from_xyz(xyz_from_lab(COLORCHECKER)), 0)


def shot(rgb, frame):
    """Return (24, 4) means at R, G1, G2 and B of patches that were simulated."""
    picture = np.kron(rgb.reshape(4, 6, 3), np.ones((2 * SIDE, 2 * SIDE, 1)))
    run = {"illuminant": "D65", "iso": 100, "frame": frame, "highlights": False}
    raw = np.asarray(SENSOR.simulate(picture.astype(np.float32), **run), float)
    blocks = raw.reshape(4, SIDE, 2, 6, SIDE, 2).mean((1, 4)).transpose(0, 2, 1, 3)
    return blocks.reshape(24, 4)[:, list(places_of(SENSOR.cfa))]


def write_tables(folder, offset=0.0, threshold=0.0, seed=1, frames=9, more=()):
    """Write tables of one chart in lights of any brightness; return the manifest.

    offset : of white, that black lies too high. threshold : of white, below which means
    are left out. more : lines of other frames."""
    rng = np.random.default_rng(seed)
    chart = NOMINAL * (1 + COLOR_ERROR * rng.standard_normal(NOMINAL.shape))
    lines = list(more)
    for index in range(frames):
        brightness = rng.uniform(0.3, 0.75)
        means = shot(chart * brightness, 100 * seed + index) + offset * SPAN
        rows = [
            ",".join(
                "" if mean < SENSOR.black_level[0] + threshold * SPAN else f"{mean:.3f}"
                for mean in row
            )
            for row in means
        ]
        pairs = zip(COLORCHECKER_NAMES, rows, strict=True)
        text = "".join(f"{name},{row},{SIDE**2}\n" for name, row in pairs)
        (folder / f"{index}.csv").write_text(f"patch,R,G1,G2,B,count\n{text}")
        lines.append(f"{{file: {index}.csv, kind: chart, chart: colours.csv}}")
    pairs = zip(COLORCHECKER_NAMES, NOMINAL, strict=True)
    text = "".join(f"{name},{r:.6f},{g:.6f},{b:.6f}\n" for name, (r, g, b) in pairs)
    (folder / "colours.csv").write_text(f"patch,r,g,b\n{text}")
    top = f"sensor: {SENSOR.id}\niso: 100\nilluminant: D65\nframes:\n"
    path = folder / "captures.yaml"
    path.write_text(top + "".join(f"  - {line}\n" for line in lines))
    return path


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
