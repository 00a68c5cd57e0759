# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Files become captures: their pixels, metadata, borders and groups."""

import numpy as np
import pytest

import cg2raw
from cg2raw.diagnose.captures.reader import read_captures
from cg2raw.diagnose.captures.splits import GROUPS
from diagnose import capture_files as files
from dng import dng_files
from images import write_image

CANON = "real/canon550d_colorchart_tinydng.dng"


def by_name(captures):
    """Return {name: Capture}."""
    return {capture.name: capture for capture in captures.captures}


def test_a_set_of_dngs_is_read_as_it_was_written(tmp_path):
    captures = read_captures(files.standard_set(tmp_path))
    assert captures.sensor.id == files.SENSOR
    assert len(captures.captures) == 9
    for index, capture in enumerate(captures.captures):
        assert capture.group == GROUPS[index % 3] and capture.set == capture.name
        assert (capture.shape, capture.iso) == (files.SHAPE, files.ISO)
        assert capture.mask is None
    found = by_name(captures)
    dark, flat, shot = (
        found[name] for name in ("dark_0.dng", "flat_1.dng", "shot_2.dng")
    )
    assert dark.exposure_time == 0.5 and flat.exposure_time is None
    raw = files.frame(tmp_path, "again.dng", files.picture(seed=2), frame=22)
    np.testing.assert_array_equal(shot.raw(), raw)
    assert shot.raw().dtype == np.uint16
    np.testing.assert_array_equal(shot.scene(), files.picture(seed=2))
    np.testing.assert_array_equal(flat.scene(), np.float32([0.4, 0.4, 0.4]))
    np.testing.assert_array_equal(dark.scene(), np.zeros(3))
    assert shot.illuminant == "as-shot"
    light = captures.sensor.illuminant("as-shot", shot.as_shot)
    expected = captures.sensor.illuminant("D65").neutral
    assert light.neutral == pytest.approx(expected, abs=1e-5)


def test_what_is_said_of_the_set(tmp_path):
    path = files.standard_set(tmp_path)
    said = "nuisance: [light]\nuncertainty: {light: 0.01}\n"
    path.write_text(said + path.read_text())
    captures = read_captures(path)
    assert captures.nuisances == {"light"} and captures.uncertainty == {"light": 0.01}
    assert captures.file == str(path)


def test_an_npy_needs_what_a_dng_says(tmp_path):
    raw = files.frame(tmp_path, "flat.npy", files.picture())
    line = "{file: flat.npy, kind: flat, scene: unknown"
    with pytest.raises(
        ValueError, match=r":3: frames\[0\] has no illuminant, and flat"
    ):
        read_captures(files.manifest(tmp_path, [line + "}"]))
    path = files.manifest(tmp_path, [line + ", illuminant: D65, exposure_time: 2}"])
    captures = read_captures(path)
    first = captures.captures[0]
    np.testing.assert_array_equal(first.raw(), raw)
    assert (first.scene, first.iso, first.exposure_time) == (None, None, 2.0)
    assert any("says the ISO" in note for note in captures.notes)


def test_the_manifest_outranks_the_file(tmp_path):
    files.frame(tmp_path, "a.dng", exposure_time=0.5)
    line = "{file: a.dng, kind: dark, iso: 400, exposure_time: 3, illuminant: A}"
    first = read_captures(files.manifest(tmp_path, [line])).captures[0]
    assert (first.iso, first.exposure_time, first.illuminant) == (400, 3, "A")


