# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Every DNG says that it is computer generated, and readers and editors keep it."""

import ctypes
import ctypes.util
import json
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
import tifffile

import cg2raw
from dng import dng_files

XMP = 700
SOURCE = "http://cv.iptc.org/newscodes/digitalsourcetype/digitalCreation"
NAMESPACES = {
    "rdf": "http://www.w3.org/1999/02/22-rdf-syntax-ns#",
    "xmp": "http://ns.adobe.com/xap/1.0/",
    "Iptc4xmpExt": "http://iptc.org/std/Iptc4xmpExt/2008-02-29/",
    "cg2raw": "urn:cg2raw:simulation:1.0/",
}
OWN = "{urn:cg2raw:simulation:1.0/}"


class Parameters(ctypes.Structure):
    """The start of LibRaw's libraw_iparams_t, as 0.20 to 0.22 have it."""

    _fields_ = [
        ("guard", ctypes.c_char * 4),
        ("names", ctypes.c_char * 64 * 5),
        ("numbers", ctypes.c_uint * 4),
        ("colors", ctypes.c_int),
        ("filters", ctypes.c_uint),
        ("xtrans", ctypes.c_char * 36 * 2),
        ("cdesc", ctypes.c_char * 5),
        ("xmplen", ctypes.c_uint),
        ("xmpdata", ctypes.c_void_p),
    ]


def packet(path):
    with tifffile.TiffFile(path) as tiff:
        return bytes(tiff.pages[0].tags[XMP].value)


def described(xmp):
    """Return the rdf:Description of a packet."""
    found = ElementTree.fromstring(xmp.decode()).findall(
        "rdf:RDF/rdf:Description", NAMESPACES
    )
    assert len(found) == 1
    return found[0]


def own(xmp):
    """Return {name: text, or list of texts} of the properties in our namespace."""
    found = {}
    for item in described(xmp):
        if item.tag.startswith(OWN):
            listed = [part.text for part in item.findall("rdf:Seq/rdf:li", NAMESPACES)]
            found[item.tag.removeprefix(OWN)] = listed or item.text
    return found


def exiftool(program, *arguments):
    """Return {group:tag: value} of exiftool."""
    done = dng_files.run(program("exiftool"), "-json", "-G1", *arguments)
    return json.loads(done.stdout)[0]


@pytest.fixture
def path(tmp_path):
    """Return a DNG of a HERO6 at ISO 100 under A, seed 5, frame 2."""
    file = tmp_path / "hero6.dng"
    run = {"iso": 100, "seed": 5, "frame": 2}
    dng_files.write(file, cg2raw.Sensor("gopro-hero6-black"), **run)
    return file


@pytest.mark.parametrize("preview", [True, False])
@pytest.mark.parametrize("compression", ["ljpeg", "none"])
def test_a_simulated_camera_is_no_photograph(tmp_path, preview, compression):
    file = tmp_path / "shot.dng"
    sensor = cg2raw.Sensor("gopro-hero6-black")
    dng_files.write(file, sensor, preview=preview, compression=compression)
    item = described(packet(file))
    (said,) = item.findall("Iptc4xmpExt:DigitalSourceType", NAMESPACES)
    assert said.text == SOURCE
    (tool,) = item.findall("xmp:CreatorTool", NAMESPACES)
    assert tool.text == f"cg2raw {cg2raw.__version__}"


def test_it_says_how_it_was_made(path):
    light = cg2raw.Sensor("gopro-hero6-black").illuminant("A")
    assert own(packet(path)) == {
        "Version": cg2raw.__version__,
        "Sensor": "gopro-hero6-black",
        "Illuminant": "A",
        "Neutral": " ".join(
            f"{channel:.6f}".rstrip("0").rstrip(".") for channel in light.neutral
        ),
        "ColorTemperature": f"{light.cct:.0f}",
        "ISO": "100",
        "Convention": "dng",
        "DigitalGain": "1",
        "Seed": "5",
        "Frame": "2",
        "Effects": ["lens_shading", "shot_noise", "read_noise"],
    }


