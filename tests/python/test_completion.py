# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Shell completion: what bash offers at each place, and what is said without shtab."""

import shutil
import subprocess
import sys

import pytest

import cg2raw
from cg2raw.cli import subcommands
from python.commands import fails, run


@pytest.fixture(scope="module")
def script(tmp_path_factory):
    """Return the file of bash's completion."""
    pytest.importorskip("shtab", reason="shtab is not installed")
    path = tmp_path_factory.mktemp("completion") / "cg2raw.bash"
    done = run("--print-completion", "bash")
    assert done.code == 0
    path.write_text(done.out)
    return path


def offered(script, line, folder="."):
    """Return what bash offers for the last word of a line."""
    words = line.split(" ")
    call = (
        f"source {script}; COMP_WORDS=({' '.join(repr(w) for w in words)}); "
        f"COMP_CWORD={len(words) - 1}; _shtab_cg2raw 2>/dev/null; "
        'printf "%s\\n" "${COMPREPLY[@]}"'
    )
    done = subprocess.run(
        ["bash", "-c", call], capture_output=True, text=True, cwd=folder
    )
    return done.stdout.split()


def test_commands_are_offered(script):
    assert set(subcommands()) <= set(offered(script, "cg2raw "))
    assert offered(script, "cg2raw conv") == ["convert"]


def test_sensors_lights_and_effects_are_offered(script):
    assert offered(script, "cg2raw sensors sony") == ["sony-a57", "sony-a7s-ii"]
    convert = "cg2raw convert shot.exr -o shot.dng"
    found = offered(script, f"{convert} --sensor ")
    assert set(cg2raw.installed_profiles()) <= set(found)
    assert offered(script, f"{convert} --illuminant D6") == ["D65"]
    assert "all" in offered(script, "cg2raw ocio --sensors a")
    assert offered(script, "cg2raw effects lens_s") == ["lens_shading"]
    assert "--exposure-time" in offered(script, "cg2raw dataset a b --exp")


def test_files_are_offered(script, tmp_path):
    (tmp_path / "shot.exr").touch()
    assert "shot.exr" in offered(script, "cg2raw convert sho", tmp_path)
    assert "shot.exr" in offered(script, "cg2raw convert a -o sho", tmp_path)


@pytest.mark.parametrize("shell", ["zsh", "tcsh"])
def test_other_shells_get_theirs(script, tmp_path, shell):
    done = run("--print-completion", shell)
    assert done.code == 0 and "sony-a57" in done.out
    if program := shutil.which(shell):
        path = tmp_path / "cg2raw"
        path.write_text(done.out)
        subprocess.run([program, "-n", path], check=True)


def test_another_shell_is_refused():
    assert "invalid choice: 'cmd'" in fails("--print-completion", "cmd", code=2)


def test_a_missing_shtab_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "shtab", None)
    line = fails("--print-completion", "bash")
    assert line.endswith("needs shtab: pip install 'cg2raw[completion]'")