@pytest.mark.parametrize("word", ["srgb", "none", ""])
def test_whole_numbers_of_a_scene_are_what_linearize_says(tmp_path, word):
    oiio = pytest.importorskip("OpenImageIO")
    height, width = files.SHAPE
    codes = np.linspace(0, 255, height * width * 3).astype(np.uint8)
    image = oiio.ImageOutput.create(str(tmp_path / "r.tif"))
    image.open(str(tmp_path / "r.tif"), oiio.ImageSpec(width, height, 3, "uint8"))
    image.write_image(codes.reshape(height, width, 3))
    image.close()
    files.frame(tmp_path, "a.npy", files.picture())
    line = "{file: a.npy, kind: scene, scene: r.tif, illuminant: D65"
    line += f", linearize: {word}}}" if word else "}"
    captures = read_captures(files.manifest(tmp_path, [line]))
    if not word:
        with pytest.raises(
            ValueError, match=r"add linearize: srgb if .* linearize: none"
        ):
            captures.captures[0].scene()
        return
    light = codes.reshape(height, width, 3) / 255.0
    if word == "srgb":  # IEC 61966-2-1
        power = ((light + 0.055) / 1.055) ** 2.4
        light = np.where(light <= 0.04045, light / 12.92, power)
    np.testing.assert_allclose(captures.captures[0].scene(), light, rtol=1e-6)
    said = any("linearised by the curve" in note for note in captures.notes)
    assert said == (word == "srgb")


def test_a_gain_multiplies_the_scene(tmp_path):
    np.save(tmp_path / "r.npy", files.picture())
    files.frame(tmp_path, "a.npy", files.picture())
    line = "{file: a.npy, kind: scene, scene: r.npy, gain: 0.4, illuminant: D65}"
    first = read_captures(files.manifest(tmp_path, [line])).captures[0]
    np.testing.assert_allclose(first.scene(), 0.4 * files.picture(), rtol=1e-6)


@pytest.mark.parametrize("ending", ["exr", "tif"])
def test_a_scene_of_each_format(tmp_path, ending):
    rgb = files.picture()
    write_image(tmp_path / f"r.{ending}", rgb)
    files.frame(tmp_path, "a.npy", rgb)
    line = f"{{file: a.npy, kind: scene, scene: r.{ending}, illuminant: D65}}"
    captures = read_captures(files.manifest(tmp_path, [line]))
    np.testing.assert_array_equal(captures.captures[0].scene(), rgb)
    assert not any("linearised by the curve" in note for note in captures.notes)


def test_masks_of_set_and_frame_are_one(tmp_path):
    whole, own = np.ones(files.SHAPE, np.uint8), np.ones(files.SHAPE, np.uint8)
    whole[:10], own[:, :20] = 0, 0
    np.save(tmp_path / "dust.npy", whole)
    np.save(tmp_path / "own.npy", own)
    fields = ["kind: dark", "kind: dark, mask: own.npy", "kind: dark"]
    top = f"sensor: {files.SENSOR}\nmask: dust.npy"
    found = by_name(files.read_series(tmp_path, fields, top))
    np.testing.assert_array_equal(found["0.npy"].mask(), whole != 0)
    np.testing.assert_array_equal(found["1.npy"].mask(), (whole & own) != 0)


def test_a_mask_may_be_an_image(tmp_path):
    own = np.ones(files.SHAPE, np.float32)
    own[:, :20] = 0
    write_image(tmp_path / "own.exr", np.repeat(own[..., None], 3, axis=2))
    found = files.read_series(tmp_path, 3 * ["kind: dark, mask: own.exr"])
    np.testing.assert_array_equal(found.captures[0].mask(), own != 0)


@pytest.mark.parametrize(
    ("array", "words"),
    [
        (np.zeros(files.SHAPE), "masks every pixel; 0 is for what to ignore"),
        (np.ones((*files.SHAPE, 2)), "is (48, 64, 2), not 64x48"),
    ],
)
def test_a_mask_of_nothing_or_of_another_shape_is_refused(tmp_path, array, words):
    np.save(tmp_path / "m.npy", array)
    [first, *_] = files.read_series(tmp_path, ["kind: dark, mask: m.npy"]).captures
    with pytest.raises(ValueError) as error:
        first.mask()
    assert str(error.value).endswith(f"m.npy: {words}")


