# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""One name for a method, in every command, message and page."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from cg2raw.cli import _methods, make_parser
from cg2raw.dataset.methods import METHODS
from python.commands import run

ROOT = Path(__file__).resolve().parents[2]
COMMANDS = {
    "convert": "convert a.exr -o a.dng --sensor nikon-d40 --illuminant D65".split(),
    "dataset": "dataset in out --sensors nikon-d40 --illuminants 1".split(),
}


def parsed(command, *options):
    return make_parser().parse_args([*COMMANDS[command], *options])


def test_the_commands_know_the_methods_that_there_are():
    assert set(_methods.METHODS) == set(METHODS)
    for command in COMMANDS:
        assert parsed(command).method == "graphics2raw"
        assert parsed(command, "--method", "upi").method == "upi"
        # The name that convert had for it, which is public.
        assert parsed(command, "--method", "g2r").method == "graphics2raw"


@pytest.mark.parametrize("option", ["--method", "--convention"])
def test_both_commands_say_the_same_of_it(option):
    texts = [run(command, "--help").out for command in COMMANDS]
    blocks = [
        re.search(rf"^  {option} .*?(?=^  --|^$)", text, re.MULTILINE | re.DOTALL)[0]
        for text in texts
    ]
    assert blocks[0] == blocks[1] and "(default)" in blocks[0]


def test_both_commands_report_the_same_word(tmp_path):
    pytest.importorskip("OpenImageIO", reason="OpenImageIO's wheel is not installed")
    pytest.importorskip("pyarrow", reason="pyarrow is not installed")
    from dataset.data_sets import rows, write_image

    path = write_image(tmp_path / "in/a.exr", np.full((24, 36, 3), 0.2, np.float32))
    words = ["--sensor", "nikon-d40", "--illuminant", "D65", "--method", "g2r"]
    done = run("convert", path, "-o", tmp_path / "a.dng", *words, "--json")
    [report] = json.loads(done.out)["files"]
    words = ["--sensors", "nikon-d40", "--illuminants", "D65", "--method", "g2r"]
    assert run("dataset", path, tmp_path / "out", *words).code == 0
    [row] = rows(tmp_path / "out")
    assert report["method"] == row["method"] == "graphics2raw"


def test_the_former_word_stands_nowhere_else():
    """But where it is taken for the new one, and in the list of changes."""
    sources = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    for folder in ("python", "ocio", "plugins", "scripts"):
        for ending in ("py", "cpp", "h", "json"):
            sources += (ROOT / folder).rglob(f"*.{ending}")
    found = [path for path in sources if re.search(r"\bg2r\b", path.read_text())]
    assert [path.name for path in found] == ["_methods.py"]
