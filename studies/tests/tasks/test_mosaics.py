# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Mosaics of files: what the plugin wrote and the reader read back is what arrays are,
and photographs are taken by their own phase and levels."""

import json
from dataclasses import replace

import numpy as np
import pytest

import cg2raw
from studies.sources.mosaics import (
    ARRAYS,
    FILES,
    PHOTOGRAPHS,
    binned,
    by_file,
    image_of,
    photographs,
    planes_of,
    sites,
)
from studies.sources.sets import Draw, material
from studies.tasks import denoising
from studies.tasks.denoising import packed
from studies.tasks.mosaics import by_photograph, files_draw


@pytest.fixture(scope="module")
def small(world, camera_of):
    """(world of a small protocol, camera, sources by file)"""
    rules = replace(
        world.protocol.denoising,
        frames={"quick": 10},
        tests={"quick": 2},
        samples={"quick": 400},
        features=20,
        isos=(1600,),
    )
    small = replace(world, protocol=replace(world.protocol, denoising=rules))
    camera = camera_of("sony-a7s-ii")
    made = material(small, camera, "night", small.protocol.seeds, 10, 3)
    return small, camera, by_file(made, camera, 3)


@pytest.fixture
def plugin():
    """Skip without a plugin for the OpenImageIO of this Python, and a reader."""
    for package in ("OpenImageIO", "rawpy"):
        pytest.importorskip(package, reason=f"{package} is not installed")
    try:
        cg2raw.register_oiio_plugin()
    except ValueError as error:
        pytest.skip(str(error))


def test_dngs_of_the_plugin_that_are_read_back_are_the_arrays(small, plugin):
    """To the last DN."""
    _, camera, made = small
    arrays, files = (packed(made[name]().images) for name in (ARRAYS, FILES))
    assert np.array_equal(arrays, files)
    white = camera.sensor.signal_range
    exact = packed(made["ours, match"]().images)
    assert abs(arrays - exact).max() <= 0.5 / white + 1e-6
    assert len(np.unique(arrays)) > 100


@pytest.mark.slow
def test_of_dngs_and_of_arrays_the_same_is_learnt(small, plugin):
    """To the last bit."""
    world, camera, made = small
    tests = {"world": denoising.test_frames(world, camera, "quick")}
    found = files_draw(Draw(world, camera, "quick", 3), made, tests)["world"]
    scores = found["ISO 1600, brightness 0.35"]
    assert scores[ARRAYS] == scores[FILES] != scores["real"]


@pytest.mark.parametrize("cfa", ["rggb", "bggr", "grbg", "gbrg"])
def test_a_file_is_taken_by_its_phase_and_levels(cfa, tmp_path):
    pytest.importorskip("rawpy", reason="rawpy is not installed")
    fields = {"cfa": cfa, "black_level": [100.0] * 4, "white_level": 1100}
    own = json.loads(cg2raw.Sensor("nikon-d850").to_json()) | fields
    sensor = cg2raw.Sensor.from_json(json.dumps(own))
    values = {"r": 200, "g": 300, "b": 600}
    block = np.array([values[site] for site in cfa], np.uint16).reshape(2, 2)
    path = tmp_path / "frame.dng"
    cg2raw.write_dng(path, np.tile(block, (32, 32)), sensor=sensor, illuminant="D65")
    planes = planes_of(str(path))
    for plane, value in zip(planes, (0.1, 0.2, 0.2, 0.5), strict=True):
        np.testing.assert_allclose(plane, value, rtol=1e-6)


def test_sites_of_an_image_are_the_planes_and_means_are_of_a_colour():
    planes = np.random.default_rng(0).random((4, 6, 8)).astype(np.float32)
    assert np.array_equal(packed([image_of(planes)])[0], planes)
    mosaic = image_of(planes)[..., 1]
    assert np.array_equal(sites(mosaic)[1:3], planes[1:3])
    assert binned(planes, 2)[3, 1, 2] == pytest.approx(planes[3, 2:4, 4:6].mean())


@pytest.mark.slow
def test_photographs_are_all_there_and_not_dark(camera_data):
    pytest.importorskip("rawpy", reason="rawpy is not installed")
    found = photographs(camera_data, 4, 64, 2)
    assert list(found) == list(PHOTOGRAPHS)
    for frames in found.values():
        assert 1 <= len(frames) <= 2
        for frame in frames:
            assert frame.shape == (128, 128, 3)
            assert -0.01 < frame.min() < frame.max() < 1.5
            assert frame.mean() > 3e-3


def test_a_missing_photograph_is_one_line(tmp_path):
    with pytest.raises(ValueError, match="is missing: no photograph") as said:
        photographs(tmp_path, 4, 64, 2)
    assert "\n" not in str(said.value)


def test_a_photograph_counts_once():
    values = {"real": {"psnr": [1.0, 3.0, 10.0]}}
    assert by_photograph(values, [2, 1]) == {"real": {"psnr": [2.0, 10.0]}}
