# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Spectral images through oiiotool: others' files, the frames of Python, errors."""

import numpy as np
import OpenImageIO as oiio
import pytest

import cg2raw
from cg2raw.spectra import simulate_spectra
from dng import dng_files
from images import attributes, read_dn
from oracles import cameras
from python import commands
from spectral_files import (
    ASKED,
    CENTRES,
    FICHET,
    WHITE,
    check_command,
    expected,
    name_of,
    write_spectra,
)


@pytest.mark.parametrize("tile", [0, 16])
def test_pixels_are_those_of_python(oiiotool, tmp_path, spectra, tile):
    names = [name_of(nm) for nm in CENTRES]
    path = write_spectra(tmp_path / "s.exr", spectra, names, tile=tile)
    oiiotool(path, *attributes(**ASKED), "-o", tmp_path / "s.dng")
    found = read_dn(tmp_path / "s.dng")
    assert np.array_equal(found, expected(spectra))
    assert len(np.unique(found)) > 1000


def test_half_floats_are_read_too(oiiotool, tmp_path, spectra):
    names = [name_of(nm) for nm in CENTRES]
    path = write_spectra(tmp_path / "s.exr", spectra, names, kind="half")
    oiiotool(path, *attributes(**ASKED), "-o", tmp_path / "s.dng")
    rounded = spectra.astype(np.float16).astype(np.float32)
    assert np.array_equal(read_dn(tmp_path / "s.dng"), expected(rounded))


def test_other_channels_and_their_order_do_not_matter(oiiotool, tmp_path, spectra):
    """A preview, other Stokes components, and bins from long to short."""
    names = ["R", "G", "B", "A", *(name_of(nm) for nm in CENTRES[::-1]), "S1.550nm"]
    others = np.full((*spectra.shape[:2], 4), 0.5, np.float32)
    pixels = np.concatenate([others, spectra[..., ::-1], others[..., :1]], axis=2)
    path = write_spectra(tmp_path / "s.exr", pixels, names)
    oiiotool(path, *attributes(**ASKED), "-o", tmp_path / "s.dng")
    # Each pixel adds its bins by rising wavelength, wherever they lie.
    assert np.array_equal(read_dn(tmp_path / "s.dng"), expected(spectra))


def test_effects_of_the_whole_frame_take_spectra_too(oiiotool, tmp_path, spectra):
    known = {effect["name"]: effect["parameters"] for effect in cg2raw.effects()}
    values = {p["name"]: p["null"] for p in known["blur"]} | {"ring_1": 0.2}
    blur = {"name": "blur", "parameters": values}
    sensor = dng_files.sensor("canon-600d", effects=[blur])
    (tmp_path / "blurred.json").write_text(sensor.to_json())
    path = write_spectra(tmp_path / "s.exr", spectra, [name_of(nm) for nm in CENTRES])
    asked = {**ASKED, "sensor": str(tmp_path / "blurred.json")}
    oiiotool(path, *attributes(**asked), "-o", tmp_path / "s.dng")
    wanted = simulate_spectra(sensor, spectra, CENTRES, illuminant="FL2", white=WHITE)
    assert np.array_equal(read_dn(tmp_path / "s.dng"), wanted)


def test_a_polarised_render_by_art(oiiotool, tmp_path):
    path = FICHET / "Polarised.exr"
    asked = {"sensor": "nikon-d850", "illuminant": "D65", "white_luminance": "500"}
    oiiotool(path, *attributes(**asked), "-o", tmp_path / "art.dng")
    pixels = oiio.ImageBuf(str(path))
    names = list(pixels.spec().channelnames)
    centres = np.arange(400.0, 681.0, 40.0)
    at = [names.index(f"S0.{nm:.0f},000000nm") for nm in centres]
    spectra = pixels.get_pixels(oiio.FLOAT)[..., at]
    wanted = simulate_spectra(
        cg2raw.Sensor("nikon-d850"), spectra, centres, illuminant="D65", white=500.0
    )
    found = read_dn(tmp_path / "art.dng")
    assert np.array_equal(found, wanted)
    assert found.max() > found.min() + 1000
    tags = dng_files.tags_of(tmp_path / "art.dng")[0]
    neutral = np.divide(tags["AsShotNeutral"][::2], tags["AsShotNeutral"][1::2])
    rgb = illuminated(cg2raw.Sensor("nikon-d850"))
    assert neutral == pytest.approx(rgb / rgb[1], rel=3e-3)


