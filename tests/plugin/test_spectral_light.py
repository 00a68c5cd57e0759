# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Spectral images through oiiotool: their own light, responses that they state."""

import json

import numpy as np
import pytest

import cg2raw
from cg2raw import _core
from cg2raw.io.spectra_file import SpectraFile, spectra_in
from cg2raw.spectra import boxes, estimated_light, simulate_spectra
from dng import dng_files
from images import attributes, read_dn
from python import commands
from spectral_files import (
    CENTRES,
    FICHET,
    WHITE,
    check_command,
    expected,
    name_of,
    write_spectra,
)


def stated(nm, power):
    return "".join(f"{w:g}nm:{p!r};" for w, p in zip(nm, power.tolist(), strict=True))


def test_the_light_that_a_file_states(oiiotool, tmp_path):
    """colour-science's example of a light, whose attribute illuminant is D65."""
    large = tmp_path / "light.exr"
    oiiotool(FICHET / "D65.exr", "--resize", "8x6", "-o", large)
    asked = {"sensor": "canon-600d", "illuminant": "estimate", "white_luminance": "3e4"}
    oiiotool(large, *attributes(**asked), "-o", tmp_path / "a.dng")
    words = ["--sensor", "canon-600d", "--illuminant", "estimate"]
    done = commands.run(
        *("convert", large, "-o", tmp_path / "b.dng", *words),
        *("--white-luminance", 3e4),
    )
    assert done.code == 0, done.err
    assert (tmp_path / "a.dng").read_bytes() == (tmp_path / "b.dng").read_bytes()
    # The file has 300 to 780 nm, and the sensitivities begin at 380.
    assert "of the energy is unseen" in done.out
    light = cg2raw.Sensor("canon-600d")
    wanted = _core.seen_by_sensitivities(light.profile, "D65").split(":")[1:]
    tags = dng_files.tags_of(tmp_path / "a.dng")[0]["AsShotNeutral"]
    neutral = np.divide(tags[::2], tags[1::2])
    assert neutral[[0, 2]] == pytest.approx([float(word) for word in wanted], rel=1e-4)


def test_responses_that_a_file_states(oiiotool, tmp_path, spectra):
    names = [name_of(nm) for nm in CENTRES]
    responses = {
        name: stated([nm - 12.5, nm, nm + 12.5], np.array([0.0, 2.0, 0.0]))
        for name, nm in zip(names, CENTRES, strict=True)
    }
    path = write_spectra(tmp_path / "s.exr", spectra, names, said=responses.items())
    found = check_command(oiiotool, path, tmp_path)
    assert not np.array_equal(found, expected(spectra))


def test_the_command_estimates_by_all_pixels(tmp_path, spectra):
    path = write_spectra(tmp_path / "s.exr", spectra, [name_of(nm) for nm in CENTRES])
    for word in ("estimate:mean", "estimate:max"):
        words = ["--sensor", "canon-600d", "--illuminant", word]
        done = commands.run(
            *("convert", path, "-o", tmp_path / "b.dng", *words),
            *("--white-luminance", WHITE),
        )
        assert done.code == 0, done.err
        wanted = simulate_spectra(
            cg2raw.Sensor("canon-600d"), spectra, CENTRES, illuminant=word, white=WHITE
        )
        assert np.array_equal(read_dn(tmp_path / "b.dng"), wanted)


@pytest.mark.parametrize(
    ("word", "spectrum"),
    [
        ("FL2", "FL2"),
        ("3200K", "black body of 3200 K"),
        ("neutral:0.53:0.61", "half daylight of 7359 K, half FL12"),
    ],
)
def test_the_spectrum_that_is_taken_is_said(oiiotool, exr, tmp_path, word, spectrum):
    asked = {"sensor": "canon-600d", "illuminant": word, "convention": "spectral"}
    debug = {"OPENIMAGEIO_DEBUG": "1"}
    out = tmp_path / "a.dng"
    done = oiiotool(exr, *attributes(**asked), "-o", out, env=debug)
    assert f"the light's spectrum is that of {spectrum}" in done.stdout + done.stderr
    words = ["--sensor", "canon-600d", "--illuminant", word]
    done = commands.run(
        *("convert", exr, "-o", tmp_path / "b.dng", *words),
        *("--convention", "spectral", "--json"),
    )
    (file,) = json.loads(done.out)["files"]
    assert file["illuminant"]["spectrum"] == spectrum
    plain = commands.run("convert", exr, "-o", tmp_path / "c.dng", *words, "--json")
    (file,) = json.loads(plain.out)["files"]
    assert file["illuminant"]["spectrum"] is None


def test_the_headers_of_a_shot_are_read_without_its_pixels(
    tmp_path, spectra, monkeypatch
):
    names = [name_of(nm) for nm in CENTRES]
    for number in (1, 2):
        write_spectra(tmp_path / f"s.{number}.exr", spectra, names)
    reads = []
    statistic = SpectraFile.statistic
    monkeypatch.setattr(
        SpectraFile,
        "statistic",
        lambda file, how: reads.append(file.path) or statistic(file, how),
    )
    words = ["--sensor", "canon-600d", "--illuminant", "estimate:mean"]
    words += ["--white-luminance", WHITE, "--framerate", 24]
    done = commands.run("convert", tmp_path / "s.#.exr", "-o", tmp_path / "raw", *words)
    assert done.code == 0, done.err
    assert sorted(reads) == [str(tmp_path / f"s.{number}.exr") for number in (1, 2)]


def test_what_is_wrong_with_channels_names_the_file(tmp_path, spectra):
    path = tmp_path / "s.exr"
    write_spectra(path, spectra[..., :2], ["T.400nm", "T.500nm"])
    with pytest.raises(ValueError, match=r"s.exr: its spectrum is a reflectance"):
        spectra_in(path)
    write_spectra(path, spectra[..., :2], ["R", "G"])
    assert spectra_in(path) is None


def test_an_estimated_spectrum_has_the_light_of_each_bin():
    """Bins reach half way to their neighbours, the outer ones as far on both sides."""
    centres, values = [400.0, 410.0, 430.0, 435.0], np.array([0.5, 2.0, 0.0, 1.0])
    nm, power = np.transpose(boxes(centres, values))
    assert (np.diff(nm) > 0).all()
    edges = [395, 405, 420, 432.5, 437.5]
    for low, high, value in zip(edges[:-1], edges[1:], values, strict=True):
        inside = np.linspace(low + 0.01, high - 0.01, 9)
        assert np.interp(inside, nm, power) == pytest.approx(value)
    assert (nm[0], nm[-1]) == pytest.approx((395, 437.5))


def test_the_light_that_an_image_states_is_taken_as_it_is():
    stated = [(400.0, 0.3), (410.0, 0.5)]
    assert estimated_light("estimate", stated, [405.0], lambda _: None) == stated
