# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""FrameStatistics of the core against the plain version, and by laws and bad input."""

from dataclasses import fields, replace
from io import BytesIO

import numpy as np
import pytest

from cg2raw import _core
from cg2raw.statistics.constant import (
    PARTS,
    RATE_EDGES,
    SMOOTH,
    VERSION,
    ConstantStatistics,
    Copies,
    DarkRates,
    GroupInfo,
    PlaneStatistics,
    polynomials,
)
from cg2raw.statistics.frame_statistics import frame_statistics
from cg2raw.statistics.kept import Kept
from cg2raw.statistics.patterns import Lattice, Spots
from oracles.plain_statistics import plain_statistics

WHITE = 4095
FILLED = 3e-5  # relative: fills are as many DN from where more rounds lead
TOLERANCE = {
    "noise": 1e-5,
    "outlier_noise": 1e-5,
    "fourth": 1e-5,
    "scatter": 1e-7,
}  # pairs are in float


def drawn(shape, count, level=200.0, sigma=5.0, seed=1):
    """Return frames of one group, with a fixed pattern and a level that drifts."""
    rng = np.random.default_rng(seed)
    fixed = level + 3 * np.random.default_rng(99).standard_normal(shape)
    fixed = fixed * (1 + 0.2 * np.linspace(-1, 1, shape[1]) ** 2)
    noise = sigma * rng.standard_normal((count, *shape))
    drift = rng.standard_normal((count, 1, 1))
    return list(np.clip(np.rint(fixed + noise + drift), 0, WHITE).astype(np.uint16))


def groups_of(*lists, kinds=()):
    """Return [(GroupInfo, frames), ...]; darks of 0, 1, ... s."""
    names = iter(range(10**6))
    kinds = [*kinds, *["dark"] * (len(lists) - len(kinds))]
    return [
        (GroupInfo(kind, tuple(str(next(names)) for _ in frames), float(t)), frames)
        for t, (kind, frames) in enumerate(zip(kinds, lists, strict=True))
    ]


def measured(groups, side, white=WHITE, threads=2, **more):
    """Return the core's statistics of frames."""
    readers = [(info, [lambda f=f: f for f in frames]) for info, frames in groups]
    return frame_statistics(readers, side, white, threads=threads, **more)


def assert_alike(found, expected, exactly=False, rtol=1e-9):
    """All arrays are equal, or as close as sums in other orders are."""
    assert found.groups == expected.groups and found.white == expected.white
    for name in ("frames", "pairs", "lags", "overlaps", "transients")[: 4 + exactly]:
        a, b = getattr(found, name), getattr(expected, name)
        np.testing.assert_allclose(a, b, atol=0 if exactly else 1e-6, err_msg=name)
    assert not exactly or repr(found.rates) == repr(expected.rates)
    assert len(found.planes) == len(expected.planes)
    for plane, other in zip(found.planes, expected.planes, strict=True):
        for field in fields(PlaneStatistics):
            a, b = getattr(plane, field.name), getattr(other, field.name)
            a, b = (np.concatenate(x) if isinstance(x, tuple) else x for x in (a, b))
            if field.name == "codes":
                a, b = (
                    np.pad(x, ((0, 0), (0, WHITE + 1 - x.shape[1]))) for x in (a, b)
                )
            if exactly:
                np.testing.assert_array_equal(a, b, err_msg=field.name)
            elif field.name == "residuals":  # a few lie at the ends of bins
                assert np.abs(a - b).sum() <= 0.002 * b.sum() + 2
            else:
                rtol = TOLERANCE.get(field.name, rtol)
                if field.name == "outliers":  # without transients: of whole sums
                    np.testing.assert_allclose(a, b, atol=0.2)
                    continue
                size = np.abs(b[np.isfinite(b)]).max(initial=1e-2)
                np.testing.assert_allclose(
                    a, b, rtol=rtol, atol=rtol * size, err_msg=field.name
                )


@pytest.mark.parametrize(
    ("shape", "side"),
    [
        ((48, 60), 1),
        ((31, 47), 1),
        ((131, 83), 1),
        ((8, 9), 1),
        ((1, 70), 1),
        ((70, 1), 1),
        ((1, 1), 1),
        ((49, 63), 2),
        ((2, 31), 2),
        ((80, 96), 2),
        ((67, 79), 6),
    ],
)
def test_it_is_what_plain_numpy_says(shape, side):
    groups = groups_of(
        drawn(shape, 4),
        drawn(shape, 1, level=230, seed=2),
        drawn(shape, 3, level=1500, sigma=20, seed=3),
        kinds=("dark", "dark", "flat"),
    )
    assert_alike(measured(groups, side), plain_statistics(groups, side, WHITE))


