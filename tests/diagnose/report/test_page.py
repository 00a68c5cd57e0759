# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""report.html shows all of a diagnosis, safely, alike each time, in one file."""

import math
import re
import sys
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from html.parser import HTMLParser

import numpy as np
import pytest

from cg2raw.diagnose.diagnosis import (
    VERDICTS,
    Alternative,
    DetectionLimit,
    Gap,
    Picture,
    ResidualTest,
)
from cg2raw.diagnose.report import charts, page, write_report
from cg2raw.diagnose.report.charts import curve, histograms, svg_of
from cg2raw.diagnose.report.page import page_of, value_of
from cg2raw.diagnose.report.values import Shown
from cg2raw.io.report_page import html_of
from diagnose.made_up_diagnosis import made_up_diagnosis

EMPTY = {
    "effects": [], "tests_before": [], "tests_after": [], "unexplained": [],
    "detection_limits": [], "next_captures": [], "notes": [],
    "groups": {}, "pictures": [], "curves": [], "charts": [],
    "histogram_before": None, "histogram_after": None, "profile_json": "",
}  # fmt: skip
HOSTILE = (
    "<script>alert(1)</script><img src=x onerror=alert(2)>\"'&amp; {{ 7 * 7 }} $x$"
)
VOID = {"meta", "img", "rect", "path", "circle", "polyline", "polygon"}
MOST_BYTES = 500_000
# What is not shown as it stands: words by which a chart is drawn, and units that are
# turned into those that are measured.
SILENT = {
    *("form", "scale", "unit", "effect"),
    *("discriminating_captures", "profile_json", "kind"),
}


class Page(HTMLParser):
    """The parts of a page: tags with the names of their attributes, text, images."""

    def __init__(self, html):
        super().__init__()
        self.tags, self.words, self.images, self.open, self.style = [], [], [], [], ""
        self.feed(html)
        self.close()

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.tags.append((tag, tuple(sorted(values))))
        if tag == "img":
            self.images.append(values)
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


def children(node):
    """Return [(key, child)] of a data class, mapping or sequence; none of a leaf."""
    if is_dataclass(node):
        return [(field.name, getattr(node, field.name)) for field in fields(node)]
    if isinstance(node, Mapping):
        return list(node.items())
    if isinstance(node, (list, tuple)):
        return list(enumerate(node))
    return []


def leaves(node, path=()):
    """Yield (path, value) of each leaf."""
    below = children(node)
    for key, child in below:
        yield from leaves(child, (*path, key))
    if not below and not isinstance(node, (list, tuple, Mapping)):
        yield path, node


def with_leaf(node, path, value):
    """Return the tree with @value at @path; nothing of @node is changed."""
    if not path:
        return value
    key, *rest = path
    child = with_leaf(dict(children(node))[key], rest, value)
    if is_dataclass(node):
        return replace(node, **{key: child})
    if isinstance(node, Mapping):
        return {**node, key: child}
    return type(node)(child if n == key else old for n, old in enumerate(node))


def paths_of_strings(tree):
    """Return the paths of all strings, in order."""
    return [path for path, value in leaves(tree) if isinstance(value, str)]


def with_mapping_keys(mapping, text):
    """Return a mapping with text(n) as its n-th key."""
    return {text(n): value for n, value in enumerate(mapping.values())}


def is_number(value):
    """Whether a leaf is a number; an array or truth value is none."""
    return isinstance(value, (int, float)) and not isinstance(value, (bool, np.bool_))


@pytest.fixture(scope="module")
def diagnosis():
    return made_up_diagnosis()


def html(diagnosis):
    return html_of(page_of(diagnosis))


def shown(diagnosis):
    return Page(html(diagnosis))


def marked(diagnosis, text):
    """Return a diagnosis with text(n) as its n-th string, but SILENT ones, and {path:
    text} of them."""
    paths = [p for p in paths_of_strings(diagnosis) if p[-1] not in SILENT]
    for n, path in enumerate(paths):
        diagnosis = with_leaf(diagnosis, path, text(n))
    return diagnosis, {path: text(n) for n, path in enumerate(paths)}


EACH = [Shown(f"m{n}", f"{n}.0", f"{n} to {n + 1} %", "%") for n in range(5)]