@pytest.mark.parametrize(
    ("array", "more", "words"),
    [
        (np.zeros(files.SHAPE), "", "is (48, 64) float64; must be (H, W, 3) floats"),
        (np.zeros((*files.SHAPE, 4)), "", "is (48, 64, 4) float64; must be (H, W, 3)"),
        (np.zeros((*files.SHAPE, 3), int), "", "is (48, 64, 3) int64; must be (H, W,"),
        (files.picture(), ", linearize: srgb", "linearize: its floats are linear; rem"),
    ],
)
def test_an_array_of_a_scene_is_of_linear_floats(tmp_path, array, more, words):
    np.save(tmp_path / "r.npy", array)
    fields = [f"kind: scene, scene: r.npy, illuminant: D65{more}"]
    [first, *_] = files.read_series(tmp_path, fields).captures
    with pytest.raises(ValueError) as error:
        first.scene()
    assert f"r.npy: {words}" in str(error.value)


def test_a_single_frame_is_divided_by_pixels(tmp_path):
    captures = files.read_series(tmp_path, ["kind: dark"])
    assert [capture.group for capture in captures.captures] == list(GROUPS)
    assert captures.captures[0].name == "0.npy (fit pixels)"
    masks = np.array([capture.mask() for capture in captures.captures])
    np.testing.assert_array_equal(masks.sum(axis=0), 1)
    assert masks.any(axis=1).all() and masks.any(axis=2).all()
    assert any("divided by pixels" in note for note in captures.notes)
    assert any("only darks" in note for note in captures.notes)


FLAT = "kind: flat, scene: 0.2, illuminant: D65, set: "


@pytest.mark.parametrize(
    ("kind", "sets", "expected"),
    [
        # What pixels have in common from frame to frame only other frames tell.
        (FLAT, "aaaa", "fit select report fit"),
        (FLAT, "aabb", "fit select report fit"),
        (FLAT, "abca", "fit select report fit"),
        # A group is that of all frames of its set.
        (FLAT, ["a", "a, group: report", *"bbb"], "report report fit select fit"),
        ("kind: dark, set: ", "aabbcc", "fit fit select select report report"),
    ],
)
def test_groups_of_sets(tmp_path, kind, sets, expected):
    captures = files.read_series(tmp_path, [kind + name for name in sets])
    assert " ".join(capture.group for capture in captures.captures) == expected
    assert not any("divided by pixels" in note for note in captures.notes)


def test_thirds_of_a_chart_are_of_its_patches(tmp_path):
    files.frame(tmp_path, "a.dng", files.picture())
    patch = "{area: [8, 8, 32, 40], rgb: [1, 1, 1]}"
    line = f"{{file: a.dng, kind: chart, patches: [{patch}]}}"
    captures = read_captures(files.manifest(tmp_path, [line])).captures
    masks = np.array([capture.mask() for capture in captures])
    expected = np.zeros(files.SHAPE, int)
    expected[14:34, 16:40] = 1  # 60 % of the patch's sides
    np.testing.assert_array_equal(masks.sum(axis=0), expected)


@pytest.mark.parametrize(
    ("times", "parts"),
    [((1, 9, 30), 9), ((9, 9, 9), 3), ((1, 9, 9, 30), 4), ((1, 9, 30, 90), 4)],
)
def test_darks_that_repeat_in_no_group_are_divided_by_pixels(tmp_path, times, parts):
    """One exposure time alone does not tell charge from offsets."""
    fields = [f"kind: dark, exposure_time: {time}" for time in times]
    read = files.read_series(tmp_path, fields)
    assert len(read.captures) == parts
    assert any("exposure time" in note for note in read.notes) == (parts == 9)


@pytest.mark.parametrize(
    ("field", "values"),
    [
        ("exposure_time", (0.1, 0.1, 0.1, 2, 2, 2)),
        ("temperature", (20, -10.1, 20.2, -10.3, 20.4, -10.5)),
    ],
)
def test_darks_of_two_kinds_are_in_each_group(tmp_path, field, values):
    fields = [f"kind: dark, {field}: {value}" for value in values]
    captures = files.read_series(tmp_path, fields).captures
    for group in GROUPS:
        high = [getattr(c, field) > 1 for c in captures if c.group == group]
        assert sorted(high) == [False, True]


