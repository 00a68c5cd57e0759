# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""docs/evidence.md has a section for all that scripts/evidence --docs writes, and its
tables are those of docs/evidence.json."""

import re

import numpy as np
import pytest

from studies.docs_page import (
    FIGURES,
    STUDIES,
    image,
    marks,
    readme_text,
    sections,
    write_docs,
    write_page,
)
from studies.figures import files
from studies.protocol import PROTOCOL
from studies.summaries import read_committed, summaries
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
    tables = tables_by_study(planted.summaries, 0.1)
    assert list(tables) == ["illuminant", "denoising", "isp"]
    text = write_docs(page, sections(tables, FIGURES))
    for table in tables.values():
        assert f"\n\n{table}\n\n" in text
    for start, end in map(marks, STUDIES):
        assert page.count(start) == text.count(start) == text.count(end) == 1


def section(page, name):
    """Return the text of a section."""
    start, end = marks(name)
    return page.partition(start)[2].partition(end)[0].strip()


def differing(page, found):
    """Return the studies whose tables on a page are not those of summaries: a section
    without summaries is empty."""
    tables = tables_by_study(found, PROTOCOL.classical.within)
    return [
        name
        for name in STUDIES
        if not (
            section(page, name).startswith(tables[name])
            if name in tables
            else not section(page, name)
        )
    ]


def test_the_tables_of_the_page_are_those_of_the_committed_results(page):
    """The page's figures aside, which show pictures, too."""
    found = read_committed()
    assert found and differing(page, found) == []
    for study in found.values():
        assert {"core", "host", "packages", "seeds"} <= set(study["made by"])


def test_the_numbers_of_the_readme_are_those_of_the_committed_results(repository):
    found = read_committed()
    readme = (repository / "README.md").read_text()
    assert section(readme, "readme") == readme_text(found)
    # The first number: the least that ours is behind real, of cameras.
    isp = found["isp, night renders"]["cameras"]
    gaps = []
    for camera in isp.values():
        ours, real = (
            np.array(camera["CIE XYZ"][source]["difference"]["frames"])
            for source in ("ours, match", "real")
        )
        gaps.append((ours - real).mean())
    assert f"ISP is {min(gaps):.2f} to {max(gaps):.2f} CIEDE2000" in " ".join(
        readme_text(found).split()
    )


def test_a_page_that_differs_from_the_committed_results_is_found(page):
    found = read_committed()
    name = next(name for name in STUDIES if name in tables_by_study(found, 0.1))
    digit = re.search(r"[0-9]\.[0-9]", section(page, name))[0]
    other = section(page, name).replace(digit, "9.9", 1)
    assert differing(write_docs(page, {name: other}), found) == [name]
    without = {study: made for study, made in found.items() if name not in study}
    assert name in differing(page, without)


def of_first_camera(planted):
    """Return {study: entry} of planted results."""
    camera = planted.cameras[0]
    return {s: of["cameras"][camera]["entry"] for s, of in planted.results.items()}


def planted_studies(planted, studies, **made_by):
    """Return the Summaries of one camera's studies. made_by : {study: made by}."""
    name = planted.cameras[0]
    return summaries(
        {
            study: {
                "made by": made_by.get(study, {}),
                "cameras": {name: {"entry": entry}},
            }
            for study, entry in studies.items()
        }
    )


def test_tables_of_other_renders_say_so_and_stand_below(planted):
    isp = of_first_camera(planted)["isp"]
    both = {"isp, night renders": isp, "isp": isp}
    tables = tables_by_study(planted_studies(planted, both), 0.1)
    heads = [line for line in tables["isp"].splitlines() if line.startswith("###")]
    assert list(tables) == ["isp"]
    assert heads[1] == f"{heads[0]}: night renders"


def test_a_source_that_one_camera_lacks_has_an_empty_cell(planted):
    study = planted.summaries["isp"]
    one, other = planted.cameras
    less = {
        goal: {s: kept for s, kept in of.items() if s != "upi, match"}
        for goal, of in study["cameras"][one].items()
    }
    cameras = {one: less, other: study["cameras"][other]}
    text = tables_by_study({"isp": {**study, "cameras": cameras}}, 0.1)["isp"]
    rows = [line for line in text.splitlines() if "upi, match" in line]
    assert len(rows) == 6  # of two goals: means, less real, and ours less it
    for row in rows:
        assert re.fullmatch(r"\| [^|]+ \| [^|]+[0-9][^|]+ \|  \|", row), row