def test_of_a_plain_array_it_says_what_is_known(tmp_path):
    sensor = cg2raw.Sensor("samsung-s20fe")
    raw = np.full((64, 96), 100, np.uint16)
    file = tmp_path / "plain.dng"
    cg2raw.write_dng(file, raw, sensor=sensor, illuminant="3200K", iso=800)
    known = {"Version", "Sensor", "Illuminant", "Neutral", "ColorTemperature", "ISO"}
    assert set(own(packet(file))) == known | {"Effects"}


def test_of_a_monochrome_sensor_it_says_no_light(tmp_path):
    dropped = dict.fromkeys(
        f"{name}_{n}"
        for name in ("calibration_illuminant", "color_matrix")
        for n in (1, 2)
    )
    sensor = dng_files.sensor(cfa="MONO", black_level=0, illuminants=None, **dropped)
    raw = sensor.simulate(np.full((64, 96, 3), 0.5, np.float32))
    cg2raw.write_dng(tmp_path / "mono.dng", raw)
    found = own(packet(tmp_path / "mono.dng"))
    assert not {"Neutral", "Illuminant", "ColorTemperature"} & set(found)


def test_exiftool_reads_all_of_it(program, path):
    found = exiftool(program, "-XMP:all", path)
    assert found["XMP-iptcExt:DigitalSourceType"] == SOURCE
    assert found["XMP-cg2raw:Sensor"] == "gopro-hero6-black"
    assert found["XMP-cg2raw:Seed"] == 5
    assert found["XMP-cg2raw:Effects"] == ["lens_shading", "shot_noise", "read_noise"]


def test_exiftool_keeps_it(program, path, tmp_path):
    before = exiftool(program, "-XMP:all", path)
    edited, bare = tmp_path / "edited.dng", tmp_path / "bare.dng"
    dng_files.run(program("exiftool"), "-o", edited, "-Artist=somebody", path)
    after = exiftool(program, "-XMP:all", "-Artist", edited)
    assert after["IFD0:Artist"] == "somebody"
    assert {**after, **before} == after | {"SourceFile": before["SourceFile"]}
    dng_files.run(program("exiftool"), "-o", bare, "-XMP:all=", path)
    assert set(exiftool(program, "-XMP:all", bare)) == {"SourceFile"}
    dng_files.run(program("exiftool"), "-tagsFromFile", path, "-XMP", bare)
    copied = exiftool(program, "-XMP:all", bare)
    assert {**copied, **before} == copied | {"SourceFile": before["SourceFile"]}


def test_libraw_keeps_it(path):
    name = ctypes.util.find_library("raw_r") or ctypes.util.find_library("raw")
    if name is None:
        pytest.skip("LibRaw is not installed")
    libraw = ctypes.CDLL(name)
    libraw.libraw_init.restype = ctypes.c_void_p
    libraw.libraw_get_iparams.restype = ctypes.POINTER(Parameters)
    handle = ctypes.c_void_p(libraw.libraw_init(0))
    try:
        assert libraw.libraw_open_file(handle, str(path).encode()) == 0
        found = libraw.libraw_get_iparams(handle).contents
        kept = ctypes.string_at(found.xmpdata, found.xmplen)
    finally:
        libraw.libraw_close(handle)
    assert kept.rstrip(b"\0") == packet(path)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["darktable-cli", "rawtherapee-cli"])
def test_developed_pictures_still_say_it(program, tmp_path, name):
    file, out = tmp_path / "hero6.dng", tmp_path / "developed.jpg"
    dng_files.write(file, cg2raw.Sensor("gopro-hero6-black"), shape=(480, 640))
    words = {
        "darktable-cli": (file, out, "--core", "--configdir", tmp_path / "config"),
        "rawtherapee-cli": ("-q", "-o", out, "-c", file),
    }
    dng_files.run(program(name), *words[name])
    found = exiftool(program, "-XMP:all", out)
    assert found["XMP-iptcExt:DigitalSourceType"] == SOURCE
    assert found["XMP-cg2raw:Sensor"] == "gopro-hero6-black"
