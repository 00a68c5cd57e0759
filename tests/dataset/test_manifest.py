# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The manifest tells the truth, and enough of it to make each file again."""

import hashlib
import json

import numpy as np
import OpenImageIO as oiio
import pyarrow.parquet
import pytest

import cg2raw
from cg2raw import read_dng_metadata
from cg2raw.dataset.manifest import FITS
from cg2raw.io.image_file import read_image
from dataset.data_sets import check_agreement, rows, scene
from python.commands import run

OPTIONS = (
    "--sensors samsung-s20fe,canon-70d --illuminants A,sample:5 --digital-gain 1,0.7 "
    "--iso clean,400 --crop 16x12 --patches 2 --seed 9"
).split()


@pytest.fixture(scope="module")
def out(images, tmp_path_factory, repository):
    """Return a data set of crops, clean and noisy."""
    folder = tmp_path_factory.mktemp("data") / "out"
    with pytest.MonkeyPatch.context() as patch:
        profiles = str(repository / "plugins" / "profiles")
        patch.setenv("CG2RAW_PROFILE_PATH", profiles)
        done = run("dataset", images, folder, *OPTIONS)
    assert done.code == 0, done
    return folder


def again(row, images):
    """Return the frame that a row describes, by the public interface."""
    rgb = read_image(images / row["input"], undo="stated").pixels
    x, y, width, height = row["crop"]
    return cg2raw.Sensor(row["sensor"]).simulate(
        np.ascontiguousarray(rgb[y : y + height, x : x + width]),
        illuminant=row["illuminant"],
        iso=row["iso"],
        noise=row["noise"],
        exposure_time=row["exposure_time"],
        seed=row["seed"],
        frame=row["frame"],
        digital_gain=row["digital_gain"],
        convention=row["convention"],
    )


def test_every_row_makes_its_file_again(out, images, tmp_path):
    found = rows(out)
    assert len(found) == 5 * 2 * 2 * 2 * 2 * 2
    for row in found[::7]:
        path = tmp_path / "again.dng"
        frame = again(row, images)
        cg2raw.write_dng(path, frame, compression=row["compression"], preview=False)
        assert path.read_bytes() == (out / row["path"]).read_bytes()


def test_manifest_and_folder_agree(out):
    check_agreement(out)


def test_both_manifests_are_the_same(out):
    assert pyarrow.parquet.read_table(out / "manifest.parquet").to_pylist() == rows(out)


def test_hashes_are_those_of_images_and_profiles(out, images):
    for row in rows(out)[::9]:
        data = (images / row["input"]).read_bytes()
        assert row["input_sha256"] == hashlib.sha256(data).hexdigest()
        text = cg2raw.Sensor(row["sensor"]).to_json()
        assert row["profile_sha256"] == hashlib.sha256(text.encode()).hexdigest()
    plan = json.loads((out / "dataset.json").read_text())
    assert list(plan["profiles"]) == ["samsung-s20fe", "canon-70d"]


def test_neutral_is_that_of_the_file(out):
    for row in rows(out)[::5]:
        metadata = read_dng_metadata(str(out / row["path"]))
        neutral = np.array(metadata.as_shot_neutral)
        # the writer keeps millionths, of the largest
        assert neutral / neutral[1] == pytest.approx(row["neutral"], abs=3e-6)
        assert metadata.black_level == row["black_level"]
        assert metadata.shot["iso"] == (row["iso"] and int(row["iso"]))


def test_matrices_take_the_white_of_the_light_to_the_neutral(out):
    for row in rows(out)[::5]:
        x, y = row["xy"]
        white = np.array(row["camera_from_xyz"]).reshape(3, 3) @ [x, y, 1 - x - y]
        # in the temperature's fixed point, which stops at 1e-7 of xy
        assert white / white[1] == pytest.approx(row["neutral"], rel=2e-5)
        first = np.array(row["transform_first"]).reshape(3, 3)
        assert first.sum(axis=1) == pytest.approx(1, abs=1e-6)  # white stays white


def test_noisy_files_name_their_clean_one(out):
    found = {row["path"]: row for row in rows(out)}
    noisy = [row for row in found.values() if row["iso"] is not None]
    assert len(noisy) == len(found) // 2
    shared = ("input", "crop", "sensor", "neutral", "digital_gain")
    for row in noisy:
        clean = found[row["clean_path"]]
        assert clean["iso"] is None and clean["clean_path"] is None
        assert all(row[name] == clean[name] for name in shared)


def test_crops_are_within_and_differ(out):
    crops = {(row["input"], row["patch"]): row["crop"] for row in rows(out)}
    assert len(crops) == 10 and len({tuple(crop) for crop in crops.values()}) > 5
    assert all(0 <= x <= 36 - 16 and 0 <= y <= 24 - 12 for x, y, _, _ in crops.values())