def test_tables_say_how_much_was_learnt_of(planted):
    made_by = {"settings": {"isp": {"frames": 80, "samples": 30000, "step": 2}}}
    study = {**planted.summaries["isp"], "made by": made_by}
    text = tables_by_study({"isp": study}, 0.1)["isp"]
    assert text.splitlines()[2] == "*By isp: 80 frames, 30,000 samples.*"


def test_an_entry_of_one_draw_waits_for_the_second(planted):
    studies = of_first_camera(planted)
    errors = {source: e[:1] for source, e in studies["illuminant"].items()}
    found = planted_studies(planted, {"illuminant": errors})
    assert tables_by_study(found, 0.1) == {}


def test_measured_tables_stand_in_their_sections(page):
    for name, title in (("classical", "### Classical"), ("colour", "### Colour, day")):
        start, end = marks(name)
        text = page.partition(start)[2].partition(end)[0].strip()
        assert title in text and text.endswith("|")
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


@pytest.fixture
def written(tmp_path, planted, monkeypatch):
    """Return written(summaries): the text of a page, and its committed results.

    The figure of gaps has the names of its studies."""
    monkeypatch.setattr(files, "gap_bars", lambda found: " ".join(found).encode())
    page = tmp_path / "page.md"
    start, end = marks("gap")
    page.write_text(f"{TWO}\n{start}\n{end}\n")
    readme = tmp_path / "README.md"
    readme.write_text("No numbers of other studies.\n")

    def write(found):
        committed = tmp_path / "evidence.json"
        write_page(found, tmp_path, page, committed, readme)
        assert readme.read_text() == "No numbers of other studies.\n"
        return page.read_text(), read_committed(committed)

    return write


def test_a_page_has_figures_of_the_studies_that_are_written(written, tmp_path, planted):
    for name in ("isp", "illuminant"):
        (tmp_path / f"{name}.png").write_bytes(name.encode())
    found = {"isp": planted.summaries["isp"]}
    text, kept = written(found)
    assert "### Neural ISP" in text and "|\n\n![The goal" in text
    assert "illuminant" not in text and kept == found
    images = {path.name: path.read_bytes() for path in (tmp_path / "images").iterdir()}
    # Of summaries, which are of all studies, figures are drawn anew.
    assert images == {image("gap"): b"isp", image("isp"): b"isp"}
    assert written(found) == (text, kept)
    # Without its picture, a study's tables are renewed above the earlier picture.
    (tmp_path / "isp.png").unlink()
    assert written(found) == (text, kept)


def test_other_studies_and_cameras_of_the_same_make_are_kept(written, planted):
    one, other = planted.cameras
    isp = planted.summaries["isp"]

    def of(camera, **made_by):
        cameras = {camera: isp["cameras"][camera]}
        return {"isp": {"made by": {**isp["made by"], **made_by}, "cameras": cameras}}

    written(of(one))
    text, kept = written(of(other))
    assert sorted(kept["isp"]["cameras"]) == sorted((one, other))
    assert one in text and other in text
    text, kept = written(of(other, core="another"))
    assert list(kept["isp"]["cameras"]) == [other] and one not in text


def test_nothing_is_written_to_a_page_that_lacks_a_section(
    tmp_path, planted, monkeypatch
):
    monkeypatch.setattr(files, "gap_bars", lambda _: b"")
    page, committed = tmp_path / "page.md", tmp_path / "evidence.json"
    page.write_text(TWO)
    with pytest.raises(ValueError, match="page.md: .*study: illuminant"):
        found = {"illuminant": planted.summaries["illuminant"]}
        write_page(found, tmp_path, page, committed)
    assert page.read_text() == TWO
    assert not (tmp_path / "images").exists() and not committed.exists()
    missing = tmp_path / "missing.md"
    with pytest.raises(ValueError, match="missing.md"):
        write_page(planted.summaries, tmp_path, missing, committed)


def test_a_page_has_no_numbers_of_few_frames(capsys):
    from studies.main import arguments

    with pytest.raises(SystemExit):
        arguments(["colour", "--docs"])
    assert "--docs needs --full" in capsys.readouterr().err
    assert arguments(["colour", "--docs", "--full"]).docs