@pytest.mark.parametrize(
    ("sentence", "each", "value", "interval"),
    [
        ("Blur: 2 px.", EACH[:1], "m0 0.0 %", "95 %: 0 to 1 %"),
        ("Blur: 2 px.", EACH[:2], "2 px", "95 %: m0 0 to 1 %; m1 1 to 2 %"),
        (
            "Blur: r2 0.1, r4 3.",  # no words of its own
            EACH,
            "M0 0.0 %, m1 1.0 %",
            "95 %: m0 0 to 1 %; m1 1 to 2 %; m2 2 to 3 %; 2 more in the table",
        ),
        ("Blur: strong.", [], "strong", ""),
        ("", [], "without a value", ""),
    ],
)
def test_a_card_tells_how_strong_an_effect_is(
    diagnosis, sentence, each, value, interval
):
    finding = replace(diagnosis.effects[0], sentence=sentence)
    assert value_of(finding, each) == (value, interval)


def test_the_bar_of_a_gain_is_its_logarithm_over_that_of_the_largest(diagnosis):
    largest, other = (one.gain_nats for one in diagnosis.effects)
    shares = [next(page.side(one, diagnosis))[2] for one in diagnosis.effects]
    assert shares == pytest.approx(
        [100, 100 * math.log(1 + other) / math.log1p(largest)]
    )


@pytest.mark.parametrize(
    ("before", "after", "shown"),
    [
        (None, None, []),
        ((0.1, 0.3), None, [("0.10 to 0.30", "unknown")]),
        (None, (0.1, 0.3), [("", "0.10 to 0.30")]),
    ],
)
def test_an_interval_of_the_gap_is_shown_where_it_is_known(before, after, shown):
    gap = Gap(0.2, 0.2, 1.1, 1.1, [], before, after)
    rows = page.numbers(made_up_diagnosis(**EMPTY, gap=gap))
    assert [ends for name, *ends in rows if name == "95 % interval"] == list(
        map(list, shown)
    )


@pytest.mark.parametrize(
    ("count", "words"),
    [
        (1, "0.10 (r2)"),
        (2, "0.10 (r2), 0.20 (r4)"),
        (4, "0.10 (r2), 0.20 (r4) and 2 more"),
    ],
)
def test_two_limits_of_an_effect_are_told_and_how_many_more(count, words):
    names = ("r2", "r4", "r6", "tilt_x")[:count]
    found = [
        DetectionLimit("lens_shading", name, n / 10, "1")
        for n, name in enumerate(names, 1)
    ]
    box = page.limits(made_up_diagnosis(**EMPTY | {"detection_limits": found}))
    assert box.pairs == [("Lens shading", words)]


def test_residual_tests_that_leave_most_come_first():
    """After what was found; by what was before, where that is alike or not known."""
    nats = {"a": (3.0, 0.1), "b": (1.0, 0.5), "c": (2.0, 0.1), "d": (9.0, math.nan)}
    tests = [
        [ResidualTest(name, 1.0, 0.5, each[n], "there") for name, each in nats.items()]
        for n in range(2)
    ]
    both = {"tests_before": tests[0], "tests_after": tests[1][:-1]}
    box = page.tests(made_up_diagnosis(**EMPTY | both))
    [table] = box.tables
    assert [row[0].lower() for row in table.rows] == ["b", "a", "c", "d"]
    assert [row[2:4] for row in table.rows][::3] == [
        ("1.0", "0.50"),
        ("9.0", "\N{EN DASH}"),
    ]
    assert box.note.endswith("leaves more than 0.50 nats per pixel")


def test_every_string_is_shown(diagnosis):
    changed, strings = marked(diagnosis, lambda n: f"mark{n}end")
    words = shown(changed).text.lower()
    hidden = [path for path, text in strings.items() if text not in words]
    whole = ("sensor_id", "verdict", "unexplained", "notes", "next_captures", "groups")
    whole += ("tests_before", "tests_after", "pictures")
    own = ("name", "where")  # of what is listed
    must = {p for p in strings if p[0] in whole or len(p) == 3 and p[2] in own}
    assert len(must) > 70 and [path for path in hidden if path in must] == []


