# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The folder of the second judge: what its loader gives, and what it refuses."""

import json

import numpy as np
import pytest

from studies.mitsuba_judge.folder import (
    GENERATOR,
    Settings,
    accept,
    frame_path,
    is_done,
    judge_frames,
    part_path,
)
from studies.mitsuba_judge.main import main

CAMERA = "sony-a7s-ii"
SETTINGS = Settings(8, 16, 0, (CAMERA,), {"lights": "0", "reflectances": "0"})


def put(folder, index, neutral=(0.5, 1.0, 0.7)):
    """Write a frame whose pixels are its index."""
    part = part_path(folder, index)
    with open(part, "wb") as file:
        np.savez(file, **{CAMERA: np.full((6, 8, 3), index, np.float32)})
    described = {**SETTINGS.as_json(), "neutrals": {CAMERA: neutral}}
    accept(part, frame_path(folder, index), described)


def test_frames_come_in_order_with_their_neutrals(tmp_path):
    for index in (10, 2):
        put(tmp_path, index, neutral=(0.1 * index, 1.0, 0.5))
    (tmp_path / "again").mkdir()
    put(tmp_path / "again", 3)
    frames = judge_frames(tmp_path, CAMERA)
    assert [image[0, 0, 0] for image in frames.images] == [2.0, 10.0]
    assert frames.images[0].dtype == np.float32
    assert frames.neutrals == pytest.approx(np.array([[0.2, 1, 0.5], [1.0, 1, 0.5]]))


def test_a_part_is_no_frame(tmp_path):
    put(tmp_path, 0)
    part_path(tmp_path, 1).write_bytes(b"half")
    assert len(judge_frames(tmp_path, CAMERA).images) == 1


@pytest.mark.parametrize("there", [True, False])
def test_a_folder_without_frames(tmp_path, there):
    folder = tmp_path if there else tmp_path / "judge"
    with pytest.raises(ValueError) as caught:
        judge_frames(folder, CAMERA)
    message = str(caught.value)
    assert message == (
        f"{folder}: holds no frames of the second judge (./studies/run mitsuba-judge "
        f"{folder} makes them)"
    )


def no_description(path):
    path.with_suffix(".json").unlink()


def no_neutrals(path):
    path.with_suffix(".json").write_text("{}")


def other_generator(path):
    text = path.with_suffix(".json")
    found = json.loads(text.read_text())
    text.write_text(json.dumps({**found, "generator": GENERATOR + 1}))


def no_archive(path):
    path.write_bytes(b"PK, but no archive")


def other_camera(path):
    np.savez(path, other=np.zeros((6, 8, 3)))


def no_image(path):
    np.savez(path, **{CAMERA: np.zeros((6, 8))})


def not_finite(path):
    np.savez(path, **{CAMERA: np.full((6, 8, 3), np.nan)})


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (no_description, "judge_0000.json: cannot be read"),
        (no_neutrals, "judge_0000.json: has no neutrals"),
        (other_generator, "judge_0000.npz: is of generator 2, not 1"),
        (no_archive, "judge_0000.npz: cannot be read"),
        (other_camera, f"judge_0000.npz: has no camera {CAMERA}"),
        (no_image, f"judge_0000.npz: {CAMERA} is no image of three channels"),
        (not_finite, f"judge_0000.npz: {CAMERA} is no image of three channels"),
    ],
)
def test_a_spoilt_frame_is_named(tmp_path, spoil, message):
    put(tmp_path, 0)
    spoil(frame_path(tmp_path, 0))
    with pytest.raises(ValueError, match=message) as caught:
        judge_frames(tmp_path, CAMERA)
    assert "\n" not in str(caught.value)


def test_a_frame_of_other_settings_is_not_kept(tmp_path):
    path = frame_path(tmp_path, 0)
    assert not is_done(path, SETTINGS)
    put(tmp_path, 0)
    assert is_done(path, SETTINGS)
    other = Settings(8, 32, 0, (CAMERA,), SETTINGS.world)
    with pytest.raises(ValueError, match="samples is 16, not 32: give another folder"):
        is_done(path, other)


def test_the_command_says_in_one_line_what_is_wrong(camera_data, tmp_path, capsys):
    given = [str(tmp_path), "--cameras", "none", "--data", str(camera_data)]
    assert main(given) == 1
    said = capsys.readouterr().err
    assert said.startswith("mitsuba-judge: camera none must be one of")
    assert said.count("\n") == 1
