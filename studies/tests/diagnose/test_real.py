# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The suite of real frames: its halves, and what is planted by hand in one of them.

The frames here are drawn by NumPy; the suite does not know."""

import ast
import json
import os
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("scipy")

from cg2raw.diagnose.captures.reader import divided, read_frames
from studies.diagnose import cameras, planted, real
from studies.diagnose import run as command
from studies.diagnose.planted import PLANTS, Exposure, Levels
from studies.diagnose.real import calibrated, halves, plantable
from studies.diagnose.real_frames import VARIABLE
from studies.diagnose.suites import cases

SIDE, BLACK, READ, GAIN, WHITE = 128, 500.0, 6.0, 0.5, 16383  # DN, DN per electron
LEVEL = 4000.0  # DN of a flat above black
PROFILE = {
    "schema": 1,
    "id": "planted",
    "make": "Made",
    "model": "Up",
    "unique_camera_model": "Made Up",
    "sources": {"noise": "made up"},
    "cfa": "MONO",
    "width": SIDE,
    "height": SIDE,
    "bits": 14,
    "black_level": BLACK,
    "white_level": WHITE,
    "noise": [
        {
            "iso": 100.0,
            "beta1": GAIN / (WHITE - BLACK),
            "beta2": (READ / (WHITE - BLACK)) ** 2,
        }
    ],
}


def drawn(rng, level):
    """Return a frame of Poisson and read noise, (H, W) DN."""
    charge = GAIN * rng.poisson(level / GAIN, (SIDE, SIDE))
    noise = READ * rng.standard_normal((SIDE, SIDE))
    return np.round(BLACK + charge + noise).astype(np.uint16)


@pytest.fixture(scope="module")
def manifest(tmp_path_factory):
    """Return a captures.yaml of 8 short darks, 8 long ones, 8 flats."""
    folder, rng = tmp_path_factory.mktemp("camera"), np.random.default_rng(5)
    (folder / "sensor.json").write_text(json.dumps(PROFILE))
    lines = ["sensor: sensor.json", "iso: 100", "frames:"]
    for kind, seconds, level in (
        ("dark", 0.01, 0),
        ("dark", 10, 0),
        ("flat", 1, LEVEL),
    ):
        for n in range(8):
            name = f"{kind}_{seconds}_{n}.npy"
            np.save(folder / name, drawn(rng, level))
            scene = ", scene: unknown" if kind == "flat" else ""
            lines.append(
                f"  - {{file: {name}, kind: {kind}, exposure_time: {seconds}{scene}}}"
            )
    (folder / "captures.yaml").write_text("\n".join(lines) + "\n")
    return folder / "captures.yaml"


LEVELS = Levels(np.full((SIDE, SIDE), BLACK), GAIN, READ, WHITE, LEVEL)


def put(name, strength, level=LEVEL, seconds=10.0, frame=1):
    """Return (level before, level after) an effect was planted in a frame."""
    before = drawn(np.random.default_rng(frame), level) - BLACK
    sensor, own = np.random.default_rng(77), np.random.default_rng(1000 + frame)
    shot = Exposure(before, seconds, level > 0, sensor, own)
    return before, PLANTS[name](shot, strength, LEVELS)


# 16384 pixels tell a variance within 1.1 %, a mean within 0.8 % of the noise's sd;
# tolerances are four times that.
def test_light_that_is_lost_leaves_poisson_noise():
    _, after = put("exposure", 0.4)
    assert after.mean() == pytest.approx(0.6 * LEVEL, abs=2)
    assert after.var() == pytest.approx(0.6 * LEVEL * GAIN + READ**2, rel=0.045)
    _, shaded = put("lens_shading", 0.4)
    corner, middle = shaded[:4, :4].mean(), shaded[60:68, 60:68].mean()
    assert corner / middle == pytest.approx(0.6, abs=0.03)
    dark, same = put("lens_shading", 0.4, level=0)
    assert np.array_equal(dark, same)


def test_a_gain_of_noise_leaves_the_mean():
    before, after = put("shot_noise", 0.3)
    assert after.mean() == pytest.approx(before.mean(), abs=2)
    wanted = np.exp(0.3) * LEVEL * GAIN + READ**2
    assert after.var() == pytest.approx(wanted, rel=0.045)


@pytest.mark.parametrize(
    ("name", "strength", "measure", "wanted", "tolerance"),
    [
        ("dark_current", 5.0, lambda a, b: (b - a).mean(), 5 * 10 * GAIN, 0.5),
        ("dark_current", 5.0, lambda a, b: (b - a).var(), 50 * GAIN**2, 0.6),
        ("read_noise", 0.5, lambda a, b: b.var() / READ**2, np.exp(0.5), 0.075),
        ("row_noise", 0.5, lambda a, b: (b - a)[:, 0].std() / READ, 0.5, 0.13),
        ("row_noise", 0.5, lambda a, b: (b - a).std(1).max(), 0, 1e-9),
        ("column_fixed_pattern", 0.5, lambda a, b: (b - a)[0].std() / READ, 0.5, 0.13),
        ("column_fixed_pattern", 0.5, lambda a, b: (b - a).std(0).max(), 0, 1e-9),
        ("dsnu", 0.5, lambda a, b: (b - a).std() / READ, 0.5, 0.02),
        ("black_level", 0.5, lambda a, b: abs((b - a).mean()) / READ, 0.5, 1e-9),
        ("hot_pixels", 0.01, lambda a, b: (b > a).mean(), 0.01, 0.0035),
        ("heavy_tailed_noise", 0.02, lambda a, b: (b != a).mean(), 0.02, 0.0045),
    ],
)
def test_what_is_planted_in_a_dark(name, strength, measure, wanted, tolerance):
    assert measure(*put(name, strength, level=0)) == pytest.approx(
        wanted, abs=tolerance
    )


@pytest.mark.parametrize("name", ["dsnu", "column_fixed_pattern", "hot_pixels", "prnu"])
def test_a_fixed_pattern_is_that_of_the_sensor(name):
    level = LEVEL if name == "prnu" else 0
    first, second = (put(name, 0.02, level=level, frame=n) for n in (1, 2))
    one, other = ((after - before).ravel() for before, after in (first, second))
    assert np.corrcoef(one, other)[0, 1] > 0.9


def test_rows_are_new_in_every_frame():
    one, other = (np.subtract(*put("row_noise", 0.5, level=0, frame=n)) for n in (1, 2))
    assert abs(np.corrcoef(one[:, 0], other[:, 0])[0, 1]) < 4 / SIDE**0.5


def test_what_is_planted_in_a_flat():
    before, after = put("prnu", 0.02)
    ratio = after / before
    assert ratio.std() == pytest.approx(0.02, rel=0.03) and ratio.mean() == (
        pytest.approx(1, abs=1e-3)
    )
    before, after = put("nonlinearity", 0.05)
    assert after.mean() == pytest.approx(0.95 * LEVEL, rel=1e-3)
    before, after = put("full_well", 0.02)
    ceiling = 1.02 * 0.98 * LEVEL
    assert after.max() < ceiling + 6 * READ < before.max()
    before, after = put("noise_reduction", 0.4, level=0)
    share = np.mean(after[:, 2:] * after[:, :-2]) / after.var()
    assert share == pytest.approx(0.6 * 0.2 / (0.6**2 + 0.4**2 / 4), abs=0.04)


def test_halves_are_shared_out_within_kind_and_exposure(manifest):
    frames = read_frames(manifest)[2]
    divisions = [halves(frames), halves(frames, np.random.default_rng(1))]
    for first, second in divisions:
        names = [f.capture.name for half in (first, second) for f in half]
        assert sorted(names) == sorted(f.capture.name for f in frames)
        for half in (first, second):
            kinds = [(f.capture.kind, f.capture.exposure_time) for f in half]
            assert {kinds.count(kind) for kind in kinds} == {4}
    by_turns, by_chance = ({f.capture.name for f in d[0]} for d in divisions)
    assert by_turns != by_chance


@pytest.mark.skipif(VARIABLE not in os.environ, reason=f"no {VARIABLE}: real frames")
def test_each_split_of_the_ccd_repeats_what_is_planted_in():
    path = cameras.manifest("ccd", Path(os.environ[VARIABLE]))
    captures, _ = divided(halves(read_frames(path)[2])[1])
    seen = Counter((c.group, c.kind, c.exposure_time) for c in captures)
    assert set(seen.values()) == {2} and len(captures) == 18


def test_what_plants_knows_no_effect_of_the_vocabulary():
    tree = ast.parse(Path(planted.__file__).read_text())
    names = {n.module for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)}
    assert {name for name in names if name.startswith("cg2raw")} == {
        *("cg2raw.arrays", "cg2raw.sensor", "cg2raw.synthetic.synthetic_camera"),
        "cg2raw.diagnose.captures.capture",
    }


def test_one_half_is_calibrated_and_the_other_planted(manifest):
    (case,) = cases("real", 3, 1, ["black_level"], manifest)
    found, hidden = case.captures()
    sensor, second = calibrated(manifest, None)
    assert found.sensor.id == sensor.id and found.sensor.black_level != [BLACK]
    assert found.sensor.black_level == pytest.approx([BLACK], abs=0.2)
    names = {frame.capture.name for frame in second}
    assert {c.name for c in found.captures} == names and len(names) == 12
    assert {c.group for c in found.captures} == {"fit", "select", "report"}
    capture = found.captures[0]
    real = np.load(manifest.parent / capture.name).astype(float)
    shift = (capture.raw() - real).mean()
    strength = hidden["black_level"]["strength"]
    assert abs(shift) == pytest.approx(strength * READ, rel=0.05, abs=0.5)
    assert np.array_equal(capture.raw(), capture.raw())


def test_untouched_halves_are_untouched_and_divided_anew(manifest, monkeypatch):
    monkeypatch.setattr(real, "calibrated_by", lambda sensor, _: sensor)
    both = cases("real-none", 3, 2, (), manifest)
    names = []
    for case in both:
        found, hidden = case.captures()
        assert hidden == {}
        for capture in found.captures[::5]:
            assert np.array_equal(
                capture.raw(), np.load(manifest.parent / capture.name)
            )
        names.append({capture.name for capture in found.captures})
    assert names[0] != names[1]


def test_what_frames_cannot_show_is_not_planted(manifest):
    names = plantable(manifest)
    assert "prnu" in names and "hot_pixels" in names
    assert not {"exposure", "nonlinearity", "noise_reduction"} & set(names)
    with pytest.raises(ValueError, match="effect 'exposure' of suite real must be one"):
        cases("real", 0, 1, ["exposure"], manifest)


@pytest.mark.slow
def test_a_planted_black_level_is_named(manifest, tmp_path):
    (one,) = command.bench(
        "real", count=1, effects=["black_level"], captures=manifest.parent, seed=3
    )
    assert one.get("error") is None and one["named"] == ["black_level"]


@pytest.mark.parametrize("more", [[], ["--seed", "1"]])
def test_a_real_suite_needs_frames(more, tmp_path, capsys, monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    more = [*more, "--json", str(tmp_path / "records.jsonl")]
    assert command.main(["real", "--quiet", *more]) == 1
    assert command.main(["real", "--captures", str(tmp_path), *more]) == 1
    assert command.main(["none", "--captures", str(tmp_path), *more]) == 1
    errors = capsys.readouterr().err.splitlines()
    assert len(errors) == 3
    assert "real frames" in errors[0] or "--captures captures.yaml" in errors[0]
    assert "there is no such file" in errors[1]
    assert "suite none makes its own" in errors[2]


def test_only_darks_and_flats_are_calibrated(manifest, tmp_path):
    text = manifest.read_text().replace("kind: flat", "kind: scene", 1)
    text = text.replace("scene: unknown", "scene: render.npy", 1)
    bad = manifest.parent / "bad.yaml"
    np.save(manifest.parent / "render.npy", np.ones((SIDE, SIDE, 3), np.float32))
    bad.write_text(text)
    with pytest.raises(ValueError, match="kind scene must be dark or flat"):
        cases("real", 0, 1, (), bad)
