# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What report.html says in words that new users stumbled on."""

import re
from dataclasses import replace

import pytest

from cg2raw.diagnose.diagnosis import Estimate
from cg2raw.diagnose.report.frame_images import frame
from cg2raw.diagnose.report.page import render
from diagnose.leaves import with_leaf
from diagnose.made_up_diagnosis import made_up_diagnosis
from diagnose.report.test_page import Page, worded


@pytest.fixture(scope="module")
def diagnosis():
    return made_up_diagnosis()


@pytest.fixture(scope="module")
def figures(diagnosis):
    return worded(diagnosis)


def test_a_parameter_without_a_unit_is_relative(diagnosis, figures):
    path = ("effects", 0, "parameters", "r6")
    text = Page(render(diagnosis, figures)).text
    assert " relative" in text
    changed = with_leaf(diagnosis, path, Estimate(0.25, "px", (0.2, 0.3)))
    assert "0.200 to 0.300 px" in Page(render(changed, figures)).text


def test_the_page_says_on_top_what_a_nat_is(diagnosis, figures):
    text = Page(render(diagnosis, figures)).text
    assert text.index("One nat is a factor e") < text.index("Small print")
    assert text.count("factor e of probability") == 1


def test_what_remains_is_told_plainly(diagnosis, figures):
    text = Page(render(replace(diagnosis, unexplained=[]), figures)).text
    assert "Remaining residuals are consistent with noise." in text


def test_frames_are_counted_in_whole_numbers(diagnosis, figures):
    text = Page(render(diagnosis, figures)).all_words
    assert re.search(r"\b\d+ held-out (dark|flat)s?\b", text)
    assert not re.search(r"\.\d+ held-out (dark|flat)", text)


def test_a_simulated_picture_is_said_to_be_a_mean(diagnosis):
    captions = [image.caption for image in frame(diagnosis.pictures[0], 1, 1).images]
    assert captions == [
        "Measured",
        "Simulated mean before, without noise",
        "Simulated mean after, without noise",
    ]
