# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Files with layers, parts and windows: which pixels become the DNG."""

import json

import numpy as np
import OpenImageIO as oiio
import pytest

import cg2raw
from cg2raw.io.image_file import read_image
from images import attributes, read_dn, write_image
from python import commands

BASE = {"sensor": "samsung-s20fe", "illuminant": "D65"}
S20 = attributes(**BASE)
RENDERERS = {
    "Blender": ["ViewLayer.Combined.", "ViewLayer.Emit."],
    "last": ["albedo.", "rgba."],
}


def simulated(scene):
    return cg2raw.Sensor("samsung-s20fe").simulate(scene, illuminant="D65")


def layered(path, scene, prefixes, picture=0):
    """Write RGBA layers, Z, and normals; the scene is the picture's, others are not."""
    pixels, names = [], []
    for number, prefix in enumerate(prefixes):
        light = scene if number == picture else scene[::-1] * 0.5
        pixels += [light, np.ones((*scene.shape[:2], 1), np.float32)]
        names += [prefix + letter for letter in "RGBA"]
    pixels.append(np.zeros((*scene.shape[:2], 4), np.float32))
    names += ["Z", "N.X", "N.Y", "N.Z"]
    image = oiio.ImageSpec(scene.shape[1], scene.shape[0], len(names), "float")
    image.channelnames = tuple(names)
    file = oiio.ImageOutput.create(str(path))
    assert file.open(str(path), image), file.geterror()
    data = np.ascontiguousarray(np.concatenate(pixels, axis=-1))
    assert file.write_image(data) and file.close(), file.geterror()
    return path


@pytest.mark.parametrize("name", RENDERERS)
def test_the_picture_of_a_renderer_is_found(oiiotool, scene, tmp_path, name):
    prefixes = RENDERERS[name]
    exr = layered(tmp_path / "in.exr", scene, prefixes, picture=int(name == "last"))
    out = tmp_path / "shot.dng"
    oiiotool(exr, *S20, "-o", out)
    np.testing.assert_array_equal(read_dn(out), simulated(scene))
    np.testing.assert_array_equal(read_image(exr).pixels, scene)


def test_a_layer_is_asked_for(oiiotool, scene, tmp_path):
    exr = layered(tmp_path / "in.exr", scene, ["", "diffuse."], picture=1)
    out = tmp_path / "shot.dng"
    oiiotool(exr, *S20, *attributes(layer="diffuse"), "-o", out)
    np.testing.assert_array_equal(read_dn(out), simulated(scene))
    done = oiiotool(exr, *S20, *attributes(layer="M"), "-o", out, check=False)
    assert done.returncode != 0
    assert "--attrib dng:layer M: no layer" in done.stdout + done.stderr


def test_the_command_that_a_message_gives_works(oiiotool, scene, tmp_path):
    exr = layered(tmp_path / "in.exr", scene, ["diffuse.", "specular."])
    out = tmp_path / "shot.dng"
    done = oiiotool(exr, *S20, "-o", out, check=False)
    assert done.returncode != 0 and not out.exists()
    said = done.stdout + done.stderr
    assert "Add --attrib dng:layer diffuse," in said
    assert "specular.R" in said
    oiiotool(exr, *S20, "--attrib", "dng:layer", "diffuse", "-o", out)
    np.testing.assert_array_equal(read_dn(out), simulated(scene))


@pytest.fixture
def parts(scene, tmp_path):
    """Return write(name, ...): a multi-part EXR; the last part is the scene."""

    def write(*names):
        path = tmp_path / "parts.exr"
        height, width, _ = scene.shape
        specs = []
        for name in names:
            channels = ("Z",) if name == "depth" else ("R", "G", "B")
            spec = oiio.ImageSpec(width, height, len(channels), "float")
            spec.channelnames = channels
            spec.attribute("oiio:subimagename", name)
            specs.append(spec)
        file = oiio.ImageOutput.create(str(path))
        assert file.open(str(path), specs), file.geterror()
        for number, spec in enumerate(specs):
            if number:
                assert file.open(str(path), spec, "AppendSubimage"), file.geterror()
            pixels = scene if number == len(specs) - 1 else scene[::-1]
            pixels = np.ascontiguousarray(pixels[..., : spec.nchannels])
            assert file.write_image(pixels), file.geterror()
        assert file.close()
        return path

    return write


def test_oiiotool_hands_over_the_first_part_only(oiiotool, scene, parts, tmp_path):
    """So the plugin takes it where it is the picture, and else says how to."""
    out = tmp_path / "shot.dng"
    oiiotool(parts("rgba", "depth"), *S20, "-o", out)
    np.testing.assert_array_equal(read_dn(out), simulated(scene[::-1]))
    for names in (("depth", "rgba"), ("diffuse", "rgba")):
        out.unlink()
        done = oiiotool(parts(*names), *S20, "-o", out, check=False)
        assert done.returncode != 0 and not out.exists()
        assert "oiiotool --subimage NAME" in done.stdout + done.stderr
        oiiotool(parts(*names), "--subimage", "rgba", *S20, "-o", out)
        np.testing.assert_array_equal(read_dn(out), simulated(scene))


