# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What all tests of data sets need."""

import pytest

pytest.importorskip("OpenImageIO", reason="OpenImageIO's wheel is not installed")
pytest.importorskip("pyarrow", reason="pyarrow is not installed")


@pytest.fixture(autouse=True)
def bundled_profiles(repository, monkeypatch):
    """Let this process and those it starts find the tree's profiles."""
    monkeypatch.setenv("CG2RAW_PROFILE_PATH", str(repository / "plugins" / "profiles"))


@pytest.fixture(scope="session")
def images(tmp_path_factory):
    """Return a folder of five small images."""
    from dataset.data_sets import folder_of_images

    return folder_of_images(tmp_path_factory.mktemp("images"))


@pytest.fixture
def image(tmp_path):
    """Return the path of an image in a folder of its own."""
    from dataset.data_sets import scene, write_image

    return write_image(tmp_path / "in/a.exr", scene())


@pytest.fixture
def out(image, tmp_path):
    """Return the folder of a finished data set."""
    from dataset.data_sets import OPTIONS
    from python.commands import run

    assert run("dataset", image, tmp_path / "out", *OPTIONS).code == 0
    return tmp_path / "out"
