# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The diagnosis of darks and flats: verdict, gap, limits, profile, and what ends it."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.diagnose import darks_and_flats
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.pipeline import diagnose
from cg2raw.synthetic.captures import draw_hidden, simulate_captures
from cg2raw.synthetic.sensors import drawn_sensor
from cg2raw.synthetic.strengths import KINDS
from diagnose.closed_loop import simulated
from diagnose.planted import bare, changed, stating
from tiers import slow

SENSOR = drawn_sensor(5)
WHITE = SENSOR.signal_range


def captures_of(seed=3, sensor=SENSOR, changed=lambda capture: capture, **strengths):
    hidden = draw_hidden(sensor, strengths, seed=seed)
    made = simulate_captures(sensor, hidden, seed=seed, twice=True)
    kept = [changed(c) for c in made.captures if c.is_uniform]
    return replace(made, captures=kept)


def uneven_columns(capture):
    """Return a flat whose columns differ in their gain, of which no effect is."""
    if capture.kind == "dark":
        return capture
    factors = 1 + 0.02 * np.random.default_rng(0).standard_normal(capture.shape[1])
    raw = np.round(capture.raw() * factors).clip(0, SENSOR.white_level)
    return replace(capture, raw=lambda: raw.astype(np.uint16))


def names(found):
    return {effect.name for effect in found.effects}


@pytest.fixture(scope="module")
def explained():
    return diagnose(captures_of(prnu=0.01, row_noise=0.3))


@pytest.fixture(scope="module")
def consistent():
    """Return a diagnosis of frames of the profile, and the shares of its progress; the
    first is of another ISO, the last of another temperature."""
    captures, shares = captures_of(), []
    every = [replace(c, temperature=20.0) for c in captures.captures]
    every[0] = replace(every[0], iso=1.0)
    every[-1] = replace(every[-1], temperature=40.0)
    given = {"details": False, "progress": lambda _, share: shares.append(share)}
    return diagnose(replace(captures, captures=every), **given), shares


def test_frames_of_the_profile_are_consistent_with_it(consistent):
    found, shares = consistent
    assert (found.verdict, found.effects, found.unexplained) == ("consistent", [], [])
    assert shares == sorted(shares) and 0 <= shares[0] < shares[-1] <= 1
    assert found.gap.chi2_after == pytest.approx(1, abs=0.02)
    assert found.gap.before == found.gap.after == pytest.approx(0, abs=0.01)
    assert found.profile_json == ""


def test_what_is_named_closes_the_gap(explained):
    assert (explained.verdict, names(explained)) == ("explained", {"prnu", "row_noise"})
    gap = explained.gap
    low, high = gap.interval_after
    assert low < 0 < high < 0.5 * gap.before
    assert gap.chi2_before > 1.05
    assert gap.chi2_after == pytest.approx(1, abs=0.02)
    assert not set(gap.held_out) & set(explained.groups["fit"])


def test_the_profile_has_what_was_found(explained):
    profile = json.loads(explained.profile_json)
    found = {e["name"]: e for e in profile["effects"]}
    assert set(found) == {"prnu", "row_noise"}
    assert found["prnu"]["parameters"]["sigma"] == pytest.approx(0.01, rel=0.1)
    low, high = found["prnu"]["ci95"]["sigma"]
    assert low < found["prnu"]["parameters"]["sigma"] < high
    told = found["prnu"]["evidence"]["captures"]
    assert told == sorted(explained.groups["fit"] + explained.groups["select"])
    Sensor.from_json(explained.profile_json, "found")


def test_noise_goes_into_the_noise_table():
    found = diagnose(captures_of(read_noise=0.5), details=False)
    assert names(found) == {"read_noise"} and found.charts == []
    before, after = SENSOR.noise[0], json.loads(found.profile_json)["noise"][0]
    factor = np.exp(found.effects[0].parameters["log_variance"].value)
    assert after["beta2"] == pytest.approx(factor * np.array(before["beta2"]))
    assert after["beta1"] == pytest.approx(before["beta1"])


def test_what_no_effect_has_is_unexplained_with_where():
    found = diagnose(captures_of(changed=uneven_columns))
    assert found.verdict in ("unexplained", "partially_explained")
    assert any("columns differ in proportion" in one.where for one in found.unexplained)
    assert all(effect.provisional for effect in found.effects)


def test_a_profile_is_judged_as_it_is():
    found = diagnose(captures_of(prnu=0.01), most=0)
    assert (found.verdict, found.effects) == ("unexplained", [])
    assert found.gap.before == found.gap.after > 0.01
    assert any("single pixels" in one.name for one in found.unexplained)


