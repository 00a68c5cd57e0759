# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What one model of darks and flats names, in frames of the generator."""

import json
from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.captures.reader import in_groups
from cg2raw.diagnose.darks_and_flats import darks_and_flats
from cg2raw.diagnose.effects.registry import stated_by
from cg2raw.diagnose.verdict.values import values_of
from cg2raw.sensor import Sensor
from cg2raw.synthetic.captures import draw_hidden, simulate_captures
from cg2raw.synthetic.sensors import drawn_sensor
from diagnose.closed_loop import simulated

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


DARK_CORNERS = {"name": "lens_shading", "parameters": {"r2": -0.3, "tilt_x": 0.05}}
SLOPING = {"name": "bias_structure", "parameters": {"vertical": 2e-3}}
HOT = {"name": "hot_pixels", "parameters": {"fraction": 2e-3, "rate": 2e-2}}


def stating(*effects):
    """The sensor with a profile that states effects."""
    entries = [one | {"parameters": stated_by(one, None)} for one in effects]
    return Sensor.from_json(
        json.dumps(json.loads(SENSOR.to_json()) | {"effects": entries})
    )


def seen_by(sensor, profile):
    """What darks and flats of a sensor name, by the profile of another."""
    made = simulated(simulate_captures(SENSOR, {}, seed=3, twice=True), sensor)
    return darks_and_flats(replace(made, sensor=profile))


def test_a_shape_that_the_profile_states_is_no_finding():
    sensor = stating(DARK_CORNERS, SLOPING, HOT)
    made = seen_by(sensor, sensor)
    assert (list(made.names), made.unexplained, list(made.notes)) == ([], [], [])


@pytest.mark.parametrize("name", ["lens_shading", "bias_structure", "hot_pixels"])
def test_a_shape_of_another_size_than_the_profile_states_is_named(name):
    effects = {one["name"]: one for one in (DARK_CORNERS, SLOPING, HOT)}
    least = {key: 0.3 * value for key, value in effects[name]["parameters"].items()}
    others = [one for one in effects.values() if one["name"] != name]
    profile = stating({"name": name, "parameters": least}, *others)
    made = seen_by(stating(*effects.values()), profile)
    assert list(made.names) == [name]
    found = {v.parameter: v for v in values_of(made, [name]) if v.effect == name}
    for key, stated in least.items():
        beyond = stated if name == "lens_shading" else 0.0  # that adds to the profile's
        value, low, high = (
            getattr(found[key], end) for end in ("value", "low", "high")
        )
        truth = effects[name]["parameters"][key] - beyond
        assert abs(value - truth) < 2 * max(high - value, value - low, 1e-9)


@pytest.mark.parametrize("share", [0.5, 0.7])
def test_a_full_well_below_the_brightest_flat_is_named_and_spoils_nothing(share):
    white, black = SENSOR.white_level, float(np.mean(SENSOR.black_level))

    def full(captures):
        flats = [c for c in captures.captures if c.kind == "flat"]
        brightest = max(float(np.median(c.raw())) for c in flats) - black
        level = black + share * brightest
        return replace(
            captures,
            captures=[
                replace(c, raw=lambda c=c: below(c, level)) for c in captures.captures
            ],
        )

    def below(capture, level):
        rng = np.random.default_rng(len(capture.name))
        raw = capture.raw()
        read = np.rint(level + rng.normal(0, 2.0, raw.shape))
        return np.where(raw > level, read, raw).astype(np.uint16)

    made = found({}, captures=full)
    assert list(made.names) == ["full_well"]
    [one] = (v for v in values_of(made, ["full_well"]) if v.effect == "full_well")
    level = (1 - one.value) * (white - black)
    flats = [c for c in made.captures.captures if c.kind == "flat"]
    assert level == pytest.approx(max(np.median(c.raw()) for c in flats) - black, 0.01)


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
