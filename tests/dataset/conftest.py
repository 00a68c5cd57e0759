# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What all tests of data sets need."""

import json
import shutil
from dataclasses import asdict

import pytest

from cg2raw.io.atomic_file import create
from cg2raw.short_messages import about

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


@pytest.fixture(autouse=True)
def no_workers(monkeypatch):
    """Let this process make the images of a command that does not say --workers: the
    start of one takes ten times as long as its images."""
    from cg2raw.cli import dataset
    from cg2raw.dataset import local

    by_workers = local.results

    def results(jobs, count, log):
        return by_workers(jobs, count, log) if count else made_here(jobs, log)

    monkeypatch.setattr(dataset, "usable_cores", lambda: 0)
    monkeypatch.setattr(local, "results", results)


def made_here(jobs, log):
    """Yield what a worker answers, in JSON's types."""
    from cg2raw.dataset.job import make
    from cg2raw.dataset.target import Job

    with create(log):
        for job in jobs:
            rows = []
            copy = Job(**json.loads(json.dumps(asdict(job))))
            try:
                rows.append(make(copy, rows.append))
            except (OSError, ValueError) as error:
                raise OSError(about(job.out, error)) from None
            yield from json.loads(json.dumps(rows))


@pytest.fixture
def image(tmp_path):
    """Return the path of an image in a folder of its own."""
    from dataset.data_sets import scene, write_image

    return write_image(tmp_path / "in/a.exr", scene())


@pytest.fixture(scope="session")
def finished(tmp_path_factory):
    """Return the folder of a finished data set, to be copied."""
    from dataset.data_sets import OPTIONS, scene, write_image
    from python.commands import run

    folder = tmp_path_factory.mktemp("finished")
    image = write_image(folder / "in/a.exr", scene())
    assert run("dataset", image, folder / "out", *OPTIONS).code == 0
    return folder / "out"


@pytest.fixture
def out(image, finished, tmp_path):
    """Return the folder of a finished data set of the image."""
    return shutil.copytree(finished, tmp_path / "out")
