# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Dust and phase-detection pixels in flats: planted ones, and what looks like them."""

import sys

import numpy as np
import pytest
from numpy.polynomial.legendre import legvander
from scipy.stats import poisson

from cg2raw.model.figures import Figure
from cg2raw.model.shapes.base import Shape, nats_beyond
from cg2raw.model.shapes.dust import Spot, _figures, dust, like_shading
from cg2raw.model.shapes.light_patterns import Excess, _weights
from cg2raw.model.shapes.pdaf_pixels import _mean
from cg2raw.statistics.constant import ConstantStatistics, GroupInfo
from cg2raw.statistics.lattice import _beside_neighbours, lattice_of
from model.shapes.planted import BLACK, GAIN, SHAPE, darks, shown, statistics_of
from tiers import slow

LEAST = np.log(33 / 0.01)
ROWS, COLUMNS = np.indices(SHAPE)
LEVELS = 300.0, 900.0  # DN of light
NONE = np.zeros(SHAPE)
MIDDLES = (20.3, 25.1), (70.8, 30.6), (30.2, 75.9), (76.4, 90.2), (48.7, 108.0)


def lattice(pitch=14, row=9, column=4, gain=-0.06):
    """Return (H, W) 1 + gain in the pixels of a lattice."""
    inside = (ROWS % pitch == row) & (COLUMNS % pitch == column)
    return 1 + gain * inside


def spots(depth, power=2.0, radius=5.0):
    """Return (H, W) the light left by spots half of whose loss is at @radius px."""
    left = np.ones(SHAPE)
    for row, column in MIDDLES:
        away = np.hypot(ROWS - row, COLUMNS - column) / radius
        left *= 1 - depth * 2.0 ** -(away**power)
    return left


RINGS = spots(0.08, 6.0, radius=12.0) / spots(0.08, 6.0, radius=4.0)


def pixels(sigma, seed=8):
    return 1 + sigma * np.random.default_rng(seed).standard_normal(SHAPE)


def frames(transmission, dark=NONE, rate=NONE):
    """Return a maker of darks and flats of a split. transmission, dark, rate : (H, W),
    what is left of light, offsets in DN of all frames, and dark current in DN/s."""

    def make(number, split):
        rng = np.random.default_rng((number, 7))
        groups = darks(number, split, NONE)
        for level in LEVELS:
            made = []
            for _ in range(4):
                light = rng.poisson(level * transmission / GAIN) * GAIN
                frame = BLACK + light + 3.0 * rng.standard_normal(SHAPE)
                made.append(np.rint(frame).astype(np.uint16))
            names = tuple(f"{split} {level} {n}" for n in range(4))
            groups.append((GroupInfo("flat", names, 0.1, None, split), made))
        for info, made in groups:
            more = dark + rate * info.exposure_time
            made[:] = [np.rint(one + more).astype(np.uint16) for one in made]
        return groups

    return make


def named(transmission, **more):
    found = shown(frames(transmission, **more)).found
    return {name: one for name, one in found.items() if one.nats > LEAST}


@pytest.mark.parametrize(
    ("transmission", "names"),
    [
        slow(np.ones(SHAPE), set()),
        (pixels(0.02), set()),
        slow(lattice(), {"pdaf_pixels"}),
        (lattice(pitch=9, row=5, gain=0.05) * pixels(0.01), {"pdaf_pixels"}),
        (spots(0.03), {"dust"}),
        slow(spots(0.2) * pixels(0.01), {"dust"}),
        (spots(0.05) * lattice(), {"dust", "pdaf_pixels"}),
        (2 - spots(0.05), set()),  # brighter spots
        (spots(0.08, radius=12.0) / spots(0.08, radius=6.0), set()),  # rings
        slow(1 - 0.3 * ((ROWS - 48) ** 2 + (COLUMNS - 60) ** 2) / 5904, set()),
        slow(1 + 0.02 * np.sin(COLUMNS / 3.0), set()),  # columns
    ],
)
def test_each_has_its_name(transmission, names):
    assert named(transmission).keys() == names


