# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A shell in which the commands of pages run, and the files that these need."""

import os
import re
import subprocess
import sys

import pytest

from conftest import BUILD, OIIOTOOLS, ROOT

# An indented line that begins with the name of one of these, perhaps behind variables
# of the environment, and what continues it.
COMMAND = re.compile(
    r"^    ((?:[A-Z0-9_]+=\S+ (?:\\\n +)?)*"
    r"(?:cg2raw|oiiotool|exiftool|ln) (?:.*\\\n)*.*)$",
    re.MULTILINE,
)
CONFIG = BUILD / "share/cg2raw/ocio/sensors.ocio"


def text_of(page):
    """Return the text of a page of docs/."""
    return (ROOT / "docs" / page).read_text()


def environment_of(folder, oiiotool):
    """Return the variables of a shell in which the programs are this tree's."""
    tool, plugins = OIIOTOOLS[oiiotool]
    programs = folder / "programs"
    programs.mkdir()
    (programs / "oiiotool").symlink_to(tool)
    (programs / "cg2raw").write_text(
        f'#!/bin/sh\nexec {sys.executable} -m cg2raw "$@"\n'
    )
    (programs / "cg2raw").chmod(0o755)
    return {
        **os.environ,
        "PATH": f"{programs}:{os.environ['PATH']}",
        "PYTHONPATH": str(BUILD / "lib/python"),
        "OCIO": str(CONFIG),
        "OIIO_LIBRARY_PATH": str(plugins),
        "OPENIMAGEIO_PLUGIN_PATH": str(plugins),
        "CG2RAW_PROFILE_PATH": str(ROOT / "plugins/profiles"),
    }


def run_commands(page, folder, oiiotool="oiio-wheel", apart=()):
    """Run the commands of a page in a folder; none may fail. Return how many.

    apart : of words; a command that has one of them is not run."""
    environment = environment_of(folder, oiiotool)
    commands = COMMAND.findall(text_of(page))
    assert all(any(word in command for command in commands) for word in apart)
    commands = [c for c in commands if not any(word in c for word in apart)]
    for command in commands:
        done = subprocess.run(
            ["bash", "-c", command],
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, command + "\n" + done.stdout + done.stderr
    return len(commands)


def write_studio_config(path):
    """Write a config of a studio: one that OpenColorIO brings along."""
    ocio = pytest.importorskip("PyOpenColorIO", minversion="2.5")
    name = "cg-config-v2.1.0_aces-v1.3_ocio-v2.3"
    path.write_text(ocio.Config.CreateFromBuiltinConfig(name).serialize())
