# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Hidden effects of pixels and lines: charge, traps, amplifiers."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.synthetic import charge, telegraph


def test_traps_switch_as_often_as_is_stated(camera):
    hidden = {
        "random_telegraph_noise": {"share": 0.3, "read_noises": 8.0, "switches": 0.2}
    }
    rng = np.random.default_rng(7)
    traps = telegraph.traps_of(rng, (400, 400), hidden, camera)
    trapped = traps.step > 0
    assert trapped.mean() == pytest.approx(0.3, abs=4 * 0.46 / 400)
    unit = float((camera.dn_per_electron * camera.read_noise).mean())
    sizes = traps.step[trapped] / (8 * unit)  # exponential, cut at 4
    assert sizes.max() <= 4 and sizes.mean() == pytest.approx(0.925, abs=0.02)
    levels = [
        telegraph.offsets(traps, n, lambda frame: np.random.default_rng(frame))
        for n in range(4)
    ]
    for first, second in zip(levels, levels[1:], strict=False):
        np.testing.assert_array_equal(np.abs(first), traps.step / 2)
        switched = (first != second)[trapped].mean()
        assert switched == pytest.approx(0.2, abs=4 * 0.4 / np.sqrt(trapped.sum()))
    assert telegraph.traps_of(rng, (4, 4), {}, camera) is None


def test_phase_detection_pixels_are_a_lattice(camera):
    values = {"loss": 0.2, "period": 8, "row": 2.0, "column": 5.0, "tilt": 0.1}
    rgb = np.ones((32, 41, 3))
    plain = charge.mosaic_light(rgb, {}, camera, 0.0)
    found = charge.mosaic_light(rgb, {"pdaf_pixels": values}, camera, 0.0) / plain
    assert found[2::8, 5::8] == pytest.approx(
        np.broadcast_to(0.8 - 0.02 * (np.arange(5, 41, 8) / 20 - 1), (4, 5))
    )
    found[2::8, 5::8] = 1
    assert (found == 1).all()


def test_a_pattern_moves_no_mean(camera):
    """Within four standard errors of 160,000 pixels."""
    strong = {"prnu": {"sigma": 0.2}, "dsnu": {"read_noises": 1.0, "shape": 2.0}}
    drawn = charge.patterns(np.random.default_rng(1), (400, 400), strong, camera)
    for values in (drawn.gain, drawn.offset):
        assert abs(values.mean()) < 4 * values.std() / 400


@pytest.mark.parametrize("power", [0.0, 1.0, 2.0])
def test_a_nonlinear_pixel_loses_its_share_at_full_well(camera, power):
    """Half way it loses half of that, or a quarter: share x level^power; power 0
    stands for a pixel that fills up, (1 - exp(-s level)) / s."""
    hidden = {"nonlinearity": {"loss": 0.1, "power": power}}
    patterns = charge.patterns(np.random.default_rng(0), (2, 2), {}, camera)
    full = camera.over(camera.full_well, (2, 2))
    kept = [
        charge.electrons(np.full((2, 2), x), hidden, camera, patterns, 0.0) / (x * full)
        for x in (1e-6, 0.5, 1.0)
    ]
    assert kept[0] == pytest.approx(1, abs=1e-6)
    assert kept[2] == pytest.approx(0.9)
    if power:
        assert kept[1] == pytest.approx(1 - 0.1 * 0.5**power)
    else:
        left = 2 * kept[2] / kept[1] - 1  # exp(-s / 2)
        assert kept[1] == pytest.approx((1 - left) / -np.log(left))


def test_a_lit_pixel_shines_on_its_neighbours(camera):
    """Each keeps what the others do not take; from_left is what comes from there."""
    shares = {"left": 0.01, "right": 0.02, "above": 0.03, "below": 0.04}
    rgb = np.zeros((8, 10, 3))
    rgb[4, 5] = 1
    values = {f"from_{side}": share for side, share in shares.items()}
    found = charge.mosaic_light(rgb, {"crosstalk": values}, camera, 0.0)
    assert found[3:6, 4:7] == pytest.approx(
        np.array([[0, 0.04, 0], [0.02, 0.9, 0.01], [0, 0.03, 0]])
    )
    assert found.sum() == pytest.approx(1)


def test_lines_and_halves_of_a_sensor(camera):
    rgb = np.random.default_rng(1).random((8, 10, 3))
    plain = charge.mosaic_light(rgb, {}, camera, 0.0)

    def seen(**hidden):
        return charge.mosaic_light(rgb, hidden, camera, 0.0)

    assert seen(smear={"share": 0.1}) == pytest.approx(plain + 0.1 * plain.mean(0))
    for across, halves in ((True, (slice(None), slice(5))), (False, (slice(4),))):
        values = {"gain": 0.02, "one_above_the_other": not across}
        ratio = seen(amplifier_mismatch=values) / plain
        first = np.zeros(plain.shape, bool)
        first[halves] = True
        assert ratio[first] == pytest.approx(0.99)
        assert ratio[~first] == pytest.approx(1.01)
    ratio = seen(gr_gb_imbalance={"split": 0.03, "lean": 0.25}) / plain
    red = [row for row in range(2) if 0 in camera.colors[row]][0]
    greens = camera.colors == 1
    in_red, in_blue = (
        ratio[row::2][:, greens[row].argmax() :: 2] for row in (red, 1 - red)
    )
    assert in_red == pytest.approx(1 + 0.25 * 0.03)
    assert in_blue == pytest.approx(1 - 0.75 * 0.03)
    assert ratio[red::2][:, camera.colors[red].argmin() :: 2] == pytest.approx(1)


