# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The generator of hidden effects keeps to the physics that it states."""

import ast
import hashlib
import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import cg2raw
from cg2raw.synthetic import captures as synthetic_captures
from cg2raw.synthetic import charge, conditions, light, memory, scenes, telegraph
from cg2raw.synthetic.camera import camera_of
from cg2raw.synthetic.captures import draw_hidden, simulate_captures
from cg2raw.synthetic.density import log_density
from cg2raw.synthetic.measured import Measured
from cg2raw.synthetic.posterior import Observation, posterior
from cg2raw.synthetic.readout import Noise, blended, read_out
from cg2raw.synthetic.sensors import ISO, drawn_sensor, with_noise
from cg2raw.synthetic.strengths import KINDS, UNKNOWN_KINDS, _glow, draw_effect
from python.commands import run

SHAPE = (48, 64)
SOURCE = Path(synthetic_captures.__file__).parent
BLENDED = {"noise_reduction": 0.3}
UNRELATED = ("interrupts", "io.atomic_file", "short_messages")
ALLOWED = ("cg2raw.synthetic", "cg2raw.diagnose.captures.capture")
# What the core predicts or draws effects with.
FORBIDDEN = {
    *("simulate", "simulation", "signal", "predict", "apply_effect"),
    *("predict_effect", "add_noise", "to_camera", "mosaic_of", "Simulation", "_core"),
}


@pytest.fixture(scope="module")
def sensor():
    return drawn_sensor(3)


@pytest.fixture(scope="module")
def camera(sensor):
    return camera_of(sensor, "D65", ISO)


def synthetic_camera_of(captures):
    return captures.captures[0].raw.func.__self__


def density(capture):
    """Return the log-density of a frame under the model that drew it."""
    return capture.raw.func.__self__.log_density(capture.raw.args[0])


def report(captures, kind):
    return [c for c in captures.captures if c.group == "report" and c.kind == kind]


