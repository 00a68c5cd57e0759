# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is not known of captures: how far it may be off, and whose it is."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.scenes.nuisances import (
    SLOPE,
    known_effects,
    laplacian,
    legendre,
    nuisances_of,
    pose_of,
    to_edge,
    wings,
)
from diagnose.planted import capture_of, changed, frames_of, sensor_of

SENSOR = sensor_of()


CHANGED = {"chart": ("scene", {"kind": "chart"}), "wall": ("flat", {"scene": None})}


def nuisances(kind="scene", n=1, flicker=None, is_blurred=False, more=None, **given):
    """Return those of a capture by name. A wall is a flat of unknown light. more :
    fields of the capture."""
    base, fields = CHANGED.get(kind, (kind, more or {}))
    capture = replace(capture_of(base, 1, shape=(48, 60)), **fields)
    [frame] = frames_of(SENSOR, [capture])
    declared = CaptureSet(SENSOR, [capture], **given)
    found = nuisances_of(declared, frame, n, flicker, is_blurred)
    return {one.name: one for one in found}


RGB = ["red", "green", "blue"]
POSE = [axis + by for axis in ("row", "column") for by in ("", " v", " u")]


@pytest.mark.parametrize(
    ("kind", "declared", "names"),
    [
        ("flat", {"exposure"}, ["exposure"]),
        ("scene", {"exposure", "white_balance"}, RGB),
        ("wall", {"exposure"}, RGB),
        ("chart", {"light", "exposure"}, ["exposure", "light"]),
        ("scene", {"registration"}, [*POSE, "sharpness", "fine sharpness"]),
        ("chart", {"registration"}, []),
        ("flat", {"registration", "radiance", "temperature"}, []),
    ],
)
def test_each_kind_of_capture_has_its_own(kind, declared, names):
    found = nuisances(kind, nuisances=frozenset(declared))
    assert [*found] == names
    for name in {"exposure", *RGB} & found.keys():
        assert found[name].own == (kind == "wall")
        assert found[name].deviation == 1


def test_a_displaced_ramp_is_brighter_by_the_places_step():
    """Constant, by v and by u; along it nothing changes."""
    ramp = np.broadcast_to(np.linspace(0.1, 0.5, 48)[:, None, None], (48, 60, 3))
    scene = {"scene": lambda: ramp.astype(np.float32)}
    found = nuisances(more=scene, nuisances=frozenset({"registration"}))
    each = [found[name] for name in POSE]
    steps = [(one.change * one.down * one.across)[0, 1, 4:-4] for one in each]
    v, u = np.mgrid[:48, :60] + 0.5 - np.array([[[24]], [[30]]])
    half = np.hypot(48, 60) / 2
    for step, place in zip(steps, (np.ones_like(v), v / half, u / half), strict=False):
        assert step == pytest.approx(steps[0][0, 0] * place[4:-4], rel=1e-3, abs=1e-6)
    assert np.abs(steps[3:]).max() < 1e-6 < steps[0].min()


def test_places_and_polynomials_of_smooth_fields():
    corner = np.array([-1.2, -(0.5**0.5), 0, 0.5**0.5, 1.2])  # of half diagonals
    assert to_edge(corner) == pytest.approx([-1.5, -1, 0, 1, 1.5])
    assert [legendre(n, np.ones(1))[0] for n in range(7)] == pytest.approx(7 * [1])
    assert legendre(2, np.array([0, 0.5])) == pytest.approx([-0.5, -0.125])
    assert pose_of({"row": 1, "column u": 2}).tolist() == [[1, 0, 0], [0, 0, 2]]


@pytest.mark.parametrize(
    ("name", "parameters", "ends", "errors"),
    [
        ("exposure", {"gain": 0.05}, {"gain": (0.03, 0.07)}, [0.02 / 1.96]),
        ("exposure", {"gain": 0.05}, {"gain": (0.05, 0.05)}, None),
        ("white_balance", {"red": 0.1, "blue": 0}, {"red": (0, 0.2)}, None),
        ("prnu", {"sigma": 0.01}, {"sigma": (0.009, 0.011)}, None),  # moves no mean
    ],
)
def test_images_correct_what_darks_and_flats_measured(name, parameters, ends, errors):
    entry = {"name": name, "parameters": parameters, "ci95": ends}
    found = known_effects(changed(SENSOR, effects=[entry]))
    assert [one.name for one in found] == ([name] if errors else [])
    for values in found.values():
        assert values == pytest.approx(errors, rel=1e-3)


