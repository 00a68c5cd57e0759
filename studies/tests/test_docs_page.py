# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""docs/evidence.md has a section for all that ./studies/run evidence --docs writes."""

import re

import pytest

from studies.docs_page import FIGURES, STUDIES, marks, sections, update_page, write_docs
from studies.tables_of_results import tables_by_study

PAGE = "docs/evidence.md"
TWO = """\
# A page

<!-- study: colour -->

old

<!-- end: colour -->
between
<!-- study: isp -->
<!-- end: isp -->
"""


@pytest.fixture
def page(repository):
    return (repository / PAGE).read_text()


def test_the_page_has_a_section_for_each_study_and_figure(page):
    names = re.findall(r"^<!-- study: (.+) -->$", page, re.MULTILINE)
    assert sorted(names) == sorted({*STUDIES, *FIGURES})
    assert names == re.findall(r"^<!-- end: (.+) -->$", page, re.MULTILINE)


def test_the_tables_of_all_studies_have_a_place(page, planted):
    tables = tables_by_study(planted.results, 0.1)
    assert list(tables) == ["illuminant", "denoising", "isp"]
    text = write_docs(page, sections(tables, FIGURES))
    for table in tables.values():
        assert f"\n\n{table}\n\n" in text
    for start, end in map(marks, STUDIES):
        assert page.count(start) == text.count(start) == text.count(end) == 1


def test_tables_of_other_renders_say_so_and_stand_below(planted):
    name, found = next(iter(planted.results["cameras"].items()))
    isp = found["studies"]["isp"]
    both = {"isp, night renders": isp, "isp": isp}
    tables = tables_by_study({"cameras": {name: {"studies": both}}}, 0.1)
    heads = [line for line in tables["isp"].splitlines() if line.startswith("###")]
    assert list(tables) == ["isp"]
    assert heads[1] == f"{heads[0]}: night renders"


def test_longer_training_and_unets_stand_below_their_studies(planted):
    name, found = next(iter(planted.results["cameras"].items()))
    studies = found["studies"]
    few = ("real", "ours, dng", "upi, graphics2raw")
    longer = {source: studies["illuminant"][source] for source in few}
    unet = {c: {s: e[s] for s in few} for c, e in studies["denoising"].items()}
    results = {"cameras": {name: {"studies": studies | {"longer": longer}}}}
    table = tables_by_study(results, 0.1)["illuminant"].split("long enough?")[1]
    rows = [line for line in table.splitlines() if " - " in line]
    # The same errors: each difference is the same before and after.
    assert len(rows) == 3
    for row in rows:
        before, after = row.split("|")[2].split(";")
        assert before.strip() == after.strip()
    results = {"cameras": {name: {"studies": {"unet": unet}}}}
    text = tables_by_study(results, 0.1)["denoising"]
    assert text.startswith("### Denoising by U-net, 2 draws")
    assert "| ours, dng - upi, graphics2raw |" in text and "upi, camera" not in text


def test_an_entry_of_one_draw_waits_for_the_second(planted):
    name, found = next(iter(planted.results["cameras"].items()))
    errors = {source: e[:1] for source, e in found["studies"]["illuminant"].items()}
    results = {"cameras": {name: {"studies": {"illuminant": errors}}}}
    assert tables_by_study(results, 0.1) == {}


def test_measured_tables_stand_in_their_sections(page):
    for name, title in (("classical", "### Classical"), ("colour", "### Colour, day")):
        start, end = marks(name)
        text = page.partition(start)[2].partition(end)[0].strip()
        assert text.startswith(title) and text.endswith("|")
        assert write_docs(page, {name: text}) == page


def test_the_pictures_of_the_page_are_there(page, repository):
    for path in re.findall(r"\((images/[^)]+)\)", page):
        assert (repository / "docs" / path).exists(), path


def test_only_named_sections_are_replaced_and_twice_is_once():
    text = write_docs(TWO, {"isp": "a \\1 table\n"})
    assert text == TWO.replace(
        "<!-- study: isp -->\n", "<!-- study: isp -->\n\na \\1 table\n\n"
    )
    assert write_docs(text, {"isp": "a \\1 table"}) == text
    assert "old" not in write_docs(text, {"colour": "new"})


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("<!-- study: isp -->", ""),
        ("<!-- end: isp -->", ""),
        ("between", "<!-- end: isp -->"),
        ("between", "<!-- study: isp -->"),
        (
            "<!-- study: isp -->\n<!-- end: isp -->",
            "<!-- end: isp --><!-- study: isp -->",
        ),
    ],
)
def test_a_page_without_the_marks_is_refused(before, after):
    assert before in TWO
    with pytest.raises(ValueError, match="<!-- study: isp -->") as refused:
        write_docs(TWO.replace(before, after), {"isp": "text"})
    assert "\n" not in str(refused.value)


def test_a_page_has_figures_of_the_studies_that_are_written(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(TWO)
    for name in ("isp", "illuminant"):
        (tmp_path / f"{name}.png").write_bytes(name.encode())
    update_page({"isp": "a table"}, tmp_path, page)
    text = page.read_text()
    assert "a table\n\n![The goal" in text and "illuminant" not in text
    written = {path.name: path.read_bytes() for path in (tmp_path / "images").iterdir()}
    assert written == {"evidence_isp.png": b"isp"}
    update_page({"isp": "a table"}, tmp_path, page)
    assert page.read_text() == text


def test_an_earlier_figure_of_all_studies_needs_tables_of_one(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(TWO)
    (tmp_path / "gap.png").write_bytes(b"gap")
    update_page({"colour": "a table"}, tmp_path, page)
    assert list((tmp_path / "images").iterdir()) == []
    with pytest.raises(ValueError, match="study: gap"):
        update_page({"isp": "a table"}, tmp_path, page)


def test_nothing_is_written_to_a_page_that_lacks_a_section(tmp_path):
    page = tmp_path / "page.md"
    page.write_text(TWO)
    with pytest.raises(ValueError, match="page.md: .*study: denoising"):
        update_page({"isp": "a table", "denoising": "a table"}, tmp_path, page)
    assert page.read_text() == TWO and not (tmp_path / "images").exists()
    with pytest.raises(ValueError, match="missing.md"):
        update_page({}, tmp_path, tmp_path / "missing.md")


def test_a_page_has_no_numbers_of_few_frames(capsys):
    from studies.main import arguments

    with pytest.raises(SystemExit):
        arguments(["colour", "--docs"])
    assert "--docs needs --full" in capsys.readouterr().err
    assert arguments(["colour", "--docs", "--full"]).docs
