# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Hidden effects of pixels and lines: charge, traps, amplifiers."""

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