def test_pages_without_names(oiiotool, scene, tmp_path):
    """Of a TIFF oiiotool itself says that it hands over the first page alone."""
    pages = tmp_path / "pages.tif"
    first = write_image(tmp_path / "a.exr", scene)
    second = write_image(tmp_path / "b.exr", scene[::-1].copy())
    oiiotool(first, second, "--siappend", "-o", pages)
    out = tmp_path / "shot.dng"
    done = oiiotool(pages, *S20, "-o", out, check=False)
    assert "does not support multiple subimages" in done.stdout + done.stderr
    np.testing.assert_array_equal(read_dn(out), simulated(scene))
    words = [word for name, value in BASE.items() for word in (f"--{name}", value)]
    words += ["--iscolorspace", "lin_rec709"]
    line = commands.fails("convert", pages, "-o", out, *words)
    assert "--layer 0, or another of 0, 1" in line
    assert commands.run("convert", pages, "-o", out, *words, "--layer", 1).code == 0
    np.testing.assert_array_equal(read_dn(out), simulated(scene[::-1]))


WINDOWS = {  # x, y, width, height of the data; the display window is 128x96 at 0,0
    "smaller": (10, 6, 50, 40),
    "overscan": (-16, -8, 160, 112),
    "shifted": (-20, 30, 128, 96),
    "one pixel": (127, 95, 128, 96),
}


def windowed(path, name):
    """Write an image with a data window of its own; return (path, what is seen)."""
    x, y, width, height = WINDOWS[name]
    pixels = np.random.default_rng(3).random((height, width, 3), dtype=np.float32)
    spec = oiio.ImageSpec(width, height, 3, "float")
    spec.x, spec.y, spec.full_width, spec.full_height = x, y, 128, 96
    file = oiio.ImageOutput.create(str(path))
    assert file.open(str(path), spec) and file.write_image(pixels) and file.close()
    whole = np.zeros((400, 400, 3), np.float32)
    whole[100 + y : 100 + y + height, 100 + x : 100 + x + width] = pixels
    return path, whole[100:196, 100:228]


@pytest.mark.parametrize("name", WINDOWS)
def test_a_dng_is_of_the_display_window(oiiotool, tmp_path, name):
    exr, seen = windowed(tmp_path / "in.exr", name)
    out = tmp_path / "shot.dng"
    oiiotool(exr, *S20, "-o", out)
    np.testing.assert_array_equal(read_dn(out), simulated(seen))
    np.testing.assert_array_equal(read_image(exr).pixels, seen)


@pytest.fixture
def blurred_sensor(tmp_path):
    """Return the path of a profile with an effect that needs the whole frame."""
    profile = json.loads(cg2raw.Sensor("samsung-s20fe").to_json())
    glare = {"name": "veiling_glare", "parameters": {"uniform": 0.05, "wide": 0.05}}
    profile["effects"] = [glare]
    path = tmp_path / "blurred.json"
    path.write_text(json.dumps(profile))
    return path


@pytest.mark.usefixtures("writing_openimageio")
@pytest.mark.parametrize("tile", [0, 32])
@pytest.mark.parametrize("whole_frame", [False, True])
@pytest.mark.parametrize("name", WINDOWS)
def test_hosts_that_do_not_crop(tmp_path, name, whole_frame, tile, blurred_sensor):
    """ImageBuf.write hands the data window over as it is."""
    exr, seen = windowed(tmp_path / "in.exr", name)
    image = oiio.ImageBuf(str(exr))
    sensor = blurred_sensor if whole_frame else "samsung-s20fe"
    image.specmod().attribute("dng:sensor", str(sensor))
    image.specmod().attribute("dng:illuminant", "D65")
    image.set_write_tiles(tile, tile)
    out = tmp_path / "shot.dng"
    assert image.write(str(out)), image.geterror()
    raw = cg2raw.Sensor(sensor).simulate(seen, illuminant="D65")
    np.testing.assert_array_equal(read_dn(out), raw)


@pytest.mark.usefixtures("writing_openimageio")
def test_windows_that_do_not_meet(tmp_path):
    exr, _ = windowed(tmp_path / "in.exr", "smaller")
    image = oiio.ImageBuf(str(exr))
    image.specmod().x = 500
    for name, value in BASE.items():
        image.specmod().attribute(f"dng:{name}", value)
    out = tmp_path / "shot.dng"
    assert not image.write(str(out))
    assert "50x40 at 500,6, lies outside its display window" in image.geterror()
    assert not out.exists()
