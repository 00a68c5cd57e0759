# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Levels of darks whose temperature is not quite the same."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.model.fit import fit
from cg2raw.statistics.constant import PIXEL, GroupInfo
from cg2raw.statistics.frame_statistics import frame_statistics

SHAPE, WHITE = (48, 64), 65535
BLACK, RATE, NOISE, GAIN, DRIFT = 1000.0, 2.0, 3.0, 0.5, 0.1  # DN, DN/s, DN, DN/e-, DN
TIMES = (0.0, 0.0, 0.0, 10.0, 30.0, 60.0, 150.0, 300.0)  # s


def darks(rng, warmth, times=TIMES, frames=1, **said):
    """Return [(GroupInfo, frames), ...]. warmth : (groups, frames) of charge. frames :
    of each group but biases, of which there are four. said : of those that gather."""
    groups = []
    for number, time in enumerate(times):
        count = frames if time else 4
        made = []
        for n in range(count):
            charge = RATE * time * (warmth[number, n] if time else 1.0)
            frame = BLACK + DRIFT * rng.standard_normal()
            frame = frame + GAIN * rng.poisson(charge / GAIN, SHAPE)
            frame += NOISE * rng.standard_normal(SHAPE)
            made.append(np.rint(frame).astype(np.uint16))
        info = GroupInfo("dark", tuple(map(str, range(count))), time)
        groups.append((replace(info, **said) if time else info, made))
    return groups


def fitted(groups, side=1):
    readers = [(info, [lambda f=f: f for f in made]) for info, made in groups]
    return fit(frame_statistics(readers, side, WHITE))


def test_each_site_has_its_level():
    """Frames whose common level drifts by 20 times the error of a site's mean."""
    rng = np.random.default_rng(4)
    sites = np.tile([[0, 3], [5, 9]], (SHAPE[0] // 2, SHAPE[1] // 2))
    groups = darks(rng, np.ones((2, 6)), (0.0, 60.0), frames=6)
    shown = [
        (info, [(frame + sites).astype(np.uint16) for frame in of])
        for info, of in groups
    ]
    found = fitted(shown, side=2)
    first, _ = found.of("black_level", 0)
    for site, above in enumerate((0, 3, 5, 9)):
        value, error = found.of("black_level", site)
        assert abs(value - BLACK - above) < 3.5 * error < 1.0
        assert value - first == pytest.approx(above, abs=0.2)


def misses(found):
    """Return by how many standard errors black level and dark current are off."""
    truths = {"black_level": BLACK, "dark_current": RATE}
    each = [(found.of(name), truth) for name, truth in truths.items()]
    return [(value - truth) / error for (value, error), truth in each]


def test_what_a_reading_leaves_open_is_in_the_errors():
    """Of 10 sets whose frames are 1.4 % apart in charge, by readings that are rounded
    to 0.41 K: 20 z of 1 have a root mean square below 1.5 in 99 of 100 cases."""
    z = []
    for seed in range(10):
        rng = np.random.default_rng(seed)
        warmth = 1 + 0.014 * rng.standard_normal((len(TIMES), 1))
        z += misses(fitted(darks(rng, warmth, warmth_error=0.014)))
    assert np.sqrt(np.mean(np.square(z))) < 1.5


def test_levels_that_are_off_their_line_are_said():
    """By what each is off, over the drift of frames, for eight levels on a line."""
    warmth = 1 + 0.014 * np.random.default_rng(9).standard_normal((len(TIMES), 1))
    found = fitted(darks(np.random.default_rng(10), warmth))
    theta, at = found.theta.copy(), found.parameters.of
    theta[at("black_level")], theta[at("dark_current")] = BLACK, RATE
    theta[at("black_level_drift")] = DRIFT**2
    off = RATE * np.array(TIMES) * (warmth[:, 0] - 1) / DRIFT
    misfit = found.likelihood.levels.line(theta).misfit
    assert misfit == pytest.approx(np.sqrt((off**2).sum() / 6), rel=0.3)


@pytest.mark.parametrize("side", [1, 2])
def test_readings_that_are_known_move_the_charge(side):
    """Frames that are warmer gather more, in a group and between groups: that is no
    drift, and the dark current is that at the temperature of all."""
    rng = np.random.default_rng(3)
    warmth = 1.1 + 0.05 * rng.standard_normal((2, 6))
    bias, (info, frames) = darks(rng, warmth, times=(0.0, 60.0), frames=6)
    found = fitted([bias, (replace(info, warmth=tuple(warmth[1])), frames)], side)
    assert np.abs(misses(found)).max() < 3
    drift, error = found.of("black_level_drift")
    assert drift == pytest.approx(DRIFT**2, abs=3 * error)
    assert error < 1.0


def test_frames_without_noise_are_refused():
    made = [
        (GroupInfo("dark", (str(n),), n), [np.full(SHAPE, 256, np.uint16)])
        for n in range(2)
    ]
    with pytest.raises(ValueError, match="0: all pixels of a colour are alike"):
        fitted(made)


def test_repeats_of_the_same_pixels_are_refused():
    frame = np.random.default_rng(1).normal(256, 3, SHAPE).astype(np.uint16)
    group = GroupInfo("dark", ("a", "b", "c"), 1.0), [frame, frame, frame]
    with pytest.raises(ValueError, match="a: has the same pixels as its 2 repeats, or"):
        fitted([group])


def test_noise_of_charge_is_known_as_well_as_the_charge():
    """The relative variance of a scatter, 2 over its freedom, is more by that."""
    error, frames, time = 0.1, 3, 300.0
    groups = darks(np.random.default_rng(5), np.ones((2, 3)), (0.0, time), frames)
    bias, (info, made) = groups
    found = fitted(groups)
    [sure] = found.likelihood.planes
    unread = fitted([bias, (replace(info, warmth_error=error), made)])
    [plane] = unread.likelihood.planes
    shot = found.of("gain")[0] * found.of("dark_current")[0] * time
    more = 2 / plane.freedom[:, PIXEL] - 2 / sure.freedom[:, PIXEL]
    expected = (error * shot / plane.scatter[1, PIXEL]) ** 2 / frames
    assert more == pytest.approx([0, expected], rel=0.02)
