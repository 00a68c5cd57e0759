# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Captures of a monochrome sensor, whose effects the registry's simulation planted."""

from dataclasses import replace

import numpy as np
import pytest

import cg2raw
from cg2raw.diagnose import diagnose, read_captures
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.darks_and_flats import darks_and_flats
from cg2raw.diagnose.effects.catalogue import candidates
from diagnose.closed_loop import simulated
from diagnose.planted import FULL_WELL, READ, listed, standard_set, unexplained
from oracles import cameras
from tiers import first_fast

ISO, SHAPE = 100.0, (96, 128)
KINDS = ("dark", "flat", "scene")
SHADING = {"r2": -0.25, "r4": 0.05, "r6": 0.0, "tilt_x": 0.01, "tilt_y": 0.0}
SHADING |= {"tilt_x_r2": 0.0, "tilt_y_r2": 0.0}
COLORED = {"white_balance", "color_matrix", "color_shading", "gr_gb_imbalance"}
COLORED |= {"lateral_chromatic_aberration"}
# Effect, its parameters, the one that is compared, how well six frames of a kind know
# it (four standard errors of what is measured, relative).
PLANTED = [
    ("exposure", {"gain": 0.05}, "gain", 0.02),
    ("prnu", {"sigma": 0.01}, "sigma", 0.05),
    ("black_level", {"offset_00": -4e-4}, "offset_00", 0.05),
    ("dark_current", {"per_second": 2e-3}, "per_second", 0.02),
    ("veiling_glare", {"uniform": 0.02, "wide": 0.0}, "uniform", 0.3),
    ("lens_shading", SHADING, "r2", 0.1),
]


def sensor_of(effects=None, black=256, white=16383, **noise):
    """Return a sensor of 9 DN per read noise, as that of `planted`, or fewer."""
    row = {"iso": ISO, "beta1": 1 / FULL_WELL, "beta2": READ**2, **noise}
    fields = {"noise": [row], "effects": listed(effects or {}), "white_level": white}
    return cg2raw.Sensor.from_json(
        cameras.mono_text(id="mono", black_level=black, **fields)
    )


def captures_of(truth, assumed=None, kinds=KINDS, shape=SHAPE):
    """Return the standard set of one sensor, to be compared with another."""
    some = [c for c in standard_set(shape) if c.kind in kinds]
    shown = simulated(CaptureSet(truth, some), truth)
    return replace(shown, sensor=assumed or sensor_of())


def found_in(truth):
    return diagnose(captures_of(truth), threads=1)


def test_nothing_is_named_where_nothing_is_hidden():
    found = found_in(sensor_of())
    assert (found.verdict, found.effects) == ("consistent", [])
    assert 0.98 < found.gap.chi2_before < 1.02


@pytest.mark.parametrize(
    ("name", "parameters", "compared", "within"),
    first_fast(PLANTED, 1),
    ids=[planted[0] for planted in PLANTED],
)
def test_what_is_planted_is_named_first(name, parameters, compared, within):
    found = found_in(sensor_of({name: parameters}))
    names = [effect.name for effect in found.effects]
    assert names == [name]
    value = found.effects[0].parameters[compared].value
    assert value == pytest.approx(parameters[compared], rel=within)
    repaired = cg2raw.Sensor.from_json(found.profile_json)
    assert repaired.cfa == "MONO"
    assert {effect["name"] for effect in repaired.effects} == set(names)


@pytest.mark.parametrize(
    ("name", "beta", "factor"),
    first_fast([("read_noise", "beta2", 1.3), ("shot_noise", "beta1", 1.3)], 1),
)
def test_noise_of_the_one_site_is_named_and_repaired(name, beta, factor):
    true = {"beta1": 1 / FULL_WELL, "beta2": READ**2}[beta] * factor
    found = found_in(sensor_of(**{beta: true}))
    assert [effect.name for effect in found.effects] == [name]
    (row,) = cg2raw.Sensor.from_json(found.profile_json).noise
    assert row[beta] == pytest.approx([true], rel=0.05)


@pytest.mark.parametrize(
    ("white", "noise", "lights"), first_fast([(2047, 1.2, 2), (16383, 13.0, 1)], 1)
)
def test_noise_that_is_cut_at_zero_hides_no_effect(white, noise, lights):
    """Without a pedestal a dark shows half of its noise. noise : DN."""
    read, levels = noise / white, {"black": 0, "white": white}
    sigma, levels = 0.3 * read, levels | {"beta2": read**2}
    true = sensor_of({"column_fixed_pattern": {"sigma": sigma}}, **levels)
    bare = sensor_of(**levels)
    captures = captures_of(true, bare, ("dark", "flat"), (64, 96))
    dim = [c for c in captures.captures if lights > 1 or c.scene()[0] < 0.3]
    found = diagnose(replace(captures, captures=dim), details=False, threads=1)
    assert found.verdict == "explained"
    [effect] = found.effects
    assert effect.name == "column_fixed_pattern"
    assert effect.parameters["sigma"].value == pytest.approx(sigma, rel=0.15)
    assert found.gap.chi2_after == pytest.approx(1, abs=0.02)


