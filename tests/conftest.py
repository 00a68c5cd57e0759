# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What tests share: where things lie, both oiiotools, and the choice of slow tests."""

import contextlib
import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
BUILD = Path(os.environ.get("CG2RAW_BUILD", ROOT / "build" / "system"))
# The program of OpenImageIO's wheel, which its oiiotool, a script of Python, starts.
WHEEL_PROGRAM = "lib/python3*/site-packages/OpenImageIO/bin/oiiotool"
WHEEL_OIIOTOOL = next((ROOT / ".venv").glob(WHEEL_PROGRAM), Path("/no/oiiotool"))
OIIOTOOLS = {
    "oiio-system": (Path("/usr/bin/oiiotool"), BUILD / "lib/cg2raw/oiio"),
    "oiio-wheel": (WHEEL_OIIOTOOL, ROOT / "build/wheel/lib/cg2raw/oiio"),
}

# Parameters of fixtures by which a test starts a program of the system's.
SYSTEMS = {"oiiotool": "oiio-system", "chains_of": "the system's Python"}


def pytest_addoption(parser):
    parser.addoption("--slow", action="store_true", help="run the slow tests too")
    parser.addoption("--kills", type=int, default=500, help="of the slow test of them")


def pytest_configure(config):
    slow = config.getoption("--slow") or os.environ.get("CG2RAW_TEST_SLOW") == "1"
    if not slow and not config.option.markexpr:
        config.option.markexpr = "not slow"


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Make all but the first test of a file slow that a program of the system's runs.

    Its oiiotool takes 0.3 CPU seconds to start, five times as long as the wheel's, by
    which all are run; both plugins are built of the same sources."""
    seen = set()
    for item in items:
        params = item.callspec.params if hasattr(item, "callspec") else {}
        if any(params.get(name) == of for name, of in SYSTEMS.items()):
            if item.path in seen:
                item.add_marker(pytest.mark.slow)
            seen.add(item.path)


@pytest.fixture(scope="session")
def repository():
    """Return the root of the source tree."""
    return ROOT


@pytest.fixture(scope="session")
def build_folder():
    """Return the CMake build folder that is under test."""
    return BUILD


@pytest.fixture(scope="session")
def camera_data():
    """Return the folder of real camera data, or skip: it is not in the repository."""
    folder = Path(os.environ.get("CG2RAW_TEST_DATA", ROOT.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"no camera data in {folder}; CG2RAW_TEST_DATA names another one")
    return folder


@pytest.fixture(scope="session")
def library(tmp_path_factory):
    """Return the injector of tests/faults, compiled once for all of them, or skip."""
    from faults.injector import compiled

    return compiled(tmp_path_factory.mktemp("injector"))


def oiiotool_runner(name):
    """Return run(*arguments, check=True, **keywords) of one of OIIOTOOLS.

    The environment has that tool's plugin folder, no other, the tree's profiles, and no
    OCIO config.
    """
    tool, plugins = OIIOTOOLS[name]
    if not tool.exists() or not (plugins / "dng.imageio.so").exists():
        pytest.skip(f"no {tool} with {plugins}/dng.imageio.so: run scripts/setup")

    def run(*arguments, check=True, env=None, **keywords):
        environment = {
            **{name: value for name, value in os.environ.items() if name != "OCIO"},
            "OIIO_LIBRARY_PATH": str(plugins),
            "OPENIMAGEIO_PLUGIN_PATH": str(plugins),
            "CG2RAW_PROFILE_PATH": str(ROOT / "plugins" / "profiles"),
            **(env or {}),
        }
        done = subprocess.run(
            [tool, *map(str, arguments)],
            env=environment,
            text=True,
            capture_output=True,
            **keywords,
        )
        if check:
            assert done.returncode == 0, done.stdout + done.stderr
        return done

    run.name = name
    return run


@contextlib.contextmanager
def mounted(folder, *options):
    """Mount a small tmpfs on a folder, or skip."""
    folder.mkdir()
    done = subprocess.run(
        ["mount", "-t", "tmpfs", *options, "tmpfs", folder], capture_output=True
    )
    if done.returncode:
        pytest.skip(f"mounting a tmpfs needs root: {done.stderr.decode().strip()}")
    try:
        yield folder
    finally:
        subprocess.run(["umount", folder], check=True)


@pytest.fixture(params=list(OIIOTOOLS))
def oiiotool(request):
    """Return a runner of the system's, then of the wheel's oiiotool."""
    return oiiotool_runner(request.param)


@pytest.fixture
def system_oiiotool():
    """Return a runner of the system's oiiotool."""
    return oiiotool_runner("oiio-system")


@pytest.fixture(scope="session")
def program():
    """Return program(name): the path of an external reader, or skip the test."""

    def find(name):
        path = shutil.which(name)
        if path is None:
            pytest.skip(f"{name} is not installed")
        return path

    return find
