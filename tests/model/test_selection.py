# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Names that frames show: of a sensor whose effects are all there, those that a profile
lacks."""

import json
from dataclasses import replace

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.model.dark_levels import LEVELS
from cg2raw.model.evaluation import Parameters
from cg2raw.model.fit import fit
from cg2raw.model.profile_values import profile_values
from cg2raw.model.selection import NAMES, selection
from cg2raw.model.shapes import Shapes
from cg2raw.model.shapes.base import Shape
from cg2raw.model.shapes.dust import NAME as DUST
from cg2raw.model.shapes.heavy_tailed_noise import NAME as TAILS
from cg2raw.statistics.constant import GroupInfo
from model.planted import planted
from oracles.plain_statistics import plain_statistics
from tiers import slow

LEAST = float(np.log(len(NAMES) / 0.01))
# Shapes, which no number of the profile's stands for.
STRUCTURES = {"bias_structure", "lens_shading"}
PUT_IN = {"amplifier_glow", "color_shading", "mains_flicker"}  # below
# Of which tests/diagnose shows the same, of frames of the generator; patterns of
# columns and of rates are named as dsnu is.
ELSEWHERE = ["black_level", "dark_current", "prnu", "read_noise", "row_noise"]
ELSEWHERE += ["column_fixed_pattern", "dark_current_nonuniformity"]
OTHERS = sorted(set(NAMES) - STRUCTURES - PUT_IN - set(ELSEWHERE))


def fits_of(made):
    """Return fits of frames of one sensor, in two halves, and its truth."""
    halves = [
        [(info, frames[half::2]) for info, frames in made.groups] for half in (0, 1)
    ]
    first, second = (fit(made._replace(groups=groups).statistics) for groups in halves)
    truth = np.zeros(len(first.parameters))
    at = first.parameters.of
    for site in range(first.parameters.sites):
        truth[at("black_level", site)] = made.truth[f"black level {site}"]
        truth[at("read_noise", site)] = made.truth[f"read noise {site}"] ** 2
        truth[at("gain", site)] = 1 / made.truth[f"gain {site}"]
    truth[at("dark_current")] = made.truth["dark current"]
    for name, figure in {
        "black_level_drift": "black level drift",
        "row_noise": "row noise",
        "column_noise": "column noise",
        "dsnu": "DSNU",
        "column_fixed_pattern": "fixed column pattern",
        "dark_current_nonuniformity": "dark current nonuniformity",
        "prnu": "PRNU",
    }.items():
        truth[at(name)] = made.truth[figure] ** 2
    return first, second, truth


@pytest.fixture(scope="module", params=[1, 2])
def fits(request):
    return fits_of(planted(21, side=request.param, shape=(120, 160)))


def test_what_the_profile_has_is_not_named(fits):
    first, second, truth = fits
    found = selection(first, second, truth, LEAST)
    assert set(found.kept(LEAST)) == STRUCTURES
    there = {name for name, gain in found.unnamed.items() if gain > LEAST}
    assert there <= {"column_noise"}  # which was planted


@pytest.mark.parametrize("fits", [2], indirect=True)
@pytest.mark.parametrize("name", [*OTHERS, *map(slow, ELSEWHERE)])
def test_what_the_profile_lacks_is_named(fits, name):
    first, second, truth = fits
    lacks = truth.copy()
    own = np.isin(first.parameters.names, NAMES[name])
    factor = 1.3 if name in ("read_noise", "shot_noise") else 0.0
    lacks[own] = truth[own] - 40 if name == "black_level" else truth[own] * factor
    found = selection(first, second, lacks, LEAST).kept(LEAST)
    assert set(found) == STRUCTURES | {name}


@pytest.mark.parametrize("fits", [2], indirect=True)
def test_what_is_weak_is_named_whichever_half_trains(fits):
    """A row noise that one half has by 5 standard errors, and the other by 2: trained
    by the first, it gains 3 nats alone."""
    first, second, truth = fits
    at = first.parameters.of("row_noise")
    lacks = truth.copy()
    value, error = first.of("row_noise")
    lacks[at] = value - 5 * error
    one, other = (
        selection(*halves, lacks, LEAST).gains["row_noise"]
        for halves in ((first, second), (second, first))
    )
    assert one == pytest.approx(other, abs=0.01)
    assert one > 2 * LEAST


@pytest.mark.parametrize("fits", [2], indirect=True)
@pytest.mark.parametrize(
    ("stated", "spots", "names"),
    [slow(0.4, 0.0, {"prnu"}), (0.4, 1.0, set()), (0.0, 1.0, {"prnu"})],
)
def test_spots_may_be_in_the_sensitivity_of_a_profile(fits, stated, spots, names):
    """A profile whose pixels have 0.4 of their variance, of frames whose spots have as
    much as all others; not in that of one that states none."""
    first, second, truth = fits
    at = first.parameters.of("prnu")
    lacks = truth.copy()
    lacks[at] *= stated
    shapes = Shapes({}, spots=spots * truth[at])
    found = selection(first, second, lacks, LEAST, shapes=shapes).kept(LEAST)
    assert set(found) == STRUCTURES | names


@pytest.mark.parametrize("fits", [2], indirect=True)
@pytest.mark.parametrize(
    ("of_profile", "most", "whole", "is_named"),
    [
        slow(0.8, 0.7, (1.0, 0.0), False),
        (0.65, 0.7, (1.0, 0.0), True),
        slow(1.2, 0.7, (1.0, 0.0), False),
        slow(1.4, 0.7, (1.0, 0.0), True),
        slow(1.4, 0.7, (1.02, 0.01), True),
        (1.4, 0.7, (1.02, 0.03), False),
        (0.65, None, (1.0, 0.0), True),
        (1.1, None, (1.1, 0.02), False),
    ],
)
def test_noise_of_a_profile_beside_tails(fits, of_profile, most, whole, is_named):
    """Most draws have seven tenths of all: a profile may have either, or between; and
    three tenths more by draws that few frames have, of all as they are known. Where
    codes are few, what most have is not known: a profile has the whole, within its
    error."""
    first, second, truth = fits
    own = np.isin(first.parameters.names, NAMES["read_noise"])
    lacks = np.where(own, truth * of_profile, truth)
    of_most = most and (most * truth[own].mean(), 1e-3 * truth[own].mean())
    shapes = Shapes({TAILS: Shape(TAILS, 99.0, ())}, most=2 * (of_most,), whole=whole)
    found = selection(first, second, lacks, LEAST, shapes=shapes).kept(LEAST)
    assert ("read_noise" in found) == is_named


@pytest.mark.parametrize("fits", [2], indirect=True)
@pytest.mark.parametrize(
    ("nats", "corners", "others"),
    [(99.0, 1.0, ["dust"]), (99.0, 1e-9, []), (0.0, 1.0, [])],
)
def test_shading_may_be_dust_in_corners_where_there_is_dust(
    fits, nats, corners, others
):
    """Of coefficients that spots in corners would have; it is named all the same."""
    first, second, truth = fits
    shapes = Shapes({DUST: Shape(DUST, nats, ())}, corners=corners)
    found = selection(first, second, truth, LEAST, shapes=shapes)
    assert "lens_shading" in found.kept(LEAST)
    assert [*found.alike.get("lens_shading", ())] == others


def fits_of_darks(seed, times, level, frames=3):
    """Return fits of two halves: of each time so many frames, whose noise is 2 DN.

    level : (s) -> DN, of all pixels or (112, 144)."""
    rng, fits = np.random.default_rng(seed), []
    for _ in range(2):
        groups = []
        for time in times:
            drawn = level(time) + 2 * rng.standard_normal((frames, 112, 144))
            info = GroupInfo("dark", tuple("abc")[:frames], time)
            groups.append((info, list(np.rint(drawn).astype(np.uint16))))
        fits.append(fit(plain_statistics(groups, 2, 4095)))
    return fits


@pytest.mark.parametrize(("dsnu", "names"), [(1.0, []), (0.0, ["dsnu"])])
def test_offsets_of_pixels_with_dark_current(dsnu, names):
    """1 DN of offset and 0.1 DN/s that are the same pattern: no profile says so, and
    one that has both is right."""
    pattern = np.random.default_rng(13).standard_normal((112, 144))
    times = (0.0, 10.0)
    fits = fits_of_darks(14, times, lambda time: 600 + (1 + 0.1 * time) * pattern)
    parameters = fits[0].parameters
    null = profile(parameters)
    null[parameters.of("dsnu")] = dsnu
    null[parameters.of("dark_current_nonuniformity")] = 0.01
    assert selection(*fits, null, LEAST).kept(LEAST) == names


def test_lines_of_light_are_no_effect_and_are_said():
    """Columns of another gain, the same in all frames."""
    rng = np.random.default_rng(9)
    made = planted(23, side=2, shape=(120, 160), black=BLACK)
    gains = 1 + 0.01 * rng.standard_normal(160)
    groups = [
        (info, [np.rint(BLACK + (f - BLACK) * gains).astype(np.uint16) for f in frames])
        if info.kind == "flat"
        else (info, frames)
        for info, frames in made.groups
    ]
    found = selection(*fits_of(made._replace(groups=groups)), LEAST)
    there = [name for name, gain in found.unnamed.items() if gain > LEAST]
    assert there == ["columns of light"]


def shone_on(frame, rng, gain):
    """A frame whose rows have a wave of brightness, of another phase each time."""
    phase = rng.uniform(0, 2 * np.pi)
    wave = 1 + 0.01 * np.sin(2 * np.pi * np.arange(len(frame)) / 23 + phase)
    return np.rint(BLACK + (frame - BLACK) * wave[:, None])


def red_shaded(frame, rng, gain):
    shaded = frame.astype(float)
    across = np.linspace(-1, 1, shaded[::2, ::2].shape[1])
    shaded[::2, ::2] = BLACK + (shaded[::2, ::2] - BLACK) * (1 + 0.05 * across**2)
    return np.rint(shaded)


def glowing(frame, rng, gain):
    """Charge that gathers towards a corner, with its noise. gain : e-/DN."""
    down, across = (np.exp(-5 * np.arange(n) / n) for n in frame.shape)
    return frame + np.rint(rng.poisson(40 * gain * down[:, None] * across) / gain)


def profile(parameters):
    """Return a black level of 600 DN and a noise of 2 DN, of four planes."""
    found = np.zeros(len(parameters))
    sites = np.arange(4)
    found[parameters.of("black_level") + sites] = 600
    found[parameters.of("read_noise") + sites] = 4
    return found


@pytest.mark.parametrize(("frames", "names"), [(1, []), (2, ["black_level"])])
def test_levels_are_named_by_frames_that_tell_their_drift(frames, names):
    """Darks of two times, 3 DN above the profile's black level: of one frame each, a
    drift of 3 DN is as likely."""
    fits = fits_of_darks(12, (0.0, 5.0), lambda time: 603, frames)
    found = selection(*fits, profile(fits[0].parameters), LEAST)
    assert found.kept(LEAST) == names
    assert (set(found.gains) & set(LEVELS) != set()) == bool(names)


def test_levels_that_agree_are_no_drift():
    """Three darks each of two times, 0.15 DN below the black level and, by charge of
    3 s, 0.15 DN above it: a drift of as much would move frames of one time, too."""
    fits = fits_of_darks(14, (0.0, 3.0), lambda time: 599.85 + 0.1 * time)
    found = selection(*fits, profile(fits[0].parameters), LEAST)
    assert set(found.kept(LEAST)) == {"black_level", "dark_current"}
    assert set(found.unsure) == {"black_level", "dark_current"}


def test_a_glow_of_one_split_leaves_dark_current_known():
    """By the mean of a glow that both have, 0.1 DN/s squared, it is not."""
    fits = fits_of_darks(14, (0.0, 3.0), lambda time: 600 + 0.1 * time)
    null, unsure = profile(fits[0].parameters), []
    for size in (0.0, 1e4):
        glow = fits[1].theta.copy()
        glow[fits[1].parameters.of("amplifier_glow, smooth_columns")] = size
        pair = replace(fits[0], theta=glow), replace(fits[1], theta=glow)
        unsure.append(selection(pair[0], fits[1], null, LEAST).unsure["dark_current"])
    both = selection(*pair, null, LEAST).unsure["dark_current"]
    assert unsure[0] == unsure[1] < both / 3


def test_first_columns_are_neither_level_nor_drift():
    """A pedestal that settles by 1 DN over 30 columns, with noise of 2 DN, is lower in
    the mean by 0.2 DN, 5 of its errors."""
    settling = 600 - np.exp(-np.arange(144) / 30) + 0.5 * np.linspace(-1, 1, 144)
    fits = fits_of_darks(11, (0.0, 5.0), lambda time: settling)
    found = selection(*fits, profile(fits[0].parameters), LEAST).kept(LEAST)
    assert found == ["bias_structure"]


BLACK = 600.0  # DN, of the frames that these are put into


@pytest.mark.parametrize(
    ("name", "change", "kind"),
    [
        ("mains_flicker", shone_on, "flat"),
        ("color_shading", red_shaded, "flat"),
        ("amplifier_glow", glowing, "dark"),
    ],
)
def test_what_is_put_in_is_named(name, change, kind):
    rng = np.random.default_rng(7)
    made = planted(22, side=2, shape=(120, 160), black=BLACK)
    groups = [
        (
            info,
            [change(f, rng, made.truth["gain 0"]).astype(np.uint16) for f in frames]
            if info.kind == kind and info.exposure_time
            else frames,
        )
        for info, frames in made.groups
    ]
    found = selection(*fits_of(made._replace(groups=groups)), LEAST).kept(LEAST)
    assert set(found) == STRUCTURES | {name}


def test_a_profile_is_in_units_of_the_frames():
    """White above black is 1000 DN; variances are squares of shares of it."""
    text = json.loads(Sensor("nikon-d40").to_json()) | {
        "black_level": [64] * 4,
        "white_level": 1064,
        "noise": [{"iso": 100, "beta1": [2e-4] * 4, "beta2": [4e-6] * 4}],
        "effects": [
            {"name": "row_noise", "parameters": {"sigma": 3e-4}},
            {"name": "dark_current", "parameters": {"per_second": 5e-4}},
            {"name": "prnu", "parameters": {"sigma": 0.01}},
            {"name": "read_noise", "parameters": {"log_variance": np.log(2)}},
            {"name": "shot_noise", "parameters": {"log_gain": np.log(3)}},
            {"name": "black_level", "parameters": {"offset_00": 0.002}},
            {
                "name": "dark_current_nonuniformity",
                "parameters": {"rate": 1e-3, "log_sigma": 1.0},
            },
        ],
    }
    parameters = Parameters(4)
    found = profile_values(Sensor.from_json(json.dumps(text)), 100, parameters)
    e = np.e
    wanted = {
        "black_level": 66,
        "read_noise": 8,
        "gain": 0.6,
        "row_noise": 0.09,
        "dark_current": 0.5,
        "prnu": 1e-4,
        "dark_current_nonuniformity": e * (e - 1),
    }
    for name, value in wanted.items():
        assert found[parameters.of(name)] == pytest.approx(value)
    rest = [n for n in parameters.names if n not in wanted]
    assert not any(found[parameters.of(name)] for name in rest)
