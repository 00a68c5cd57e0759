# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""report.html shows all of a diagnosis, safely, alike each time, in one file."""

import base64
import re
import sys
from dataclasses import replace
from html.parser import HTMLParser

import matplotlib
import numpy as np
import pytest

from cg2raw.diagnose.diagnosis import (
    VERDICTS,
    Alternative,
    Estimate,
    Gap,
    Picture,
)
from cg2raw.diagnose.report import write_report
from cg2raw.diagnose.report.figures import draw, figure
from cg2raw.diagnose.report.frame_images import frame
from cg2raw.diagnose.report.page import render
from cg2raw.diagnose.report.plots import curve_figure, histogram_figure
from cg2raw.diagnose.report.sensor_figures import panels
from diagnose.leaves import (
    is_number,
    leaves,
    paths_of_strings,
    with_leaf,
    with_mapping_keys,
    with_strings,
)
from diagnose.made_up_diagnosis import made_up_diagnosis, pictures
from tiers import slow

EMPTY = {
    "effects": [], "tests_before": [], "tests_after": [], "unexplained": [],
    "ladder": [], "detection_limits": [], "next_captures": [], "notes": [],
    "groups": {},
    "pictures": [], "curves": [], "histogram_before": None, "histogram_after": None,
    "profile_json": "", "characteristics": None,
}  # fmt: skip
DRAWN_FIELDS = (
    *("pictures", "histogram_before", "histogram_after", "curves"),
    "characteristics",
)
HOSTILE = (
    "<script>alert(1)</script><img src=x onerror=alert(2)>\"'&amp; {{ 7 * 7 }} $x$"
)
VOID = {"meta", "img", "br", "rect"}


class Page(HTMLParser):
    """The parts of a page: tags with the names of their attributes, text, images."""

    def __init__(self, html):
        super().__init__()
        self.tags, self.words, self.images, self.links = [], [], [], []
        self.ids, self.open, self.style = set(), [], ""
        self.feed(html)
        self.close()

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.tags.append((tag, tuple(sorted(values))))
        self.ids.add(values.get("id"))
        if tag == "img":
            self.images.append(values)
        if "href" in values:
            self.links.append(values["href"])
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert tag in VOID or self.open.pop() == tag

    def handle_data(self, data):
        if "style" in self.open:
            self.style += data
        else:
            self.words.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())

    @property
    def all_words(self):
        return self.text + " ".join(image["alt"] for image in self.images)


@pytest.fixture(scope="module")
def diagnosis():
    return made_up_diagnosis(pictures=pictures(3, 40, 60))


@pytest.fixture(scope="module")
def figures(diagnosis):
    return worded(diagnosis)


