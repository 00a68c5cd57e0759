# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A chart's patches are where they are photographed, in their published colours."""

import csv

import numpy as np
import pytest

from cg2raw.diagnose.captures.chart import (
    COLORCHECKER,
    ColorChecker,
    PatchChart,
    chart_from_pixel,
    rec709_from_xyz,
    rec709_of,
    xyz_from_lab,
)
from cg2raw.diagnose.captures.manifest import Patch
from cg2raw.diagnose.captures.reader import read_frames
from diagnose import capture_files as files

# The real chart: centres of dark skin, bluish green, black and white, found by eye.
CANON = "real/canon550d_colorchart_tinydng.dng"
CORNERS = ((624, 714), (612, 1248), (922, 1256), (932, 702))
OPTICAL_BLACK = 2048  # DN, that the published patch means are above


def test_the_colorchecker_is_the_published_one(repository):
    colour = pytest.importorskip("colour")
    name = "ColorChecker24 - Before November 2014"
    published = colour.CCS_COLOURCHECKERS[name]
    xyz = colour.xyY_to_XYZ(np.array(list(published.data.values())))
    lab = colour.XYZ_to_Lab(xyz, published.illuminant)
    np.testing.assert_allclose(COLORCHECKER, lab, atol=2e-3)
    # X-Rite's table of 2005 has four decimals of x, y, Y.
    table = repository / "tests" / "data" / "colorchecker_2005.csv"
    lines = [line for line in table.open() if not line.startswith("#")]
    rows = [[float(row[k]) for k in "xyY"] for row in csv.DictReader(lines)]
    np.testing.assert_allclose(
        xyz_from_lab(COLORCHECKER), colour.xyY_to_XYZ(rows), atol=4e-4
    )


@pytest.mark.parametrize(
    ("lab", "expected"),
    [
        ((100, 0, 0), (1, 1, 1)),  # D50 is white in Rec.709 after adaptation
        ((0, 0, 0), (0, 0, 0)),
        ((8, 0, 0), (216 / 24389,) * 3),  # the joint of CIE 15
        ((50, 0, 0), ((66 / 116) ** 3,) * 3),
        ((4, 0, 0), (4 * 27 / 24389,) * 3),  # on the straight part
    ],
)
def test_lab_of_greys(lab, expected):
    found = rec709_from_xyz(xyz_from_lab(np.array(lab, float)))
    np.testing.assert_allclose(found, expected, atol=1e-6)


def test_a_patch_is_given_in_three_ways():
    lab = (42.101, 53.378, 28.190)
    xyz = tuple(xyz_from_lab(np.array(lab)))
    rgb = rec709_of(Patch((0, 0, 4, 4), lab, "lab"))
    np.testing.assert_allclose(rec709_of(Patch((0, 0, 4, 4), xyz, "xyz")), rgb)
    np.testing.assert_allclose(rec709_of(Patch((0, 0, 4, 4), tuple(rgb), "rgb")), rgb)
    colour = pytest.importorskip("colour")
    d50 = np.array((0.3457, 0.3585))
    theirs = colour.XYZ_to_sRGB(
        colour.Lab_to_XYZ(lab, d50), d50, "Bradford", apply_cctf_encoding=False
    )
    np.testing.assert_allclose(rgb, theirs, atol=2e-4)  # their matrix has 4 decimals


def test_patches_are_drawn_and_their_middles_count():
    patches = [Patch((2, 4, 10, 20), (0.5, 0.25, 0.1), "rgb")]
    patches += [Patch((20, 30, 10, 10), (0.1, 0.2, 0.3), "rgb")]
    chart = PatchChart(patches, files.SHAPE, 2.0)
    scene, mask = chart.scene(), chart.mask()
    assert scene.dtype == np.float32
    np.testing.assert_allclose(
        scene[2:12, 4:24], np.broadcast_to((1, 0.5, 0.2), (10, 20, 3))
    )
    np.testing.assert_allclose(scene[0, 0], (0.6, 0.45, 0.4), rtol=1e-6)  # the mean
    assert mask.sum() == 6 * 12 + 6 * 6
    assert mask[4:10, 8:20].all() and mask[22:28, 32:38].all()


@pytest.mark.parametrize("turns", range(4))
def test_a_colorchecker_may_be_turned(turns):
    corners = [(20, 20), (20, 120), (80, 120), (80, 20)]
    shape = (100, 140)
    upright = ColorChecker(corners, shape, 1.0)
    turned = [corners[(index + turns) % 4] for index in range(4)]
    if turns % 2:  # six patches lie across four
        turned = [(col, row) for row, col in turned[::-1]]
        shape = shape[::-1]
    chart = ColorChecker(turned, shape, 1.0)
    for index, (row, col) in enumerate(turned):
        patch = (0, 5, 23, 18)[index]
        np.testing.assert_allclose(
            chart.scene()[row, col], upright.colors[patch], rtol=1e-6
        )
        assert chart.mask()[row, col]
    between = upright.scene()[30, 30]
    np.testing.assert_allclose(between, upright.colors.mean(axis=0), rtol=1e-6)
    # Of a pitch of 20 pixels: 0.85 of it, 8.5 to each side, of which 0.6 counts.
    patches = (upright.scene() != between).any(axis=-1)
    assert (patches.sum(), upright.mask().sum()) == (24 * 17**2, 24 * 11**2)
    assert chart.mask().sum() == pytest.approx(24 * 10.2**2, rel=0.2)


def test_a_chart_in_perspective_is_where_a_planted_map_has_it():
    pixel_from_chart = np.array([[30, 3, 40], [-4, 25, 30], [0.02, 0.03, 1]])
    row, col, w = pixel_from_chart @ [*np.mgrid[:4, :6].reshape(2, -1), np.ones(24)]
    seen = np.array([row / w, col / w, np.ones(24)])
    y, x, w = chart_from_pixel(seen[:2, [0, 5, 23, 18]].T) @ seen
    assert 6 * y / w + x / w == pytest.approx(np.arange(24)) and (w > 0).all()


def test_the_real_chart_has_its_published_patches(camera_data, tmp_path):
    """Means of all patches of a real photo, as somebody else measured them."""
    corners = [list(corner) for corner in CORNERS]
    path = files.manifest(
        tmp_path,
        [f"{{file: {camera_data / CANON}, kind: chart, chart: colorchecker, "
         f"corners: {corners}}}"],
        f"sensor: {camera_data / CANON}",
    )  # fmt: skip
    [frame] = read_frames(path)[2]
    raw = frame.capture.raw().astype(float) - OPTICAL_BLACK
    mask = frame.capture.mask()
    chart = ColorChecker(CORNERS, frame.capture.shape, 1.0)
    index, _ = chart.positions(slice(0, raw.shape[0]))
    table = camera_data / "tables/colorchecker"
    with open(table / "canon550d_colorchart_24patches_bayer_mean_var.csv") as file:
        published = list(csv.DictReader(file))
    sites = {"R": (0, 0), "G1": (0, 1), "G2": (1, 0), "B": (1, 1)}
    for patch, row in enumerate(published):
        for name, (top, left) in sites.items():
            ours = (mask & (index == patch))[top::2, left::2]
            mean = raw[top::2, left::2][ours].mean()
            assert mean == pytest.approx(float(row[name]), rel=0.01, abs=3), (
                patch,
                name,
            )
