# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The plugin reads DNGs: the words that others read, and a linear picture."""

import numpy as np
import pytest
import rawpy
import tifffile

import cg2raw
from dng import dng_files
from images import attributes, write_image
from oracles import cameras

DEVELOPED = ("-iconfig", "dng:developed", 1)


@pytest.fixture
def ours(oiiotool):
    """Return ours(path): a name by which this oiiotool's choice is our reader.

    LibRaw's reader, of the system's, keeps the ending .dng."""

    def link(path):
        if oiiotool.name == "oiio-wheel":
            return path
        other = path.with_suffix(".cg2raw")
        other.unlink(missing_ok=True)
        other.symlink_to(path)
        return other

    return link


@pytest.fixture(params=["nikon-d40", "fujifilm-x-m1", "mono"])
def sensor(request):
    """Return a sensor of each kind of CFA."""
    if request.param == "mono":
        return cg2raw.Sensor.from_json(cameras.mono_text(id="mono"), "mono.json")
    return cg2raw.Sensor(request.param)


def libraw_words(path):
    """Return all stored DN as LibRaw reads them."""
    with rawpy.imread(str(path)) as raw:
        return raw.raw_image.copy()


def read_words(oiiotool, path, tmp_path):
    """Return what oiiotool reads, by way of an uncompressed TIFF."""
    out = tmp_path / "words.tif"
    oiiotool(path, "--compression", "none", "-o", out)
    return tifffile.imread(out)


def read_picture(oiiotool, path, tmp_path):
    """Return the developed picture, (H, W, 3) float32."""
    out = tmp_path / "picture.tif"
    oiiotool(*DEVELOPED, path, "--compression", "none", "-o", out)
    return tifffile.imread(out)


def said_of(oiiotool, path, *hints):
    """Return {name: text} of what oiiotool --info -v prints."""
    lines = oiiotool(*hints, "--info", "-v", path).stdout.splitlines()
    pairs = [line.strip().split(": ", 1) for line in lines[1:] if ": " in line]
    return {"": lines[1], **{name: value.strip('"') for name, value in pairs}}


def numbers(text):
    """Return the numbers of an attribute."""
    return [float(word) for word in text.split(",")]


@pytest.mark.parametrize("compression", ["none", "ljpeg"])
@pytest.mark.parametrize("preview", [True, False])
def test_the_words_are_those_that_others_read(
    oiiotool, ours, sensor, tmp_path, compression, preview
):
    path = tmp_path / "shot.dng"
    mosaic = dng_files.random_mosaic(sensor, (131, 203))
    light = "" if sensor.cfa == "MONO" else "A"
    options = {"compression": compression, "preview": preview, "illuminant": light}
    dng_files.write(path, sensor, mosaic, **options)
    words = read_words(oiiotool, ours(path), tmp_path)
    assert words.dtype == np.uint16
    np.testing.assert_array_equal(words, libraw_words(path))
    with tifffile.TiffFile(path) as tiff:
        np.testing.assert_array_equal(words, dng_files.raw_page(tiff).asarray())


def test_its_tags_are_attributes(oiiotool, ours, exr, tmp_path):
    path = tmp_path / "shot.dng"
    more = ["--attrib", "ExposureTime", 0.01, "--attrib", "Artist", "A. Person"]
    given = attributes(sensor="canon-5d-mark-iv", illuminant="A", iso=800)
    oiiotool(exr, *more, *given, "-o", path)
    said, metadata = said_of(oiiotool, ours(path)), cg2raw.read_dng_metadata(str(path))
    assert "128 x   96, 1 channel, uint16 dng" in said[""]
    assert said["channel list"] == "Y"
    assert said["Make"] == metadata.make and said["Artist"] == "A. Person"
    assert said["raw:UniqueCameraModel"] == metadata.unique_camera_model
    assert said["Exif:ISOSpeedRatings"] == said["Exif:PhotographicSensitivity"] == "800"
    assert float(said["ExposureTime"].split(" ")[0]) == 0.01
    assert said["raw:FilterPattern"] == "RGGB"
    assert numbers(said["raw:BlackLevel"]) == metadata.black_level
    assert int(said["raw:WhiteLevel"]) == metadata.white_level
    assert said["raw:ActiveArea"] == "0, 0, 96, 128"
    assert said["raw:DefaultCropSize"] == "124, 92"
    assert said["raw:CalibrationIlluminant1"] == "17"
    neutral = numbers(said["raw:AsShotNeutral"])
    np.testing.assert_allclose(neutral, metadata.as_shot_neutral, rtol=1e-5)
    assert len(numbers(said["raw:ColorMatrix2"])) == 9
    assert len(numbers(said["raw:NoiseProfile"])) == 6
    assert not [name for name in said if name.startswith("dng:")]