def test_a_lamp_on_rectified_mains(camera):
    """|sin|: its waves are as 1 / (4 n^2 - 1), the first as large as is stated."""
    rows = 240
    values = {"rows": 60.0, "swing": 0.3, "exposed": 0.0}
    rgb = np.ones((rows, 4, 3))
    hidden = {"mains_flicker": values}
    light = charge.mosaic_light(rgb, hidden, camera, 0.2)[:, 0]
    waves = 2 * np.abs(np.fft.rfft(light)) / rows
    assert waves[0] == pytest.approx(2)  # 1 on average
    assert waves[[4, 8, 12]] == pytest.approx(0.3 * np.array([1, 3 / 15, 3 / 35]))
    whole = {"mains_flicker": values | {"exposed": 0.5}}
    even = 2 * np.abs(np.fft.rfft(charge.mosaic_light(rgb, whole, camera, 0.2)[:, 0]))
    assert even[4] / rows == pytest.approx(0.3) and even[8] < 1e-9  # two waves long


def test_patterns_are_as_large_as_is_stated(camera):
    """Within four standard errors of 160,000 pixels, 400 columns, 3200 hot pixels."""
    read = float(camera.read_noise.mean())
    hidden = {
        "prnu": {"sigma": 0.02},
        "dsnu": {"read_noises": 0.5, "shape": 3.0},
        "column_fixed_pattern": {"read_noises": 0.3},
        "hot_pixels": {"share": 0.02, "electrons_per_second": 50.0},
    }
    drawn = charge.patterns(np.random.default_rng(8), (400, 400), hidden, camera)
    assert np.log1p(drawn.gain).std() == pytest.approx(0.02, rel=4 / 565)
    assert drawn.offset.std() == pytest.approx(0.5 * read, rel=0.02)
    assert np.mean(drawn.offset**3) / drawn.offset.std() ** 3 == pytest.approx(
        2 / 3**0.5, rel=0.1
    )  # a tail to one side, of a gamma of shape 3
    assert drawn.column.std() == pytest.approx(0.3 * read, rel=0.1)
    assert np.abs(drawn.column).max() < 3**0.5 * 0.3 * read
    assert drawn.hot.mean() == pytest.approx(0.02, abs=4 * 0.14 / 400)
    assert (drawn.leak > 0).sum() == drawn.hot.sum()
    assert drawn.leak[drawn.hot].mean() == pytest.approx(50, rel=4 / 56)
    uneven = {"electrons_per_second": 4.0, "skew": 1.0}
    law = charge.uneven_dark(uneven)
    assert law.median() == pytest.approx(4)
    found = charge.patterns(
        np.random.default_rng(9),
        (400, 400),
        {"dark_current_nonuniformity": uneven},
        camera,
    ).leak
    assert abs(found.mean()) < 4 * law.std() / 400
    assert np.median(found) + law.mean() == pytest.approx(4, rel=0.02)


def test_charge_is_light_and_dark_current(camera):
    rng = np.random.default_rng(4)
    plane = charge.Patterns.none((4, 6))
    fixed = replace(plane, gain=rng.normal(0, 0.1, (4, 6)), leak=rng.random((4, 6)))
    x, full = rng.random((4, 6)), camera.over(camera.full_well, (4, 6))
    light = full * x * (1 + fixed.gain)
    hidden = {"dark_current": {"electrons_per_second": 3.0}}
    for seconds in (0.0, 2.0):
        found = charge.electrons(x, hidden, camera, fixed, seconds)
        assert found == pytest.approx(light + (fixed.leak + 3) * seconds)
    cold = replace(plane, leak=np.full((4, 6), -1.0))
    assert (charge.electrons(0 * x, {}, camera, cold, 1.0) == 0).all()
    values = {"electrons_per_second": 9.0, "down": 0.0, "across": 0.5}
    glow = charge.glow(values | {"fades_over": 0.1}, (30, 40))  # of 50 px
    assert glow[9, 19] / glow[4, 19] == pytest.approx(np.exp(-1), rel=0.01)
    assert glow.max() == pytest.approx(9, rel=0.2) and glow[0, 19] == glow[0, 20]


def test_without_charge_there_are_black_and_offsets(camera):
    shape, gain = (4, 6), camera.over(camera.dn_per_electron, (4, 6))
    black = camera.over(camera.black, shape)
    rng = np.random.default_rng(5)
    fixed = replace(
        charge.Patterns.none(shape), offset=rng.normal(size=shape), column=rng.random(6)
    )

    def found(**hidden):
        return charge.pedestal(hidden, camera, fixed, shape) - plain

    plain = black + gain * (fixed.offset + fixed.column)
    assert found() == pytest.approx(0)
    shift = {"dn_00": 1.0, "dn_01": 2.0, "dn_10": 3.0, "dn_11": 4.0}
    assert found(black_level=shift)[2:, 4:] == pytest.approx(np.array([[1, 2], [3, 4]]))
    values = {"gain": 0.0, "read_noises": 2.0, "one_above_the_other": False}
    step = gain * 2 * camera.read_noise.mean()
    offsets = found(amplifier_mismatch=values)
    assert offsets[:, :3] == pytest.approx(-step[:, :3] / 2)
    assert offsets[:, 3:] == pytest.approx(step[:, 3:] / 2)
    values = {"right_dn": 2.0, "down_dn": -6.0, "first_dn": 8.0, "half_px": 1.0}
    structure = found(bias_structure=values)
    assert structure[0] - structure[3] == pytest.approx(6)
    settling = 8 * 0.5 ** np.arange(6)
    expected = np.linspace(-1, 1, 6) + settling
    assert structure.mean(0) == pytest.approx(expected)