@pytest.fixture(scope="module")
def folder(diagnosis, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report") / "made" / "here"
    write_report(diagnosis, folder)
    return folder


def worded(diagnosis):
    """Return the figures with their words and without pictures, which take seconds."""
    with pytest.MonkeyPatch.context() as patch:
        for module in ("cg2raw.diagnose.report.plots", "cg2raw.io.plot"):
            patch.setattr(f"{module}.drawn", lambda *_, **__: b"")
        return draw(diagnosis)


def page_of(diagnosis):
    return Page(render(diagnosis, worded(diagnosis)))


def drawn_page_of(diagnosis):
    return Page(render(diagnosis, draw(diagnosis)))


def test_every_string_is_shown(diagnosis):
    marked, strings = with_strings(diagnosis, lambda n: f"mark{n}end")
    words = page_of(marked).all_words.lower()
    hidden = {
        path
        for path, text in zip(paths_of_strings(diagnosis), strings, strict=True)
        if text not in words
    }
    # Which captures discriminate two effects is said of the runner-up alone.
    field = "discriminating_captures"
    others = {path for path in hidden if path[-1] == field and path[-2] > 0}
    assert len(strings) > 150 and len(others) == 6
    assert hidden - others == {
        ("detection_limits", 6, "unit")
    }  # of what cannot be seen


def test_every_name_of_a_parameter_and_group_is_shown(diagnosis):
    effect = diagnosis.effects[0]
    names = with_mapping_keys(effect.parameters, lambda n: f"parameter{n}end")
    groups = with_mapping_keys(diagnosis.groups, lambda n: f"group{n}end")
    changed = with_leaf(diagnosis, ("effects", 0, "parameters"), names)
    text = page_of(with_leaf(changed, ("groups",), groups)).text
    assert [name for name in (*names, *groups) if name not in text] == []


def test_every_number_and_flag_is_shown(diagnosis, figures):
    few = {key: getattr(diagnosis, key)[:3] for key in ("tests_before", "tests_after")}
    diagnosis = replace(diagnosis, **few)
    page = render(diagnosis, figures)
    silent = []
    for path, value in leaves(diagnosis):
        if path[0] in DRAWN_FIELDS:
            continue
        if isinstance(value, bool) or is_number(value):
            other = not value if isinstance(value, bool) else 1.7 * value + 1e-3
            if render(with_leaf(diagnosis, path, other), figures) == page:
                silent.append(path)
    # 1e300 is where an e-value is capped.
    assert silent == [("effects", 0, "e_value")]


NO_PANELS = {"transfer": None, "dark_levels": None, "patterns": []}


def panels_of(field, *index):
    """Return a function that draws the panels of one field of the characteristics."""

    def drawn(diagnosis):
        found = diagnosis.characteristics
        value = getattr(found, field)
        alone = {**NO_PANELS, field: [value[n] for n in index] or value}
        alone = replace(found, **alone)
        return [i.png for panel in panels(alone, figure) for i in panel.images]

    return drawn


# What draws the arrays below a place of a diagnosis, and how many they are.
DRAWN = {
    ("characteristics", "transfer"): (panels_of("transfer"), 5),
    ("characteristics", "dark_levels"): (panels_of("dark_levels"), 5),
    ("characteristics", "patterns", 0): (panels_of("patterns", 0), 6),
    ("characteristics", "patterns", 1): (panels_of("patterns", 1), 6),
    ("pictures", 0): (
        lambda d: [i.png for i in all_images(frame(d.pictures[0], 1, 1))],
        5,
    ),
    ("curves", 0): (lambda d: curve_figure(d.curves[0]), 6),
    ("histogram_before",): (lambda d: histogram_figure(d.histogram_before, None), 2),
    ("histogram_after",): (lambda d: histogram_figure(None, d.histogram_after), 2),
}


@pytest.mark.parametrize(
    "start",
    [slow(at) if at[0] == "characteristics" else pytest.param(at) for at in DRAWN],
    ids=str,
)
def test_every_array_is_drawn(diagnosis, start, monkeypatch):
    draw_it, count = DRAWN[start]
    monkeypatch.setattr("cg2raw.io.figure.DPI", 40)  # as much to see, in less time
    arrays = [
        (path, value)
        for path, value in leaves(diagnosis)
        if path[: len(start)] == start and isinstance(value, np.ndarray)
    ]
    assert len(arrays) == count
    drawn = draw_it(diagnosis)
    for path, value in arrays:
        other = value.astype(float)
        other[len(other) // 2 :] *= 1.3
        assert draw_it(with_leaf(diagnosis, path, other)) != drawn, path


def all_images(shown):
    """Return the five images of a frame."""
    return [*shown.images, *shown.maps]


@pytest.mark.parametrize("verdict", VERDICTS)
def test_the_verdict_is_one_sentence_with_a_badge(diagnosis, figures, verdict):
    html = render(with_leaf(diagnosis, ("verdict",), verdict), figures)
    text = Page(html).text
    heading = re.search(r"<h1>([^<]+)</h1>", html).group(1)
    assert heading.endswith(".") and heading.count(".") - heading.count("99.92") == 1
    assert "nikon-d40" in heading and verdict in text
    assert len(re.findall(r'class="badge \w+"', html)) == 1


def test_an_interrupted_report_says_so_on_top(diagnosis, figures):
    stopped = render(with_leaf(diagnosis, ("interrupted",), True), figures)
    assert 0 < stopped.index("Interrupted.") < stopped.index("<h1>")
    assert "Interrupted." not in render(diagnosis, figures)


def test_names_cannot_become_markup(diagnosis):
    benign = page_of(named(diagnosis, lambda n: f"name {n}"))
    hostile = drawn_page_of(named(diagnosis, lambda n: f"{HOSTILE}{n}"))
    assert hostile.tags == benign.tags and len(hostile.tags) > 500
    assert HOSTILE in hostile.text


def named(diagnosis, text):
    """Return a diagnosis with text(n) as its n-th string, and as every key."""
    diagnosis, _ = with_strings(diagnosis, text)
    parameters = with_mapping_keys(diagnosis.effects[0].parameters, text)
    groups = with_mapping_keys(diagnosis.groups, text)
    diagnosis = with_leaf(diagnosis, ("effects", 0, "parameters"), parameters)
    return with_leaf(diagnosis, ("groups",), groups)


def test_nothing_found_and_nothing_known(diagnosis):
    nan = float("nan")
    gap = Gap(nan, nan, nan, float("inf"), None, None, [], (nan, nan), None)
    page = drawn_page_of(made_up_diagnosis(**EMPTY, gap=gap, seconds=nan))
    assert not page.open and "unknown" in page.text
    assert not re.search(r"\b(nan|inf|None)\b", page.all_words)


def test_every_number_may_be_unknown(diagnosis):
    for path, value in list(leaves(diagnosis)):
        if is_number(value):
            diagnosis = with_leaf(diagnosis, path, float("nan"))
        elif isinstance(value, np.ndarray):
            diagnosis = with_leaf(diagnosis, path, value * np.nan)
    page = drawn_page_of(diagnosis)
    assert not page.open and "unknown" in page.text
    assert not re.search(r"\b(nan|inf|None)\b", page.all_words)


def test_without_a_power_limit_the_frames_cannot_show_it(diagnosis, figures):
    assert Page(render(diagnosis, figures)).text.count("cannot be seen") == 1


def test_a_parameter_on_its_bound_has_an_interval_without_width(diagnosis, figures):
    path = ("effects", 0, "parameters", "r6")
    stuck = with_leaf(diagnosis, path, Estimate(0.25, "1", (0.25, 0.25)))
    assert "0.2500 0.250 to 0.250 relative" in Page(render(stuck, figures)).text


def test_one_file_without_network_or_script(folder):
    html = (folder / "report.html").read_text()
    page = Page(html)
    assert not page.open and page.images and page.links
    assert all(i["src"].startswith("data:image/png;base64,") for i in page.images)
    assert [link for link in page.links if link.lstrip("#") not in page.ids] == []
    assert not re.search(r"url\(|@import|https?:", page.style)
    assert not {"script", "link", "iframe"} & {tag for tag, _ in page.tags}


def test_the_pictures_lie_beside_the_page(folder):
    page = Page((folder / "report.html").read_text())
    shown = {base64.b64decode(i["src"].partition(",")[2]) for i in page.images}
    files = {path.read_bytes() for path in folder.glob("*.png")}
    assert shown == files and len(files) == 5 + 1 + 2 * 3 + 2 * 4 + 1 + 2 + 2 * 3


def test_every_picture_has_words_with_numbers(folder):
    page = Page((folder / "report.html").read_text())
    assert [i["alt"] for i in page.images if not re.search(r"\d", i["alt"])] == []


def test_same_diagnosis_same_bytes(diagnosis, folder, tmp_path):
    with matplotlib.rc_context({"font.size": 30, "savefig.facecolor": "red"}):
        write_report(diagnosis, tmp_path)
    names = sorted(path.name for path in folder.iterdir())
    assert sorted(path.name for path in tmp_path.iterdir()) == names
    for name in names:
        assert (tmp_path / name).read_bytes() == (folder / name).read_bytes(), name


def test_pictures_of_an_earlier_report_go_and_other_files_stay(diagnosis, tmp_path):
    ours = ("frame_09_before.png", "curve_07.png", "pattern_flat_after.png")
    for name in (*ours, "dark_levels.png", "mine.png", "verdict.json"):
        (tmp_path / name).write_text("x")
    write_report(made_up_diagnosis(**EMPTY), tmp_path)
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"report.html", "gap.png", "mine.png", "verdict.json"}


@pytest.mark.parametrize("library", ["jinja2", "PIL"])
def test_a_missing_library_is_named(diagnosis, tmp_path, monkeypatch, library):
    few = made_up_diagnosis(**{**EMPTY, "pictures": diagnosis.pictures[:1]})
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(ValueError, match=r"cg2raw\[diagnose\]"):
        write_report(few, tmp_path / "report")
    assert not (tmp_path / "report").exists()


@pytest.mark.slow
def test_eight_noisy_frames_make_at_most_three_megabytes(tmp_path):
    rng = np.random.default_rng(1)
    shown = [rng.uniform(0, 1, (512, 512, 3)).astype(np.float32) for _ in range(3)]
    z = [rng.standard_normal((512, 512)).astype(np.float32) for _ in range(2)]
    frames = [Picture(f"{n}.dng", "scene", *shown, *z) for n in range(8)]
    write_report(made_up_diagnosis(pictures=frames), tmp_path)
    assert (tmp_path / "report.html").stat().st_size <= 3e6


def test_a_runner_up_that_was_ahead_says_by_which_rule_it_lost(diagnosis, figures):
    """And is not "too close to call": nobody called it ambiguous."""
    rule = "read_noise gains more, but is noise."
    rows = replace(
        diagnosis.effects[1],
        alternatives=[Alternative("read_noise", 43.7)],
        ambiguous_with=[],
        rule=rule,
    )
    text = Page(render(replace(diagnosis, effects=[rows]), figures)).text
    assert ", 12.0 nats ahead." in text
    assert f"Why this name: {rule}" in text
    assert "too close to call" not in text
    doubtful = replace(rows, ambiguous_with=["read_noise"])
    text = Page(render(replace(diagnosis, effects=[doubtful]), figures)).text
    assert "12.0 nats ahead \u2014 too close to call" in text


def test_the_time_limit_is_told(diagnosis, figures):
    page = render(replace(diagnosis, time_limit_reached=True), figures)
    assert "Time limit." in Page(page).text and "--time-limit" in page
    assert "Time limit." not in Page(render(diagnosis, figures)).text