def test_the_light_of_colours_is_all_of_it():
    colors = nuisances(nuisances=frozenset({"white_balance"}))
    exposure = nuisances(nuisances=frozenset({"exposure"}))["exposure"].change
    total = sum(one.change for one in colors.values())
    np.testing.assert_array_equal(total, exposure)
    assert not colors["green"].change[:, [0, 2]].any()


def test_waves_of_a_lamp_are_a_frame_s_own():
    """Of any phase: their squares add up to that of the light times the amplitude."""
    waves = nuisances("flat", n=4, flicker=(0.1, 20.0)).values()
    [light] = nuisances("flat", nuisances=frozenset({"light"})).values()
    assert [(one.own, one.deviation) for one in waves] == 2 * [(True, 0.5)]
    square = sum(one.change**2 for one in waves)
    assert square == pytest.approx(light.change**2 * 0.1**2 / 2)
    for one in waves:
        assert one.change[..., 20:, :] == pytest.approx(one.change[..., :-20, :])
        assert one.change == pytest.approx(one.change[..., :1] * np.ones(60))


@pytest.mark.parametrize("frames", [1, 4])
@pytest.mark.parametrize(("declared", "each"), [({}, 0.005), ({"light": 0.03}, 0.03)])
def test_light_that_jitters_is_a_frame_s_own(frames, declared, each):
    """The mean of four frames is off by half as much as one."""
    given = {"nuisances": frozenset({"light"}), "uncertainty": declared}
    [light] = nuisances(n=frames, **given).values()
    assert light.own and light.deviation == pytest.approx(each / np.sqrt(frames))


def test_a_smooth_error_is_of_a_set_and_as_large_at_each_degree():
    found = nuisances(nuisances=frozenset({"radiance"}))
    assert not any(one.own for one in found.values())
    assert len(found) == 27  # products of polynomials of up to degree 6 in all
    assert {one.deviation for one in found.values()} == {0.01}


@pytest.mark.parametrize(
    ("kind", "declared", "doubt"),
    [("chart", {}, 0.05), ("chart", {"radiance": 0.02}, 0.02), ("scene", {}, 0.01)],
)
def test_lamps_light_charts_less_evenly_than_renders_are(kind, declared, doubt):
    given = {"nuisances": frozenset({"radiance"}), "uncertainty": declared}
    assert nuisances(kind, **given)["field 1 0"].deviation == pytest.approx(doubt)


def test_a_blurred_render_has_wings_and_no_chart():
    [wing] = nuisances(is_blurred=True).values()
    assert (wing.own, wing.deviation) == (False, 0.01)
    assert nuisances("chart", is_blurred=True) == {}


def test_slopes_and_laplacians_are_those_of_polynomials():
    """Exact up to the sixth degree, and up to the third."""
    steps = np.arange(-3.0, 4.0)
    assert [SLOPE @ steps**n for n in range(7)] == pytest.approx([0, 1, 0, 0, 0, 0, 0])
    y, x = np.mgrid[-4:5, -4:5].astype(float)
    camera = (3 * y**2 + 2 * y**3 + 5 * x**2 + 7 * x * y + x + 4)[None, None]
    inner = laplacian(camera)[0, 0, 1:-1, 1:-1]
    assert inner == pytest.approx((2 * (3 + 5) + 12 * y)[1:-1, 1:-1])


def test_wings_of_a_point_fall_with_the_third_power_and_keep_its_light():
    camera = np.zeros((1, 1, 161, 161))
    camera[..., 80, 80] = 1
    point = wings(camera)[0, 0]
    assert point[80, 80] == pytest.approx(-1)
    near, far = point[80, [68, 92]], point[[56, 104], 80]  # 12 and 24 px away
    assert near == pytest.approx(8 * far) and (far > 0).all()
    assert point[80, 81:90] == pytest.approx(0) and point.sum() == pytest.approx(0)
    everywhere = wings(np.full((1, 3, 20, 30), 0.7))
    assert everywhere == pytest.approx(0)  # to the borders


def test_darks_have_none():
    every = frozenset({"light", "radiance", "registration", "exposure"})
    assert nuisances("dark", nuisances=every) == {}
