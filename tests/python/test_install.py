# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""An sdist makes a wheel, and what pip installs of it works by itself."""

import os
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile

import pytest

pytestmark = pytest.mark.slow

USE = """
import cg2raw, numpy as np
sensor = cg2raw.Sensor("nikon-d40")
raw = sensor.simulate(np.full((64, 64, 3), 0.5, np.float32), illuminant="D65")
cg2raw.write_dng("shot.dng", raw)
print(cg2raw.__file__, cg2raw.read_dng_metadata("shot.dng").model, sep="\\n")
"""


def run(*command, **keywords):
    """Run a command; return the finished process."""
    words = [str(word) for word in command]
    return subprocess.run(words, capture_output=True, text=True, **keywords)


@pytest.fixture(scope="module")
def wheel(repository, tmp_path_factory):
    """Return the wheel that the sdist of the sources under version control makes."""
    listed = run("git", "ls-files", "-z", cwd=repository)
    if listed.returncode:
        pytest.skip("not a git checkout")
    folder = tmp_path_factory.mktemp("wheel")
    for name in filter(None, listed.stdout.split("\0")):
        target = folder / "sources" / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if (repository / name).is_file():
            shutil.copy(repository / name, target)
    build = (sys.executable, "-m", "build", "--outdir", folder, folder / "sources")
    done = run(*build)
    if "No matching distribution found for scikit-build-core" in done.stdout:
        pytest.skip("no package index to take scikit-build-core from")
    assert done.returncode == 0, done.stdout + done.stderr
    [wheel] = folder.glob("cg2raw-*.whl")
    return wheel


@pytest.fixture(scope="module")
def environment(wheel, tmp_path_factory):
    """Return a folder of programs: a Python with that wheel and our libraries."""
    folder = tmp_path_factory.mktemp("environment")
    made = run(sys.executable, "-m", "venv", "--without-pip", folder)
    assert made.returncode == 0, made.stderr
    paths = sysconfig.get_paths(vars={"base": str(folder), "platbase": str(folder)})
    pip = (sys.executable, "-m", "pip", f"--python={folder / 'bin/python'}", "install")
    done = run(*pip, "-q", "--no-deps", "--no-index", wheel)
    assert done.returncode == 0, done.stderr
    # As lines of a .pth: so no .pth over there is read, one of which names this tree.
    libraries = [p for p in sys.path if p.endswith("-packages")]
    (folder / paths["purelib"] / "libraries.pth").write_text("\n".join(libraries))
    return folder / "bin"


def clean(environment):
    """Return an environment without anything that helps."""
    return {"PATH": f"{environment}:/usr/bin:/bin", "HOME": os.environ.get("HOME", "/")}


def test_the_wheel_holds_package_stubs_profiles_and_config(wheel, repository):
    names = zipfile.ZipFile(wheel).namelist()
    profiles = sorted(p.name for p in (repository / "plugins/profiles").glob("*.json"))
    held = [n.rpartition("/")[2] for n in names if "cg2raw/share/cg2raw/profiles" in n]
    assert sorted(held) == profiles and len(profiles) > 5
    for name in ("_core.pyi", "py.typed", "share/cg2raw/ocio/sensors.ocio"):
        assert f"cg2raw/{name}" in names
    assert "cg2raw_ocio/chain.py" in names
    assert any(name.endswith("data/share/man/man1/cg2raw.1") for name in names)
    assert "cg2raw/io/templates/report.html.jinja" in names
    assert not [name for name in names if name.startswith(("tests", "include", "lib"))]


def test_the_sdist_has_what_a_wheel_needs_and_no_test_data(wheel):
    [sdist] = wheel.parent.glob("cg2raw-*.tar.gz")
    with tarfile.open(sdist) as tar:
        names = {name.partition("/")[2] for name in tar.getnames()}
    needed = ("scripts/wheel", "plugins/dng.imageio/portable/loader.cpp", "LICENSE")
    assert names.issuperset(needed)
    assert not [
        name for name in names if name.startswith(("tests/data", "build", ".ci"))
    ]


def test_the_package_works(environment, tmp_path):
    done = run(environment / "python", "-c", USE, cwd=tmp_path, env=clean(environment))
    assert done.returncode == 0, done.stderr
    file, model = done.stdout.split("\n")[:2]
    assert file.startswith(str(environment.parent)) and model == "NIKON D40"


def test_the_command_works(environment, tmp_path):
    sensors = run(environment / "cg2raw", "sensors", env=clean(environment))
    assert sensors.returncode == 0 and "nikon-d40" in sensors.stdout
    pytest.importorskip("PyOpenColorIO")
    words = ("ocio", "--sensors", "nikon-d40", "--illuminants", "A", "-o", "my.ocio")
    made = run(environment / "cg2raw", *words, cwd=tmp_path, env=clean(environment))
    assert made.returncode == 0, made.stderr
    assert "RAW - nikon-d40 - A" in (tmp_path / "my.ocio").read_text()
