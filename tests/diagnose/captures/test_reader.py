# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Files become captures: their pixels, metadata, borders and groups."""

import shutil

import numpy as np
import pytest

import cg2raw
from cg2raw.diagnose.captures.reader import read_captures
from cg2raw.diagnose.captures.splits import GROUPS, groups_of_sets, third
from diagnose import capture_files as files
from dng import dng_files

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


def test_a_gain_multiplies_the_scene(tmp_path):
    np.save(tmp_path / "r.npy", files.picture())
    files.frame(tmp_path, "a.npy", files.picture())
    line = "{file: a.npy, kind: scene, scene: r.npy, gain: 2.5, illuminant: D65}"
    first = read_captures(files.manifest(tmp_path, [line])).captures[0]
    np.testing.assert_allclose(first.scene(), 2.5 * files.picture(), rtol=1e-6)


@pytest.mark.parametrize("ending", ["exr", "tif", "png"])
def test_a_scene_of_each_format(tmp_path, ending):
    oiio = pytest.importorskip("OpenImageIO")
    rgb = files.picture()
    spec = oiio.ImageSpec(rgb.shape[1], rgb.shape[0], 3, "float")
    stored = rgb
    if ending == "png":
        spec.set_format("uint16")
        spec.attribute("oiio:ColorSpace", "srgb_rec709_scene")
        stored = np.where(
            rgb < 0.0031308, 12.92 * rgb, 1.055 * rgb ** (1 / 2.4) - 0.055
        )
    image = oiio.ImageOutput.create(str(tmp_path / f"r.{ending}"))
    image.open(str(tmp_path / f"r.{ending}"), spec)
    image.write_image(np.ascontiguousarray(stored, np.float32))
    image.close()
    files.frame(tmp_path, "a.npy", rgb)
    line = f"{{file: a.npy, kind: scene, scene: r.{ending}, illuminant: D65}}"
    captures = read_captures(files.manifest(tmp_path, [line]))
    np.testing.assert_allclose(captures.captures[0].scene(), rgb, atol=3e-5)
    said = any("linearised by the curve" in note for note in captures.notes)
    assert said == (ending == "png")


def test_masks_of_set_and_frame_are_one(tmp_path):
    whole, own = np.ones(files.SHAPE, np.uint8), np.ones(files.SHAPE, np.uint8)
    whole[:10], own[:, :20] = 0, 0
    np.save(tmp_path / "dust.npy", whole)
    np.save(tmp_path / "own.npy", own)
    lines = []
    for index in range(3):
        files.frame(tmp_path, f"{index}.npy", frame=index)
        mask = ", mask: own.npy" if index == 1 else ""
        lines.append(f"{{file: {index}.npy, kind: dark{mask}}}")
    top = f"sensor: {files.SENSOR}\nmask: dust.npy"
    found = by_name(read_captures(files.manifest(tmp_path, lines, top)))
    np.testing.assert_array_equal(found["0.npy"].mask(), whole != 0)
    np.testing.assert_array_equal(found["1.npy"].mask(), (whole & own) != 0)


def test_a_single_frame_is_divided_by_pixels(tmp_path):
    files.frame(tmp_path, "a.npy")
    captures = read_captures(files.manifest(tmp_path, ["{file: a.npy, kind: dark}"]))
    assert [capture.group for capture in captures.captures] == list(GROUPS)
    assert captures.captures[0].name == "a.npy (fit pixels)"
    masks = np.array([capture.mask() for capture in captures.captures])
    np.testing.assert_array_equal(masks.sum(axis=0), 1)
    assert masks.any(axis=1).all() and masks.any(axis=2).all()
    assert any("divided by pixels" in note for note in captures.notes)
    assert any("only darks" in note for note in captures.notes)


def test_thirds_of_a_chart_are_of_its_patches(tmp_path):
    files.frame(tmp_path, "a.dng", files.picture())
    patch = "{area: [8, 8, 32, 40], rgb: [1, 1, 1]}"
    line = f"{{file: a.dng, kind: chart, patches: [{patch}]}}"
    captures = read_captures(files.manifest(tmp_path, [line])).captures
    masks = np.array([capture.mask() for capture in captures])
    expected = np.zeros(files.SHAPE, int)
    expected[14:34, 16:40] = 1  # 60 % of the patch's sides
    np.testing.assert_array_equal(masks.sum(axis=0), expected)


def test_a_third_is_a_third_of_every_row_and_column():
    for group in GROUPS:
        mask = third((240, 480), group)
        for axis in (0, 1):
            np.testing.assert_allclose(mask.mean(axis=axis), 1 / 3)


