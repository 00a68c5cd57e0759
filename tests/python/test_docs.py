# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The pages: what scripts write is up to date, the Python examples run, and the
reference lists every public name, each of which says what it is."""

import argparse
import dataclasses
import importlib
import inspect
import re
import shlex
import shutil
import textwrap
from pathlib import Path

import numpy as np
import pytest

import cg2raw
import cg2raw.match
import cg2raw.model
import cg2raw.statistics
from cg2raw import _core, _public, calibration, dataset, diagnose, synthetic
from cg2raw.cli import make_parser, subcommands
from cg2raw.cli._messages import with_command
from cg2raw.diagnose import diagnosis
from tiers import slow

ROOT = Path(__file__).resolve().parents[2]
# tests/dataset/test_docs.py and tests/diagnose/test_docs.py run those whose programs
# need the files that their commands write.
APART = ("dataset", "diagnose")
PAGES = [
    ROOT / "README.md",
    *(page for page in sorted((ROOT / "docs").glob("*.md")) if page.stem not in APART),
]
FENCED = re.compile(r"^( *)```python\n(.*?)^\1```", re.MULTILINE | re.DOTALL)
INDENTED = re.compile(r"(?:^    .*\n|^\n(?=    ))+", re.MULTILINE)
# Files that examples name, in the real data.
FILES = {
    "Canon_EOS_600D_380_780_5.json": "tables/ssf/rawtoaces-data/data/camera",
}


def examples(page):
    """Return the Python blocks of a page that use cg2raw, in order."""
    text = page.read_text()
    found = [(match.start(), match[2]) for match in FENCED.finditer(text)]
    for match in INDENTED.finditer(FENCED.sub("", text)):
        # A shell command may stand above, with an empty line between.
        code = re.sub(r"\A(?:(?!    (?:import|from) cg2raw\b).*\n)+", "", match[0])
        if code:
            found.append((text.index(code), code))
    return [textwrap.dedent(code) for _, code in sorted(found)]


WITH_EXAMPLES = [page for page in PAGES if examples(page)]


def test_pages_have_examples():
    assert {"README.md", "python.md"} <= {page.name for page in WITH_EXAMPLES}


@pytest.mark.parametrize(
    "page",
    [slow(page) if page.name == "calibrate.md" else page for page in WITH_EXAMPLES],
    ids=lambda page: page.name,
)
def test_the_examples_of_a_page_run(page, tmp_path, monkeypatch, request):
    """In one namespace, in an empty folder, with the render that they speak of."""
    code = examples(page)
    for name, folder in FILES.items():
        if any(name in block for block in code):
            data = request.getfixturevalue("camera_data")
            shutil.copy(data / folder / name, tmp_path)
    monkeypatch.chdir(tmp_path)
    rgb = np.random.default_rng(1).uniform(0, 1, (64, 96, 3)).astype(np.float32)
    names = {"rgb": rgb}
    for block in code:
        exec(compile(block, str(page), "exec"), names)
    for written in tmp_path.glob("*.dng"):
        assert cg2raw.read_dng_metadata(str(written)).bits >= 8


# What scripts/generate.py writes, or a part of: words of that.
GENERATED = {
    "docs/effects.md": "of the amplifiers",
    "docs/oiiotool.md": "an ISO from 1 to 10000000",
    "docs/profile.md": "list of objects",
    "docs/man/cg2raw-convert.1": ".SH SYNOPSIS",
    "python/cg2raw/_core.pyi": "def base_iso(self)",
}


@pytest.fixture
def generate(monkeypatch, capsys):
    """Return generate(*words): what scripts/generate.py returns, and prints."""
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    main = importlib.import_module("generate").main

    def run(*words):
        monkeypatch.setattr("sys.argv", ["generate.py", *map(str, words)])
        return main(), capsys.readouterr().out

    return run


def test_generated_files_are_up_to_date(generate):
    assert generate("--check") == (0, "")


def test_generated_files_that_are_stale_are_named_and_mended(tmp_path, generate):
    right = {name: (ROOT / name).read_text() for name in GENERATED}
    for name, words in GENERATED.items():
        assert words in right[name]
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(right[name].replace(words, "other words"))
    gone = "docs/man/cg2raw-gone.1"
    (tmp_path / gone).write_text("of a command that is no more")
    code, named = generate("--check", tmp_path)
    assert generate(tmp_path)[0] == 0  # what is not there is written, too
    made = [path.relative_to(tmp_path) for path in tmp_path.rglob("*.*")]
    told = {f"{name} is not up to date: run scripts/generate.py" for name in made}
    told |= {f"{gone} is not up to date: run scripts/generate.py"}
    assert (code, set(named.splitlines())) == (1, told)
    assert generate("--check", tmp_path) == (0, "")
    assert {name: (tmp_path / name).read_text() for name in right} == right
    assert not (tmp_path / gone).exists()


def test_every_effect_has_its_section():
    page = (ROOT / "docs/effects.md").read_text()
    sections = re.findall(r"^## (\w+)$", page, re.MULTILINE)
    assert sections == [effect["name"] for effect in cg2raw.effects()]
    assert sections == re.findall(r"^\| \[`(\w+)`\]\(#", page, re.MULTILINE)


TERM = re.compile(r"^\| (.+?) \| (.+) \|$", re.MULTILINE)


def glossary():
    """Return {term without what is in brackets: (term, meaning)}."""
    _, _, table = (ROOT / "docs/glossary.md").read_text().partition("|---|---|\n")
    rows = TERM.findall(table)
    assert len(rows) == table.count("\n")
    found = {term.partition(" (")[0]: (term, meaning) for term, meaning in rows}
    assert len(found) == len(rows)
    return found


def test_the_glossary_is_in_order():
    terms = [term.replace("`", "").lower() for term, _ in glossary().values()]
    assert terms == sorted(terms) and len(terms) > 100
    assert all(meaning[-1] == "." for _, meaning in glossary().values())


@pytest.mark.parametrize("effect", cg2raw.effects(), ids=lambda effect: effect["name"])
def test_the_glossary_has_every_effect_and_its_stage(effect):
    assert glossary()[f"`{effect['name']}`"][1].startswith("Effect: ")
    assert "(stage" in glossary()[f"`{effect['stage']}`"][0]


@pytest.mark.parametrize("verdict", diagnosis.VERDICTS)
def test_the_glossary_has_every_verdict(verdict):
    assert glossary()[f"`{verdict}`"][1].startswith("Verdict: ")


@pytest.mark.parametrize(
    "former", ["early_clipping", "photon_statistics", "column_noise"]
)
def test_the_glossary_has_the_former_names_of_effects(former):
    current = _core.current_effect_name(former)
    assert f"formerly `{former}`" in glossary()[f"`{current}`"][0]


def public_things():
    """Yield (name, object) of all public names and the members of public classes."""
    for name in cg2raw.__all__:
        value = getattr(cg2raw, name)
        if not isinstance(value, str):
            yield name, value
        if inspect.isclass(value):
            members = vars(value).items()
            yield from ((f"{name}.{n}", v) for n, v in members if n[0] != "_")


THINGS = {n: v for n, v in public_things() if callable(v) or hasattr(v, "__get__")}


@pytest.mark.parametrize("name", THINGS)
def test_every_public_name_says_what_it_is(name):
    text = inspect.getdoc(THINGS[name]) or ""
    # pybind11's own first line is a signature.
    said = [line for line in text.splitlines() if " -> " not in line and line.strip()]
    if name != "RawFrame.simulation":
        assert said and len(" ".join(said)) > 10


DIRECTIVE = re.compile(
    r"^\.\. (auto\w+|py:data):: ([\w.]+)\n((?:   .+\n)*)", re.MULTILINE
)


def reference():
    """Return {dotted name: (directive, options)} of the reference's sources."""
    pages = sorted((ROOT / "docs/reference").glob("*.rst"))
    found = [match for page in pages for match in DIRECTIVE.findall(page.read_text())]
    assert len({name for _, name, _ in found}) == len(found)
    return {name: (directive, options) for directive, name, options in found}


