# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What repeats of a frame show: planted faults are said, and chance rarely is."""

from dataclasses import replace

import numpy as np
import pytest

from cg2raw.diagnose.captures.check import check
from cg2raw.diagnose.captures.reader import read_frames
from cg2raw.diagnose.captures.repeats import FALSE_ALARM, Repeats, repeats_of
from cg2raw.statistics import GroupInfo, frame_statistics
from diagnose import capture_files as files

BLACK, READ = 64.0, 3.0  # DN
DN_PER_ELECTRON = 0.5
MASKED = "kind: dark, mask: m.npy"


def darks(count, seed=1, shape=(60, 80), drift=0.3, hot=20):
    """Return frames with read noise, drifting levels and some hot pixels, DN."""
    rng = np.random.default_rng(seed)
    charge = np.zeros(shape)
    charge.ravel()[rng.choice(charge.size, hot, replace=False)] = 1500
    frames = BLACK + rng.normal(0, READ, (count, *shape))
    frames += DN_PER_ELECTRON * rng.poisson(charge, frames.shape)
    return frames + drift * rng.standard_normal((count, 1, 1))


def flats(count, seed=1, lamp=0.0, shape=(60, 80)):
    """Return frames of a lamp of 800 DN that shines lamp (relative) unevenly."""
    rng = np.random.default_rng(seed)
    level = 800 * (1 + lamp * rng.standard_normal((count, 1, 1)))
    light = DN_PER_ELECTRON * rng.poisson(level / DN_PER_ELECTRON, (count, *shape))
    return BLACK + light + rng.normal(0, READ, (count, *shape))


def series(frames, kind="dark"):
    """Return the Repeats of frames, named 0, 1, ..."""
    raws = np.rint(frames).clip(0, 4095).astype(np.uint16)
    info = GroupInfo(kind, tuple(map(str, range(len(raws)))))
    found = frame_statistics([(info, [lambda r=r: r for r in raws])], 2, 4095)
    return repeats_of(found, 1)


def test_the_noise_is_that_of_a_frame_without_outliers():
    frames = darks(5, shape=(200, 300))
    frames[2, :5] += 300
    expected = np.hypot(READ, 12**-0.5)
    assert series(frames).noise == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize(("rows", "columns"), [(0, 0), (2, 0), (0, 2)])
def test_a_level_knows_its_error(rows, columns):
    """By pixels' noise and by that of whole rows or columns; patterns add nothing."""
    rng = np.random.default_rng(2)
    frames = rng.normal(BLACK, READ, (200, 60, 80)) + rng.normal(0, 9, (60, 80))
    frames += rows * rng.standard_normal((200, 60, 1))
    frames += columns * rng.standard_normal((200, 1, 80))
    frames[1:, 0, :5] = 4000
    found = series(frames)
    assert found.levels.std() == pytest.approx(found.error, rel=0.15)  # 3 x 5 %
    assert abs(found.levels.mean() - BLACK) < 0.5


@pytest.mark.parametrize("away", [4.0, -4.0])
def test_a_first_frame_that_is_off(away):
    frames = darks(8)
    frames[0] += away
    words = series(frames).first_is_off()
    assert words.startswith(f"0: the first of 8 repeats is {away:+.0f}"[:-1])
    assert words.endswith("leave it out, as many cameras need a first frame to settle")
    frames[0] -= away
    frames[3] += away  # another one that is off is no first
    assert series(frames).first_is_off() is None


def test_three_frames_do_not_say_that_the_first_is_off():
    frames = darks(3)
    frames[0] += 50
    assert series(frames).first_is_off() is None


def by_chance(count, seed):
    """Return Repeats of levels that differ by noise of 0.2 DN, at 800 DN of light."""
    levels = BLACK + 800 + 0.2 * np.random.default_rng(seed).standard_normal(count)
    return Repeats([str(n) for n in range(count)], levels, 0.2)


def test_a_first_frame_is_off_by_chance_as_rarely_as_stated():
    found = [replace(by_chance(4, n), error=0.0).first_is_off() for n in range(2000)]
    # Poisson: 2 are expected, and 9 or more come once in 4000 times.
    assert 0 < sum(words is not None for words in found) < 9 and FALSE_ALARM == 1e-3


@pytest.mark.parametrize("lamp", [0.002, 0.02])
def test_a_lamp_that_drifts(lamp):
    frames = flats(10, lamp=lamp)
    light = frames.mean((1, 2)) - BLACK
    words = series(frames, "flat").lamp_drift(BLACK)
    deviation, most = light.std(ddof=1) / light.mean(), np.ptp(light) / light.mean()
    assert f"differs by {deviation:.2%}"[:-2] in words and f"{most:.1%}"[:-2] in words


def test_a_steady_lamp_drifts_by_chance_as_rarely_as_stated():
    found = [by_chance(3, n).lamp_drift(BLACK) for n in range(2000)]
    assert 0 < sum(words is not None for words in found) < 9
    assert by_chance(3, 1).lamp_drift(BLACK + 900) is None  # there is no light


@pytest.mark.parametrize("count", [3, 10])
def test_cosmic_rays_are_counted_in_the_frame_that_has_them(count):
    frames = darks(count, hot=60)
    frames[1, 10, 5:25] += 200
    frames[2, 40, 5:13] += 90
    words = series(frames).cosmic_rays()
    assert f"0 and its {count - 1} repeats: 28 pixels lie above" in words
    assert words.endswith("0 below: cosmic rays; most, 20, in 1")


