# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What one model of darks and flats names, in frames of the generator."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.captures.reader import in_groups
from cg2raw.diagnose.darks_and_flats import darks_and_flats
from cg2raw.synthetic.captures import draw_hidden, simulate_captures
from cg2raw.synthetic.sensors import drawn_sensor

SENSOR = drawn_sensor(5)


def found(strengths, seed=3, captures=lambda it: it):
    hidden = draw_hidden(SENSOR, strengths, seed=seed)
    made = simulate_captures(SENSOR, hidden, seed=seed, twice=True)
    return darks_and_flats(captures(made))


@pytest.mark.parametrize(
    "strengths",
    [
        {},
        {"exposure": 0.02},
        {"lens_shading": 0.3, "crosstalk": 0.03},
        {"noise_reduction": 0.2, "black_level": 0.5},
        {"dark_current": 2.0, "row_noise": 0.3, "prnu": 0.01, "white_balance": 0.03},
    ],
    ids=lambda strengths: "+".join(strengths) or "nothing",
)
def test_names_are_those_that_are_hidden(strengths):
    assert set(found(strengths).names) == set(strengths)


def spoiled(capture, rows, columns):
    """A capture with white samples, which its mask leaves out."""

    def raw():
        frame = capture.raw().copy()
        frame[rows, columns] = SENSOR.white_level
        return frame

    def mask():
        counts = np.ones(capture.shape, bool)
        counts[rows, columns] = False
        return counts

    return replace(capture, raw=raw, mask=mask)


def test_a_band_that_a_mask_leaves_out_is_no_noise():
    """The upper 40 of 112 rows: means of columns are of the others alone."""

    def masked(captures):
        some = [c for c in captures.captures if c.kind in ("dark", "flat")]
        band = slice(0, 40), slice(None)
        return replace(captures, captures=[spoiled(c, *band) for c in some])

    made = found({}, captures=masked)
    assert (list(made.names), made.unexplained, list(made.notes)) == ([], [], [])


def test_dead_lines_are_said_with_their_place():
    """A column that is dark in all frames, and two rows that are bright."""

    def dead(captures):
        def changed(capture):
            def raw():
                frame = capture.raw().copy()
                frame[:, 31] = SENSOR.black_level[0]
                frame[[50, 77]] = SENSOR.white_level - 100
                return frame

            return replace(capture, raw=raw)

        return replace(captures, captures=[changed(c) for c in captures.captures])

    made = found({"prnu": 0.01}, captures=dead)
    assert list(made.names) == ["prnu"]
    assert [note.rpartition(": ")[2] for note in made.notes] == [
        *("row 50, 77.", "column 31.")
    ]


def test_two_amplifiers_have_no_name_and_are_said():
    """Halves that differ by half a read noise."""
    made = found({"second_amplifier": 0.5})
    assert (list(made.names), made.unexplained) == ([], ["halves"])


def test_flats_of_unknown_light_tell_no_exposure():
    def unknown(captures):
        flats = [
            replace(c, scene=None) if c.kind == "flat" else c for c in captures.captures
        ]
        return replace(captures, captures=flats)

    strengths = {"exposure": 0.02, "prnu": 0.01}
    assert set(found(strengths, captures=unknown).names) == {"prnu"}


def test_flats_of_one_light_alone():
    """They tell what is in proportion to light from nothing else, and take all else
    from the profile."""

    def one_light(captures):
        flats = [c for c in captures.captures if c.kind == "flat"]
        brightest = {
            group: max(
                (c for c in flats if c.group == group), key=lambda c: c.raw().mean()
            ).set
            for group in {c.group for c in flats}
        }
        some = [c for c in flats if c.set == brightest[c.group]]
        return replace(captures, captures=some)

    strengths = {"prnu": 0.01, "lens_shading": 0.3, "shot_noise": 0.2}
    assert set(found(strengths, captures=one_light).names) == set(strengths)


SHADED = {"prnu": 0.02, "lens_shading": 0.4}


@pytest.mark.parametrize("strengths", [{}, SHADED], ids=len)
def test_single_frames_are_divided_by_columns(strengths):
    """One frame of each exposure time and light, a third of its columns to each group,
    without what a mask leaves out: there frames are white."""

    some = slice(20, 30), slice(40, 60)

    def single(captures):
        first = {}
        for one in captures.captures:
            if one.kind in ("dark", "flat"):
                light = tuple(one.scene()) if one.shows.light else ()
                first.setdefault((one.kind, one.exposure_time, light), one)
        each = (in_groups(spoiled(one, *some), None) for one in first.values())
        return replace(captures, captures=[part for parts in each for part in parts])

    diagnosed = found(strengths, captures=single)
    assert set(diagnosed.names) == set(strengths)
    assert any("divided by columns" in note for note in diagnosed.notes)


def test_values_are_in_units_of_the_registry():
    values = {(one.effect, one.parameter): one for one in found({"prnu": 0.01}).values}
    prnu = values["prnu", "sigma"]
    assert prnu.low < 0.01 < prnu.high
    assert prnu.value == pytest.approx(0.01, rel=0.05)
    read = values["read_noise", "log_variance"]
    assert read.low < 0 < read.high


def test_scenes_alone_are_refused():
    def scenes(captures):
        some = [c for c in captures.captures if c.kind == "scene"]
        return replace(captures, captures=some)

    with pytest.raises(ValueError, match="captures: no darks or flats"):
        found({}, captures=scenes)