def test_a_frame_of_a_shot_says_so(oiiotool, ours, exr, tmp_path):
    """By OpenImageIO's names: OpenEXR keeps them, and the next DNG is one, too."""
    path, out, again = (tmp_path / name for name in ("x.dng", "x.exr", "y.dng"))
    given = attributes(sensor="nikon-d40", illuminant="A", framerate="59.94")
    given += attributes(timecode="01:02:03;05", reel="A001", camera_label="B")
    oiiotool(exr, *given, "-o", path)
    expected = {
        "FramesPerSecond": "60000/1001 (59.9401)",
        "reelName": "A001",
        "cameraLabel": "B",
    }
    place = ("FramesPerSecond", "smpte:TimeCode", "reelName", "cameraLabel")
    for hints in ((), DEVELOPED):
        said = said_of(oiiotool, ours(path), *hints)
        assert {name: said[name] for name in expected} == expected
        # Above 30 frames a second OpenEXR files count pairs: 5 is the second of one.
        assert said["smpte:TimeCode"][:8] == "01:02:03"
        assert said["smpte:TimeCode"][9:] == "02"
    oiiotool(*DEVELOPED, ours(path), "-o", out)
    kept = said_of(oiiotool, out)
    assert {name: kept[name] for name in place} == {name: said[name] for name in place}
    oiiotool(out, *attributes(sensor="nikon-d40", illuminant="D65"), "-o", again)
    read, first = (cg2raw.read_dng_metadata(str(p)).shot for p in (again, path))
    assert first["time_code"] == "01:02:03;05" and first["frame_rate"] == "60000/1001"
    for name in ("frame_rate", "time_code", "reel_name", "camera_label"):
        assert read[name] == first[name]


def test_a_still_says_nothing_of_a_shot(oiiotool, ours, exr, tmp_path):
    path = tmp_path / "x.dng"
    oiiotool(exr, *attributes(sensor="nikon-d40", illuminant="A"), "-o", path)
    said = said_of(oiiotool, ours(path))
    place = {"FramesPerSecond", "smpte:TimeCode", "reelName", "cameraLabel"}
    assert not place & set(said)


def test_its_xmp_says_that_it_is_computer_generated(oiiotool, ours, exr, tmp_path):
    """Which a developed OpenEXR file keeps."""
    path, out = tmp_path / "shot.dng", tmp_path / "picture.exr"
    run = {"sensor": "gopro-hero6-black", "illuminant": "D50", "iso": 100}
    oiiotool(exr, *attributes(**run, seed=7, frame=12), "-o", path)
    expected = {
        "Iptc4xmpExt:DigitalSourceType": (
            "http://cv.iptc.org/newscodes/digitalsourcetype/digitalCreation"
        ),
        "Software": f"cg2raw {cg2raw.__version__}",
        "cg2raw:Version": cg2raw.__version__,
        "cg2raw:Sensor": "gopro-hero6-black",
        "cg2raw:Illuminant": "D50",
        "cg2raw:ISO": "100",
        "cg2raw:Convention": "dng",
        "cg2raw:DigitalGain": "1",
        "cg2raw:Seed": "7",
        "cg2raw:Frame": "12",
        "cg2raw:Effects": "lens_shading; shot_noise; read_noise",
    }
    said = said_of(oiiotool, ours(path))
    assert {name: said[name] for name in expected} == expected
    neutral = [float(word) for word in said["cg2raw:Neutral"].split()]
    np.testing.assert_allclose(neutral, numbers(said["raw:AsShotNeutral"]), rtol=1e-5)
    assert abs(int(said["cg2raw:ColorTemperature"]) - 5000) < 10
    oiiotool(*DEVELOPED, ours(path), "-o", out)
    kept = said_of(oiiotool, out)
    of_packet = [name for name in expected if ":" in name]
    assert {n: kept[n] for n in of_packet} == {n: expected[n] for n in of_packet}


