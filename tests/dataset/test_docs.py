# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The commands and programs of docs/dataset.md, run as they stand there."""

import re
import shlex

import numpy as np
import pytest

from dataset.data_sets import scene, write_image
from python.commands import run
from tiers import slow


@pytest.fixture
def page(repository, tmp_path, monkeypatch):
    """Return the page's text, in a folder with the renders that it speaks of."""
    for number in range(2):
        write_image(tmp_path / f"renders/{number}.exr", scene((260, 280), number))
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(repository / "python" / "examples"))
    return (repository / "docs/dataset.md").read_text().replace("\\\n", " ")


def commands(page):
    """Return the words of each command of the page."""
    return [
        shlex.split(line)[1:] for line in re.findall(r"^    (cg2raw .*)", page, re.M)
    ]


def programs(page):
    """Return the Python programs of the page."""
    return re.findall(r"```python\n(.*?)```", page, re.S)


@pytest.mark.parametrize("number", [0, 1, slow(2), 3])  # 2: eight workers start
def test_commands(page, number):
    assert len(commands(page)) == 4
    done = run(*commands(page)[number])
    assert done.code == 0 and "wrote" in done.out, done


def test_a_row_is_made_again(page):
    assert run(*commands(page)[0]).code == 0
    names = {}
    exec(programs(page)[0], names)
    assert names["raw"].shape == (260, 280) and names["raw"].max() > 0


def test_noise_is_drawn_anew_by_the_manifest_alone(page):
    """As scattered as the file that cg2raw wrote, in the same places."""
    assert run(*commands(page)[3]).code == 0
    names = {}
    exec(programs(page)[1], names)
    row, clean, again = (names[name] for name in ("row", "x", "noisy"))
    known = (np.load(f"out/{row['path']}") - clean)[clean < 1]
    drawn = (again - clean)[clean < 1]
    # Two variances, each of 65,536 sites: standard errors below 1 %
    assert len(drawn) > 20000
    assert drawn.var() == pytest.approx(known.var(), rel=0.05)
    assert not (again - clean)[clean >= 1].any()


def test_pytorch(page):
    pytest.importorskip("torch", reason="PyTorch is not installed")
    assert run(*commands(page)[3]).code == 0
    names = {}
    reading, synthesis = programs(page)[2:]
    exec(reading.replace("num_workers=4", "num_workers=0"), names)
    assert names["noisy"].shape == names["clean"].shape == (16, 4, 128, 128)
    exec(synthesis, names)
    assert len(names["loader"]) == 10 * 2 * 64 / 16
    assert names["data"][1]["noisy"].shape == (4, 128, 128)