def test_the_temperature_of_all_frames_and_of_one(tmp_path):
    fields = ["kind: dark", "kind: dark, temperature: 5"]
    top = f"sensor: {files.SENSOR}\ntemperature: -20"
    captures = files.read_series(tmp_path, fields, top).captures
    assert {c.name[0]: c.temperature for c in captures} == {"0": -20.0, "1": 5.0}
    alone = files.read_series(tmp_path, fields[:1])
    assert alone.captures[0].temperature is None and alone.temperature is None
    some = files.read_series(tmp_path, [*fields, "kind: dark"], top)
    assert some.temperature == -20.0  # of most
    assert files.read_series(tmp_path, fields).temperature is None  # not of all


@pytest.mark.parametrize(
    ("value", "words"), [(np.nan, "nan"), (np.inf, "inf"), (-np.inf, "-inf")]
)
def test_a_scene_that_is_not_finite_names_the_pixel(tmp_path, value, words):
    rgb = files.picture()
    rgb[5, 7, 1] = value
    np.save(tmp_path / "r.npy", rgb)
    files.frame(tmp_path, "a.dng", files.picture())
    line = "{file: a.dng, kind: scene, scene: r.npy}"
    captures = read_captures(files.manifest(tmp_path, [line]))
    with pytest.raises(ValueError, match=f"G of row 5, column 7 is {words};"):
        captures.captures[0].scene()


