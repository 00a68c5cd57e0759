# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""import cg2raw makes OpenImageIO's wheel write DNGs, without environment variables."""

import os
import shutil
import subprocess
import sys

import pytest

WRITE = """
image = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(64, 48, 3, "float"))
OpenImageIO.ImageBufAlgo.fill(image, (0.2, 0.4, 0.6))
image.specmod().attribute("dng:sensor", "nikon-d40")
image.specmod().attribute("dng:illuminant", "D65")
print(image.write("shot.dng"))
OpenImageIO.geterror()
"""
FIRST = "import cg2raw; import OpenImageIO"
SECOND = "import OpenImageIO; import cg2raw"
LATER = """
import cg2raw, sys
assert "OpenImageIO" not in sys.modules
import importlib; OpenImageIO = importlib.import_module("OpenImageIO")
import cg2raw as again
"""


def python(code, folder, **environment):
    """Run code with nothing in the environment that names plugins; return its words."""
    kept = {"PATH": os.environ["PATH"], "PYTHONPATH": os.environ.get("PYTHONPATH", "")}
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=folder,
        env={**kept, **environment},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0 and done.stderr == "", done.stderr
    return done.stdout.split()


@pytest.fixture(scope="module")
def wheel_plugin(repository):
    """Return the folder of the plugin for OpenImageIO's wheel, or skip."""
    pytest.importorskip("OpenImageIO")
    folder = repository / "build/wheel/lib/cg2raw/oiio"
    if not (folder / "dng.imageio.so").exists():
        pytest.skip(f"no plugin for OpenImageIO's wheel in {folder}: run scripts/setup")
    return folder


@pytest.mark.parametrize("order", [FIRST, SECOND, LATER])
def test_it_writes_whichever_is_imported_first(wheel_plugin, order, tmp_path):
    assert python(order + "\n" + WRITE, tmp_path) == ["True"]
    assert (tmp_path / "shot.dng").read_bytes()[:4] == b"II*\0"


def test_without_cg2raw_it_does_not(wheel_plugin, tmp_path):
    assert python("import OpenImageIO\n" + WRITE, tmp_path) == ["False"]


def test_folders_that_were_there_stay_behind(wheel_plugin, tmp_path):
    code = """
import OpenImageIO
OpenImageIO.attribute("plugin_searchpath", "/mine:/yours")
import cg2raw, cg2raw.oiio.registration
cg2raw.oiio.registration.tell(OpenImageIO)
print(OpenImageIO.get_string_attribute("plugin_searchpath"))
"""
    assert python(code, tmp_path) == [f"{wheel_plugin}:/mine:/yours"]


@pytest.fixture(scope="module")
def package_alone(build_folder, tmp_path_factory):
    """Return a folder with the package and nothing else, as pip installs it."""
    folder = tmp_path_factory.mktemp("alone")
    source = build_folder / "lib/python/cg2raw"
    skip = shutil.ignore_patterns("__pycache__")
    shutil.copytree(source, folder / "cg2raw", ignore=skip)
    return folder


@pytest.mark.parametrize("order", [FIRST, SECOND])
def test_a_plugin_that_is_not_there_is_no_error(order, package_alone, tmp_path):
    pytest.importorskip("OpenImageIO")
    path = {"PYTHONPATH": str(package_alone)}
    assert python(f"{order}\n{WRITE}", tmp_path, **path) == ["False"]


def test_an_openimageio_that_is_none_and_one_that_is_missing(tmp_path):
    (tmp_path / "OpenImageIO.py").write_text("VERSION_STRING = 'new'")
    code = "import cg2raw, OpenImageIO; print(OpenImageIO.VERSION_STRING)"
    assert python(code, tmp_path) == ["new"]
    code = """
import cg2raw, sys
sys.path = [p for p in sys.path if "site-packages" not in p and p]
try:
    import OpenImageIO
except ImportError as error:
    print(error.name)
"""
    (tmp_path / "OpenImageIO.py").unlink()
    assert python(code, tmp_path) == ["OpenImageIO"]


def test_only_the_abi_of_that_version(wheel_plugin, tmp_path):
    code = """
import cg2raw.oiio.registration as p
print(p.plugin_for("3.2.2.0")); print(p.plugin_for("2.4.7")); print(p.plugin_for("9.0"))
"""
    found = python(code, tmp_path)
    assert found[0] == str(wheel_plugin / "dng.imageio.so")
    assert found[0] not in found[1:]
    assert (
        python('import cg2raw.oiio.registration as p; print(p.plugin_for("9.0"))', tmp_path)
        == []
    )


def test_doctor_tells_that_the_import_finds_none(package_alone, tmp_path):
    pytest.importorskip("OpenImageIO")
    code = """
import json
from cg2raw.cli import doctor
report = doctor.examine()
hosts = [host for host in report["hosts"] if host["import_cg2raw"] is not None]
print(json.dumps([host["import_cg2raw"] for host in hosts]))
print("no plugin for API" in doctor.as_text(report))
"""
    path = {"PYTHONPATH": str(package_alone)}
    assert python(code, tmp_path, **path) == ['[""]', "True"]


def test_doctor_names_the_plugin_of_the_import(wheel_plugin, tmp_path):
    code = "from cg2raw.cli import doctor; print(doctor.as_text(doctor.examine()))"
    words = python(code, tmp_path)
    assert str(wheel_plugin / "dng.imageio.so") in words[words.index("finds") :]


@pytest.mark.parametrize("place", ["lib/python3/site-packages", "lib/python"])
def test_only_places_of_the_package_are_searched(package_alone, place, tmp_path):
    """A plugin is a program: one that lies in a folder above is not taken."""
    installed = tmp_path / "prefix" / place
    shutil.copytree(package_alone, installed)
    code = "import cg2raw.oiio.registration as p, sys; print(sys.prefix, *p.plugin_folders())"
    prefix, *folders = python(code, tmp_path, PYTHONPATH=str(installed))
    expected = [str(tmp_path / "prefix/lib/cg2raw/oiio"), f"{prefix}/lib/cg2raw/oiio"]
    assert folders == expected
