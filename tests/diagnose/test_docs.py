# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The commands and programs of docs/diagnose.md, run as they stand there."""

import json
import re
import shlex
import shutil

import pytest

from cg2raw.diagnose.diagnosis import VERDICTS
from cg2raw.synthetic.strengths import KINDS
from python.commands import run

COMMANDS = ("synthesize", "run", "compare")


def text_of(repository):
    return (repository / "docs/diagnose.md").read_text().replace("\\\n", " ")


def commands(page):
    """Return the words of each command on the example's folders."""
    lines = re.findall(r"^    ((?:cg2raw|oiiotool) .*)", page, re.M)
    return [shlex.split(line) for line in lines if "blind/" in line]


@pytest.fixture(scope="module")
def example(repository, tmp_path_factory):
    """Return the folder in which the page's commands ran, and what they printed."""
    folder = tmp_path_factory.mktemp("example")
    done = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        found = commands(text_of(repository))
        for name, words in zip(COMMANDS, found, strict=True):
            done[name] = run(*words[1:])
    return folder, done


@pytest.mark.slow
def test_the_commands_run(example):
    _, done = example
    assert all(each.code == 0 for each in done.values()), done
    assert "explained: row_noise, lens_shading" in done["run"].out
    before, after = re.findall(r"^(?:canon|report).*", done["compare"].out, re.M)
    assert before.endswith("unexplained") and after.endswith("consistent")


def compare(shown, written, where):
    """Every leaf that the page shows is what was written, as far as it is shown."""
    if isinstance(shown, dict):
        for key, value in shown.items():
            compare(value, written[key], f"{where}.{key}")
    elif isinstance(shown, list):
        assert len(shown) == len(written), where
        for number, pair in enumerate(zip(shown, written, strict=True)):
            compare(*pair, f"{where}[{number}]")
    elif isinstance(shown, float | int) and not isinstance(shown, bool):
        near = {"rel": 0.02, "abs": 0.003 if where.startswith(".gap.") else 0.0}
        assert written == pytest.approx(shown, **near), where
    else:
        assert written == shown, where


@pytest.mark.slow
def test_the_verdict_is_the_page_s(example, repository):
    folder, _ = example
    (shown,) = re.findall(r"```json\n(.*?)```", text_of(repository), re.S)
    written = json.loads((folder / "report/verdict.json").read_text())
    compare(json.loads(shown), written, "")


def test_the_comparison_can_fail():
    for wrong in ({"a": 1.1}, {"a": [1.0]}, {"a": "b"}):
        with pytest.raises((AssertionError, TypeError)):
            compare(wrong, {"a": 1.0}, "")


@pytest.mark.slow
def test_the_programs_run(example, repository, monkeypatch):
    folder, _ = example
    monkeypatch.chdir(folder)
    names = {}
    for block in re.findall(r"```python\n(.*?)```", text_of(repository), re.S):
        exec(compile(block, "docs/diagnose.md", "exec"), names)
    assert [effect.name for effect in names["found"].effects] == [
        "row_noise",
        "lens_shading",
    ]
    assert names["mean"][0, 0] / names["mean"][200, 300] == pytest.approx(
        0.72, abs=0.01
    )
    assert [effect.name for effect in names["again"].effects] == ["crosstalk"]
    assert (folder / "by_python/report.html").exists()


@pytest.mark.slow
def test_oiiotool_simulates_what_was_found(example, repository, system_oiiotool):
    folder, _ = example
    (command,) = re.findall(r"^    (oiiotool shot.*)", text_of(repository), re.M)
    shutil.copy(repository / "tests/data/interior.exr", folder / "shot.exr")
    system_oiiotool(*shlex.split(command)[1:], cwd=folder)
    assert (folder / "shot.dng").stat().st_size > 100_000


def test_the_tables_are_whole(repository):
    page = text_of(repository)
    rows = dict(re.findall(r"^\| `([a-z ,_]+)` \|.*?\| (\d+) \|$", page, re.M))
    assert {name: int(code) for name, code in rows.items()} == VERDICTS
    table = page.partition("| captures | show |")[2].partition("\n\n")[0]
    assert sorted(re.findall(r"`(\w+)`", table)) == sorted(KINDS)


def test_pictures_are_small(repository):
    named = re.findall(r"\]\((images/\w+\.png)\)", text_of(repository))
    assert len(named) == 1
    for name in named:
        assert 5_000 < (repository / "docs" / name).stat().st_size < 200_000, name
