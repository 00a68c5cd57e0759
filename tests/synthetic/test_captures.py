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
from cg2raw.synthetic import charge, scenes
from cg2raw.synthetic.captures import draw_hidden, simulate_captures
from cg2raw.synthetic.density import log_density
from cg2raw.synthetic.measured import Measured
from cg2raw.synthetic.readout import Noise, read_out
from cg2raw.synthetic.sensors import ISO, drawn_sensor, with_noise
from cg2raw.synthetic.strengths import KINDS, UNKNOWN_KINDS
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


def test_a_chart_fits_into_a_narrow_picture_and_leaves_gaps():
    """24 patches of 2 x 2 pixels, in squares of three: 18 columns of 21."""
    for seed in range(20):
        image = np.full((30, 21, 3), np.nan)
        scenes.chart(np.random.default_rng(seed), image)
        assert np.isfinite(image[..., 0]).sum() == 24 * 4


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