@pytest.mark.parametrize(
    ("strata", "declared", "expected"),
    [
        ({"a": 0, "b": 0, "c": 0}, {}, "fit select report"),
        ({"a": 2, "b": 1, "c": 0}, {}, "report select fit"),
        ({"a": 0, "b": 0, "c": 0, "d": 0}, {}, "fit select report fit"),
        ({"a": 0, "b": 0}, {}, "- -"),
        ({"a": 0, "b": 0}, {"a": "report"}, "report -"),
        ({"a": 0, "b": 0, "c": 0}, {"a": "report"}, "report fit select"),
        ({"a": 0, "b": 0, "c": 0, "d": 0}, {"b": "fit", "c": "fit"},
         "select fit fit report"),
    ],
)  # fmt: skip
def test_sets_take_turns(strata, declared, expected):
    found = groups_of_sets(strata, declared)
    assert " ".join(found[name] or "-" for name in strata) == expected


def test_darks_of_two_times_are_in_each_group(tmp_path):
    lines = []
    for index in range(6):
        files.frame(tmp_path, f"{index}.npy", frame=index)
        time = 0.1 if index < 3 else 2
        lines.append(f"{{file: {index}.npy, kind: dark, exposure_time: {time}}}")
    captures = read_captures(files.manifest(tmp_path, lines)).captures
    for group in GROUPS:
        assert {c.exposure_time for c in captures if c.group == group} == {0.1, 2.0}


def test_frames_of_a_set_stay_together(tmp_path):
    lines = []
    for index in range(6):
        files.frame(tmp_path, f"{index}.npy", frame=index)
        lines.append(f"{{file: {index}.npy, kind: dark, set: s{index // 2}}}")
    captures = read_captures(files.manifest(tmp_path, lines)).captures
    assert [c.group for c in captures] == [g for g in GROUPS for _ in range(2)]


def bad_sets(folder):
    """Yield (name, lines of frames, words of the message, top lines)."""
    sensor = f"sensor: {files.SENSOR}"
    for name in ("a.npy", "b.npy"):
        files.frame(folder, name, frame=ord(name[0]))
    files.frame(folder, "a.dng")
    shutil.copy(folder / "a.npy", folder / "copy.npy")
    np.save(folder / "small.npy", np.zeros((8, 8), np.uint16))
    np.save(folder / "float.npy", np.zeros((48, 64), np.float32))
    np.save(folder / "small_render.npy", np.zeros((8, 8, 3), np.float32))
    (folder / "text.npy").write_text("no array")
    (folder / "cut.dng").write_bytes((folder / "a.dng").read_bytes()[:300])
    (folder / "text.nef").write_text("no RAW")
    dng_files.write(folder / "bggr.dng", files.other_sensor(cfa="BGGR"))
    dng_files.write(folder / "bits.dng", files.other_sensor(bits=14, white_level=16000))
    dng_files.write(folder / "white.dng", files.other_sensor(white_level=900))

    def dark(name, more=""):
        return f"{{file: {name}, kind: dark{more}}}"

    a = dark("a.npy")
    yield "twice", [a, dark("./a.npy")], [":4: frames[1].file", "is that of line 3"]
    yield "copy", [a, dark("copy.npy")], [":4: frames[1].file", "the bytes of that of"]
    yield "size", [a, dark("small.npy")], ["small.npy is 8x8, a.npy 64x48; all frames"]
    yield "type", [dark("float.npy")], ["float.npy: is (48, 64) float32; must be"]
    yield "no array", [dark("text.npy")], ["text.npy: is no .npy file, or cut off"]
    yield "cut DNG", [dark("cut.dng")], [":3: frames[0].file cannot be used", "cut.dng"]
    yield "no RAW", [dark("text.nef")], ["text.nef: LibRaw cannot read it"]
    yield "CFA", [dark("bggr.dng")], ["its CFA is BGGR, that of samsung-s20fe"]
    yield "bits", [dark("bits.dng")], ["bits.dng: its bit depth is 14, that of"]
    yield (
        "white",
        [dark("white.dng")],
        ["say white level 900 DN, samsung-s20fe 1023 DN"],
    )
    yield (
        "render",
        ["{file: a.dng, kind: scene, scene: small_render.npy}"],
        ["[0].scene small_render.npy is 8x8, the frames are 64x48; it must"],
    )
    yield (
        "render of another kind",
        ["{file: a.dng, kind: scene, scene: text.nef}"],
        ["frames[0].scene cannot be used"],
    )
    yield (
        "mask",
        [dark("a.npy", ", mask: small.npy")],
        ["[0].mask small.npy is 8x8, the"],
    )
    top = f"{sensor}\nmask: small.npy"
    yield "mask of all", [a], ["captures.yaml:2: mask small.npy is 8x8, the"], top
    yield "light", [dark("a.npy", ", illuminant: sunny")], ['illuminant is "sunny":']
    yield "ISO", [dark("a.npy", ", iso: 9e6")], ["iso 9e+06, of a.npy:"]
    yield (
        "set of two kinds",
        [dark("a.npy", ", set: s"), "{file: a.dng, kind: flat, scene: 1, set: s}"],
        [':4: frames[1].set "s" holds a flat here and a dark in line 3'],
    )
    yield (
        "set of two groups",
        [
            dark("a.npy", ", set: s, group: fit"),
            dark("b.npy", ", set: s, group: report"),
        ],
        [':4: frames[1].group is "report", but that of set "s" in line 3 is "fit"'],
    )
    yield (
        "no report",
        [dark("a.npy", ", group: fit"), dark("b.npy", ", group: select")],
        ['no frame is left for the group "report"'],
    )
    yield "sensor", [a], ['captures.yaml:1: sensor is "nikon"'], "sensor: nikon"
    yield "profile", [a], ['sensor is "./x.json"'], "sensor: ./x.json"
    yield "DNG as sensor", [a], ['sensor is "cut.dng"'], "sensor: cut.dng"
    yield (
        "outside",
        ["{file: a.dng, kind: chart, patches: [{area: [44, 0, 8, 8], xyz: [1,1,1]}]}"],
        ["patches[0].area ends at row 52, column 8; the frame has 48 rows"],
    )
    yield (
        "corners outside",
        ["{file: a.dng, kind: chart, chart: colorchecker, "
         "corners: [[1, 1], [1, 99], [30, 60], [30, 1]]}"],
        ["corners: [1, 99] is outside the frame"],
    )  # fmt: skip
    yield (
        "corners crossed",
        ["{file: a.dng, kind: chart, chart: colorchecker, "
         "corners: [[1, 1], [30, 60], [1, 60], [30, 1]]}"],
        ["corners: are no quadrangle"],
    )  # fmt: skip