def test_the_numbers_of_the_gap_and_of_each_effect_are_shown(diagnosis):
    page = html(diagnosis)
    silent = []
    for path, value in leaves(diagnosis):
        if path[0] in ("gap", "effects", "unexplained", "detection_limits", "seconds"):
            if isinstance(value, bool) or is_number(value):
                other = not value if isinstance(value, bool) else 1.7 * value + 1e-3
                if html(with_leaf(diagnosis, path, other)) == page:
                    silent.append(path)
    # Evidence is said in nats; of the residuals that are left, by what they cost.
    told = {"e_value", "statistic", "p_value"}
    assert {path[-1] for path in silent} <= told | {"gain_nats", "provisional"}


def drawings(diagnosis):
    """Return what each array of a diagnosis is drawn by."""
    pair = diagnosis.histogram_before, diagnosis.histogram_after
    return [
        *map(svg_of, diagnosis.charts),
        *map(curve, diagnosis.curves),
        histograms(*pair),
    ]


def test_every_array_is_drawn(diagnosis):
    drawn, count = drawings(diagnosis), 0
    for path, value in leaves(diagnosis):
        is_drawn = path[0] in ("charts", "curves") or path[0].startswith("histogram")
        if not is_drawn or path[-1] in ("low", "high"):
            continue
        if isinstance(value, np.ndarray) and path[:2] != ("charts", 3):
            other = value.astype(float)
            other[len(other) // 2 :] = 1.3 * other[len(other) // 2 :] + 0.3
            assert drawings(with_leaf(diagnosis, path, other)) != drawn, path
            count += 1
    assert count == 4 * 4 + 2 * 4 + 2 * 2


def test_noise_alone_has_a_normal_law(diagnosis, monkeypatch):
    monkeypatch.setattr(charts, "lines", lambda title, marks, *_: marks)
    law = histograms(diagnosis.histogram_before, None)[-1]
    assert np.trapezoid(law.y, law.x) == pytest.approx(1, abs=1e-3)
    assert np.average(law.x**2, weights=law.y) == pytest.approx(1, abs=2e-3)


@pytest.mark.parametrize("verdict", VERDICTS)
def test_the_verdict_is_one_sentence_with_a_badge(diagnosis, verdict):
    page = html(with_leaf(diagnosis, ("verdict",), verdict))
    heading = re.search(r"<h1>([^<]+)</h1>", page).group(1)
    assert len(heading) < 80 and "profile" in heading or verdict == "incomplete"
    assert len(re.findall(r'class="badge \w+"', page)) == 1
    assert verdict.replace("_", " ") in Page(page).text


def test_a_card_says_effect_value_interval_evidence_and_shows_it(diagnosis):
    card = page_of(diagnosis).cards[1]
    assert (card.title, card.tag) == ("Row noise", "readout")
    # 0.412 and 0.381 to 0.447 DN; electrons of 2.083 to a DN.
    assert card.value == "standard deviation 0.412 DN"
    assert card.interval == "95 %: 0.381 to 0.447 DN (0.794 to 0.931 e\u207b)"
    assert card.evidence.startswith("Whole rows, new in each frame; with it, ")
    assert "10\u00b9\u00b3 times as likely" in card.evidence  # 31.7 / ln 10 = 13.77
    (chart,) = card.charts
    for words in ("Noise of rows", "without it", "with it", "measured", "rms, DN"):
        assert words in chart
    assert "stroke-dasharray" in chart  # a line is told apart without its colour


def test_sites_have_their_colours_and_shapes(diagnosis):
    drawn = svg_of(diagnosis.charts[1])
    assert "#c62828" in drawn and "#5a9216" in drawn and ">Gb<" in drawn
    assert "<circle" in drawn and "m-3 -3h6v6h-6z" in drawn


def test_warnings_stand_on_top(diagnosis):
    for name, words in (
        ("interrupted", "Interrupted:"),
        ("time_limit_reached", "Time limit:"),
    ):
        stopped = html(with_leaf(diagnosis, (name,), True))
        assert 0 < stopped.index(words) < stopped.index("<h1>")
        assert words not in html(diagnosis)


def test_names_cannot_become_markup(diagnosis):
    benign = shown(named(diagnosis, lambda n: f"name {n}"))
    hostile = shown(named(diagnosis, lambda n: f"{HOSTILE}{n}"))
    assert hostile.tags == benign.tags and len(hostile.tags) > 400
    assert HOSTILE in hostile.text


def named(diagnosis, text):
    """Return a diagnosis with text(n) as its n-th string, and as every key."""
    diagnosis, _ = marked(diagnosis, text)
    groups = with_mapping_keys(diagnosis.groups, text)
    return with_leaf(diagnosis, ("groups",), groups)


def test_nothing_found_and_nothing_known():
    nan = float("nan")
    gap = Gap(nan, nan, nan, float("inf"), [], (nan, nan), None)
    page = shown(made_up_diagnosis(**EMPTY, gap=gap, seconds=nan))
    assert not page.open and "unknown" in page.text
    assert not re.search(r"\b(nan|inf|None)\b", page.text)


def test_every_number_may_be_unknown(diagnosis):
    for path, value in list(leaves(diagnosis)):
        if is_number(value):
            diagnosis = with_leaf(diagnosis, path, float("nan"))
        elif isinstance(value, np.ndarray):
            diagnosis = with_leaf(diagnosis, path, value * np.nan)
    page = html(diagnosis)
    assert not Page(page).open and "unknown" in page
    assert not re.search(r"\b(nan|inf|None)\b", page)


def test_what_cannot_be_seen_is_told_apart(diagnosis):
    text = shown(diagnosis).text
    assert "These frames cannot show: dark current." in text
    assert "Exposure 0.042 % (gain)" in text  # a limit has two digits and a unit


def test_one_file_without_network_or_script(diagnosis, tmp_path):
    write_report(diagnosis, tmp_path / "made" / "here")
    (file,) = (tmp_path / "made" / "here").iterdir()
    page = Page(file.read_text())
    assert file.name == "report.html" and not page.open and page.images
    assert all(i["src"].startswith("data:image/png;base64,") for i in page.images)
    assert [i["alt"] for i in page.images if not i["alt"]] == []
    assert not re.search(r"url\(|@import|https?:", page.style)
    assert not {"script", "link", "iframe"} & {tag for tag, _ in page.tags}


def test_every_picture_has_a_title(diagnosis):
    page = html(diagnosis)
    assert page.count("<svg ") == page.count("<title>") - 1  # and that of the window
    assert page.count('<svg viewBox="0 0 420 ') == page.count("<svg ") >= 6


def test_same_diagnosis_same_bytes(diagnosis):
    assert html(diagnosis) == html(diagnosis)


@pytest.mark.parametrize("library", ["jinja2", "PIL"])
def test_a_missing_library_is_named(diagnosis, tmp_path, monkeypatch, library):
    few = made_up_diagnosis(**{**EMPTY, "pictures": diagnosis.pictures[:1]})
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(ValueError, match=r"cg2raw\[diagnose\]"):
        write_report(few, tmp_path / "report")
    assert not (tmp_path / "report").exists()


def test_eight_noisy_frames_make_at_most_half_a_megabyte(tmp_path):
    rng = np.random.default_rng(1)
    signal = [rng.uniform(0, 1, (384, 512, 3)).astype(np.float32) for _ in range(3)]
    z = [rng.standard_normal((384, 512)).astype(np.float32) for _ in range(2)]
    frames = [Picture(f"{n}.dng", "scene", *signal, *z) for n in range(8)]
    write_report(made_up_diagnosis(pictures=frames), tmp_path)
    assert 100_000 < (tmp_path / "report.html").stat().st_size <= MOST_BYTES


def test_the_next_best_explanation_is_named_or_a_doubt(diagnosis):
    rows = replace(
        diagnosis.effects[1],
        alternatives=[Alternative("dsnu", 9.0), Alternative("read_noise", 43.7)],
        ambiguous_with=[],
    )
    text = shown(replace(diagnosis, effects=[rows])).text
    assert "Next best explanation: read noise, 12.0 nats ahead." in text
    doubtful = replace(rows, ambiguous_with=["read_noise"])
    text = shown(replace(diagnosis, effects=[doubtful])).text
    assert "Or it is read noise: these frames cannot tell." in text
