# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw.register_oiio_plugin() makes OpenImageIO's wheel write DNGs, without
environment variables; import cg2raw alone changes nothing."""

import os
import platform
import shutil
import subprocess
import sys

import pytest

from cg2raw.oiio import plugin_file
from cg2raw.oiio.elf import Library
from tiers import slow

WRITE = """
image = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(64, 48, 3, "float"))
OpenImageIO.ImageBufAlgo.fill(image, (0.2, 0.4, 0.6))
image.specmod().attribute("dng:sensor", "nikon-d40")
image.specmod().attribute("dng:illuminant", "D65")
print(image.write("shot.dng"))
OpenImageIO.geterror()
"""
BEFORE = "import cg2raw; cg2raw.register_oiio_plugin(); import OpenImageIO"
AFTER = "import OpenImageIO, cg2raw; cg2raw.register_oiio_plugin()"
PLUGIN_FOR = "from cg2raw.oiio.registration import plugin_for"
TWICE = f"{BEFORE}; cg2raw.register_oiio_plugin()"


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


@pytest.mark.parametrize("order", [BEFORE, AFTER, TWICE])
def test_it_writes_whichever_is_imported_first(wheel_plugin, order, tmp_path):
    assert python(order + "\n" + WRITE, tmp_path) == ["True"]
    assert (tmp_path / "shot.dng").read_bytes()[:4] == b"II*\0"


@pytest.mark.parametrize("words", ["import OpenImageIO", "import cg2raw, OpenImageIO"])
def test_unasked_it_does_not(wheel_plugin, words, tmp_path):
    assert python(f"{words}\n{WRITE}", tmp_path) == ["False"]


def test_an_import_hooks_nothing_in(tmp_path):
    code = """
import sys
before = list(sys.meta_path)
import cg2raw
print(sys.meta_path == before, "OpenImageIO" in sys.modules)
"""
    assert python(code, tmp_path) == ["True", "False"]


def test_folders_that_were_there_stay_behind(wheel_plugin, tmp_path):
    code = """
import OpenImageIO
OpenImageIO.attribute("plugin_searchpath", "/mine:/yours")
import cg2raw
print(cg2raw.register_oiio_plugin(), cg2raw.register_oiio_plugin())
print(OpenImageIO.get_string_attribute("plugin_searchpath"))
"""
    plugin = f"{wheel_plugin}/dng.imageio.so"
    assert python(code, tmp_path) == [plugin, plugin, f"{wheel_plugin}:/mine:/yours"]


@pytest.fixture(scope="module")
def package_alone(build_folder, tmp_path_factory):
    """Return a folder with the package and nothing else, as pip installs it."""
    folder = tmp_path_factory.mktemp("alone")
    source = build_folder / "lib/python/cg2raw"
    skip = shutil.ignore_patterns("__pycache__")
    shutil.copytree(source, folder / "cg2raw", ignore=skip)
    return folder


REFUSED = """
import cg2raw
try:
    cg2raw.register_oiio_plugin()
except ValueError as error:
    print(error)
"""


def test_a_plugin_that_is_not_there_is_told(package_alone, tmp_path):
    pytest.importorskip("OpenImageIO")
    words = python(REFUSED, tmp_path, PYTHONPATH=str(package_alone))
    assert " ".join(words).startswith("there is no DNG plugin for OpenImageIO 3.")


def test_an_openimageio_that_is_none_and_one_that_is_missing(tmp_path):
    (tmp_path / "OpenImageIO.py").write_text("VERSION_STRING = 'new'")
    words = " ".join(python(REFUSED, tmp_path))
    assert words.startswith("there is no DNG plugin for OpenImageIO new in")
    (tmp_path / "OpenImageIO.py").write_text("raise ImportError")
    words = " ".join(python(REFUSED, tmp_path))
    assert words.startswith("OpenImageIO is not installed for this Python")


def test_only_the_abi_of_that_version(wheel_plugin, tmp_path):
    code = f"""
{PLUGIN_FOR}
print(plugin_for("3.2.2.0")); print(plugin_for("2.4.7")); print(plugin_for("9.0"))
"""
    found = python(code, tmp_path)
    assert found[0] == str(wheel_plugin / "dng.imageio.so")
    assert found[0] not in found[1:]
    assert python(f'{PLUGIN_FOR}; print(plugin_for("9.0"))', tmp_path) == []


@pytest.fixture(scope="module")
def package_of_a_wheel(package_alone, wheel_plugin, tmp_path_factory):
    """Return a folder with the package and its plugin, as pip installs a wheel's."""
    folder = tmp_path_factory.mktemp("wheel")
    shutil.copytree(package_alone, folder, dirs_exist_ok=True)
    plugins = folder / "cg2raw/lib/cg2raw/oiio-3.1"
    plugins.mkdir(parents=True)
    shutil.copy(wheel_plugin / "dng.imageio.so", plugins)
    return folder


