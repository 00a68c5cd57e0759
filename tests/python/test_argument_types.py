# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Arguments of a wrong type: one line that names the wrong one alone."""

import numpy as np
import pytest

import cg2raw

RGB = np.full((4, 6, 3), 0.2, np.float32)
SENSOR = cg2raw.Sensor("nikon-d40")
RAW = SENSOR.simulate(RGB, illuminant="D65")
PLANE = RGB[..., 0]


def written(**options):
    cg2raw.write_dng("x.dng", RAW, **options)


WRONG = {
    "preview 'no' must be True or False or None": lambda: written(preview="no"),
    "compression None must be a text": lambda: written(compression=None),
    "matrices 3 must be a text": lambda: written(matrices=3),
    "tone_curve 3 must be a text": lambda: written(tone_curve=3),
    "crop False must be a text": lambda: written(crop=False),
    "shading True must be a text or None": lambda: written(shading=True),
    "sync 'no' must be True or False": lambda: written(sync="no"),
    "threads 'all' must be a whole number": lambda: written(threads="all"),
    "shot 5 must be a dict or a Shot": lambda: written(shot=5),
    "path 5 must be the path of a file, a text": lambda: cg2raw.write_dng(5, RAW),
    "path b'x' must be the path of a file, a text": lambda: cg2raw.read_dng_metadata(
        b"x"
    ),
    "cfa 4 must be a text": lambda: cg2raw.read_dng_metadata("x.dng", 4),
    "threads 1.5 must be a whole number": lambda: SENSOR.simulate(
        RGB, illuminant="A", threads=1.5
    ),
    "convention 5 must be a text": lambda: SENSOR.to_camera(
        RGB, illuminant="A", convention=5
    ),
    "digital_gain '2' must be a number": lambda: SENSOR.to_scene(
        RGB, illuminant="A", digital_gain="2"
    ),
    "highlights 'no' must be True or False": lambda: SENSOR.to_camera(
        RGB, illuminant="A", highlights="no"
    ),
    "row_noise: sigma 'x' must be a number": lambda: SENSOR.apply_effect(
        PLANE, "row_noise", {"sigma": "x"}
    ),
    "row_noise: parameters 5 must be a dict of numbers": lambda: SENSOR.predict_effect(
        PLANE, "row_noise", 5
    ),
    "cfa 2 must be a text": lambda: cg2raw.mosaic(RGB, 2),
    "cfa None must be a text": lambda: cg2raw.demosaic(PLANE, None),
}


@pytest.mark.parametrize("said", WRONG)
def test_the_wrong_one_alone_is_named(said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError) as error:
        WRONG[said]()
    assert str(error.value) == said
    assert list(tmp_path.iterdir()) == []


def test_numbers_of_numpy_and_paths_are_taken(tmp_path):
    path = tmp_path / "x.dng"
    options = {"preview": np.bool_(False), "threads": np.int64(1)}
    cg2raw.write_dng(path, RAW, **options)
    assert cg2raw.read_dng_metadata(path).model == SENSOR.model
    SENSOR.to_camera(RGB, illuminant="A", digital_gain=np.float32(1.5))
    SENSOR.apply_effect(PLANE, "row_noise", {"sigma": np.float32(0.001)})