def test_what_flickers_both_ways_is_no_cosmic_ray():
    frames = darks(9)
    rng = np.random.default_rng(6)
    frames[:, :4] += 100 * (rng.random((9, 4, 80)) < 0.5)
    assert series(frames).cosmic_rays() is None


@pytest.mark.parametrize("seed", range(20))
def test_hot_pixels_and_noise_are_no_cosmic_rays(seed):
    assert series(darks(5, seed, (120, 160), hot=500)).cosmic_rays() is None
    assert series(darks(2, seed)).cosmic_rays() is None


def manifest(folder, frames, lines):
    """Write frames and a manifest of lines, one for each; return what is said."""
    for number, frame in enumerate(frames):
        np.save(folder / f"{number}.npy", np.rint(frame).clip(0).astype(np.uint16))
    lines = [f"{{file: {n}.npy, {line}}}" for n, line in enumerate(lines)]
    return files.checked(folder, lines)


def test_frames_of_two_times_or_temperatures_are_no_repeats(tmp_path):
    frames = darks(8)
    frames[:4] += 30  # of another exposure time or temperature
    for field, one, two in (("exposure_time", 5, 1), ("temperature", 20, -5)):
        lines = [f"kind: dark, {field}: {one if n < 4 else two}" for n in range(8)]
        assert manifest(tmp_path, frames, lines).is_right
    frames[4:] -= 6
    frames[4] += 20
    [words] = manifest(tmp_path, frames, lines).complaints
    assert words.startswith("4.npy: the first of 4 repeats is +")


def test_unknown_lights_are_repeats_within_a_set(tmp_path):
    frames = np.concatenate([flats(3), flats(3, 2) * 0.5 + 32])
    common = "kind: flat, scene: unknown, illuminant: D65"
    lines = [f"{common}, set: s{n // 3}" for n in range(6)]
    assert manifest(tmp_path, frames, lines).remarks == []
    [words] = manifest(tmp_path, frames, [f"{common}, set: s"] * 6).remarks
    assert "a lamp that drifts; nuisance: [light] would cover it: add it" in words
    assert manifest(tmp_path, frames, [common] * 6).remarks == []


def test_frames_stay_in_order(tmp_path):
    lines = ["kind: dark, iso: 100", "kind: dark, iso: 200", "kind: dark, iso: 100"]
    found = manifest(tmp_path, darks(3), lines)
    assert [one.name for one in found.integrities] == ["0.npy", "1.npy", "2.npy"]
    assert [capture.name for capture in found.captures] == ["0.npy", "1.npy", "2.npy"]


def test_pictures_of_one_set_are_repeats_by_their_means(tmp_path):
    picture = np.kron(
        np.random.default_rng(3).uniform(90, 900, (6, 8)), np.ones((8, 8))
    )
    same = picture + np.random.default_rng(4).normal(0, READ, (3, *files.SHAPE))
    frames = [frame * (1.3 if n == 2 else 1) for n, frame in enumerate(same)]
    np.save(tmp_path / "r.npy", files.picture())
    line = "kind: scene, scene: r.npy, illuminant: D65, set: s"
    [words] = manifest(tmp_path, frames, [line] * 3).remarks
    assert "0.npy and its 2 repeats: their light differs by 17" in words
    assert manifest(tmp_path, same, [line] * 3).remarks == []


def test_a_mask_that_leaves_too_little_to_compare(tmp_path):
    mask = np.zeros(files.SHAPE, np.uint8)
    mask[20:23, 30:33] = 1
    np.save(tmp_path / "m.npy", mask)
    found = manifest(tmp_path, darks(3, shape=files.SHAPE), [MASKED] * 3)
    [words] = found.remarks
    assert words.startswith("0.npy and its 2 repeats: nearly all samples are masked")
    assert found.is_right and found.integrities[2].high < 80


def test_masked_pixels_count_in_nothing(tmp_path):
    frames = darks(5, shape=files.SHAPE, hot=0)
    frames[1, :8] = 4000  # light that leaks in
    mask = np.ones(files.SHAPE, np.uint8)
    mask[:8] = 0
    np.save(tmp_path / "m.npy", mask)
    found = manifest(tmp_path, frames, [MASKED] * 5)
    assert found.is_right and found.remarks == []
    assert found.integrities[1].high < 200
    assert not manifest(tmp_path, frames, ["kind: dark"] * 5).is_right


def test_progress_ends_with_all_frames(tmp_path):
    shares = []
    path = files.standard_set(tmp_path)
    _, sensor, frames, _ = read_frames(path)
    check(frames, sensor, progress=shares.append)
    assert shares[-1] == 1
    steps = np.diff([0, *shares])
    assert steps.min() >= 0 and steps.max() < 1.01 / len(frames)


@pytest.mark.parametrize(("bright", "is_companded"), [(8, False), (40, True)])
def test_codes_that_lie_farther_apart_in_brighter_flats(tmp_path, bright, is_companded):
    rng = np.random.default_rng(5)
    steps = ((200, 20, 8), (700, 60, bright))
    frames = [np.rint(rng.normal(m, s, files.SHAPE) / d) * d for m, s, d in steps]
    common = "kind: flat, scene: unknown, illuminant: D65"
    found = manifest(tmp_path, frames, [f"{common}, set: s{n}" for n in range(2)])
    assert any("companded" in words for words in found.complaints) == is_companded