@pytest.mark.parametrize(
    ("allowed", "named"),
    [({"without": ("prnu",)}, "row_noise"), slow({"only": ("prnu",)}, "prnu")],
)
def test_what_may_not_be_named_is_not(allowed, named):
    captures = captures_of(prnu=0.01, row_noise=0.3)
    found = diagnose(captures, **allowed, details=False)
    assert names(found) == {named} and found.verdict == "partially_explained"


# Of a limit; sets of frames, and how many of them at least, and at most, name it.
@pytest.mark.parametrize(
    ("name", "share", "sets", "least", "most"),
    [
        ("prnu", 0.5, 2, 0, 0),
        ("black_level", 1.0, 1, 1, 1),  # of all sites, each of which has that limit
        slow("prnu", 1.0, 20, 17, 20),
    ],
)
def test_a_limit_is_seen_in_95_of_100_sets(consistent, name, share, sets, least, most):
    limits = {one.name: one for one in consistent[0].detection_limits}
    assert limits["blur"].strength is None
    strength = share * limits[name].strength
    hidden = {} if name == "black_level" else {name: strength}
    more = 0.0 if hidden else strength * WHITE
    profile = changed(SENSOR, black_level=[b + more for b in SENSOR.black_level])
    found = [
        names(diagnose(replace(made, sensor=profile), details=False))
        for made in (captures_of(11 + n, **hidden) for n in range(sets))
    ]
    assert least <= sum(name in one for one in found) <= most


def test_limits_are_beyond_what_the_profile_has():
    """Of a square that frames show as well with it."""
    stated = stating(SENSOR, {"prnu": {"sigma": 0.01}})
    limits = [
        {one.name: one.strength for one in diagnose(captures).detection_limits}["prnu"]
        for captures in (captures_of(), replace(captures_of(prnu=0.01), sensor=stated))
    ]
    assert limits[1] == pytest.approx(math.hypot(0.01, limits[0]) - 0.01, rel=0.25)


def test_a_level_that_unnamed_structure_may_make_is_not_sure():
    """Weak bias structure, most of which is the same in all pixels."""
    sensor = drawn_sensor(829361818)
    captures = captures_of(829361818, sensor, bias_structure=None)
    found = diagnose(captures, details=False)
    assert (found.verdict, names(found)) == ("ambiguous", {"black_level"})
    assert found.effects[0].ambiguous_with == ["bias_structure"]
    for one in found.effects[0].parameters.values():
        assert one.ci95[0] < 0 < one.ci95[1]


def with_one_flat(captures):
    """Keep the first flat of each split, and all darks."""
    first = {c.group: c for c in captures.captures[::-1] if c.kind == "flat"}
    darks = [c for c in captures.captures if c.kind == "dark"]
    return replace(captures, captures=[*darks, *first.values()])


@pytest.mark.parametrize(
    ("seed", "hidden", "verdict"),
    [
        *[(120, {}, "consistent"), (123, {}, "consistent")],
        (120, {"lens_shading": 0.2}, "explained"),
        (120, {"prnu": 0.01}, "ambiguous"),
    ],
)
def test_one_flat_of_each_split(seed, hidden, verdict):
    """Its noise is that of the fit, and it does not tell PRNU from shot noise."""
    captures = captures_of(seed - 100, drawn_sensor(seed), **hidden)
    found = diagnose(with_one_flat(captures), details=False)
    assert (found.verdict, names(found)) == (verdict, {*hidden})
    assert not any("Flats differ" in note for note in found.notes)
    if verdict == "ambiguous":
        assert found.effects[0].ambiguous_with == ["shot_noise"]
        assert "Several flats of one level" in found.next_captures[0]


def test_one_flat_does_not_tell_waves_of_its_light_from_shading():
    """Where those of all splits happen to be alike, and where not."""
    for seed, verdict in ((101, "consistent"), (103, "ambiguous")):
        captures = captures_of(seed - 100, drawn_sensor(seed), mains_flicker=0.03)
        found = diagnose(with_one_flat(captures), details=False)
        assert found.verdict == verdict
        assert any("Flats differ in shape" in note for note in found.notes)
        alike = {one.name: one.ambiguous_with for one in found.effects}
        assert all(alike.values()), alike
        assert "mains_flicker" in alike.get("lens_shading", ["mains_flicker"])


@pytest.mark.parametrize(
    ("hidden", "alike"),
    [
        ({"lens_shading": 0.002}, {"exposure": ["lens_shading", "nonlinearity"]}),
        ({"color_shading": 0.004}, {"white_balance": ["color_shading"]}),
        ({"exposure": 0.004}, {"exposure": []}),
        ({"white_balance": 0.004}, {"white_balance": []}),
    ],
)
def test_shading_too_weak_to_be_seen_may_move_the_mean(hidden, alike):
    """Unless it is left out, as what cannot be there."""
    captures = captures_of(4, drawn_sensor(104), **hidden)
    found = diagnose(captures, details=False)
    assert {one.name: one.ambiguous_with for one in found.effects} == alike
    decides = any("falls off from the middle" in one for one in found.next_captures)
    assert decides == any(alike.values())
    [again] = diagnose(captures, only=list(alike), details=False).effects
    assert again.name in alike and not again.ambiguous_with


