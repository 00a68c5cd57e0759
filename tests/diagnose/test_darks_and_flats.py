# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What one model of darks and flats names, in frames of the generator."""

import itertools
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.captures.reader import in_groups
from cg2raw.diagnose.darks_and_flats import (
    WithinCode,
    _check_codes,
    _nats_of_well,
    darks_and_flats,
)
from cg2raw.diagnose.effects.catalogue import names, of_images
from cg2raw.diagnose.verdict.values import values_of
from cg2raw.model import dark_levels, flat_levels, lags, selection
from cg2raw.model.amplifier_mismatch import NAME as MISMATCH
from cg2raw.model.full_well import FullWell
from cg2raw.model.shapes import (
    dust,
    heavy_tailed_noise,
    hot_pixels,
    pdaf_pixels,
    random_telegraph_noise,
)
from cg2raw.synthetic.captures import draw_hidden, simulate_captures
from cg2raw.synthetic.sensors import drawn_sensor
from cg2raw.synthetic.strengths import KINDS
from diagnose.closed_loop import simulated
from diagnose.planted import stating, unexplained
from tiers import first_fast, slow

SENSOR = drawn_sensor(5)


def found(strengths, seed=3, changed=lambda captures: captures):
    """Return what is found in the generator's captures, or in what is made of them."""
    hidden = draw_hidden(SENSOR, strengths, seed=seed)
    made = simulate_captures(SENSOR, hidden, seed=seed, twice=True)
    return darks_and_flats(replace(made, captures=changed(made.captures)))


def with_raw(capture, change):
    """Return a capture whose pixels are changed, (H, W) DN -> (H, W) DN."""
    return replace(capture, raw=lambda: change(capture.raw()).astype(np.uint16))


@pytest.mark.parametrize(
    "strengths",
    [
        slow({"exposure": 0.02}),
        {"lens_shading": 0.3, "crosstalk": 0.03},
        {"noise_reduction": 0.2, "black_level": 0.5},
        {"dark_current": 2.0, "row_noise": 0.3, "prnu": 0.01, "white_balance": 0.03},
    ],
    ids="+".join,
)
def test_names_are_those_that_are_hidden(strengths):
    """Where nothing is: tests/diagnose/verdict/test_constant.py."""
    assert set(found(strengths).names) == set(strengths)


SHAPES = dust, heavy_tailed_noise, hot_pixels, pdaf_pixels, random_telegraph_noise
PARTS = (
    dark_levels.LEVELS,
    flat_levels.CHANGES,
    set(selection.NAMES) - set(dark_levels.LEVELS),  # variances
    lags.NAMES,
    [MISMATCH],
    [module.__name__.rpartition(".")[2] for module in SHAPES],
)
OF_DARKS_AND_FLATS = sorted(name for part in PARTS for name in part)


def test_each_effect_is_in_one_part():
    """Images decide what no dark or flat shows, and those of light with flats."""
    of_light = {*flat_levels.CHANGES, "lens_shading", "color_shading"}
    assert sorted([*OF_DARKS_AND_FLATS, *of_images() - of_light]) == sorted(names())
    assert of_light < of_images()


@pytest.mark.slow
@pytest.mark.parametrize("name", OF_DARKS_AND_FLATS)
def test_each_is_named_alone(name):
    """At the middle of the strengths that the generator hides; six at once:
    tests/diagnose/verdict/test_constant.py."""
    strength = math.sqrt(KINDS[name].low * KINDS[name].high)
    diagnosed = found({name: strength}, seed=8)
    assert list(diagnosed.names) == [name]
    assert not unexplained(diagnosed)


STATED = {
    "lens_shading": {"r2": -0.3, "tilt_x": 0.05},
    "bias_structure": {"vertical": 2e-3},
    "hot_pixels": {"fraction": 2e-3, "rate": 2e-2},
}


def seen_by(sensor, profile):
    """What darks and flats of a sensor name, by the profile of another."""
    made = simulated(simulate_captures(SENSOR, {}, seed=3, twice=True), sensor)
    return darks_and_flats(replace(made, sensor=profile))


def test_a_shape_that_the_profile_states_is_no_finding():
    sensor = stating(SENSOR, STATED)
    made = seen_by(sensor, sensor)
    assert [*made.names] == unexplained(made) == [*made.frames.notes] == []


@pytest.mark.parametrize("name", ["lens_shading", "hot_pixels", slow("bias_structure")])
def test_a_shape_of_another_size_than_the_profile_states_is_named(name):
    least = {key: 0.3 * value for key, value in STATED[name].items()}
    made = seen_by(stating(SENSOR, STATED), stating(SENSOR, STATED | {name: least}))
    assert list(made.names) == [name]
    found = {v.parameter: v for v in values_of(made, [name]) if v.effect == name}
    for key, stated in least.items():
        beyond = stated if name == "lens_shading" else 0.0  # that adds to the profile's
        value, low, high = (
            getattr(found[key], end) for end in ("value", "low", "high")
        )
        truth = STATED[name][key] - beyond
        assert abs(value - truth) < 2 * max(high - value, value - low, 1e-9)