def test_the_plugin_inside_the_package_is_taken(package_of_a_wheel, tmp_path):
    path = {"PYTHONPATH": str(package_of_a_wheel)}
    found = python(
        "import cg2raw; print(cg2raw.register_oiio_plugin())", tmp_path, **path
    )
    folder = f"{package_of_a_wheel}/cg2raw/lib/cg2raw/oiio-3.1"
    assert found == [f"{folder}/dng.imageio.so"]
    shell = python("from cg2raw import cli; cli.main(['env'])", tmp_path, **path)
    assert f"OPENIMAGEIO_PLUGIN_PATH={folder}" in shell


@pytest.mark.parametrize(
    ("version", "api"),
    [
        ("3.0.4.0", "26"),
        slow("2.5.18.0", "25"),
        slow("3.3.0.0", "unknown to this cg2raw"),
    ],
)
def test_what_a_wheel_has_no_plugin_for_is_told(
    package_of_a_wheel, version, api, tmp_path
):
    (tmp_path / "OpenImageIO.py").write_text(f"VERSION_STRING = {version!r}")
    words = python(REFUSED, tmp_path, PYTHONPATH=str(package_of_a_wheel))
    assert " ".join(words) == (
        f"there is no DNG plugin for OpenImageIO {version} in this installation of "
        f"cg2raw: its plugin API is {api}, and there are plugins for OpenImageIO 3.1 "
        "to 3.2; install a wheel of cg2raw and one of these, or build the plugin "
        "(scripts/setup)"
    )


@pytest.mark.parametrize(
    ("folder", "version", "fits"),
    [
        ("oiio", "2.5.18", True),  # built for one SDK: OpenImageIO says itself
        ("oiio-2.4", "2.4.7.1", True),
        ("oiio-2.4", "2.5.18", False),
        ("oiio-2.4", "3.0.3", False),
    ],
)
def test_before_3_a_wheels_plugin_is_of_one_minor_version(folder, version, fits):
    library = Library(platform.machine(), 25)
    path = f"/site/cg2raw/lib/cg2raw/{folder}/dng.imageio.so"
    assert (plugin_file.misfit(library, version, path) == "") == fits


# A doctor that looks at no other program.
OF_THIS_PYTHON = """
import sys
from OpenImageIO import VERSION_STRING
from cg2raw.cli import doctor
doctor.hosts.find_hosts = lambda: [
    doctor.hosts.Host("python", sys.executable, VERSION_STRING)
]
"""


def test_doctor_tells_that_there_is_none_to_register(package_alone, tmp_path):
    pytest.importorskip("OpenImageIO")
    code = f"""
import json
{OF_THIS_PYTHON}
report = doctor.examine()
found = [host["register_oiio_plugin"] for host in report["hosts"]]
print(json.dumps([path for path in found if path is not None]))
print("no plugin for API" in doctor.as_text(report))
"""
    path = {"PYTHONPATH": str(package_alone)}
    assert python(code, tmp_path, **path) == ['[""]', "True"]


def test_doctor_names_the_plugin_that_would_be_registered(wheel_plugin, tmp_path):
    code = f"{OF_THIS_PYTHON}\nprint(doctor.as_text(doctor.examine()))"
    words = python(code, tmp_path)
    assert str(wheel_plugin / "dng.imageio.so") in words[words.index("finds") :]


@pytest.mark.parametrize("place", ["lib/python3/site-packages", "lib/python"])
def test_only_places_of_the_package_are_searched(package_alone, place, tmp_path):
    """A plugin is a program: one that lies in a folder above is not taken."""
    installed = tmp_path / "prefix" / place
    shutil.copytree(package_alone, installed)
    code = """
import sys
from cg2raw.oiio.registration import plugin_folders
print(sys.prefix, *plugin_folders())
"""
    prefix, *folders = python(code, tmp_path, PYTHONPATH=str(installed))
    expected = [str(tmp_path / "prefix/lib/cg2raw/oiio"), f"{prefix}/lib/cg2raw/oiio"]
    assert folders == expected