def illuminated(sensor):
    """What the sensitivities see of D65."""
    from cg2raw.profile.illuminant_spectra import illuminant_spectrum

    return illuminant_spectrum("D65") @ sensor.spectral_sensitivities["rgb"]


def test_the_command_writes_the_same_bytes(oiiotool, tmp_path, spectra):
    names = ["R", "G", "B", *(name_of(nm) for nm in CENTRES)]
    pixels = np.concatenate([spectra[..., :3], spectra], axis=2)
    path = write_spectra(tmp_path / "s.exr", pixels, names)
    assert np.array_equal(check_command(oiiotool, path, tmp_path), expected(spectra))


def test_settings_of_a_camera_say_what_white_is(tmp_path, spectra):
    """White is at 78 / S lx s of q L t / N^2; ISO 12232:2019."""
    path = write_spectra(tmp_path / "s.exr", spectra, [name_of(nm) for nm in CENTRES])
    words = ["--sensor", "canon-600d", "--illuminant", "FL2", "--effects", "none"]
    words += ["--exposure-time", "1/1000", "--f-number", 8, "--iso"]
    iso = 78 * 8**2 / (0.65 * WHITE / 1000)
    done = commands.run("convert", path, "-o", tmp_path / "a.dng", *words, iso)
    assert done.code == 0, done.err
    found = read_dn(tmp_path / "a.dng").astype(int)
    assert np.abs(found - expected(spectra)).max() <= 1


def test_what_the_command_needs_is_one_line(tmp_path, spectra):
    path = write_spectra(tmp_path / "s.exr", spectra, [name_of(nm) for nm in CENTRES])
    words = ["--sensor", "canon-600d", "--illuminant", "FL2"]
    line = commands.fails("convert", path, "-o", tmp_path / "b.dng", *words)
    assert "which luminance is white? Add --white-luminance CD_PER_M2" in line
    assert not list(tmp_path.glob("*.dng"))


def test_a_sensor_without_filters(oiiotool, tmp_path, spectra):
    """Its DN are one integral; both commands agree."""
    nm = np.arange(380, 781, 10)
    curve = np.exp(-0.5 * ((nm - 540) / 80.0) ** 2)
    field = {"wavelengths": nm.tolist(), "mono": curve.tolist()}
    (tmp_path / "mono.json").write_text(
        cameras.mono_text(spectral_sensitivities=field, black_level=[0.0])
    )
    path = write_spectra(tmp_path / "s.exr", spectra, [name_of(nm) for nm in CENTRES])
    asked = {**ASKED, "sensor": str(tmp_path / "mono.json"), "illuminant": "D65"}
    oiiotool(path, *attributes(**asked), "-o", tmp_path / "a.dng")
    words = ["--sensor", tmp_path / "mono.json", "--illuminant", "D65"]
    words += ["--white-luminance", WHITE]
    assert commands.run("convert", path, "-o", tmp_path / "b.dng", *words).code == 0
    assert (tmp_path / "a.dng").read_bytes() == (tmp_path / "b.dng").read_bytes()
    found = read_dn(tmp_path / "a.dng").astype(float)
    fine = np.arange(373.75, 786.26, 0.05)
    weights = np.interp(fine, nm, curve, left=0, right=0)
    bins = np.searchsorted(CENTRES + 6.25, fine)
    per_bin = np.bincount(bins, weights, minlength=len(CENTRES))[: len(CENTRES)]
    wanted = spectra.astype(float) @ per_bin
    inside = (found > 800) & (found < found.max())
    ratio = (found / wanted)[inside]
    assert inside.mean() > 0.5
    assert ratio == pytest.approx(np.median(ratio), rel=4e-3)
