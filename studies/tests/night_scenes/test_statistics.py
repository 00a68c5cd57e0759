# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The numbers of variety: known areas, and planted duplicates."""

import numpy as np
import pytest

from studies.night_scenes import statistics

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])


def test_the_hull_of_a_square_with_points_inside():
    rng = np.random.default_rng(1)
    points = np.concatenate([rng.uniform(0, 1, (50, 2)), SQUARE])
    assert statistics.hull(points).tolist() == SQUARE.tolist()
    assert statistics.area(statistics.hull(points)) == 1.0


@pytest.mark.parametrize(
    ("points", "expected"),
    [
        (SQUARE, 1.0),
        (3 * SQUARE - 1, 1.0),
        (SQUARE + (0.5, 0.0), 0.5),
        (SQUARE + (0.5, 0.5), 0.25),
        (SQUARE + (2.0, 0.0), 0.0),
        (0.5 * SQUARE, 0.25),
        (SQUARE[:3], 0.5),
        (SQUARE[:2], 0.0),
    ],
)
def test_the_share_of_a_window(points, expected):
    assert statistics.share(points, SQUARE) == pytest.approx(expected, abs=1e-12)


def picture(seed, shape=(45, 80, 3)):
    return np.random.default_rng(seed).lognormal(-3, 1.5, shape)


def test_a_duplicate_is_found_although_it_is_darker():
    pictures = [picture(seed) for seed in range(6)]
    pictures.append(0.5 * pictures[2])
    smooth = [np.kron(p[::5, ::5], np.ones((5, 5, 1))) for p in pictures]
    thumbnails = [statistics.thumbnail(each) for each in smooth]
    apart, *pair = statistics.closest(thumbnails)
    assert sorted(pair) == [2, 6]
    assert apart < statistics.ALIKE
    others, *_ = statistics.closest(thumbnails[:6])
    assert others > statistics.ALIKE


def test_a_thumbnail_is_the_mean_of_blocks():
    small = np.random.default_rng(3).uniform(0.1, 1, (9, 16, 3))
    large = np.kron(small, np.ones((10, 10, 1)))
    assert np.allclose(statistics.thumbnail(large), statistics.thumbnail(small))


def test_a_grey_scene_has_the_neutral_of_its_light():
    import cg2raw

    sensor = cg2raw.Sensor(statistics.SENSOR)
    # The matrix times the white of D65; 0.001: published to 8 digits, white to 4.
    assert statistics.neutral(sensor, (0.2, 0.2, 0.2)) == pytest.approx(
        (0.3928, 0.6665), abs=1e-3
    )


def test_a_folder_without_frames_is_refused(tmp_path):
    from studies.night_scenes.folder import Refused

    with pytest.raises(Refused, match="no frames"):
        statistics.report(tmp_path)


@pytest.mark.parametrize("words", [["--statistics"], ["--contact-sheet", "sheet.png"]])
def test_a_damaged_frame_is_one_line(tmp_path, capsys, words):
    from studies.night_scenes.main import main

    (tmp_path / "night_0000.exr").write_bytes(b"v/1\x01\x02")
    assert main([str(tmp_path), *words]) == 1
    errors = capsys.readouterr().err
    assert errors.startswith("night-scenes: ") and errors.count("\n") == 1
    assert "night_0000.exr" in errors
