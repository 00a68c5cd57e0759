# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is said of two sets of frames, by what is known of each frame."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from cg2raw.match.comparison import (
    cast,
    compare,
    exposure_words,
    levels_of,
    rows_of,
    spread_note,
    tone_note,
)
from cg2raw.match.frame import PROBABILITIES, Frame
from cg2raw.match.shift import Shift

COUNT = 12
GREY = np.log2(0.18)


def frame(level, contrast=2.0, **fields):
    """Return a Frame of normal levels, stops; its quarters are @contrast apart. Its
    thumbnail shows no scene."""
    deviation = contrast / (norm.ppf(0.75) - norm.ppf(0.25))
    known = {
        "black_bins": 0.0, "white_bins": 0.0, "black": 0.0, "clipped": 0.0,
        "red": 0.0, "blue": 0.0, "saturation": 1.0, "sharpness": 0.5, "noise": 0.01,
    }  # fmt: skip
    quantiles = level + deviation * norm.ppf(PROBABILITIES)
    nothing = np.full((16, 16), np.nan, np.float16)
    return Frame("a", quantiles, **(known | fields), thumbnail=nothing)


def frames(middle, spread=2.0, count=COUNT, **fields):
    """Return frames whose levels are @spread around a middle."""
    levels = middle + spread * np.linspace(-0.5, 0.5, count)
    return [frame(level, **fields) for level in levels]


RENDERS = frames(-5.0)


def test_frames_of_no_level_are_bounds_or_left_out_and_counted():
    white, black = frame(-1.0, white_bins=0.5), frame(-9.0, black_bins=0.5)
    captures = [*frames(-3.0), white]
    found = compare("s", captures, [*RENDERS, black, black])
    assert found.notes[:2] == (
        "2 renders without light: left out of the exposure",
        "1 capture of which more than half is clipped or black: taken as a bound",
    )
    assert found.fields()["captures"] == 13 and found.fields()["renders"] == 14
    assert found.fields()["levels"]["renders"][0] == [0.0, -6.0]
    levels = levels_of([captures[0], white, black], [0.5, 1.0, 2.0])
    numbers = levels.known, levels.above, levels.below
    assert np.concatenate(numbers).tolist() == [-4.5, -2.0, -11.0]


@pytest.mark.parametrize(
    ("captures", "renders", "said"),
    [
        ([*RENDERS, *13 * [frame(-1, white_bins=0.6)]], RENDERS, "captures is clipped"),
        (RENDERS, [*RENDERS[:9], frame(-9, black_bins=1.0)], "renders is clipped"),
        (RENDERS[:9], RENDERS, "9 captures: an exposure is inferred from 10"),
        (RENDERS, RENDERS[:1], "1 render: an exposure is inferred from 10"),
    ],
)
def test_too_few_frames_of_known_level_tell_no_exposure(captures, renders, said):
    with pytest.raises(ValueError, match=said):
        compare("s", captures, renders)


def test_a_tone_that_differs_is_said_with_what_it_does_to_the_exposure():
    """About grey, renders at -5 stops would be moved by half of 2.53 stops down."""
    [note] = tone_note(frames(-3.0, contrast=3.0), RENDERS)
    assert "contrast of captures is 1.50 times that of renders" in note
    assert note.endswith(f"{0.5 * (5 + GREY):+.2f} stops more")
    for contrast in (2.15, 1.86, 0.0, np.nan):  # a tenth; not known
        assert tone_note(frames(-3.0, contrast=contrast), RENDERS) == []
    [note] = tone_note(frames(-3.0, contrast=0.4), frames(-5.0, contrast=0.8))
    assert "contrast of captures is 0.50 times that of renders" in note


@pytest.mark.parametrize(("spread", "is_said"), [(1.5, True), (1.7, False)])
def test_captures_whose_levels_vary_less_were_metered(spread, is_said):
    notes = spread_note(frames(-3.0, spread), RENDERS)
    assert [("no drawn exposure" in note) for note in notes] == [True] * is_said


def test_a_cast_is_that_of_frames_which_show_colours():
    unseen = replace(RENDERS[0], red=np.nan)
    captures = [*frames(-3.0, red=0.3), unseen]
    renders = [*(replace(one, red=0.1) for one in RENDERS), unseen]
    assert cast("red", captures, renders, []).median == pytest.approx(0.2, abs=0.02)
    pairs = [(n, len(RENDERS) - n) for n in range(len(RENDERS) + 1)]
    found = cast("red", captures, renders, pairs)
    assert (found.median, found.spread) == pytest.approx((0.2, 0))
    with pytest.raises(ValueError, match="too few frames show colours"):
        cast("red", captures[3:], renders, [])


def test_the_table_says_what_renders_are_beside_captures():
    captures = frames(-3.0, clipped=0.02, saturation=0.5, red=0.25, blue=np.nan)
    renders = frames(-5.0, clipped=0.004, contrast=3.0, sharpness=np.nan)
    rows = {row.name: row for row in rows_of(compare("s", captures, renders))}
    for share, words in ((5, "are 3.2 stops darker"), (95, "are 0.8 stops darker")):
        row = rows[f"luminance that {share}% of a frame is below"]
        assert row.sentence.endswith(f" of your renders {words}")
        assert row.captures == pytest.approx(
            3 - 2 * norm.ppf(share / 100) / 1.349, 1e-3
        )
    assert {name: row.sentence for name, row in list(rows.items())[3:]} == {
        "clipped samples": "They clip 0.4 % of samples where captures clip 2 %",
        "black samples": "They blacken 0 % of samples where captures blacken 0 %",
        "saturation": "They are twice as saturated as captures",
        "contrast": "They are 1.5 times as rich in contrast",
        "sharpness": "The frames do not show their sharpness",
        "noise": "They are just as noisy where they are flat",
        "red over green": "After white balance they are 0.25 stops less red",
        "blue over green": "The frames do not show how blue they are",
    }
    assert rows["clipped samples"].captures == pytest.approx(2)


def test_an_exposure_is_said_with_its_intervals():
    words = exposure_words(Shift(1.5, 0.7, (), (1.25, 1.75), (0.5, 1.0)))
    assert words.startswith("Add +1.50 stops to your renders (+1.25 to +1.75), with a ")
    assert words.endswith("0.70 (0.50 to 1.00); the intervals hold with 99% confidence")