def test_a_dng_that_is_cut_in_its_pixels(tmp_path):
    files.frame(tmp_path, "a.dng", files.picture((256, 256)))
    data = (tmp_path / "a.dng").read_bytes()
    (tmp_path / "a.dng").write_bytes(data[: len(data) * 3 // 4])
    path = files.manifest(tmp_path, ["{file: a.dng, kind: dark}"])
    with pytest.raises(ValueError, match=r"a\.dng"):
        read_captures(path).captures[0].raw()


def test_masked_borders_are_darks(camera_data, tmp_path):
    path = files.manifest(
        tmp_path,
        [f"{{file: {camera_data / CANON}, kind: flat, scene: unknown}}"],
        f"sensor: {camera_data / CANON}",
    )
    captures = read_captures(path)
    name = "canon550d_colorchart_tinydng.dng (masked {}, fit pixels)"
    found = by_name(captures)
    left, top = found[name.format("left")], found[name.format("top")]
    assert (left.kind, left.shape, left.group) == ("dark", (1156, 140), "fit")
    assert (top.kind, top.shape) == ("dark", (14, 1734))
    np.testing.assert_array_equal(left.scene(), np.zeros(3))
    raw = left.raw()
    # README of the camera data: "optical black 2049 against the tag's 2056".
    assert raw.mean() == pytest.approx(2049, abs=0.5)
    assert top.raw().mean() == pytest.approx(2048, abs=1)
    assert captures.sensor.black_level[0] == 2056
    rawpy = pytest.importorskip("rawpy")
    with rawpy.imread(str(camera_data / CANON)) as file:
        np.testing.assert_array_equal(raw, file.raw_image[26:1182, 8:148])
    flat = found["canon550d_colorchart_tinydng.dng (fit pixels)"]
    assert flat.raw().shape == (1156, 1734) and flat.exposure_time is None


def test_a_raw_that_is_no_dng(camera_data, tmp_path):
    nef = camera_data / "real" / "nikon_d1_imagemeta.nef"
    profile = tmp_path / "d1.json"
    fields = {"cfa": "BGGR", "bits": 12, "white_level": 4095, "black_level": [0] * 4}
    profile.write_text(dng_files.sensor("nikon-d40", **fields).to_json())
    path = files.manifest(
        tmp_path, [f"{{file: {nef}, kind: dark}}"], f"sensor: {profile}"
    )
    first = read_captures(path).captures[0]
    assert first.shape == (1324, 2012) and first.raw().shape == first.shape
    assert first.exposure_time is not None


def test_another_sensor_in_the_manifests_place(tmp_path):
    path = files.standard_set(tmp_path)
    other = files.other_sensor(black_level=[66] * 4)
    assert read_captures(path, other).sensor.black_level[0] == 66
    with pytest.raises(ValueError, match="its CFA is"):
        read_captures(path, cg2raw.Sensor("nikon-d850"))


def test_a_fits_file_is_read_as_its_header_says(tmp_path):
    fits = pytest.importorskip("astropy.io.fits", reason="astropy is not installed")
    header = {"EXPTIME": 0.0, "CCD-TEMP": -4.82, "BAYERPAT": "GRBG"}
    header |= {"EGAIN": 2.0, "PEDESTAL": -4}
    raw = files.frame(tmp_path, "raw.npy")
    hdu = fits.PrimaryHDU(raw + np.uint16(4))
    hdu.header.update(header)
    hdu.writeto(tmp_path / "bias.fit")
    path = files.manifest(tmp_path, ["{file: bias.fit, kind: dark, iso: 100}"])
    found = read_captures(path)
    first = found.captures[0]
    np.testing.assert_array_equal(first.raw(), raw)
    assert (first.exposure_time, first.shape) == (0.0, files.SHAPE)
    assert first.temperature == -4.82
    assert "bias.fit: a PEDESTAL of 4 DN is taken off" in found.notes
    sensor = found.sensor
    beta1 = np.mean(sensor.noise_at(100)["beta1"])
    per_dn = 1 / (beta1 * sensor.signal_range)
    assert any(
        f"headers say 2 electrons per DN, the noise of {sensor.id} at ISO 100 "
        f"{per_dn:.3g};" in note
        for note in found.notes
    )


def test_an_overscan_moves_the_level_of_a_fits_file_to_the_sensor_s_black(tmp_path):
    fits = pytest.importorskip("astropy.io.fits", reason="astropy is not installed")
    raw, (height, width) = files.frame(tmp_path, "raw.npy"), files.SHAPE
    bias = np.full((height, 16), 80, np.uint16)  # 16 DN above the profile's 64
    hdu = fits.PrimaryHDU(np.hstack([raw + np.uint16(16), bias]))
    hdu.header["DATASEC"] = f"[1:{width},1:{height}]"
    hdu.header["BIASSEC"] = f"[{width + 1}:{width + 16},1:{height}]"
    hdu.writeto(tmp_path / "a.fits")
    path = files.manifest(tmp_path, ["{file: a.fits, kind: dark, iso: 100}"])
    np.testing.assert_array_equal(read_captures(path).captures[0].raw(), raw)


@pytest.mark.parametrize("where", ["frame", "top"])
def test_a_manifest_chooses_one_of_several_images(tmp_path, where):
    fits = pytest.importorskip("astropy.io.fits", reason="astropy is not installed")
    raw = files.frame(tmp_path, "raw.npy")
    images = [fits.PrimaryHDU(), fits.ImageHDU(raw + np.uint16(1)), fits.ImageHDU(raw)]
    fits.HDUList(images).writeto(tmp_path / "a.fits")
    more = ", image: 2" if where == "frame" else ""
    top = f"sensor: {files.SENSOR}" + ("\nimage: 2" if where == "top" else "")
    lines = [f"{{file: a.fits, kind: dark{more}}}"]
    found = read_captures(files.manifest(tmp_path, lines, top))
    np.testing.assert_array_equal(found.captures[0].raw(), raw)
    with pytest.raises(ValueError, match=r":3: frames\[0\].file .*holds 2 images"):
        read_captures(files.manifest(tmp_path, ["{file: a.fits, kind: dark}"]))