def test_rings_are_there_and_are_unlike_dust():
    of_rings, of_dust = (
        shown(frames(one)).found["dust"] for one in (RINGS, spots(0.05))
    )
    assert of_rings.unlike > LEAST > of_dust.unlike == of_rings.nats == 0


def test_offsets_in_darks_lack_no_light():
    """The same pixels are as far off in darks."""
    assert named(np.ones(SHAPE), dark=20 * (lattice(gain=1.0) - 1)) == {}


def test_spots_add_their_squares_to_the_variance_of_the_sensitivity():
    light = spots(0.2)
    found = shown(frames(light)).spots
    assert found == pytest.approx(np.mean((1 - light) ** 2), rel=0.1)


@pytest.mark.parametrize("rate", [0.0, 20.0])
def test_values_of_a_lattice(rate):
    """The gain within 3.5 standard errors, whatever dark current its pixels have; the
    place exactly."""
    own = rate * (lattice(gain=1.0) - 1)
    gain, *place = named(lattice() * pixels(0.01), rate=own)["pdaf_pixels"].figures
    assert [one.value for one in place] == [14, 9, 4]
    assert abs(gain.value + 0.06) < 3.5 * gain.standard_error < 0.01


@pytest.mark.parametrize("power", [2.0, 6.0])
def test_values_of_dust(power):
    """Depth and radius of soft and of sharp spots, within 3.5 standard errors, which
    are less than a fifth; as many spots as there are."""
    density, depth, radius = named(spots(0.08, power=power))["dust"].figures
    assert density.value == pytest.approx(5 / (SHAPE[0] * SHAPE[1] / 1e6))
    for figure, truth in ((depth, 0.08), (radius, 5.0)):
        assert abs(figure.value - truth) < 3.5 * figure.standard_error, figure
        assert figure.standard_error < truth / 5


def test_dust_in_corners_has_smooth_coefficients():
    """By Legendre's polynomials of degrees 0 to 5, whose squares have a sum of 1 over
    the samples of a side, and without the mean."""
    plane = statistics_of(frames(spots(0.05))(1, "training")).planes[0]
    numbers = zip(("density", "depth", "radius"), (9.0, 0.05, 20.0), strict=True)
    figures = [Figure(name, "", x, 0.0, x, x) for name, x in numbers]
    sides = []
    for n in plane.shape:
        sizes = np.sqrt((2 * np.arange(6) + 1) / n)
        sides.append(legvander(np.linspace(-1, 1, n), 5).T * sizes[:, None])
    spot = 0.05 * (np.hypot(*2 * np.indices(plane.shape)) < 20)
    squares = (sides[0] @ spot @ sides[1].T) ** 2
    wanted = 4 * (squares.sum() - squares[0, 0]) / 35
    found = like_shading(Shape("dust", 1.0, tuple(figures)), plane, 2)
    assert found == pytest.approx(wanted, rel=0.2)  # of sums in place of integrals
    assert like_shading(Shape("dust", 1.0, _figures([], SHAPE)), plane, 2) == 0


def test_spots_of_the_law_of_dust_lose_nothing_by_it(monkeypatch):
    found = shown(frames(spots(0.05))).found["dust"]
    monkeypatch.setattr(sys.modules[dust.__module__], "_fitted", lambda *_: None)
    assert shown(frames(spots(0.05))).found["dust"].nats == found.nats > LEAST


def test_patterns_are_set_apart_from_all_else(tmp_path):
    """Mean images have the level, the pixels and the rows that they would have without
    them; and a file has the patterns."""
    make = frames(lattice(gain=-0.3) * spots(0.2))
    whole, plain = (
        statistics_of(one(0, "training")) for one in (make, frames(np.ones(SHAPE)))
    )
    for plane, other in zip(whole.planes, plain.planes, strict=True):
        np.testing.assert_allclose(plane.level, other.level, rtol=1e-3)
        for part in ("smooth_columns", "field"):
            variance = whole.variance(-1, part) / plain.variance(-1, part)
            assert 1 / 4 < variance.mean() < 4, part
    path = str(tmp_path / "statistics.npz")
    whole.save(path)
    again = ConstantStatistics.load(path)
    assert again.lattice == whole.lattice
    np.testing.assert_array_equal(again.spots.places, whole.spots.places)