def test_openexr_keeps_the_attributes(oiiotool, ours, exr, tmp_path):
    """Where OpenImageIO has a format of the name "raw", its OpenEXR writer takes what
    begins so for that format's own, and drops it."""
    path, out = tmp_path / "shot.dng", tmp_path / "words.exr"
    oiiotool(exr, *attributes(sensor="nikon-d40", illuminant="A"), "-o", path)
    oiiotool(ours(path), "-o", out)
    kept, said = said_of(oiiotool, out), said_of(oiiotool, ours(path))
    arrays = {"raw:ActiveArea", "raw:BlackLevel", "raw:CFARepeatPatternDim"}
    arrays |= {"raw:DefaultCropOrigin", "raw:DefaultCropSize"}  # not kept
    names = {name for name in said if name.startswith("raw:")} - arrays
    assert {"raw:AsShotNeutral", "raw:ColorMatrix2", "raw:UniqueCameraModel"} <= names
    if oiiotool.name == "oiio-system":
        assert kept["Make"] == said["Make"] and not names & set(kept)
    else:
        assert {name: kept[name] for name in names} == {n: said[n] for n in names}


def test_a_developed_picture_is_the_render(oiiotool, ours, sensor, tmp_path):
    """Of a flat field each demosaicking is exact; what is left is a DN of the darkest
    channel: 1 over 4095 less black, over the neutral's least, 0.4, and the matrix."""
    colour = (0.2, 0.2, 0.2) if sensor.cfa == "MONO" else (0.3, 0.2, 0.15)
    path = tmp_path / "shot.dng"
    scene = np.full((48, 66, 3), colour, np.float32)
    light = "" if sensor.cfa == "MONO" else "D65"
    cg2raw.write_dng(path, sensor.simulate(scene, illuminant=light))
    picture = read_picture(oiiotool, ours(path), tmp_path)
    assert picture.shape == scene.shape and picture.dtype == np.float32
    np.testing.assert_allclose(picture, scene, atol=2e-3)
    said = said_of(oiiotool, ours(path), *DEVELOPED)
    assert said["channel list"] == "R, G, B"
    assert said["oiio:ColorSpace"].lower() in ("linear", "lin_rec709_scene")


def test_a_developed_picture_is_near_librawls(oiiotool, ours, tmp_path):
    """A sensor of one matrix, which LibRaw then uses as well; it rounds its own
    products, at 16 bits, to about a thousandth."""
    sensor, path = cg2raw.Sensor("samsung-s20fe"), tmp_path / "shot.dng"
    scene = np.full((64, 96, 3), (0.3, 0.2, 0.15), np.float32)
    cg2raw.write_dng(path, sensor.simulate(scene, illuminant="D65"))
    with rawpy.imread(str(path)) as raw:
        other = raw.postprocess(
            gamma=(1, 1),
            no_auto_bright=True,
            use_camera_wb=True,
            output_bps=16,
            output_color=rawpy.ColorSpace.sRGB,
        )
    picture = read_picture(oiiotool, ours(path), tmp_path)
    ratio = picture.mean(axis=(0, 1)) / (other.mean(axis=(0, 1)) / 65535)
    np.testing.assert_allclose(ratio / ratio[1], 1.0, atol=0.01)  # colour
    np.testing.assert_allclose(ratio[1], 1.0, atol=0.03)  # exposure


def test_a_developed_picture_becomes_another_camera_s(oiiotool, ours, exr, tmp_path):
    first, second = tmp_path / "first.dng", tmp_path / "second.dng"
    given = attributes(sensor="samsung-s20fe", illuminant="D65", iso=200)
    oiiotool(exr, *given, "-o", first)
    other = attributes(sensor="nikon-d40", illuminant="A")
    oiiotool(*DEVELOPED, ours(first), *other, "-o", second)
    metadata = cg2raw.read_dng_metadata(str(second))
    assert metadata.model == cg2raw.Sensor("nikon-d40").model
    assert not metadata.noise_profile  # the first one's noise is no wish for the second


def test_librawls_reader_keeps_the_ending(system_oiiotool, exr, tmp_path):
    path = tmp_path / "shot.dng"
    given = attributes(sensor="nikon-d40", illuminant="A")
    system_oiiotool(exr, *given, "-o", path)
    for hints in ((), DEVELOPED):
        assert said_of(system_oiiotool, path, *hints)[""].endswith("uint16 raw")
        nowhere = {"OIIO_LIBRARY_PATH": ""}
        done = system_oiiotool(*hints, "--info", path, env=nowhere)
        assert done.stdout == system_oiiotool(*hints, "--info", path).stdout