def classes_of_a_diagnosis():
    """Return the names of the classes that diagnosis.py defines."""
    of_module = vars(diagnosis).values()
    classes = filter(inspect.isclass, of_module)
    return {c.__name__ for c in classes if c.__module__ == diagnosis.__name__}


def test_the_reference_lists_all_public_names_and_no_others():
    parts = classes_of_a_diagnosis() - set(diagnose.__all__)
    assert set(reference()) == {
        "cg2raw",
        "cg2raw.spectra.camera_from_spectra",
        "cg2raw.spectra.simulate_spectra",
        "cg2raw.calibration",
        "cg2raw.dataset",
        "cg2raw.diagnose",
        "cg2raw.match",
        "cg2raw.model",
        "cg2raw.statistics",
        "cg2raw.synthetic",
        *(f"cg2raw.{name}" for name in cg2raw.__all__),
        *(f"cg2raw.calibration.{name}" for name in calibration.__all__),
        *(f"cg2raw.dataset.{name}" for name in dataset.__all__),
        *(f"cg2raw.diagnose.{name}" for name in diagnose.__all__),
        *(f"cg2raw.diagnose.diagnosis.{name}" for name in parts),
        *(f"cg2raw.match.{name}" for name in cg2raw.match.__all__),
        *(f"cg2raw.model.{name}" for name in cg2raw.model.__all__),
        *(f"cg2raw.statistics.{name}" for name in cg2raw.statistics.__all__),
        *(f"cg2raw.synthetic.{name}" for name in synthetic.__all__),
    }