WIDEST = {"r2": 0.015, "x": 0.005, "y": 0.005}
WIDEST |= {"horizontal": 1e-4, "vertical": 1e-4, "offset": 5e-5, "response": 2e-3}


@pytest.mark.parametrize("way", ["horizontal", "vertical"])
def test_amplifiers_take_nothing_of_the_light_and_the_bias(way):
    """A strong fall-off, tilted along the step, and a ramp."""
    shading = {"r2": -0.3, "tilt_x": 0.04, "tilt_y": -0.03}
    steps = {f"{way}_offset": 1e-3, f"{way}_response": 5e-3}
    ramps = {"horizontal": 2e-3, "vertical": 2e-3}
    planted = {"lens_shading": shading, "bias_structure": ramps, MISMATCH: steps}
    made = seen_by(stating(SENSOR, planted), SENSOR)
    assert (set(made.names), unexplained(made)) == ({*planted}, [])
    found = {(v.effect, v.parameter): v for v in values_of(made, made.names)}
    for name, parameters in planted.items():
        for parameter, truth in parameters.items():
            one = found[name, parameter]
            half = (one.high - one.low) / 2
            assert one.value == pytest.approx(truth, abs=1.5 * half), parameter
            assert half < WIDEST[parameter.rpartition("_")[2]], parameter


@pytest.mark.parametrize("share", first_fast([0.5, 0.7], 1))
def test_a_full_well_below_the_brightest_flat_is_named_and_spoils_nothing(share):
    white, black = SENSOR.white_level, float(np.mean(SENSOR.black_level))

    def full(captures):
        flats = [c for c in captures if c.kind == "flat"]
        brightest = max(float(np.median(c.raw())) for c in flats) - black
        level = black + share * brightest

        def below(raw):
            rng = np.random.default_rng(int(raw.sum()))  # of each frame
            read = np.rint(level + rng.normal(0, 2.0, raw.shape))
            return np.where(raw > level, read, raw)

        return [with_raw(c, below) for c in captures]

    made = found({}, changed=full)
    assert list(made.names) == ["full_well"]
    [one] = (v for v in values_of(made, ["full_well"]) if v.effect == "full_well")
    level = (1 - one.value) * (white - black)
    flats = [c for c in made.captures.captures if c.kind == "flat"]
    assert level == pytest.approx(max(np.median(c.raw()) for c in flats) - black, 0.01)


def spoiled(capture, rows, columns):
    """A capture with white samples, which its mask leaves out."""

    counts = np.ones(capture.shape, bool)
    counts[rows, columns] = False
    white = with_raw(capture, lambda raw: np.where(counts, raw, SENSOR.white_level))
    return replace(white, mask=lambda: counts)


@pytest.mark.parametrize("rows", [slice(40), slice(40, 80)])
def test_a_band_that_a_mask_leaves_out_is_no_noise(rows):
    """40 of 112 rows, at the edge and inside."""
    band = rows, slice(None)

    def masked(captures):
        return [spoiled(c, *band) for c in captures if c.is_uniform]

    made = found({}, changed=masked)
    assert [*made.names] == unexplained(made) == [*made.frames.notes] == []


@pytest.fixture(scope="module")
def with_dead_lines():
    """What is found of a column that is dark in all frames, two rows that are bright,
    and PRNU."""

    def dead(raw):
        frame = raw.copy()
        frame[:, 31] = SENSOR.black_level[0]
        frame[[50, 77]] = SENSOR.white_level - 100
        return frame

    return found(
        {"prnu": 0.01}, changed=lambda every: [with_raw(c, dead) for c in every]
    )


def test_dead_lines_are_said_with_their_place(with_dead_lines):
    assert list(with_dead_lines.names) == ["prnu"]
    assert [note.rpartition(": ")[2] for note in with_dead_lines.frames.notes] == [
        *("row 50, 77.", "column 31.")
    ]


def test_a_dark_with_a_residual_image_is_left_out():
    """0.5 % of a scene in the first dark of each group: 11 names without that."""

    def lagging(captures):
        pictures = {c.group: c.raw() for c in captures if c.kind == "scene"}
        black = float(np.mean(SENSOR.black_level))
        rng = np.random.default_rng(0)

        def spoiled(raw, group):
            light = 0.005 * (pictures[group] - black)
            return np.rint(raw + light + rng.uniform(-0.5, 0.5, raw.shape))

        return [
            with_raw(c, lambda raw, group=c.group: spoiled(raw, group))
            if c.name.endswith("dark_0")
            else c
            for c in captures
        ]

    made = found({}, changed=lagging)
    assert list(made.names) == [] and len(made.frames.spoiled) == 3
    for group, note in zip(("fit", "select", "report"), made.frames.notes, strict=True):
        start = f"{group}_dark_0: has a residual image of {group}_scene_"
        assert note.startswith(start) and note.endswith("% of its light: left out.")