def test_files_that_do_not_belong_together(tmp_path):
    for name, lines, words, *top in bad_sets(tmp_path):
        path = files.manifest(tmp_path, lines, *top)
        with pytest.raises(ValueError) as error:
            read_captures(path)
        message = str(error.value)
        assert message.startswith(str(path)) and "\n" not in message, name
        for word in words:
            assert word in message, name


def test_levels_that_differ_a_little_are_noted(tmp_path):
    dng_files.write(tmp_path / "a.dng", files.other_sensor(black_level=[66] * 4))
    captures = read_captures(files.manifest(tmp_path, ["{file: a.dng, kind: dark}"]))
    [note] = [note for note in captures.notes if "black level" in note]
    assert "say black level 66 DN, samsung-s20fe 64 DN" in note


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


def test_a_file_without_a_mosaic(camera_data, tmp_path):
    file = camera_data / "real" / "canon6d_lossy_linear_photoprism.dng"
    path = files.manifest(tmp_path, [f"{{file: {file}, kind: dark}}"])
    with pytest.raises(ValueError, match=r":3: frames\[0\].file .*LinearRaw"):
        read_captures(path)


def test_another_sensor_in_the_manifests_place(tmp_path):
    path = files.standard_set(tmp_path)
    other = files.other_sensor(black_level=[66] * 4)
    assert read_captures(path, other).sensor.black_level[0] == 66
    with pytest.raises(ValueError, match="its CFA is"):
        read_captures(path, cg2raw.Sensor("nikon-d850"))


LIGHT = "exposure_time: 1"
FLAT = "kind: flat, illuminant: A, scene"


@pytest.mark.parametrize(
    ("frames", "words"),
    [
        ([f"kind: dark, {LIGHT}"] * 3, ["only darks"]),
        ([f"{FLAT}: 1"], ["one frame only", "no darks", "no scenes", "flats of one"]),
        ([f"{FLAT}: 1", f"{FLAT}: 2"], ["no darks", "no scenes"]),
        ([f"{FLAT}: unknown"] * 2, ["no darks", "no scenes"]),
        (
            [f"kind: dark, {LIGHT}"] * 2 + [f"{FLAT}: 1"] * 2,
            ["darks of one exposure time", "no scenes", "flats of one level"],
        ),
        (
            ["kind: dark, exposure_time: 9", f"kind: dark, {LIGHT}"]
            + ["kind: scene, scene: r.npy, illuminant: A"],
            [],
        ),
    ],
)
def test_what_captures_cannot_tell_is_said(tmp_path, frames, words):
    np.save(tmp_path / "r.npy", files.picture())
    lines = []
    for index, fields in enumerate(frames):
        files.frame(tmp_path, f"{index}.npy", frame=index)
        lines.append(f"{{file: {index}.npy, iso: 100, {fields}}}")
    notes = read_captures(files.manifest(tmp_path, lines)).notes
    notes = [n for n in notes if "divided" not in n and "optical centre" not in n]
    assert len(notes) == len(words)
    for note, word in zip(notes, words, strict=True):
        assert note.startswith(word)
