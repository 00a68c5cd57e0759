# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The plugin reads DNGs: the words that others read, and a linear picture."""

import numpy as np
import pytest
import rawpy
import tifffile

import cg2raw
from dng import dng_files
from images import DEVELOPED, attributes, said_of, write_image
from oracles import cameras


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
    both, nowhere = ("--info", path, *DEVELOPED, path), {"OIIO_LIBRARY_PATH": ""}
    said = system_oiiotool(*both).stdout
    assert [line.split()[-2:] for line in said.splitlines()] == 2 * [["uint16", "raw"]]
    assert system_oiiotool(*both, env=nowhere).stdout == said


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