@pytest.mark.parametrize("levels", [1, 2])
def test_flats_alone_do_not_tell_light_from_the_black_level(levels):
    """But where both splits together tell the black level."""
    for hidden in ({"black_level": None}, {"exposure": 0.02}):
        captures = captures_of(1, drawn_sensor(101), **hidden)
        kept = [c for c in captures.captures if c.kind == "flat"]
        kept = [c for c in kept if int(c.name.split("_")[2]) < levels]
        found = diagnose(replace(captures, captures=kept), details=False)
        alike = {one.name: one.ambiguous_with for one in found.effects}
        if "exposure" in hidden:
            assert alike == {"exposure": []}
        else:
            assert alike and all("black_level" in others for others in alike.values())


def test_levels_of_single_flats_without_darks_may_drift():
    hidden = draw_hidden(drawn_sensor(8), {"black_level_drift": 0.43}, seed=8)
    captures = simulate_captures(drawn_sensor(8), hidden, seed=8, shape=(80, 96))
    kept = [one for one in captures.captures if one.kind == "flat"]
    found = diagnose(replace(captures, captures=kept), details=False)
    assert all("black_level_drift" in one.ambiguous_with for one in found.effects)
    assert found.effects


def flats_of(seed, has_darks, splits, **strengths):
    """Return captures by drawn_sensor(seed): flats of two levels, twice in some splits,
    and single darks of two times."""
    made = captures_of(seed, drawn_sensor(seed), **strengths)
    kept = [
        one
        for one in made.captures
        if "again" not in one.name or (one.kind == "flat" and one.group in splits)
        if one.kind == "flat" or has_darks
    ]
    return replace(made, captures=kept)


def test_light_that_dust_takes_outside_of_its_spots_is_in_no_sure_name():
    """Two of twelve spots lie in one another at the edge, and one is masked."""
    found = diagnose(flats_of(1187522582, True, GROUPS, dust=None), details=False)
    alike = {one.name: one.ambiguous_with for one in found.effects}
    assert alike.pop("dust") == [] and {"exposure", "color_shading"} <= alike.keys()
    assert all("dust" in others for others in alike.values())


def test_noise_that_a_filter_left_in_single_flats_is_no_shading():
    """It took most of what pixels have, and little of what is smooth."""
    captures = flats_of(1289026223, False, (), noise_reduction=0.335)
    found = diagnose(captures, details=False)
    alike = {one.name: one.ambiguous_with for one in found.effects}
    assert alike == {"shot_noise": ["noise_reduction"]}


@pytest.mark.parametrize(
    ("hidden", "told"),
    [
        ({"color_matrix": 0.04}, {"nonlinearity", "white_balance"}),
        ({"nonlinearity": 0.03}, set()),
        ({"crosstalk": 0.01}, set()),
    ],
)
def test_flats_that_are_not_grey_may_have_another_colour_matrix(hidden, told):
    """Four of them, each of its own colour: what they do not share is told."""
    captures = captures_of(1484943544, drawn_sensor(1484943544), **hidden)
    found = diagnose(captures, details=False)
    assert names(found) == (told or {*hidden})
    for one in found.effects:
        assert ("color_matrix" in one.ambiguous_with) == (one.name in told)
        assert bool(one.ambiguous_with) == bool(told)


@pytest.mark.parametrize("times", [[0.0], [0.0, 4.0], [4.0]])
def test_darks_of_one_time_do_not_tell_what_grew_in_it(times):
    """But where they are biases."""
    captures = captures_of(dsnu=0.5, read_noise=0.3)
    darks = [c for c in captures.captures if c.kind == "dark"]
    numbers = [int(c.name.split("_")[2]) for c in darks]
    kept = [
        replace(c, exposure_time=times[n])
        for c, n in zip(darks, numbers, strict=True)
        if n < len(times)
    ]
    found = diagnose(replace(captures, captures=kept), details=False)
    grown = ["dark_current_nonuniformity"], ["dark_current"]
    told = {one.name: one.ambiguous_with for one in found.effects}
    expected = grown if times == [4.0] else ([], [])
    assert told == dict(zip(("dsnu", "read_noise"), expected, strict=True))
    assert all("two exposure times" in said for said in found.next_captures)