def test_the_wheel_shows_a_preview_but_for_our_reader(exr, tmp_path):
    from conftest import oiiotool_runner

    wheel, path = oiiotool_runner("oiio-wheel"), tmp_path / "shot.dng"
    wheel(exr, *attributes(sensor="nikon-d40", illuminant="A"), "-o", path)
    nowhere = {"OIIO_LIBRARY_PATH": "", "OPENIMAGEIO_PLUGIN_PATH": ""}
    done = wheel("--info", path, env=nowhere)
    assert "64 x   48, 3 channel, uint8 tiff" in done.stdout
    assert "128 x   96, 1 channel, uint16 dng" in wheel("--info", path).stdout


REAL = [
    "Fusion_GPFR7066.dng",
    "Hero6_GOPR0024.dng",
    "bmpcc_twelvemonkeys.dng",
    "canon550d_colorchart_tinydng.dng",
]


@pytest.mark.parametrize("name", REAL)
def test_real_dngs_are_those_of_libraw(oiiotool, ours, camera_data, tmp_path, name):
    """16 bits in a strip, packed 14 bits with a masked border, and lossless JPEG in
    tiles through a linearisation table. oiiotool cuts off the border."""
    path = tmp_path / name
    path.symlink_to(camera_data / "real" / name)
    words = read_words(oiiotool, ours(path), tmp_path)
    with rawpy.imread(str(path)) as raw:
        np.testing.assert_array_equal(words, raw.raw_image_visible)


@pytest.mark.parametrize("name", REAL)
def test_all_stored_words_are_those_of_libraw(writing_openimageio, camera_data, name):
    import OpenImageIO as oiio

    path = camera_data / "real" / name
    image = oiio.ImageInput.open(str(path))
    words = image.read_image(0, 0, 0, 1, "uint16")
    assert image.format_name() == "dng"
    np.testing.assert_array_equal(words[..., 0], libraw_words(path))


def test_a_masked_border_is_outside_the_display_window(
    oiiotool, ours, camera_data, tmp_path
):
    path = tmp_path / "canon.dng"
    path.symlink_to(camera_data / "real" / "canon550d_colorchart_tinydng.dng")
    said = said_of(oiiotool, ours(path))
    assert "1888 x 1182, 1 channel" in said[""]
    assert said["full/display size"] == "1734 x 1156"
    assert said["full/display origin"] == "152, 26"
    picture = read_picture(oiiotool, ours(path), tmp_path)
    assert picture.shape == (1156, 1734, 3) and np.isfinite(picture).all()
    # A photograph of a chart in daylight: its mean is between black and white.
    assert 0.01 < picture.mean() < 0.9


def test_eight_bits_stay_eight_bits(oiiotool, ours, tmp_path):
    from fuzz import mosaic_seeds

    path = tmp_path / "eight.dng"
    path.write_bytes(mosaic_seeds.mosaics()["bits_8_little"])
    words = read_words(oiiotool, ours(path), tmp_path)
    assert words.dtype == np.uint8
    assert words.ravel().tolist() == [v & 255 for v in mosaic_seeds.VALUES]


def test_python_reads_rows(writing_openimageio, tmp_path):
    import OpenImageIO as oiio

    sensor, path = cg2raw.Sensor("nikon-d40"), tmp_path / "shot.dng"
    mosaic = dng_files.random_mosaic(sensor, (64, 96))
    dng_files.write(path, sensor, mosaic)
    image = oiio.ImageInput.open(str(path))
    assert image.format_name() == "dng"
    rows = image.read_scanlines(0, 0, 10, 20, 0, 0, 1, "uint16")
    np.testing.assert_array_equal(rows[..., 0], mosaic[10:20])
    neutral = cg2raw.read_dng_metadata(str(path)).as_shot_neutral
    np.testing.assert_allclose(image.spec()["raw:AsShotNeutral"], neutral, rtol=1e-5)
    hints = oiio.ImageSpec()
    hints.attribute("dng:developed", 1)
    picture = oiio.ImageBuf(str(path), 0, 0, hints)
    assert picture.spec().nchannels == 3


def test_a_grey_card_written_again_is_the_same_dn(oiiotool, ours, tmp_path):
    """Out and in: what is developed and simulated by the same sensor, is the same."""
    scene = np.full((32, 48, 3), 0.18, np.float32)
    exr = write_image(tmp_path / "grey.exr", scene)
    given = attributes(sensor="nikon-d40", illuminant="D65")
    first, second = tmp_path / "first.dng", tmp_path / "second.dng"
    oiiotool(exr, *given, "-o", first)
    oiiotool(*DEVELOPED, ours(first), *given, "-o", second)
    differences = libraw_words(first).astype(int) - libraw_words(second)
    assert abs(differences).max() <= 1