def imports_of(tree):
    """Return the modules that a source imports from."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module


@pytest.mark.parametrize(
    "path",
    sorted(SOURCE.glob("*.py")),
    ids=lambda path: path.name,
)
def test_nothing_is_shared_with_what_is_tested(path):
    tree = ast.parse(path.read_text())
    ours = [name for name in imports_of(tree) if name.startswith("cg2raw")]
    extra = {"cg2raw", *(f"cg2raw.{name}" for name in UNRELATED)}
    assert [n for n in ours if n not in extra and not n.startswith(ALLOWED)] == []
    used = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    names = {a.name for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)
             for a in n.names}  # fmt: skip
    assert (used | names) & FORBIDDEN == set()


def test_one_seed_makes_one_set(sensor):
    hidden = draw_hidden(sensor, {"prnu": None, "row_noise": 0.3}, seed=4)
    assert hidden == draw_hidden(sensor, {"prnu": None, "row_noise": 0.3}, seed=4)
    first = simulate_captures(sensor, hidden, seed=4, shape=SHAPE)
    again = simulate_captures(sensor, hidden, seed=4, shape=SHAPE)
    other = simulate_captures(sensor, hidden, seed=5, shape=SHAPE)
    for one, same, another in zip(
        first.captures, again.captures, other.captures, strict=True
    ):
        np.testing.assert_array_equal(one.raw(), same.raw())
        assert (one.raw() != another.raw()).any()


def test_a_set_has_three_disjoint_groups(sensor):
    captures = simulate_captures(sensor, {}, seed=0, shape=SHAPE).captures
    for group in ("fit", "select", "report"):
        mine = [one for one in captures if one.group == group]
        assert [one.kind for one in mine] == ["dark"] * 2 + ["flat"] * 2 + ["scene"] * 4
        assert len({one.exposure_time for one in mine if one.kind == "dark"}) == 2
    sets = {(one.set, one.group) for one in captures}
    assert len({name for name, _ in sets}) == len(sets)


def test_darks_and_flats_that_are_taken_twice_have_noise_of_their_own(sensor):
    hidden = draw_hidden(sensor, {"random_telegraph_noise": None}, seed=6)
    once = simulate_captures(sensor, {}, seed=6, shape=SHAPE).captures
    frames = {
        one.name: one.raw()
        for one in simulate_captures(
            sensor, {}, seed=6, shape=SHAPE, twice=True
        ).captures
    }
    assert all(np.array_equal(one.raw(), frames[one.name]) for one in once)
    twice = simulate_captures(sensor, hidden, seed=6, shape=SHAPE, twice=True)
    assert {one.name for one in twice.captures} == set(frames) and len(frames) == 36
    dark, again = twice.captures[:2]
    assert again.name == f"{dark.name}_again"
    assert (again.set, again.exposure_time) == (dark.set, dark.exposure_time)
    assert (dark.raw() != again.raw()).any()


def test_scenes_have_shadows_colours_and_clipped_lights(sensor):
    for one in report(simulate_captures(sensor, {}, seed=1, shape=SHAPE), "scene"):
        scene = one.scene()
        assert scene.shape == (*SHAPE, 3) and scene.dtype == np.float32
        assert scene.min() > 0
        assert np.quantile(scene, 0.95) / np.quantile(scene, 0.05) > 10
        assert (np.ptp(scene, -1) / scene.mean(-1) > 0.3).mean() > 0.1
        assert 0 < (one.raw() == sensor.white_level).mean() < 0.05


def test_camera_rgb_is_that_of_the_core(sensor, camera):
    scene = np.random.default_rng(0).uniform(0.3, 0.6, (8, 8, 3)).astype(np.float32)
    core = sensor.to_camera(scene, illuminant="D65", highlights=False)
    np.testing.assert_allclose(camera.light(scene), core, rtol=2e-6)
    np.testing.assert_array_equal(
        camera.mosaic(core.astype(float)), sensor.mosaic(core)
    )


@pytest.mark.parametrize("poisson", [False, True])
@pytest.mark.parametrize("electrons", [0.0, 20.0, 900.0])
def test_frames_have_the_stated_mean_and_variance(camera, electrons, poisson):
    shape = (400, 400)
    level = np.full(shape, electrons)
    foot = camera.over(camera.black, shape)
    noise = Noise(excess=1.3, poisson=poisson)
    raw = read_out(np.random.default_rng(1), level, foot, noise, camera).astype(float)
    gain, read = camera.dn_per_electron[0, 0], camera.read_noise[0, 0]
    variance = gain**2 * (1.3 * electrons + read**2) + 1 / 12
    count = raw.size
    mean_error = (raw - foot).mean() - gain * electrons
    assert abs(mean_error) < 4.5 * np.sqrt(variance / count)
    assert raw.var() == pytest.approx(variance, rel=4.5 * np.sqrt(2 / count))


def test_density_of_the_plain_model_is_the_entropy_of_a_gaussian(sensor, camera):
    captures = simulate_captures(sensor, {}, seed=2, shape=SHAPE)
    source = synthetic_camera_of(captures)
    for one in report(captures, "flat") + report(captures, "dark"):
        charges, _ = source.expected(one.raw.args[0], source.patterns)
        gain = camera.over(camera.dn_per_electron, SHAPE)
        read = camera.over(camera.read_noise, SHAPE)
        variance = gain**2 * (charges + read**2) + 1 / 12
        entropy = 0.5 * np.log(2 * np.pi * np.e * variance)
        error = -density(one).mean() - entropy.mean()
        assert abs(error) < 4.5 * np.sqrt(0.5 / charges.size)


PERTURBED = {  # effect -> what stands for "a little otherwise"
    "lens_shading": ("corner_loss", 0.97),
    "crosstalk": ("from_left", 0.8),
    "shot_noise": ("log_gain", 0.6),
    "read_noise": ("log_variance", 0.6),
    "row_noise": ("read_noises", 0.7),
    "heavy_tailed_noise": ("share", 0.4),
    "noise_reduction": ("blend", 0.9),
    "full_well": ("below_white", 0.98),
    "black_level": ("dn_00", 0.8),
    "nonlinearity": ("loss", 0.9),
}
STRENGTH = {"row_noise": 0.5, "full_well": 0.25, "heavy_tailed_noise": 0.05,
            "noise_reduction": 0.3, "read_noise": 0.5, "shot_noise": 0.3,
            "black_level": 1.0}  # fmt: skip


@pytest.mark.parametrize("name", PERTURBED)
def test_truth_is_denser_than_what_is_a_little_otherwise(sensor, name):
    hidden = draw_hidden(sensor, {name: STRENGTH.get(name)}, seed=7)
    field, factor = PERTURBED[name]
    other = {name: {**hidden[name], field: factor * hidden[name][field]}}
    frames = simulate_captures(sensor, hidden, seed=7, shape=SHAPE)
    wrong = synthetic_camera_of(simulate_captures(sensor, other, seed=7, shape=SHAPE))
    gain = 0.0
    for one in frames.captures:
        if one.group == "report":
            expected = wrong.expected(one.raw.args[0], wrong.patterns)
            there = log_density(one.raw(), *expected, wrong.noise, wrong.camera)
            gain += float((density(one) - there).sum())
    assert gain > 10


@pytest.mark.parametrize("name", ["prnu", "dsnu", "column_fixed_pattern", "hot_pixels"])
def test_patterns_are_known_as_far_as_the_fit_frames_tell(sensor, name):
    strength = {"hot_pixels": 5e-3}.get(name, KINDS[name].high)
    hidden = draw_hidden(sensor, {name: strength}, seed=8)
    captures = simulate_captures(sensor, hidden, seed=8, shape=SHAPE)
    source = synthetic_camera_of(captures)
    feasible = knowing = ignorant = 0.0
    for one in report(captures, "dark") + report(captures, "flat"):
        shot = one.raw.args[0]
        rest = (source.noise, source.camera)
        flat = charge.Patterns.none(SHAPE)
        feasible += density(one).sum()
        knowing += log_density(
            one.raw(), *source.expected(shot, source.patterns), *rest
        ).sum()
        ignorant += log_density(one.raw(), *source.expected(shot, flat), *rest).sum()
    assert ignorant + 10 < feasible < knowing


def test_what_is_known_of_a_pixel_by_those_before_it():
    """Against the dense covariance of a row; a pixel that is not known tells nothing,
    and those before it no more."""
    rng = np.random.default_rng(5)
    residual, variance = rng.normal(size=(1, 7)), rng.uniform(1, 2, (1, 7))
    shared = np.zeros((1, 7))
    shared[0, 1:] = rng.uniform(-0.5, 0.5, 6)
    residual[0, 3] = np.nan
    mean, less = memory.told_by_before(residual, variance, shared)
    off = np.diag(shared[0, 1:], 1)
    covariance = np.diag(variance[0]) + off + off.T
    for col in range(7):
        known = [n for n in range(col) if n != 3]
        across = covariance[col, known]
        weights = np.linalg.solve(covariance[np.ix_(known, known)], across)
        assert mean[0, col] == pytest.approx(weights @ residual[0, known])
        assert less[0, col] == pytest.approx(weights @ across)


@pytest.mark.parametrize("correlation", [0.0, 0.3, -0.45])
def test_noise_that_remembers_correlates_as_is_stated(correlation):
    """Within four standard errors of 160,000 pixels; those two apart do not."""
    rng = np.random.default_rng(6)
    noise = memory.with_memory(rng, rng.standard_normal((400, 400)), correlation)
    assert noise.var() == pytest.approx(1, abs=4 * 2 / 400)
    for apart, expected in ((1, correlation), (2, 0.0)):
        found = np.mean(noise[:, apart:] * noise[:, :-apart])
        assert found == pytest.approx(expected, abs=4 * 1.5 / 400)


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


def observed(rng, count, shape=(5, 4)):
    """Return frames of pixels whose patterns are random, one of them clipped in one."""
    frames = []
    for number in range(count):
        usable = np.ones(shape, bool)
        usable[2, 1] = number > 0
        slopes = tuple(rng.uniform(0.5, 2, shape) for _ in range(3))
        frames.append(
            Observation(
                rng.normal(size=shape), rng.uniform(1, 3, shape), usable, slopes
            )
        )
    return frames


def test_patterns_of_a_pixel_are_those_of_linear_regression(camera):
    """Gain and offset, of known variances: (1 / S + sum b b' / v)^-1 sum b r / v."""
    read = float(camera.read_noise.mean())
    hidden = {"prnu": {"sigma": 0.7}, "dsnu": {"read_noises": 1 / read, "shape": 3.0}}
    frames = observed(np.random.default_rng(2), 3)
    truth = charge.Patterns.none((5, 4))
    found = posterior(frames, hidden, camera, truth)
    for at in ((0, 0), (2, 1), (4, 3)):
        seen = [one for one in frames if one.usable[at]]
        b = np.array([[one.slopes[0][at], one.slopes[2][at]] for one in seen])
        v = np.array([one.variance[at] for one in seen])
        r = np.array([one.residual[at] for one in seen])
        expected = np.linalg.inv(np.diag([0.7**-2, 1]) + (b / v[:, None]).T @ b)
        mean = expected @ (b / v[:, None]).T @ r
        assert found.covariance[at][np.ix_([0, 2], [0, 2])] == pytest.approx(expected)
        assert found.covariance[at][1] == pytest.approx(0)  # no leak: it is known
        assert [found.mean.gain[at], found.mean.offset[at]] == pytest.approx(mean)
        slopes = tuple(np.full((5, 4), slope) for slope in (2.0, 5.0, 3.0))
        unsure = np.array([2, 3]) @ expected @ np.array([2, 3])
        assert found.variance(slopes)[at] == pytest.approx(unsure)


def test_offsets_of_columns_are_weighted_means(camera):
    read = float(camera.read_noise.mean())
    hidden = {"column_fixed_pattern": {"read_noises": 0.8 / read}}
    frames = observed(np.random.default_rng(3), 2)
    found = posterior(frames, hidden, camera, charge.Patterns.none((5, 4)))
    weight = sum(one.usable * one.slopes[2] ** 2 / one.variance for one in frames)
    pull = sum(
        one.usable * one.slopes[2] * one.residual / one.variance for one in frames
    )
    variance = 1 / (0.8**-2 + weight.sum(0))
    assert found.column == pytest.approx(variance)
    assert found.mean.column == pytest.approx(variance * pull.sum(0))
    slopes = tuple(np.full((5, 4), 2.0) for _ in range(3))
    assert found.variance(slopes) == pytest.approx(np.tile(4 * variance, (5, 1)))


def test_densities_of_few_levels_add_up_to_one(camera):
    black = camera.black[0, 0]
    levels = (black + np.arange(-60, 340)).astype(np.uint16)[None]
    shape = levels.shape
    foot = camera.over(camera.black, shape)
    gain = camera.dn_per_electron[0, 0]
    for noise in (
        Noise(),
        Noise(poisson=True),
        Noise(weights=(0.9, 0.1), variances=(0.6, 4.6)),
    ):
        charges = np.full(shape, 30 / gain)
        total = np.exp(log_density(levels, charges, foot, noise, camera)).sum()
        assert total == pytest.approx(1, abs=2e-3)


@pytest.mark.parametrize(
    "noise",
    [
        Noise(excess=1.7),
        Noise(excess=1.7, poisson=True),
        Noise(well=25 / 5000),
        Noise(well=60 / 5000, weights=(0.9, 0.1), variances=(0.6, 4.6)),
        Noise(row=3.0),
        Noise(row=3.0, poisson=True),
    ],
    ids=str,
)
def test_densities_of_other_noise_add_up_to_one_too(noise):
    """Each pixel is a row of its own, whose offset is unknown; a full well may be near
    30 electrons. Levels far below black are unlikely, and no more."""
    camera = camera_of(with_noise(drawn_sensor(3), 5000, 2.0, ISO), "D65", ISO)
    gain, black = camera.dn_per_electron[0, 0], camera.black[0, 0]
    dn = np.arange(int(-90 * gain), int(90 * gain))
    levels = (black + dn).astype(np.uint16)[:, None]
    foot = camera.over(camera.black, levels.shape)
    charges = np.full(levels.shape, 30.0)
    found = log_density(levels, charges, foot, noise, camera)
    assert np.exp(found).sum() == pytest.approx(1, abs=2e-3)
    assert found.max() < -1 and (np.diff(found[:, 0], axis=0)[: len(dn) // 2] > 0).all()


@pytest.mark.parametrize(
    "noise",
    [Noise(correlation=0.4), Noise(row=2.0, correlation=0.4)],
    ids=str,
)
def test_densities_of_two_pixels_of_a_row_add_up_to_one(noise):
    """And are those of a normal pair: their levels vary together as their noise does,
    a row's offset by its range squared over 12."""
    camera = camera_of(with_noise(drawn_sensor(3), 5000, 1.5, ISO), "D65", ISO)
    black = camera.black[0, 0]
    read = camera.dn_per_electron[0, 0] * camera.read_noise[0, 0]
    reach = np.arange(-np.ceil(8 * read + 3), np.ceil(8 * read + 3) + 1)
    pairs = np.stack(np.meshgrid(reach, reach), -1).reshape(-1, 2)
    pairs = pairs[: len(pairs) // 2 * 2]
    foot = camera.over(camera.black, pairs.shape)
    levels = (black + pairs).astype(np.uint16)
    found = log_density(levels, np.zeros(pairs.shape), foot, noise, camera)
    weights = np.exp(found.astype(float).sum(1))
    assert weights.sum() == pytest.approx(1, abs=2e-3)
    offset = (2 * noise.row * read) ** 2 / 12
    together = weights @ (pairs[:, 0] * pairs[:, 1])
    assert together == pytest.approx(noise.correlation * read**2 + offset, rel=0.03)
    assert weights @ pairs[:, 0] ** 2 == pytest.approx(
        read**2 + offset + 1 / 12, rel=0.03
    )


def test_densities_of_many_photons_add_up_to_one_too(camera):
    """Beyond what is summed one by one; the third term of the saddle point is 1 / 12 of
    a photon's share, 5e-4 here."""
    gain, black = camera.dn_per_electron[0, 0], camera.black[0, 0]
    sigma = np.sqrt(160 + camera.read_noise[0, 0] ** 2)
    near = black + gain * np.array([160 - 7 * sigma, 160 + 7 * sigma])
    levels = np.arange(*near.round()).astype(np.uint16)[None]
    foot, charges = (
        camera.over(camera.black, levels.shape),
        np.full(levels.shape, 160.0),
    )
    found = log_density(levels, charges, foot, Noise(poisson=True), camera)
    assert np.exp(found).sum() == pytest.approx(1, abs=1e-4)


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


def test_blend_is_undone(camera):
    plane = np.random.default_rng(0).standard_normal((20, 30))
    again = blended(blended(plane, 0.4), 0.4, inverse=True)
    np.testing.assert_allclose(again, plane, atol=1e-12)
    assert blended(np.ones((20, 30)), 0.4) == pytest.approx(1)


def test_a_chart_fits_into_a_narrow_picture_and_leaves_gaps():
    """24 patches of 2 x 2 pixels, in squares of three: 18 columns of 21."""
    for seed in range(20):
        image = np.full((30, 21, 3), np.nan)
        scenes.chart(np.random.default_rng(seed), image)
        assert np.isfinite(image[..., 0]).sum() == 24 * 4


def test_a_glow_is_also_in_corners():
    rng = np.random.default_rng(2)
    drawn = [_glow(rng, 1.0, None) for _ in range(200)]
    places = {(one["down"], one["across"]) for one in drawn}
    assert {(0, 0), (0, 1), (1, 0), (1, 1)} <= places


def test_a_pattern_moves_no_mean(camera):
    """Within four standard errors of 160,000 pixels."""
    strong = {"prnu": {"sigma": 0.2}, "dsnu": {"read_noises": 1.0, "shape": 2.0}}
    drawn = charge.patterns(np.random.default_rng(1), (400, 400), strong, camera)
    for values in (drawn.gain, drawn.offset):
        assert abs(values.mean()) < 4 * values.std() / 400


def test_what_is_moved_stands_beside():
    """Of a ramp, that cubic splines keep but for its mirrored edges."""
    field = light.Field((40, 50), 10)
    ramp = 200 + 2 * field.x + 3 * field.y
    moved = field.moved(ramp, np.full(ramp.shape, 1.5), np.full(ramp.shape, -0.5))
    assert moved[field.inner] == pytest.approx(ramp[field.inner] + 1.5, abs=1e-4)


@pytest.mark.parametrize(
    ("shift", "residual"), [(2.0, 0.0), (0.0, 0.2), (2.0, 0.2), (0.0, 0.0)]
)
def test_a_camera_stands_aside_by_no_more_than_is_stated(shift, residual):
    """Of ramps of a pixel a step: what they are moved by is what they change by."""
    field = light.Field((40, 50), 10)
    ramps = np.stack([100 + field.x, 100 + field.y, np.full(field.x.shape, 9.0)], -1)
    nuisances = {"shift": shift, "residual": residual}
    farthest = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        moved = conditions.misregistered(rng, ramps, field, nuisances)
        by = (moved - ramps)[field.inner]
        assert by[..., 2] == pytest.approx(0, abs=1e-9)  # no structure, no change
        aside = np.hypot(by[..., 0], by[..., 1])
        assert aside.max() <= shift + residual + 1e-3
        farthest.append(aside.max())
        if not residual:
            assert aside == pytest.approx(aside.max(), abs=1e-3)  # all alike
    assert max(farthest) >= 0.6 * (shift + residual)


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


def test_what_no_camera_has_is_refused(sensor):
    hidden = {"prnu": {"sigma": 0.01, "size": 2.0}}
    field = np.ones((48, 60))
    for options, words in (
        ({"hidden": hidden}, "hidden effect prnu needs sigma, not sigma, size"),
        ({"shape": (48, 65)}, "size 65x48 px: both sides must be even, and 48 at le"),
        ({"shape": (46, 64)}, "size 64x46 px: both sides"),
        ({"nuisances": {"fog": 1}}, "nuisance 'fog' must be one of light, exposure"),
        ({"nuisances": {"shift": 20.1}}, "nuisance shift = 20.1 must be 0 to 20"),
        ({"nuisances": {"shift": -0.1}}, "nuisance shift = -0.1 must be 0 to 20"),
        (
            {"measured": Measured(transmission=field)},
            r"measured transmission, \(48, 60\), must have the frames' shape \(48, 6",
        ),
    ):
        given = {"hidden": {}, "seed": 1, "shape": SHAPE} | options
        with pytest.raises(ValueError, match=words):
            simulate_captures(sensor, given.pop("hidden"), **given)
    for full_well, read_noise, words in (
        (9.9, 0.5, "full well 9.9 e- must be 10 to 1000000"),
        (1.1e6, 2, "full well 1.1e"),
        (1000, 0, "read noise 0 e- must be above 0 and below a tenth"),
        (1000, 100, "read noise 100 e- must be above 0 and below a tenth of the full "
         "well, 1000 e-"),
    ):  # fmt: skip
        with pytest.raises(ValueError, match=words):
            with_noise(sensor, full_well, read_noise, ISO)
    for full_well in (10, 1e6):
        noise = with_noise(sensor, full_well, full_well / 20, ISO).noise_at(ISO)
        assert noise["beta1"] == pytest.approx([1 / full_well] * 4)
        assert noise["beta2"] == pytest.approx([1 / 400] * 4)


# How large an effect is by its parameters, in the unit of its strength; of the others
# one parameter is.
SIZES = {
    "exposure": lambda v, unit: abs(np.exp2(v["stops"]) - 1),
    "white_balance": lambda v, unit: np.hypot(
        np.exp2(v["red_stops"]) - 1, np.exp2(v["blue_stops"]) - 1
    ),
    "color_matrix": lambda v, unit: np.linalg.norm(list(v.values())),
    "lateral_chromatic_aberration": lambda v, unit: np.hypot(v["red_px"], v["blue_px"]),
    "color_shading": lambda v, unit: (
        1
        - np.cos(np.radians(v["corner_degrees"]))
        ** max(abs(v["red_power"]), abs(v["blue_power"]))
    ),
    "crosstalk": lambda v, unit: sum(v.values()),
    "bias_structure": lambda v, unit: np.hypot(v["right_dn"], v["down_dn"]) / unit,
}
NOT_ONE = ("black_level",)  # of which each site has another


@pytest.mark.parametrize("name", [*KINDS, *UNKNOWN_KINDS])
def test_an_effect_is_as_strong_as_is_stated(camera, name):
    kind = KINDS.get(name) or UNKNOWN_KINDS[name]
    rng = np.random.default_rng(3)
    unit = float((camera.dn_per_electron * camera.read_noise).mean())
    for strength in np.geomspace(kind.low, kind.high, 9):
        values = draw_effect(name, rng, camera, strength)
        if name in SIZES:
            assert SIZES[name](values, unit) == pytest.approx(strength)
        elif name not in NOT_ONE:
            assert strength in [pytest.approx(abs(one)) for one in values.values()]
    drawn = [kind.random_strength(rng) for _ in range(400)]
    assert kind.low <= min(drawn) <= max(drawn) <= kind.high * (1 + 1e-12)
    middle = np.log(drawn).mean() - np.log(kind.low * kind.high) / 2
    width = np.log(kind.high / kind.low)
    assert abs(middle) <= 4.5 * width / np.sqrt(12 * 400)  # log-uniform
    for strength in (0.0, -1.0, 10.01 * kind.high, np.nan):
        with pytest.raises(ValueError, match=rf"of {name} \(.*\) must be above 0 and"):
            draw_effect(name, rng, camera, strength)


def test_former_names_of_effects_are_told_the_new(camera):
    for name, words in (
        ("early_clipping", "'early_clipping' is called 'full_well' now"),
        ("fog", "'fog' is unknown; there are amplifier_glow, "),
    ):
        with pytest.raises(ValueError, match=f"hidden effect {words}"):
            draw_effect(name, np.random.default_rng(0), camera)


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


def test_colours_turn_about_grey():
    still = {"hue": 0.0, "saturation": 0.0, "red_as_green": 0.0}
    scene = np.array([[0.2, 0.2, 0.2], [0.5, 0.1, 0.3]])

    def seen(**values):
        return light.recolored(scene, {"color_matrix": still | values})

    for values in ({"hue": 0.3}, {"saturation": 0.5}, {"red_as_green": 0.1}):
        assert seen(**values)[0] == pytest.approx(scene[0])
    assert seen() == pytest.approx(scene)
    assert seen(saturation=-1.0)[1] == pytest.approx(0.3)
    assert seen(saturation=1.0)[1] == pytest.approx([0.7, -0.1, 0.3])
    assert seen(hue=2 * np.pi / 3)[1] == pytest.approx([0.3, 0.5, 0.1])
    assert seen(red_as_green=0.1)[1] == pytest.approx([0.5, 0.13, 0.3])
    hidden = {
        "exposure": {"stops": 1.0},
        "white_balance": {"red_stops": 1.0, "blue_stops": -2.0},
    }
    assert light.gained(np.ones(3), hidden) == pytest.approx([4, 2, 0.5])


def test_a_lens_moves_mirrors_and_spreads():
    field = light.Field((41, 61), 12)
    ramps = np.stack([200 + field.x, 200 + field.y, np.full(field.x.shape, 200)], -1)
    plain = ramps[field.inner]
    found = light.through_lens(ramps, {"lens_distortion": {"corner_px": -2.0}}, field)
    assert found[20, 30] == pytest.approx(plain[20, 30])
    corner = found[0, 0, :2] - plain[0, 0, :2]  # moved along the radius
    assert corner == pytest.approx(2 * np.array([30, 20]) / np.hypot(30, 20), abs=0.01)
    values = {"red_px": 1.5, "blue_px": -1.0, "bend": 0.5}
    hidden = {"lateral_chromatic_aberration": values}
    same = np.repeat(200 + field.x[..., None], 3, -1)
    moved = light.through_lens(same, hidden, field)[20, -1] - same[field.inner][20, -1]
    ratio = 30 / np.hypot(30, 20)
    bend = 0.5 * ratio + 0.5 * ratio**3
    assert moved == pytest.approx([1.5 * bend, 0, -bend], abs=0.01)
    spot = np.zeros_like(ramps)
    spot[12 + 5, 12 + 10] = 1
    ghost = {"ghost_image": {"share": 0.05, "disc_px": 0.01}}
    found = light.through_lens(spot, ghost, field)
    assert found[40 - 5, 60 - 10] == pytest.approx(0.05, abs=1e-4)
    shading = {
        **{"corner_degrees": 20.0, "red_power": 2.0, "blue_power": -1.0},
        **{"axis_x": 0.0, "axis_y": 0.0},
    }
    cast = light.through_lens(np.ones_like(ramps), {"color_shading": shading}, field)
    cosine = np.cos(np.radians(20))
    assert cast[0, 0] == pytest.approx([cosine**2, 1, 1 / cosine])


def test_transfer_functions_are_those_of_optics():
    """A disc's first zero lies at 3.8317 / (2 pi r); an aperture passes 0.391 of half
    its cutoff, nothing from there on (Goodman, section 6.3)."""
    f = np.array([0.0, 3.8317 / (2 * np.pi * 2.5), 0.5, 0.4, 0.2])
    assert light.disc(f, 2.5)[:2] == pytest.approx([1, 0], abs=1e-4)
    assert light.airy(f, 0.4)[[0, 2, 3, 4]] == pytest.approx([1, 0, 0, 0.391], abs=1e-3)


def test_fall_off_is_the_fourth_power_of_the_cosine():
    field = light.Field((101, 101), 0)
    values = {"corner_loss": 0.4, "axis_x": 0.0, "axis_y": 0.0}
    rgb = light.through_lens(np.ones((101, 101, 3)), {"lens_shading": values}, field)
    assert rgb[50, 50] == pytest.approx(1)
    assert rgb[0, 0] == pytest.approx(0.6)
    tangent = np.sqrt(0.6**-0.5 - 1)
    half_way = np.cos(np.arctan(tangent / 2)) ** 4
    assert rgb[25, 25] == pytest.approx(half_way)


@pytest.mark.parametrize("name", ["blur", "motion_blur", "veiling_glare"])
def test_spread_light_is_kept(sensor, name):
    hidden = draw_hidden(sensor, {name: None}, seed=9)
    field = light.Field((64, 64), 12)
    rows, cols = np.mgrid[-44:44, -44:44]
    spot = np.exp(-(rows**2 + cols**2) / 4)  # as sharp as a render, nearly
    image = np.repeat(spot[..., None], 3, axis=-1)
    after = light.through_lens(image, hidden, field)
    assert after.sum((0, 1)) == pytest.approx(image.sum((0, 1)), rel=0.02)
    assert after.max() < 0.995


@cache
def clean(full_well):
    """Return a sensor, its camera without effects, and what that expects of its report
    frames. full_well : electrons."""
    sensor = with_noise(drawn_sensor(3), full_well, 2.0, ISO)
    captures = simulate_captures(sensor, {}, seed=10, shape=SHAPE)
    camera = synthetic_camera_of(captures)
    shots = [c.raw.args[0] for c in captures.captures if c.group == "report"]
    return sensor, camera, {s.name: camera.expected(s, camera.patterns) for s in shots}


@pytest.mark.parametrize("name", [*KINDS, *UNKNOWN_KINDS])
def test_every_effect_can_be_hidden_and_seen(name):
    """Photons that are counted, where they are few."""
    kind = KINDS.get(name) or UNKNOWN_KINDS[name]
    sensor, camera, expected = clean(100.0 if name == "poisson_shot_noise" else 5000.0)
    hidden = draw_hidden(sensor, {name: kind.high}, seed=10)
    frames = simulate_captures(sensor, hidden, seed=10, shape=SHAPE)
    gap = []
    for one in frames.captures:
        if one.group == "report":
            rest = (camera.noise, camera.camera)
            there = log_density(one.raw(), *expected[one.name], *rest)
            gap.append(float((density(one) - there)[8:-8, 8:-8].mean()))
    assert np.mean(gap) > 3e-4


def test_nuisances_change_the_capture_and_are_declared(sensor):
    clean = simulate_captures(sensor, {}, seed=11, shape=SHAPE)
    studio = simulate_captures(
        sensor, {}, seed=11, shape=SHAPE, nuisances=conditions.STUDIO
    )
    assert studio.nuisances == {"light", "exposure", "registration", "radiance"}
    assert clean.nuisances == frozenset() and clean.uncertainty == {}
    for one, other in zip(clean.captures, studio.captures, strict=True):
        if one.kind == "scene":
            ratio = other.scene() / one.scene()
            assert 0.005 < ratio.std() < 0.02
        if one.kind == "flat":
            black = sensor.black_level[0]
            factor = (other.raw().mean() - black) / (one.raw().mean() - black)
            assert 0.78 < factor < 1.22 and abs(factor - 1) > 1e-3
        if one.kind == "dark":
            np.testing.assert_array_equal(one.raw(), other.raw())


def test_command_writes_a_set_that_readers_take(tmp_path):
    folder = tmp_path / "blind"
    argv = ["-s", "nikon-d40", "--effects", "lens_shading=0.3,random", "--seed", "2"]
    argv = ["diagnose", "synthesize", *argv, "--size", "64x48", "-o", str(folder)]
    done = run(*argv, "--json")
    assert (done.code, done.err) == (0, "")
    said, truth = json.loads(done.out), (folder / "truth.json").read_bytes()
    assert (said["folder"], said["frames"]) == (str(folder), 36)
    assert said["truth_sha256"] == hashlib.sha256(truth).hexdigest()
    assert said["truth_sha256"] in (folder / "captures.yaml").read_text()
    assert "assumed, not measured: full well 10000 e-, read noise 5 e-" in done.out
    hidden = json.loads(truth)["hidden"]
    assert hidden["lens_shading"]["corner_loss"] == 0.3 and len(hidden) == 2
    dng = cg2raw.read_dng_metadata(str(folder / "fit_dark_1.dng"))
    assert dng.cfa == "BGGR" and dng.shot["exposure_time"] > 1
    assert np.load(folder / "report_scene_1.npy").shape == (48, 64, 3)
    assert cg2raw.Sensor(str(folder / "sensor.json")).noise_at(100)["beta1"][0] == 1e-4
    for option, is_said in (((), True), (("--quiet",), False)):
        done = run(*argv, *option)
        assert (done.code, done.err, bool(done.out)) == (0, "", is_said)


def test_a_render_is_off_by_what_is_stated():
    """Smoothly, rms of a set's render, and by grain, rms of a pixel."""
    scene = np.full((200, 300, 3), 0.5)
    for radiance, grain in ((0.01, 0.0), (0.0, 0.005), (0.01, 0.005)):
        nuisances = {"radiance": radiance, "render_noise": grain}
        off = (
            conditions.rendered(np.random.default_rng(1), scene, nuisances) / scene - 1
        )
        assert np.ptp(off, axis=2).max() < 1e-6  # of all colours alike
        off = off[..., 0]
        assert off.std() == pytest.approx(np.hypot(radiance, grain), rel=0.02)
        steps = np.diff(off, axis=1).std() / np.sqrt(2)
        assert steps == pytest.approx(grain, rel=0.02, abs=2e-4)


@pytest.mark.parametrize("studio", [True, False])
def test_captures_of_a_studio_say_what_may_be_off(studio):
    files = synthetic_captures.Synthesis(
        "canon-70d", "prnu", 1, "64x48", "D65", None, None, None, studio
    ).folder()
    name, text = next(iter(files.items()))
    assert name == "captures.yaml"
    for line in (
        b"nuisance: [exposure, light, radiance, registration]\n",
        b"uncertainty: {light: 0.005, radiance: 0.01}\n",
    ):
        assert (line in text) == studio


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--effects", "fog"], "hidden effect 'fog' is unknown"),
        (["--effects", "prnu=much"], "'much' is no number"),
        (["--effects", "prnu=-1"], "must be above 0"),
        (["--effects", "prnu,prnu"], "names prnu twice"),
        (["--size", "96"], "must be WxH"),
        (["--size", "95x64"], "must be even"),
        (["--read-noise", "0"], "must be a number from 0.001"),
        (["--seed", "-1"], "must be a whole number from 0"),
        (["-s", "fujifilm-x-m1"], "must be a Bayer pattern"),
        (["-s", "gopro-hero6-black"], "has effects of its own, lens_shading"),
    ],
)
def test_command_says_what_is_wrong(tmp_path, options, message):
    folder = tmp_path / "blind"
    words = ("-s", "canon-70d", "--effects", "prnu", *options, "-o", str(folder))
    done = run("diagnose", "synthesize", *words)
    assert done.code in (1, 2) and message in done.err
    assert not folder.exists()


def test_all_effects_that_can_be_hidden_are_listed():
    done = run("diagnose", "synthesize", "--list-effects")
    assert done.code == 0
    lines = done.out.splitlines()
    names = {line.split()[0] for line in lines if line.startswith("  ")}
    assert names == {*KINDS, *UNKNOWN_KINDS}


@pytest.mark.parametrize(
    ("name", "field", "place", "blend"),
    [("prnu", "gain", 0, {}), ("dsnu", "offset", 2, {}), ("prnu", "gain", 0, BLENDED)],
)
def test_what_is_unknown_of_a_pattern_is_stated(sensor, name, field, place, blend):
    hidden = draw_hidden(sensor, {name: KINDS[name].high, **blend}, seed=12)
    source = synthetic_camera_of(
        simulate_captures(sensor, hidden, seed=12, shape=SHAPE)
    )
    error = getattr(source.patterns, field) - getattr(source.found.mean, field)
    sure = source.found.covariance[..., place, place]
    assert np.mean(error**2) == pytest.approx(sure.mean(), rel=0.06)
    assert sure.mean() < 0.7 * getattr(source.patterns, field).var()


def test_density_of_blended_noise_is_the_entropy_of_its_spectrum(camera):
    shape, blend = (200, 200), 0.35
    charges = np.full(shape, 800.0)
    foot = camera.over(camera.black, shape)
    noise = Noise(blend=blend)
    raw = read_out(np.random.default_rng(5), charges, foot, noise, camera)
    gain, read = camera.dn_per_electron[0, 0], camera.read_noise[0, 0]
    u = np.cos(np.pi * np.arange(100) / 100)
    v = u[:, None]
    response = 1 - blend + blend / 4 * (u + v + 2 * u * v)
    power = gain**2 * (800 + read**2) * response**2 + 1 / 12
    entropy = 0.5 * np.mean(np.log(2 * np.pi * np.e * power))
    measured = -log_density(raw, charges, foot, noise, camera).mean()
    assert measured == pytest.approx(entropy, abs=4.5 * np.sqrt(0.5 / raw.size))