def test_frames_of_another_iso_or_temperature_are_left_out(consistent):
    found, _ = consistent
    for what in ("ISO", "temperature"):
        assert any(f"1 frame of another {what}" in note for note in found.notes)
    _, *others, _ = captures_of().captures
    assert sorted(sum(found.groups.values(), [])) == sorted(c.name for c in others)


def test_a_profile_without_noise_takes_that_of_the_frames():
    captures = replace(captures_of(row_noise=0.5), sensor=bare(SENSOR))
    found = diagnose(captures, details=False)
    assert names(found) == {"row_noise"}
    assert any("no noise" in note for note in found.notes)


def test_a_time_limit_leaves_it_incomplete():
    found = diagnose(captures_of(prnu=0.01), time_limit=0.0)
    assert (found.verdict, found.effects) == ("incomplete", [])
    assert found.time_limit_reached and not found.interrupted


def test_ctrl_c_leaves_it_incomplete(monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(darks_and_flats, "fit", interrupted)
    found = diagnose(captures_of(prnu=0.01))
    assert found.verdict == "incomplete" and found.interrupted


def test_a_split_without_frames_is_one_clear_error():
    captures = captures_of()
    some = [c for c in captures.captures if c.group != "report"]
    with pytest.raises(ValueError, match="no dark or flat is in the group report"):
        diagnose(replace(captures, captures=some))


def test_charts_show_each_effect_with_and_without_it(explained):
    charts = {chart.effect: chart for chart in explained.charts}
    assert {one.name for one in explained.effects} & charts.keys()
    for name, chart in charts.items():
        for one in chart.series:
            each = (one.measured, one.before, one.after)
            assert all(part.shape == one.x.shape for part in each), name
    (transfer,) = charts[""].series
    # Variances of a few thousand pixels are known to a few percent.
    assert transfer.measured == pytest.approx(transfer.after, rel=0.1)
    assert (np.diff(transfer.x) > 0).all()


@pytest.mark.parametrize(("name", "size"), [("prnu", 0.01), ("row_noise", None)])
def test_a_chart_has_what_was_planted(explained, name, size):
    (chart,) = (chart for chart in explained.charts if chart.effect == name)
    (one,) = chart.series
    # Of two frames of 72 columns: a row's mean is known to a tenth.
    assert one.measured == pytest.approx(one.after, rel=0.2)
    assert (one.before < 0.5 * one.measured).all()
    if size:  # in proportion to light
        assert one.measured / one.x == pytest.approx(size, rel=0.1)
    assert explained.white_dn == WHITE


def test_charts_of_levels_shapes_and_neighbours_show_what_was_hidden():
    """At the middles of their strengths: what is left is a fifth of what was, but for
    hot pixels, few of which are in each bin of the chart."""
    hidden = {
        name: math.sqrt(KINDS[name].low * KINDS[name].high)
        for name in (
            *("black_level", "dark_current", "exposure", "hot_pixels"),
            *("lens_shading", "read_noise_correlation", "amplifier_mismatch"),
        )
    }
    found = diagnose(captures_of(**hidden))
    assert names(found) == set(hidden)
    charts = {chart.effect: chart for chart in found.charts}
    for name in hidden:
        assert charts[name].series
        for one in charts[name].series:
            off, left = (
                np.sqrt(np.nanmean((one.measured - of) ** 2))
                for of in (one.before, one.after)
            )
            assert left < (1.0 if name == "hot_pixels" else 0.2) * off, name
    chart = charts["amplifier_mismatch"]
    [mismatch] = (one for one in found.effects if one.name == chart.effect)
    way = "horizontal" if chart.x_label == "column" else "vertical"
    step, scale = {"DN": ("offset", WHITE)}.get(chart.y_label, ("response", 100.0))
    size = scale * mismatch.parameters[f"{way}_{step}"].value
    assert chart.series[0].after[-1] - chart.series[0].after[0] == pytest.approx(size)


def test_a_chart_of_levels_has_a_shading_that_the_profile_states():
    """Corners 30 % darker take a tenth of the mean of a flat: no part of what exposure
    moves it by."""
    corners, brighter = {"lens_shading": {"r2": -0.3}}, {"exposure": {"gain": 0.05}}
    frames = simulated(captures_of(), stating(SENSOR, brighter | corners))
    found = diagnose(replace(frames, sensor=stating(SENSOR, corners)))
    assert found.gap.before > 0.01 and abs(found.gap.after) < 0.2 * found.gap.before
    (chart,) = (one for one in found.charts if one.effect == "exposure")
    for one in chart.series:
        assert one.before == pytest.approx(0, abs=1e-6)
        assert one.measured == pytest.approx(5, abs=1)
        assert one.after == pytest.approx(5, abs=1)