def spoilt(frames):
    """Return frames with a hot pixel, a dead column, an odd row and a cosmic ray."""
    frames = [frame.copy() for frame in frames]
    for frame in frames:
        frame[10, 20], frame[:, 31], frame[5] = 3000, 0, frame[5] + 60
    frames[2][40, 50] = 900
    return frames


@pytest.mark.parametrize("side", [1, 2])
def test_masks_and_fills_are_those_of_plain_numpy(side):
    groups = groups_of(spoilt(drawn((96, 120), 4)), drawn((96, 120), 2, seed=5))
    found = measured(groups, side)
    assert_alike(found, plain_statistics(groups, side, WHITE), rtol=FILLED)
    masked = np.zeros((96, 120), bool)
    for p, plane in enumerate(found.planes):
        masked[p // side :: side, p % side :: side] = plane.masked
    expected = np.zeros((96, 120), bool)
    expected[10, 20] = expected[40, 50] = expected[:, 31] = expected[5] = True
    assert (masked == expected).all()


def test_what_one_frame_has_alone_is_counted_and_in_no_mean():
    """A cosmic ray and a dropped pixel; hot pixels, which all frames have, are."""
    first, second = spoilt(drawn((96, 120), 4)), drawn((96, 120), 3, seed=5)
    second[1][70, 80] = 0
    found = measured(groups_of(first, second), 2)
    mean = found.mean_of
    above, below = found.transients[..., 0], found.transients[..., 1]
    assert above.tolist() == [[0, 0, 1, 0], [0, 0, 0, 0]]
    assert below.tolist() == [[0, 0, 0, 0], [0, 1, 0, 0]]
    expected = np.mean(first, axis=0)
    levels = [round(frame[::2, ::2].mean()) for frame in first]
    others = [int(first[i][40, 50]) - levels[i] for i in (0, 1, 3)]
    expected[40, 50] = np.mean(others) + np.mean(levels)
    np.testing.assert_allclose(mean(0), expected, atol=0.13)  # of a sum of integers
    others = np.mean([second[0][70, 80], second[2][70, 80]])
    assert mean(1)[70, 80] == pytest.approx(others, abs=2)  # levels drift


def test_the_noise_of_a_hot_pixel_is_no_transient():
    frames = drawn((96, 120), 5)
    for frame, charge in zip(frames, (900, 1000, 1100, 1000, 1300), strict=True):
        frame[10, 20:40] = charge
    found = measured(groups_of(frames), 2)
    assert not found.transients.any()
    assert sum(int(plane.masked.sum()) for plane in found.planes) == 20


def test_codes_of_each_frame_are_handed_on():
    frames, found, shares = drawn((48, 60), 3), [], []
    looked = lambda *one: found.append(one)  # noqa: E731
    measured(groups_of(frames), 2, looked=looked, progress=shares.append)
    assert shares == sorted(shares) and shares[-1] == 1
    assert [number for number, _ in found] == [0, 1, 2]
    for (_, counts), frame in zip(found, frames, strict=True):
        expected = np.bincount(frame[1::2, ::2].ravel(), minlength=counts.shape[1])
        np.testing.assert_array_equal(counts[2], expected)


def test_codes_of_masked_samples_are_left_out():
    (frame,) = drawn((48, 60), 1)
    excluded = np.random.default_rng(3).random((48, 60)) < 0.5
    counts = _core.code_counts(frame, 2, excluded).sum(axis=0)
    np.testing.assert_array_equal(counts, np.bincount(frame[~excluded]))
    with pytest.raises(ValueError, match="mask is 48 x 60 pixels, the frame 60 x 48"):
        _core.code_counts(frame, 2, excluded.T)


@pytest.mark.parametrize(("part", "planted"), [("pixel", 25), ("fast_rows", 25 + 1080)])
def test_the_variance_of_a_part(part, planted):
    """Of rows that move by 6 DN, on 30 samples of a plane's row."""
    frames = drawn((160, 60), 6, seed=7)
    rng = np.random.default_rng(8)
    moved = [f + np.rint(rng.normal(0, 6, (160, 1))) for f in frames]
    found = measured(groups_of([f.astype(np.uint16) for f in moved], frames[:1]), 2)
    assert found.variance(0, part).mean() == pytest.approx(planted, rel=0.1)
    # Of a single frame, with its fixed pattern of 3 DN.
    assert found.variance(1).mean() == pytest.approx(25 + 9, rel=0.05)


@pytest.mark.parametrize("side", [1, 2, 6])
def test_threads_do_not_matter(side):
    groups = groups_of(spoilt(drawn((170, 130), 5)), drawn((170, 130), 2, seed=5))
    assert_alike(*(measured(groups, side, threads=n) for n in (1, 3)), exactly=True)


def test_a_file_has_all_of_it(tmp_path):
    excluded = np.zeros((96, 121), bool)
    excluded[7:9, 3] = True
    groups = groups_of(spoilt(drawn((96, 121), 5)), drawn((96, 121), 1))
    found = replace(
        measured(groups, 2, excluded=excluded),
        rates=(DarkRates("", np.arange(len(RATE_EDGES) - 1), 0.1, 0.02),),
        lattice=Lattice(12, 5, 3, 80.0, 89_426),
        spots=Spots(np.array([[5.5, 7.5, 4.0]]), 700),
    )
    path = str(tmp_path / "statistics.npz")
    found.save(path)
    again = ConstantStatistics.load(path)
    assert_alike(again, found, exactly=True)
    np.testing.assert_array_equal(again.planes[0].products, found.planes[0].products)
    for number in (0, 1, 0):
        mean = again.mean_of(number)
        np.testing.assert_array_equal(mean, found.mean_of(number), strict=True)
        mean[:] = 0
    some = again.only([1])
    for one in (again, some):
        np.testing.assert_array_equal(one.excluded, excluded, strict=True)
        assert (one.lattice, repr(one.spots)) == (found.lattice, repr(found.spots))
        assert repr(one.rates) == repr(found.rates)
    np.testing.assert_array_equal(some.mean_of(0), found.mean_of(1))


@pytest.mark.parametrize("side", [1, 2])
def test_pixels_that_are_noisy_in_two_groups(side):
    """Three that jump by 8 sigma from frame to frame are beyond 4 in some pair."""
    lists = [drawn((60, 130), 6), drawn((60, 130), 6, seed=5), drawn((60, 130), 1)]
    for frames in lists:
        for number, frame in enumerate(frames):
            frame[[3, 40, 58], [7, 64, 128]] += np.uint16(40 * (number % 2))
    groups = groups_of(*lists)
    found = measured(groups, side)
    np.testing.assert_array_equal(
        found.overlaps, plain_statistics(groups, side, WHITE).overlaps
    )
    assert found.overlaps[0, 1] == found.overlaps[1, 0] == 3
    assert not found.overlaps[2].any()


def test_rates_of_darks():
    """Of a tenth of the pixels 2 DN/s more: what the others have is the level. Of darks
    of 0, 5 and 10 s, the noise of a slope, with that of the means that are taken
    off."""
    rng, shape = np.random.default_rng(8), (90, 120)
    rate = 2.0 * (rng.random(shape) < 0.1)
    times, sigma = (0.0, 5.0, 10.0), 4.0
    lists = [
        [
            np.rint(200 + rate * t + sigma * rng.standard_normal(shape)).astype(
                np.uint16
            )
            for _ in range(4)
        ]
        for t in times
    ]
    groups = [
        (replace(info, exposure_time=t, split="training"), frames)
        for (info, frames), t in zip(groups_of(*lists), times, strict=True)
    ]
    statistics = measured(groups, 2)
    (found,) = statistics.rates
    plane = statistics.planes[0]
    lost = 1 - plane.freedom[-1] / plane.masked.size
    noise = np.sqrt((sigma**2 + 1 / 12) / 4 / 50 + lost * rate.var())
    assert found.split == "training" and found.counts.sum() == rate.size
    assert found.noise == pytest.approx(noise, rel=0.02)
    above = found.counts[RATE_EDGES[1:] > 1 / noise].sum()
    assert above == pytest.approx((rate > 0).sum(), rel=0.02)
    assert measured(groups[:1], 2).rates == ()


def test_some_of_the_groups():
    """As of these alone, where nothing is masked for the others' sake."""
    lists = drawn((48, 60), 4), drawn((48, 60), 1, seed=2), drawn((48, 60), 3, seed=3)
    groups = groups_of(*lists)
    some = [groups[2], groups[0]]
    assert_alike(measured(groups, 2).only([2, 0]), measured(some, 2))


def test_the_shortest_darks_of_a_split_are_those_that_repeat_each_other():
    """Flats, and a dark without another of its kind, are none."""
    plan = [
        ("flat", "training", 0.0, 2),
        ("dark", "training", 9.0, 2),
        ("dark", "training", 3.0, 2),
        ("dark", "training", 1.0, 1),
        ("dark", "test", 2.0, 2),
        ("dark", "training", 3.0, 3),
    ]
    lists = [drawn((8, 9), count, seed=n) for n, (*_, count) in enumerate(plan)]
    groups = [
        (replace(info, kind=kind, split=split, exposure_time=time), frames)
        for (info, frames), (kind, split, time, _) in zip(
            groups_of(*lists), plan, strict=True
        )
    ]
    found = measured(groups, 1)
    assert [list(one) for one in found.darks_by_time()] == [[4], [2, 5], [1]]
    assert [list(one) for one in found.darks_by_time("training")] == [[2, 5], [1]]
    assert list(found.shortest_darks("training")) == [2, 5]
    assert list(found.shortest_darks("validation")) == []


def test_a_corner_without_samples_is_not_filled_with_the_noise_of_the_rest():
    """Of the field's squares hardly any are outside of it, for some polynomials: fitted
    to their end, these are 10 DN off there."""
    rng = np.random.default_rng(2)
    frames = list(np.rint(rng.normal(100, 4, (4, 64, 80))).astype(np.uint16))
    excluded = np.zeros((64, 80), bool)
    excluded[:16, 64:] = True
    (plane,) = measured(groups_of(frames), 1, excluded=excluded).planes
    fills = np.mean(frames, axis=0)[excluded] - plane.outliers[0]
    assert np.abs(fills - 100).max() < 4


def half(content):
    return content[: len(content) // 2]


def one_byte(content):
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


def without_a_mean(content):
    with np.load(BytesIO(content)) as file:
        rest = {name: file[name] for name in file.files if name != "mean 1"}
    np.savez(room := BytesIO(), **rest)
    return room.getvalue()


def one_array(content):
    np.save(room := BytesIO(), np.zeros(3))
    return room.getvalue()


@pytest.mark.parametrize(
    "damaged",
    [
        half,
        one_byte,
        without_a_mean,
        one_array,
        lambda content: b"",
        lambda content: b"no archive",
        lambda content: b"PK\x05\x06" + bytes(18),
    ],
)
def test_a_file_of_something_else_is_refused(tmp_path, damaged):
    path = tmp_path / "statistics.npz"
    measured(groups_of(drawn((8, 9), 2), drawn((8, 9), 1)), 1).save(path)
    path.write_bytes(damaged(path.read_bytes()))
    with pytest.raises(ValueError, match=r"statistics\.npz: no statistics of frames"):
        ConstantStatistics.load(path)


def test_a_file_is_of_certain_facts(tmp_path):
    path = tmp_path / "statistics.npz"
    measured(groups_of(drawn((8, 9), 2)), 1).save(path, {"a": "1", "b": "2"})
    ConstantStatistics.load(path)
    ConstantStatistics.load(path, {"b": "2", "a": "1"})
    for facts, name in (
        ({"a": "1", "b": "3"}, "b"),
        ({"a": "1"}, "b"),
        ({"a": "1", "b": "2", "c": "3"}, "c"),
    ):
        with pytest.raises(ValueError, match=f"other frames: {name} has changed"):
            ConstantStatistics.load(path, facts)


def test_a_file_of_another_version_is_refused(tmp_path):
    path = str(tmp_path / "statistics.npz")
    measured(groups_of(drawn((8, 9), 2)), 1).save(path)
    with np.load(path) as file:
        arrays = dict(file)
    arrays["about"] = np.array(
        str(arrays["about"]).replace(f'"version": {VERSION}', '"version": 0')
    )
    np.savez(path, **arrays)
    with pytest.raises(ValueError, match=f"of version 0; must be {VERSION}: remove"):
        ConstantStatistics.load(path)


@pytest.mark.parametrize("part", range(8))
def test_white_noise_is_alike_in_all_parts(part):
    (plane,) = measured(groups_of(drawn((64, 96), 6)), 1).planes
    freedom = 5 * plane.freedom[part]
    within = 4 * np.sqrt(2 / freedom)
    variance = plane.scatter[0, part] / freedom
    assert variance == pytest.approx(25 + 1 / 12, rel=within), PARTS[part]
    assert plane.power[0] == pytest.approx(25 + 1 / 12, rel=0.06)


def test_mean_images_have_the_noise_of_copied_lines():
    """A band of 24 rows is masked: of each part, and of the level, squares of white
    noise of 25 DN^2 as predicted."""
    rng, masked = np.random.default_rng(5), np.zeros((24, 32), bool)
    masked[7:17] = True
    found, levels, count = [], [], 150
    for _ in range(count):
        frame = np.rint(200 + 5 * rng.standard_normal(masked.shape)).astype(np.uint16)
        (plane,) = measured(groups_of([frame]), 1, excluded=masked).planes
        squares = plane.products[:, 0, 0] / plane.count / plane.mean_noise
        squares[-1] = plane.products[-1, 0, 0] / plane.freedom[-1]
        found.append(squares / (25 + 1 / 12))
        levels.append(plane.level[0])
    part = [PARTS.index(name) for name in ("smooth_rows", "slow_rows", "fast_rows")]
    within = 4 * np.std(found, axis=0) / np.sqrt(count)
    for at in (*part, PARTS.index("fast_columns"), len(PARTS) - 1):
        mean = np.mean(found, axis=0)[at]
        assert mean == pytest.approx(1, abs=within[at]), PARTS[at]
    level = (25 + 1 / 12) * plane.copies.level / masked.size
    assert np.var(levels) == pytest.approx(level, rel=4 * np.sqrt(2 / count))


def test_copied_lines_leave_so_much_freedom():
    """By Satterthwaite, of the covariance of coefficients of white lines and copies:
    its trace, and the square of that over the trace of its square."""
    masked = np.isin(np.arange(60), [0, 1, 20, 21, 22, 40])
    others = np.flatnonzero(~masked)
    copy = np.eye(60)[[others[np.abs(others - line).argmin()] for line in range(60)]]
    low = polynomials(60)
    fast = np.linalg.svd(np.eye(60) - low.T @ low)[0][:, : 60 - len(low)].T
    copies = Copies.of(masked, np.zeros(32, bool))
    for name, basis in (
        ("smooth_rows", low[1 : SMOOTH + 1]),
        ("slow_rows", low[SMOOTH + 1 :]),
        ("fast_rows", fast),
    ):
        covariance = basis @ copy @ copy.T @ basis.T
        at, trace = PARTS.index(name), np.trace(covariance)
        assert copies.noise[at] == pytest.approx(trace / len(basis))
        freedom = trace**2 / (covariance**2).sum() / len(basis)
        assert copies.freedom[at] == pytest.approx(freedom)
    whole = low[0] @ copy @ copy.T @ low[0]
    assert (copies.level, copies.open_lines) == (pytest.approx(whole), (0.9, 1.0))


@pytest.mark.parametrize("axis", ["rows", "columns"])
@pytest.mark.parametrize(
    ("degree", "part"), [(1, "smooth"), (3, "smooth"), (4, "slow"), (11, "slow")]
)
def test_a_polynomial_is_in_the_part_of_its_degree(axis, degree, part):
    """Its squares, but for those of rounding; of squares of steps of 40 DN."""
    profile = 2000 * polynomials(60)[degree]
    image = np.broadcast_to(profile, (60, 60))
    frame = np.rint(1000 + (image if axis == "columns" else image.T)).astype(np.uint16)
    (plane,) = measured(groups_of([frame]), 1).planes
    share = plane.products[:, 0, 0] / (60 * 2000**2)
    expected = np.array([name == f"{part}_{axis}" for name in PARTS], float)
    assert share == pytest.approx(expected, abs=1e-3)


def test_parts_add_up():
    """By Parseval, the parts' squares are those of the samples."""
    frames = drawn((61, 47), 4)
    (plane,) = measured(groups_of(frames), 1).planes
    mean = np.mean(frames, axis=0)
    assert plane.products.sum() == pytest.approx(((mean - mean.mean()) ** 2).sum())
    rest = np.array(frames) - mean
    rest -= rest.mean(axis=(1, 2), keepdims=True)
    assert plane.scatter.sum() == pytest.approx((rest**2).sum())
    assert plane.freedom.sum() == 61 * 47 - 1


@pytest.mark.parametrize("length", [1, 2, 3, 8, 24, 500])
def test_polynomials_are_orthonormal_and_leave_half(length):
    found = polynomials(length)
    np.testing.assert_allclose(found @ found.T, np.eye(len(found)), atol=1e-12)
    assert found.shape[1] == length
    assert len(found) - 1 <= (length - 1) / 2


@pytest.mark.parametrize(
    ("lists", "side", "words"),
    [
        ([], 1, "frames: a group has none; give darks or flats"),
        ([drawn((8, 9), 1), []], 1, "frames: a group has none"),
        (
            [[*drawn((8, 9), 1), *drawn((9, 8), 1)]],
            1,
            "frame is 8 x 9 pixels, the first",
        ),
        (
            [drawn((2, 30), 2)],
            6,
            "30 x 2 pixels; must be at least as large as the CFA's",
        ),
    ],
)
def test_bad_frames_are_refused(lists, side, words):
    with pytest.raises(ValueError, match=words):
        measured(groups_of(*lists), side)


def test_what_is_no_frame_is_refused():
    info = GroupInfo("dark", ("a", "b"))
    for bad in (np.zeros((8, 9)), np.zeros((8, 9, 3), np.uint16), "frame"):
        with pytest.raises(ValueError, match="raw must be|raw is"):
            frame_statistics(
                [(info, [lambda: drawn((8, 9), 1)[0], lambda b=bad: b])], 1, 99
            )
    for side, white, words in (
        (0, 99, "side: 0; must be"),
        (1, 0, "white: 0; must be"),
    ):
        with pytest.raises(ValueError, match=words):
            frame_statistics([(info, [lambda: drawn((8, 9), 1)[0]])], side, white)


def test_a_reader_that_fails_says_why():
    def fails():
        raise OSError("a.dng: cannot be read")

    with pytest.raises(OSError, match=r"a\.dng: cannot be read"):
        frame_statistics([(GroupInfo("dark", ("a",)), [fails])], 1, 99)


def test_a_strong_shading_masks_no_line():
    """cos^4 that is 0.45 in the corner: polynomials do not follow it to the edge."""
    rng = np.random.default_rng(3)
    down, across = np.mgrid[-1 : 1 : 56 * 1j, -1.28 : 1.28 : 72 * 1j]
    light = 4000 / (1 + 0.36 * ((down - 0.1) ** 2 + (across + 0.15) ** 2)) ** 2
    frames = [light + 3 * rng.standard_normal(light.shape) for _ in range(4)]
    codes = np.rint(frames).astype(np.uint16)
    found = measured(groups_of(codes, kinds=["flat"]), 1, 65535)
    assert not found.planes[0].masked.any()


def test_samples_are_excluded():
    groups = groups_of(drawn((48, 60), 3), drawn((48, 60), 2, seed=4))
    excluded = np.zeros((48, 60), bool)
    excluded[:, 55:] = excluded[7:9, 3:30] = True
    for _, frames in groups:
        for frame in frames:
            frame[excluded] = 4000
    found = measured(groups, 2, excluded=excluded)
    assert_alike(found, plain_statistics(groups, 2, WHITE, excluded), rtol=FILLED)
    assert sum(int(plane.masked.sum()) for plane in found.planes) == excluded.sum()
    with pytest.raises(ValueError, match="all samples are masked: none is left"):
        measured(groups, 2, excluded=np.ones((48, 60), bool))
    with pytest.raises(ValueError, match="mask is 48 x 60 pixels, the frames 60 x 48"):
        measured(groups, 2, excluded=excluded.T)


def test_a_frame_is_read_again_where_all_do_not_fit(monkeypatch):
    from cg2raw.statistics import kept

    groups, read = groups_of(drawn((40, 50), 3)), []

    def reader(index, frame):
        read.append(index)
        return frame

    readers = [
        (info, [lambda i=i, f=f: reader(i, f) for i, f in enumerate(frames)])
        for info, frames in groups
    ]
    whole = frame_statistics(readers, 1, WHITE)
    assert sorted(read) == [0, 1, 2]
    monkeypatch.setattr(kept.Kept.__init__, "__defaults__", (40 * 50 * 2,))
    assert_alike(frame_statistics(readers, 1, WHITE), whole, exactly=True)
    assert sorted(read) == [0, 0, 1, 1, 1, 2, 2, 2]


def test_groups_say_what_they_are():
    (info, frames), *_ = groups_of(drawn((8, 9), 2))
    info = replace(info, temperature=-5.0, split="training", warmth=(1.0,))
    assert measured([(info, frames)], 1).groups == (info,)


def test_statistics_in_steps_are_those_of_the_numbers_of_steps():
    """Codes of n steps of 4 DN from 3 on say in steps what codes of n DN do; pixels
    that stand out are masked at a quarter of a step."""
    lists = drawn((40, 48), 4, level=9.0), drawn((40, 48), 3, level=60.0, seed=2)
    coded = [[4 * frame + 3 for frame in frames] for frames in lists]
    found = measured(groups_of(*coded), 2, 4 * WHITE + 3, step=4).in_steps(4, 3)
    expected = measured(groups_of(*lists), 2)
    assert expected.planes[0].low[0] > 0
    assert_alike(found, replace(expected, rates=()))


def test_a_kept_frame_is_kept_once():
    frame = np.zeros((8, 8), np.uint16)
    read = Kept().reader(lambda: frame)
    other = Kept(frame.nbytes)
    assert other.reader(read) is read
    assert read() is read()
    assert other.has_room(frame)  # none of which is taken
    assert not other.has_room(frame)


@pytest.mark.parametrize("side", [1, 2])
def test_blocks_are_as_bright_and_as_noisy_as_their_pixels(side):
    """Noise that grows to the right, over slopes; blocks of 12 x 13 pixels."""
    shape, rng = (96 * side, 104 * side), np.random.default_rng(5)
    across = np.linspace(0, 1, shape[1])
    down = np.linspace(-1, 1, shape[0])[:, None]
    level = 500 + 300 * across + 200 * across**2 * down
    frames = [
        np.rint(level + (4 + 8 * across) * rng.standard_normal(shape)) for _ in range(8)
    ]
    found = measured(groups_of([frame.astype(np.uint16) for frame in frames]), side)
    noise, error = found.block_noise(0)
    level = found.block_levels(0)
    for site, (row, column) in enumerate(np.ndindex(side, side)):
        plane = np.array(frames)[:, row::side, column::side]
        blocks = plane.reshape(8, 8, 12, 8, 13).swapaxes(2, 3)
        mean = blocks.mean(axis=(0, 3, 4)).ravel()
        variance = blocks.var(axis=0, ddof=1).mean(axis=(2, 3)).ravel()
        assert level[site] == pytest.approx(mean, abs=1.5)
        assert noise[site] == pytest.approx(variance, rel=0.35)
        assert noise[site].mean() == pytest.approx(variance.mean(), rel=0.02)
    assert error == pytest.approx(np.sqrt(2 / (4 * 12 * 13)))


def test_planes_of_fewer_lines_than_blocks_have_empty_ones():
    found = measured(groups_of(drawn((5, 60), 2)), 1)
    noise, error = found.block_noise(0)
    assert noise.shape == error.shape == found.block_levels(0).shape == (1, 64)
    assert (error.reshape(8, 8) > 1).all(axis=1).sum() == 3  # rows of blocks of none


@pytest.mark.parametrize(("rare", "splits", "codes"), [(4, 1, 2), (5, 1, 3), (5, 2, 2)])
def test_codes_of_darks_are_those_of_five_samples_in_each_plane(rare, splits, codes):
    """And in each split. One plane has more; what flats have is not counted."""
    dark = np.full((40, 60), 64, np.uint16)
    dark[:20] = 65
    other = np.roll(dark, 20, 0)
    for row, column in ((0, 0), (0, 1), (1, 0), (1, 1)):
        dark[row:20:2, column::2].flat[: rare + (row == 0)] = 66
    plan = [("dark", "training", dark), ("dark", "validation", other)][:splits]
    infos = [info for info, _ in groups_of(*([[dark, other]] * splits), [dark])]
    groups = [
        (replace(info, kind=kind, split=split), [frame, other])
        for info, (kind, split, frame) in zip(infos, plan, strict=False)
    ]
    flat = (replace(infos[-1], kind="flat", frames=("a", "b")), drawn((40, 60), 2))
    assert measured([*groups, flat], 2).dark_codes == codes