@pytest.mark.parametrize("shape", [(2, 2), (5, 7), (7, 64)])
def test_frames_too_small_for_a_lattice(shape):
    found = lattice_of(np.ones(shape, np.float32), 2)
    assert found is None or not found.is_sure


def test_one_pixel_is_no_lattice():
    """However far it is off, its lattice has others that are not."""
    light = np.random.default_rng(1).standard_normal(SHAPE).astype(np.float32)
    light[40, 50] = 1e4
    found = lattice_of(light, 2)
    assert found is not None and not found.is_sure


@pytest.mark.parametrize("defects", [0.0, 2e-3])
def test_pixels_beside_their_neighbours_are_in_units_of_the_noise(defects):
    """Of 2 % of pixels, which a defect is beside, two thirds were within the noise."""
    rng = np.random.default_rng(6)
    light = 0.3 + 0.01 * rng.normal(size=(240, 320)).astype(np.float32)
    light[rng.random(light.shape) < defects] += 10
    found = _beside_neighbours(light, 2)
    within = np.abs(found[~np.isnan(found)]) < 1
    assert within.mean() == pytest.approx(0.6827, abs=0.02)


def test_the_mean_of_a_lattice_is_that_of_most_of_its_pixels():
    values = np.random.default_rng(7).normal(-0.06, 0.01, 200)
    values[::20] = 1.0
    places = np.arange(200)
    mean, error = _mean(Excess(places, places, values, np.full(200, 1e4)))
    assert error == pytest.approx(0.01 / 190**0.5, rel=0.15)
    assert mean == pytest.approx(-0.06, abs=4 * error)


def test_weights_of_frames_show_light_and_nothing_that_darks_have():
    """Of frames whose noise differs, in the unit of light; none without any light, nor
    where the frames cannot tell it from what they have besides."""
    light, time = np.array([0.0, 0.0, 300.0, 900.0]), np.array([0.0, 4.0, 0.1, 0.1])
    others = np.column_stack([np.ones(4), time])
    covariance = np.diag([1.0, 4.0, 2.0, 3.0])
    found = _weights(light, others, covariance)
    assert found @ light == pytest.approx(1)
    assert found @ others == pytest.approx(0, abs=1e-12)
    assert _weights(0 * light, others, covariance) is None
    assert _weights(light[:2] + 9, others[:2], covariance[:2, :2]) is None


@pytest.mark.parametrize(
    ("count", "low", "high"),
    [(0, 0.0, 3.689), (1, 0.0253, 5.572), (5, 1.623, 11.668), (10, 4.795, 18.390)],
)
def test_as_many_spots_as_poisson_s_law_lets_be(count, low, high):
    """95 % intervals by F. Garwood, Biometrika 28, 1936, of spots whose middle is in a
    frame of a quarter of a megapixel."""
    errors = np.array([0.1, 0.1, 0.01, 0.2, 0.5])
    inside = Spot(np.array([3.0, 5.0, 0.05, 4.0, 2.0]), errors, 0.0)
    outside = Spot(np.array([-0.6, 5.0, 0.05, 4.0, 2.0]), errors, 0.0)
    density, depth, radius = _figures([*count * [inside], outside], (500, 500))
    assert (density.value, density.unit) == (4 * count, "1/MP")
    assert (density.low, density.high) == pytest.approx((4 * low, 4 * high), rel=1e-3)
    assert (depth.value, radius.value) == (pytest.approx(0.05), pytest.approx(4.0))


@pytest.mark.parametrize(("count", "mean"), [(1, 0.5), (10, 4.0), (300, 200.0)])
def test_nats_of_many_bound_their_chance(count, mean):
    nats = nats_beyond(count, mean)
    chance = -poisson.logsf(count - 1, mean)
    assert 0 < nats <= chance < nats + 4
    assert nats_beyond(mean, mean) == nats_beyond(mean - 0.1, mean) == 0
    assert nats_beyond(count, 0.0) == np.inf
