# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A chart through RAW and back: EXR -> RAW space -> DNG -> mosaic -> RAW -> scene."""

import numpy as np
import OpenImageIO as oiio
import pytest

from cg2raw import _core
from cg2raw_ocio import names
from cg2raw_ocio.config import config_text, make_config
from images import write_image
from oracles import cameras, de2000
from tiers import slow

SENSOR = "canon-600d"  # 14 bits
PATCH = 24  # pixels, of each square patch; LibRaw wants at least 22
MEAN_DE2000 = 0.05
# The white patch, 0.915 of white, must stay below 0.9: highlights give up their colour.
EXPOSURE = 0.95


def chart():
    """Return (24, 3) float32 scene colours, those outside sRGB at its border."""
    return EXPOSURE * np.maximum(cameras.colorchecker(), 0.0).astype(np.float32)


def developed(mosaic, profile):
    """Return (24, 3) camera RGB: the mean of each colour's sites in each patch."""
    black, white = np.mean(profile.black_level), profile.white_level
    linear = (mosaic.astype(float) - black) / (white - black)
    phases = [(linear[i::2, j::2]) for i in (0, 1) for j in (0, 1)]
    camera = np.zeros((24, 3))
    for colour, letter in enumerate("RGB"):
        sites = [p for p, c in zip(phases, profile.cfa, strict=True) if c == letter]
        blocks = np.mean(sites, axis=0).reshape(PATCH // 2, 24, PATCH // 2)
        camera[:, colour] = blocks.mean(axis=(0, 2))
    return camera.astype(np.float32)


@pytest.mark.parametrize("light", [slow("A"), "D65"])
def test_chart_through_a_dng(system_oiiotool, tmp_path, light):
    profile = _core.load_profile(SENSOR)
    assert profile.bits == 14
    path = tmp_path / "config.ocio"
    path.write_text(config_text(make_config([profile], [light])))
    env = {"OCIO": str(path)}
    raw, *_ = names.raw_space(SENSOR, light)
    row = np.repeat(chart(), PATCH, axis=0)[None]
    scene = write_image(tmp_path / "chart.exr", np.repeat(row, PATCH, axis=0))
    dng, mosaic = tmp_path / "chart.dng", tmp_path / "mosaic.tif"
    system_oiiotool(scene, "--tocolorspace", raw, "-o", dng, env=env)
    undemosaiced = ["--iconfig", "raw:Demosaic", "none"]
    system_oiiotool(*undemosaiced, dng, "-o", mosaic, env=env)
    dn = oiio.ImageBuf(str(mosaic)).get_pixels(oiio.UINT16)[..., 0]
    assert dn.shape == (PATCH, 24 * PATCH)
    camera = write_image(tmp_path / "camera.exr", developed(dn, profile)[None])
    back = tmp_path / "back.exr"
    convert = ["--colorconvert", raw, names.SCENE_LINEAR]
    system_oiiotool(camera, *convert, "-d", "float", "-o", back, env=env)
    seen = oiio.ImageBuf(str(back)).get_pixels(oiio.FLOAT)[0]
    difference = de2000.between_linear_srgb(seen, chart())
    print(f"{light}: mean dE2000 {difference.mean():.4f}, max {difference.max():.4f}")
    assert difference.mean() <= MEAN_DE2000
