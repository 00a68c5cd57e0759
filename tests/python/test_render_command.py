# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw render: the picture that is in a DNG, and what LibRaw cannot open."""

import json

import numpy as np
import OpenImageIO as oiio
import pytest

import cg2raw
from dng import dng_files
from oracles.de2000 import between_linear_srgb
from python.commands import fails, run

COLORS = np.array([[0.18] * 3, [0.5, 0.2, 0.1], [0.1, 0.4, 0.15], [0.1, 0.15, 0.5]])
PATCH = 32


@pytest.fixture
def shot(tmp_path):
    """Return the path of a DNG of four patches, which every reader gives back."""
    scene = COLORS.repeat(PATCH, 0)[None].repeat(64, 0).astype(np.float32)
    sensor = cg2raw.Sensor("canon-5d-mark-iv")  # 14 bits
    raw = sensor.simulate(scene, illuminant="2856K")
    path = tmp_path / "shot.dng"
    cg2raw.write_dng(path, raw, matrices="exact")
    return path


def pixels_of(path):
    """Return (image as read, its linear light)."""
    image = oiio.ImageBuf(str(path))
    encoded = image.get_pixels("float").astype(float)
    linear = ((encoded + 0.055) / 1.055) ** 2.4  # IEC 61966-2-1; no patch is darker
    return image, linear


def colors_of(linear):
    """Return the patches' means, their borders left out."""
    scale = linear.shape[1] // 4
    patches = linear.reshape(linear.shape[0], 4, scale, 3)
    inner = slice(scale // 4, -scale // 4)
    return patches[4:-4, :, inner].mean(axis=(0, 2))


@pytest.mark.parametrize("bits", [8, 16])
@pytest.mark.parametrize("half", [False, True])
def test_the_picture_is_the_render(shot, tmp_path, bits, half):
    out = tmp_path / "look.png"
    words = ["--bits", bits] + (["--half"] if half else [])
    assert run("render", shot, "-o", out, *words).code == 0
    image, linear = pixels_of(out)
    assert linear.shape == ((32, 64, 3) if half else (64, 128, 3))
    assert str(image.spec().format) == ("uint8" if bits == 8 else "uint16")
    # Half a code value of 8 bits is up to 0.3.
    assert between_linear_srgb(colors_of(linear), COLORS).max() < 0.6


def test_brightness_is_what_is_asked(shot, tmp_path):
    means = {}
    for words in ((), ("--brightness", 0.5), ("--auto-bright",)):
        out = tmp_path / "look.png"
        assert run("render", shot, "-o", out, "--bits", 16, *words).code == 0
        means[words] = colors_of(pixels_of(out)[1])[0].mean()
    plain, half, stretched = means.values()
    assert half / plain == pytest.approx(0.5, rel=0.01)
    assert stretched > 1.3 * plain


def test_by_default_it_goes_to_the_current_folder(shot, tmp_path, monkeypatch):
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    done = run("render", shot)
    assert done.out == "wrote     shot.png: 128x64\n"
    assert [path.name for path in here.iterdir()] == ["shot.png"]


def test_many_go_to_a_folder_and_bad_ones_are_named(shot, tmp_path):
    (tmp_path / "cut.dng").write_bytes(shot.read_bytes()[:200])
    (tmp_path / "text.dng").write_text("no RAW")
    files = [shot, tmp_path / "cut.dng", tmp_path / "text.dng", tmp_path / "none.dng"]
    out = tmp_path / "looks"
    done = run("render", *files, "-o", out, "--json")
    assert done.code == 1
    report = json.loads(done.out)
    assert [file["output"] for file in report["files"]] == [str(out / "shot.png")]
    assert (report["files"][0]["width"], report["files"][0]["bits"]) == (128, 8)
    for file, error in zip(files[1:], report["errors"], strict=True):
        assert error["input"] == str(file) and str(file) in error["error"]
    assert "LibRaw cannot read it" in report["errors"][1]["error"]
    assert [path.name for path in out.iterdir()] == ["shot.png"]
    assert "is no folder" in fails("render", *files, "-o", shot)


@pytest.mark.parametrize("size", [(511, 640), (512, 512)])
def test_small_x_trans_files_get_a_reason(tmp_path, size):
    """LibRaw's own message is "Input/output error"."""
    path, out = tmp_path / "small.dng", tmp_path / "small.png"
    dng_files.write(path, cg2raw.Sensor("fujifilm-x-m1"), shape=size)
    if min(size) >= 512:
        assert run("render", path, "-o", out).code == 0
        return
    assert "512x512" in fails("render", path, "-o", out)
    assert not out.exists()
    assert run("render", path, "-o", out, "--half").code == 0


BAD = [
    (["-o", "x.jpg"], 1, ".png"),
    (["-o", "/nowhere/x.png"], 1, "no folder /nowhere"),
    (["--bits", "12"], 2, "--bits"),
    (["--brightness", "-1"], 2, "0.001"),
]


@pytest.mark.parametrize(("words", "code", "said"), BAD, ids=str)
def test_errors_are_one_line(shot, tmp_path, monkeypatch, words, code, said):
    monkeypatch.chdir(tmp_path)
    assert said in fails("render", shot, *words, code=code)
    assert [path.name for path in tmp_path.iterdir()] == ["shot.dng"]