def test_drawn_gains_follow_the_profile_and_are_shared(images, tmp_path):
    words = (
        "--sensors samsung-s20fe --illuminants 40 --digital-gain sample --iso clean,100"
    )
    run("dataset", images, tmp_path / "out", *words.split(), "--format", "npy")
    found = rows(tmp_path / "out")
    by_path = {row["path"]: row for row in found}
    for row in found:
        assert row["digital_gain_drawn"]
        clean = by_path[row["clean_path"] or row["path"]]
        assert row["digital_gain"] == clean["digital_gain"]
    gains = np.array([row["digital_gain"] for row in found if row["iso"] is None])
    # N(0.8, 0.1) of the profile; 200 draws: five standard errors
    assert len(set(gains)) == 200
    assert gains.mean() == pytest.approx(0.8, abs=5 * 0.1 / 200**0.5)
    assert gains.std() == pytest.approx(0.1, rel=5 / 400**0.5)


def test_upi_draws_a_camera_for_each_light(images, tmp_path):
    """Clean and noisy files share it, and the manifest's seed gives it again."""
    out = tmp_path / "out"
    options = "--sensors samsung-s20fe --illuminants 2 --iso clean,400 --method upi"
    assert run("dataset", images, out, *options.split()).code == 0
    seeds = {}
    for row in rows(out):
        upi = cg2raw.Upi(row["sensor"], digital_gain=row["digital_gain"])
        drawn = upi.draw(row["method_seed"])
        assert row["method"] == "upi" and row["illuminant"] == drawn.illuminant
        metadata = read_dng_metadata(str(out / row["path"]))
        [calibration] = metadata.calibrations
        np.testing.assert_allclose(
            calibration["camera_from_xyz"], drawn.camera_from_xyz, atol=1e-9
        )
        seeds.setdefault(row["method_seed"], []).append(row["iso"])
    assert len(seeds) == 5 * 2 and all(len(isos) == 2 for isos in seeds.values())


def test_upi_draws_lights_itself(images, tmp_path):
    words = "--sensors samsung-s20fe --illuminants A,D65 --method upi".split()
    done = run("dataset", images, tmp_path / "out", *words)
    assert done.code == 1 and "--illuminants" in done.err


def test_layers_and_windows_are_those_of_convert(tmp_path):
    """The picture is taken, or the layer that is asked for, of the display window."""
    pixels = np.abs(scene((40, 50)))
    names = [*"RGB", "diffuse.R", "diffuse.G", "diffuse.B", "Z"]
    spec = oiio.ImageSpec(50, 40, 7, "float")
    spec.channelnames = tuple(names)
    spec.x, spec.y, spec.full_width, spec.full_height = -8, 3, 36, 48
    whole = np.concatenate([pixels, pixels[::-1] * 0.5, pixels[..., :1]], axis=-1)
    (tmp_path / "in").mkdir()
    path = str(tmp_path / "in/a.exr")
    file = oiio.ImageOutput.create(path)
    assert file.open(path, spec) and file.write_image(whole) and file.close()
    options = "--sensors nikon-d40 --illuminants D65".split()
    for layer, name in ((None, ""), ("diffuse", "diffuse")):
        out = tmp_path / f"out-{name}"
        words = [*options, *(["--layer", layer] if layer else [])]
        assert run("dataset", tmp_path / "in", out, *words).code == 0
        (row,) = rows(out)
        assert (row["layer"], row["width"], row["height"]) == (name, 36, 48)
        image = read_image(path, row["layer"], undo="stated")
        drawn = {"seed": row["seed"], "frame": row["frame"]}
        sensor = cg2raw.Sensor("nikon-d40")
        raw = sensor.simulate(image.pixels, illuminant="D65", **drawn)
        cg2raw.write_dng(tmp_path / "same.dng", raw, preview=False)
        assert (tmp_path / "same.dng").read_bytes() == (out / row["path"]).read_bytes()
    assert not image.pixels[:3].any() and image.pixels[3:43].any()


@pytest.mark.parametrize(
    ("kind", "fit", "do_not"),
    [
        ("int32", [-(2**31), 2**31 - 1], [-(2**31) - 1, 2**31, 1.0, True, "1"]),
        ("int64", [-(2**63), 2**63 - 1], [-(2**63) - 1, 2**63]),
        ("uint64", [0, 2**64 - 1], [-1, 2**64]),
        ("double", [0.5, -(2**53), 2**53], [-(2**53) - 1, 2**53 + 1, None]),
        ("list", [[], [0.5, 1]], [[None], (0.5,)]),
        ("integers", [[-(2**31), 3]], [[2**31], [0.5]]),
        ("strings", [["a"]], [[1], "a"]),
    ],
)
def test_what_a_column_holds(kind, fit, do_not):
    assert all(map(FITS[kind], fit)) and not any(map(FITS[kind], do_not))
