# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw env: what a shell makes of its lines, and whether the hosts then work."""

import json
import os
import platform
import shutil
import subprocess

import pytest

from cg2raw.cli import env
from cg2raw.oiio import elf, plugin_file
from conftest import OIIOTOOLS, ROOT
from python.commands import fails, run

NAMES = ("OIIO_LIBRARY_PATH", "OPENIMAGEIO_PLUGIN_PATH", "OCIO")


@pytest.fixture(autouse=True)
def bare(monkeypatch):
    """No variable is set."""
    for name in NAMES:
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
def prefix(tmp_path, build_folder):
    """Return a prefix as cmake --install leaves it, in a folder with a quote."""
    folder = tmp_path / "it's here"
    for part in ("lib/cg2raw/oiio", "share/cg2raw"):
        if not (build_folder / part).is_dir():
            pytest.skip(f"no {build_folder / part}: run scripts/setup")
        shutil.copytree(build_folder / part, folder / part)
    return folder


def told(*arguments):
    """Return the variables as JSON has them."""
    done = run("env", "--json", *arguments)
    assert done.code == 0, done.err
    return json.loads(done.out)


@pytest.mark.parametrize("shell", ["sh", "bash", "zsh", "fish"])
def test_a_shell_takes_the_lines(prefix, shell):
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    done = run("env", "--shell", shell, "--prefix", prefix)
    assert done.code == 0
    script = done.out + '\nprintf "%s\\n" "$OIIO_LIBRARY_PATH" "$OCIO"\n'
    shown = subprocess.run([shell, "-c", script], capture_output=True, text=True)
    expected = told("--prefix", prefix)
    assert shown.stdout.splitlines() == [
        expected["OIIO_LIBRARY_PATH"],
        expected["OCIO"],
    ]
    assert expected["OCIO"] == str(prefix / "share/cg2raw/ocio/sensors.ocio")


def test_fish_lines_are_quoted_by_its_rules(prefix):
    done = run("env", "--shell", "fish", "--prefix", prefix)
    folder = str(prefix).replace("'", "\\'")
    first = f"set -gx OIIO_LIBRARY_PATH '{folder}/lib/cg2raw/oiio'"
    assert done.out.splitlines()[0] == first


def test_the_systems_oiiotool_then_writes_and_converts(prefix, tmp_path):
    tool, _ = OIIOTOOLS["oiio-system"]
    if not tool.exists():
        pytest.skip(f"no {tool}")
    out = tmp_path / "shot.dng"
    words = "--pattern constant:color=0.2,0.4,0.6 32x32 3"
    space = "RAW - nikon-d40 - D65"
    script = f"{run('env', '--prefix', prefix).out}{tool} {words} "
    script += f"--iscolorspace lin_rec709 --tocolorspace '{space}' -o {out}"
    done = subprocess.run(["sh", "-c", script], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert out.read_bytes()[:4] == b"II*\0"


def test_the_trees_build_comes_as_scripts_env_has_it(build_folder):
    if not (ROOT / "build/wheel/lib/cg2raw/oiio/dng.imageio.so").exists():
        pytest.skip("no build/wheel: run scripts/setup")
    script = f"source {ROOT}/scripts/env; env"
    done = subprocess.run(["bash", "-c", script], capture_output=True, text=True)
    theirs = dict(
        line.split("=", 1) for line in done.stdout.splitlines() if "=" in line
    )
    assert told() == {name: theirs[name] for name in NAMES}


def test_the_newest_plugin_api_comes_first_and_each_once(tmp_path, monkeypatch):
    apis = {"system": 25, "wheel": 27, "other": 27}
    for name in apis:
        folder = tmp_path / "build" / name / "lib/cg2raw/oiio"
        folder.mkdir(parents=True)
        (folder / plugin_file.NAME).touch()

    def read_library(path, symbol):
        name = os.path.relpath(path, tmp_path).split(os.sep)[1]
        return elf.Library(platform.machine(), apis[name])

    monkeypatch.setattr(env, "__file__", str(tmp_path / "python/cg2raw/cli/env.py"))
    monkeypatch.setattr(plugin_file, "read_library", read_library)
    found = told()
    folders = [f"{tmp_path}/build/{name}/lib/cg2raw/oiio" for name in apis]
    assert found["OIIO_LIBRARY_PATH"] == f"{folders[1]}:{folders[0]}"
    assert found["OPENIMAGEIO_PLUGIN_PATH"] == folders[1]


def test_what_the_variables_name_already_stays(prefix, monkeypatch):
    ours = str(prefix / "lib/cg2raw/oiio")
    monkeypatch.setenv("OIIO_LIBRARY_PATH", f"/studio/plugins:{ours}")
    monkeypatch.setenv("OCIO", "/studio/config.ocio")
    done = run("env", "--json", "--prefix", prefix)
    assert json.loads(done.out) == {"OIIO_LIBRARY_PATH": f"{ours}:/studio/plugins"}
    assert "OCIO stays /studio/config.ocio" in done.err


def test_a_damaged_plugin_is_left_out(prefix):
    (prefix / "lib/cg2raw/oiio/dng.imageio.so").write_bytes(b"no library")
    line = run("env", "--prefix", prefix)
    assert line.code == 1
    assert "is not a shared library; left out" in line.err
    assert "no plugin for OpenImageIO" in line.err


def test_errors(tmp_path):
    line = fails("env", "--prefix", tmp_path / "none")
    assert "is no folder" in line
    line = fails("env", "--prefix", tmp_path)
    assert f"no plugin for OpenImageIO in {tmp_path}" in line
    assert "invalid choice" in fails("env", "--shell", "cmd", code=2)
    assert os.listdir(tmp_path) == []