@pytest.mark.parametrize(
    ("splits", "verdict"),
    [(("fit", "select", "report"), "explained"), (("report",), "unexplained")],
)
def test_full_wells_show_in_flats_that_nothing_repeats(splits, verdict):
    """They are named if the splits that decide have some, and else said to be there."""
    full, bare = (
        captures_of(sensor_of(one), kinds=("dark", "flat"), shape=(64, 96))
        for one in ({"full_well": {"below_white": 0.6}}, None)
    )
    pairs = zip(full.captures, bare.captures, strict=True)
    captures = [one if one.group in splits else other for one, other in pairs]
    found = diagnose(replace(bare, captures=captures), details=False, threads=1)
    assert found.verdict == verdict
    values = {one.name: one.parameters["below_white"].value for one in found.effects}
    named = {"full_well": pytest.approx(0.6, abs=1e-3)}
    assert values == (named if verdict == "explained" else {})
    places = [one.where for one in found.unexplained if one.name == "full wells"]
    level = "light brings no more noise from 6451 DN above black on"
    assert places == ([] if values else [level])


def test_darks_of_two_codes_tell_no_black_level():
    """Noise of 0.3 DN without a pedestal: one share of darks, two unknowns."""
    bare = sensor_of(black=0, white=4095, beta2=(0.3 / 4095) ** 2)
    found = darks_and_flats(captures_of(bare, bare, ("dark", "flat"), (64, 96)))
    assert (list(found.names), unexplained(found)) == ([], [])
    assert any(one.startswith("Darks have two codes") for one in found.frames.notes)


@pytest.mark.parametrize("kinds", [KINDS, ("dark", "scene")])
def test_noise_that_no_profile_states_is_estimated(kinds):
    """Darks alone do not tell that of light."""
    fields = {"id": "mono", "black_level": 256, "noise": None}
    unmeasured = cg2raw.Sensor.from_json(cameras.mono_text(**fields))
    found = diagnose(captures_of(sensor_of(), unmeasured, kinds), threads=1)
    assert found.effects == []
    (row,) = cg2raw.Sensor.from_json(found.profile_json).noise
    assert row["beta1"] == pytest.approx([1 / FULL_WELL], rel=0.1)


def test_what_tells_colours_apart_is_no_candidate():
    names = {effect.name for effect in candidates("MONO")}
    everything = {effect.name for effect in candidates("RGGB")}
    assert everything - names == COLORED | {"noise_reduction"}
    (offset,) = (e for e in candidates("mono") if e.name == "black_level")
    assert offset.parameters == ("offset_00",)


def manifest_of(folder, lines, top=""):
    (folder / "mono.json").write_text(sensor_of().to_json())
    path = folder / "captures.yaml"
    path.write_text(f"sensor: mono.json\niso: {ISO}\n{top}frames:\n{lines}")
    return path


@pytest.fixture
def files(tmp_path):
    """Write three darks and six flats, DNG and .npy in turns; return their lines."""
    lines = []
    for number in range(9):
        kind, sensor = "dark" if number < 3 else "flat", sensor_of()
        level = 0.0 if number < 3 else 0.3 + 0.2 * (number % 2)
        grey = np.full((*SHAPE, 3), level, np.float32)
        raw = sensor.simulate(grey, iso=ISO, frame=number, convention="sensor")
        name = f"{kind}_{number}.{'npy' if number % 2 else 'dng'}"
        if number % 2:
            np.save(tmp_path / name, np.asarray(raw))
        else:
            cg2raw.write_dng(tmp_path / name, raw)
        scene = "" if number < 3 else f", scene: {level:.1f}"
        lines.append(f"  - {{file: {name}, kind: {kind}, exposure_time: 1{scene}}}\n")
    return "".join(lines)


def test_files_need_no_illuminant(files, tmp_path):
    captures = read_captures(manifest_of(tmp_path, files))
    assert captures.sensor.cfa == "MONO"
    words = next(note for note in captures.notes if note.startswith("no scenes"))
    assert "blur, crosstalk and glare" in words and "colour" not in words
    found = diagnose(captures, only=("exposure", "read_noise", "prnu"), threads=1)
    assert (found.verdict, found.effects) == ("consistent", [])


def test_only_darks_say_nothing_of_colour(files, tmp_path):
    darks = "".join(line for line in files.splitlines(True) if "dark" in line)
    (note,) = (
        note
        for note in read_captures(manifest_of(tmp_path, darks)).notes
        if note.startswith("only darks")
    )
    assert "gain, optics and all else" in note


def test_a_white_balance_is_no_nuisance(files, tmp_path):
    path = manifest_of(tmp_path, files, "nuisance: [exposure, white_balance]\n")
    with pytest.raises(ValueError, match=r":3: nuisance has white_balance.*monochrome"):
        read_captures(path)