@pytest.mark.parametrize("single", [("dark",), ("dark", "flat")], ids="+".join)
def test_darks_that_do_not_repeat_have_the_noise_of_their_lines(single):
    """Beside flats that do, and beside flats that do not: rows that differ move levels
    by chance, and are no drift of the black level."""

    def once(captures):
        return [c for c in captures if c.kind not in single or "again" not in c.name]

    strengths = {"row_noise": 0.4, "prnu": 0.01}
    assert set(found(strengths, seed=1, changed=once).names) == set(strengths)


def test_flats_of_unknown_light_tell_no_exposure():
    def unknown(captures):
        return [replace(c, scene=None) if c.kind == "flat" else c for c in captures]

    strengths = {"exposure": 0.02, "prnu": 0.01}
    assert set(found(strengths, changed=unknown).names) == {"prnu"}


def test_flats_that_hold_no_light_tell_nothing_of_it():
    """Darks that are said to be flats: gains are not known, of some sites alone."""

    def unlit(captures):
        darks = itertools.cycle(c for c in captures if c.kind == "dark")
        return [
            replace(c, raw=next(darks).raw) if c.kind == "flat" else c for c in captures
        ]

    assert {"prnu", "shot_noise", "exposure"}.isdisjoint(found({}, changed=unlit).names)


def test_flats_of_one_light_alone():
    """They tell what is in proportion to light from nothing else, and take all else
    from the profile."""

    def one_light(captures):  # the second of each group's is the brighter one
        return [c for c in captures if c.kind == "flat" and c.set.endswith("flat_1")]

    strengths = {"prnu": 0.01, "lens_shading": 0.3, "shot_noise": 0.2}
    assert set(found(strengths, changed=one_light).names) == set(strengths)


SHADED = {"prnu": 0.02, "lens_shading": 0.4}


@pytest.mark.parametrize("strengths", [SHADED, slow({})], ids=len)
def test_single_frames_are_divided_by_columns(strengths):
    """One frame of each exposure time and light, a third of its columns to each group,
    without what a mask leaves out: there frames are white."""

    some = slice(20, 30), slice(40, 60)

    def single(captures):
        first = {}
        for one in (c for c in captures if c.is_uniform):
            light = tuple(one.scene()) if one.shows.light else ()
            first.setdefault((one.kind, one.exposure_time, light), one)
        each = (in_groups(spoiled(one, *some), None) for one in first.values())
        return [part for parts in each for part in parts]

    diagnosed = found(strengths, changed=single)
    assert set(diagnosed.names) == set(strengths)
    assert any("divided by columns" in note for note in diagnosed.frames.notes)


def test_values_are_in_units_of_the_registry(with_dead_lines):
    values = {(one.effect, one.parameter): one for one in with_dead_lines.values}
    prnu = values["prnu", "sigma"]
    assert prnu.low < 0.01 < prnu.high
    assert prnu.value == pytest.approx(0.01, rel=0.05)
    read = values["read_noise", "log_variance"]
    assert read.low < 0 < read.high


def test_scenes_alone_are_refused():
    with pytest.raises(ValueError, match="captures: no darks or flats"):
        found({}, changed=lambda every: [c for c in every if not c.is_uniform])


@pytest.mark.parametrize(
    ("stated", "nats"), [(None, 99.0), (0.2, 0.0), (0.25, 12.5), (0.5, 99.0)]
)
def test_a_full_well_that_the_profile_states_gains_what_it_is_off(stated, nats):
    """A well at 0.8 of white, known to 0.01, which gains 99 nats over none."""
    white = SENSOR.signal_range
    effects = {} if stated is None else {"full_well": {"below_white": stated}}
    well = FullWell((0,), 0.8 * white, 0.01 * white, 99.0)
    assert _nats_of_well(well, stating(SENSOR, effects)) == pytest.approx(
        nats, abs=1e-9
    )


@pytest.mark.parametrize(
    ("share", "frames", "is_enough"),
    [
        (0.03, 2, True),
        (0.02, 2, False),
        (0.02, 3, True),
        (0.03, 1, True),
        (0, 1, False),
    ],
)
def test_five_pixels_of_darks_are_off_the_commonest_code_in_both_of_two(
    share, frames, is_enough
):
    """By chance: a share's square of 10,000, of each pair of frames. Flats, of one code
    here, are not asked."""
    off = round(1e4 * frames * share)
    codes = np.array([[1e4 * frames - off, off], [0, 1e4 * frames]])
    groups = [SimpleNamespace(frames=[name]) for name in ("dark", "flat")]
    statistics = SimpleNamespace(
        is_flat=np.array([False, True]),
        frames=np.array([frames, frames]),
        planes=[SimpleNamespace(codes=codes, unmasked=10000)],
        groups=groups,
    )
    if is_enough:
        return _check_codes(statistics)
    percent = f"{100 * share:.2f}%"
    with pytest.raises(WithinCode, match=f"^dark: .* all but {percent} of its pixels"):
        _check_codes(statistics)