def test_the_reference_shows_what_a_name_is():
    """A class with its members; a dataclass has its fields shown without that."""
    for name, (directive, options) in reference().items():
        home, _, last = name.rpartition(".")
        value = getattr(importlib.import_module(home), last) if home else cg2raw
        if directive == "autoclass":
            assert inspect.isclass(value)
            assert ":members:" in options or dataclasses.is_dataclass(value), name
        elif directive == "autofunction":
            assert callable(value) and not inspect.isclass(value)
        elif directive == "automodule":
            assert inspect.ismodule(value)
        else:
            assert directive == "py:data" and isinstance(value, str)


@pytest.mark.parametrize(
    "value",
    [
        *(getattr(diagnose, name) for name in diagnose.__all__),
        *(getattr(diagnosis, name) for name in classes_of_a_diagnosis()),
        *(getattr(cg2raw.match, name) for name in cg2raw.match.__all__),
        *(getattr(synthetic, name) for name in synthetic.__all__),
    ],
    ids=lambda value: value.__name__,
)
def test_every_name_of_the_diagnosis_says_what_it_is(value):
    assert len(inspect.getdoc(value)) > 10
    # A dataclass without a docstring has its signature for one.
    assert not inspect.getdoc(value).startswith(f"{value.__name__}(")


def test_all_is_sorted_and_whole():
    public = {
        n for n, v in vars(_public).items() if n[0] != "_" and not inspect.ismodule(v)
    }
    assert public | {"__version__"} == set(cg2raw.__all__) <= set(dir(cg2raw))
    assert len(set(cg2raw.__all__)) == len(cg2raw.__all__)


COMMAND = re.compile(r"^ {4,}(?:eval \"\$\()?(cg2raw (?:.*\\\n)*.*)$", re.MULTILINE)


def commands(page):
    """Return the words of each command of cg2raw that stands on a page."""
    found = []
    for match in COMMAND.finditer(FENCED.sub("", page.read_text())):
        line = re.sub(r"\\\n\s*", " ", match[1]).partition(')"')[0]
        line = line.partition(" | ")[0].partition(" > ")[0]
        words = shlex.split(line, comments=True)
        found.append(words[1:])
    return found


ALL_PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


@pytest.mark.parametrize("page", ALL_PAGES, ids=lambda page: page.name)
def test_every_command_on_a_page_exists(page, capsys):
    """Its options, too; whether it does what the page says is tested elsewhere."""
    for words in commands(page):
        try:
            make_parser().parse_args(with_command(words))
        except SystemExit as stop:
            assert stop.code in (None, 0), (words, capsys.readouterr().err)


def test_pages_have_commands():
    assert sum(len(commands(page)) for page in ALL_PAGES) >= 25
    # Also those inside a list, which are indented further.
    assert ["--illuminants", "estimate:mean"] in [
        words[-6:-4] for words in commands(ROOT / "docs/spectral.md")
    ]


LINK = re.compile(r"\]\(([^)\s]+)\)")
LINKED = [*ALL_PAGES, *(ROOT / f for f in ("CONTRIBUTING.md", "packaging/README.md"))]


def anchors(page):
    """Return the names by which links lead to headings of a page, as on GitHub."""
    found = re.findall(r"^#+ (.*)$", FENCED.sub("", page.read_text()), re.MULTILINE)
    plain = [re.sub(r"[^\w\- ]", "", heading.lower()) for heading in found]
    return {heading.replace(" ", "-") for heading in plain}


@pytest.mark.parametrize("page", LINKED, ids=lambda page: page.name)
def test_every_link_to_a_file_leads_somewhere(page):
    for link in LINK.findall(page.read_text()):
        file, _, name = link.partition("#")
        if link.startswith(("https://", "http://")):
            continue
        target = page.parent / file if file else page
        assert target.exists(), link
        assert not name or name in anchors(target), link


INLINE = re.compile(r"`(cg2raw [^`\n]+)`")


@pytest.mark.parametrize("page", ALL_PAGES, ids=lambda page: page.name)
def test_every_option_in_the_text_of_a_page_exists(page):
    """As in `cg2raw profile --ssf`: they are no whole command lines."""
    for text in INLINE.findall(page.read_text()):
        name, *words = text.split()[1:]
        shown = subcommands()[name] if name in subcommands() else None
        parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
        if shown is not None:
            shown.add_arguments(parser)
        known = {
            option for action in parser._actions for option in action.option_strings
        }
        asked = {word.partition("=")[0] for word in words if word.startswith("--")}
        assert asked <= known, text
