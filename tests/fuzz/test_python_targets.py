# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Manifests of captures and journals of data sets: the corpus, and what Hypothesis
makes of it; scripts/fuzz does the same by Atheris."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzz import python_targets
from fuzz.python_targets import TARGETS, Finding, check

HERE = Path(__file__).parent
FEW, MANY = 30, 20000
WORDS = {
    "captures": b"file kind scene gain illuminant set group iso exposure_time mask "
    b"chart patches corners unit count cut_below area rgb lab xyz patch sensor frames "
    b"nuisance dark flat unknown colorchecker dark.npy render.npy means.csv pipe nan "
    b"1e400 -1 0 .5 {} [] {a: [ - &a *a ! | > %% %YAML '' \" \\ud800 \\UFFFFFFFF",
    "journal": b'+{"path": - = ~ null true 1e400 -1 [] {} "order" "sha256" "image" '
    b'"bytes" "reason" "modified" "neutral" "crop" "cfa" "noise_effects" NaN \\ud800',
}


def corpus(kind):
    return sorted((HERE / kind).iterdir())


@st.composite
def edited(draw, kind):
    """Return a seed with pieces of it replaced by words or bytes."""
    seeds = [path.read_bytes() for path in corpus(kind)]
    data = draw(st.sampled_from(seeds))
    words = [*WORDS[kind].split(b" "), b"\n", b"\n  - ", b", ", b": ", b"\0", b"\xff"]
    pieces = st.one_of(st.sampled_from(words), st.binary(max_size=4))
    for _ in range(draw(st.integers(0, 6))):
        start = draw(st.integers(0, len(data)))
        end = min(len(data), start + draw(st.sampled_from((0, 0, 1, 4, 16, 200))))
        data = data[:start] + draw(pieces) + data[end:]
    return data


@pytest.fixture(scope="module", params=TARGETS)
def kind(request):
    return request.param


@pytest.fixture(scope="module")
def target(kind, tmp_path_factory):
    return TARGETS[kind](tmp_path_factory.mktemp(kind))


def test_the_corpus_brings_about_no_finding(kind, target):
    results = [target(path.read_bytes()) for path in corpus(kind)]
    # A corpus that the reader refuses at the door would show nothing.
    assert True in results and False in results and len(results) >= 24


def run(kind, target, examples, **options):
    @settings(max_examples=examples, deadline=None, database=None, **options)
    @given(edited(kind))
    def brings_about_no_finding(data):
        target(data)

    brings_about_no_finding()


def test_edited_seeds_bring_about_no_finding(kind, target):
    run(kind, target, FEW, derandomize=True)


@pytest.mark.slow
def test_many_edited_seeds_bring_about_no_finding(kind, target):
    run(kind, target, MANY)


@pytest.mark.parametrize(
    "error",
    [
        ValueError("another.yaml:1: is no number"),
        ValueError("a.yaml:1: is\ntwo lines"),
        ValueError("a.yaml:1: " + "x" * 2000),
        ValueError(""),
        UnicodeEncodeError("utf-8", "\ud800", 0, 1, "a.yaml"),
    ],
    ids=["other file", "lines", "long", "empty", "codec"],
)
def test_what_is_no_message_is_a_finding(error):
    check(ValueError("a.yaml:1: is no number"), "a.yaml")
    with pytest.raises(Finding):
        check(error, "a.yaml")


def test_another_error_is_not_taken_for_a_refusal():
    with pytest.raises(TypeError):
        python_targets.accepted(lambda: len(5))
