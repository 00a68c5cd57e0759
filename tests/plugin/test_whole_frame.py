# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Effects that need the whole frame, and the exposure time: the plugin holds its pixels
and writes what the core simulates, however the host hands them over."""

import json

import numpy as np
import pytest

import cg2raw
from images import attributes, read_dn, write_image

SITES = ("00", "01", "10", "11")
EFFECTS = {
    "blur": {"ring_1": 0.2, "ring_2": 0.1, "ring_10": 0.05},
    "veiling_glare": {"uniform": 0.03, "wide": 0.05},
    "crosstalk": {"left": 0.01, "right": 0.02, "up": 0.03, "down": 0.01},
    "shot_noise": {f"beta1_{site}": 4e-4 for site in SITES},
    "full_well": {"below_white": 0.2},
    "read_noise": {f"beta2_{site}": 2e-6 for site in SITES},
    "noise_reduction": {"blend": 0.4, "diagonal": 0.1},
    "prnu": {"sigma": 0.01},
    "hot_pixels": {"fraction": 0.01, "rate": 4.0},
}
SECONDS = 0.25
EXIF = ["--attrib", "ExposureTime", SECONDS]


@pytest.fixture
def profile(tmp_path, repository):
    """Return the path of a profile with many effects."""
    fields = json.loads((repository / "plugins/profiles/nikon-d40.json").read_text())
    known = {effect["name"]: effect["parameters"] for effect in cg2raw.effects()}
    fields["id"] = "spread"
    fields["effects"] = [
        {"name": name, "parameters": {p["name"]: p["null"] for p in known[name]} | own}
        for name, own in EFFECTS.items()
    ]
    path = tmp_path / "spread.json"
    path.write_text(json.dumps(fields))
    return path


def words_of(profile):
    return attributes(
        sensor=profile, illuminant="2856K", convention="sensor", seed=3, frame=2
    )


def expected(profile, scene):
    return cg2raw.Sensor(profile).simulate(
        scene,
        illuminant="2856K",
        convention="sensor",
        seed=3,
        frame=2,
        exposure_time=SECONDS,
    )


@pytest.mark.parametrize("shape", [(96, 128), (300, 270)])
@pytest.mark.parametrize("tile", [0, 32])
def test_the_plugin_writes_what_the_core_simulates(
    oiiotool, tmp_path, profile, shape, tile
):
    scene = np.random.default_rng(3).uniform(0, 1.2, (*shape, 3)).astype(np.float32)
    exr = write_image(tmp_path / "scene.exr", scene, tile=tile)
    out = tmp_path / "shot.dng"
    oiiotool(exr, *EXIF, *words_of(profile), "-o", out)
    raw = expected(profile, scene)
    np.testing.assert_array_equal(read_dn(out), raw)


def test_the_command_writes_the_same(tmp_path, profile, scene, oiiotool):
    from cg2raw.conversion import Request, convert

    exr = write_image(tmp_path / "a.exr", scene, {"ExposureTime": SECONDS})
    request = Request(
        {
            "sensor": str(profile),
            "illuminant": "2856K",
            "convention": "sensor",
            "seed": "3",
            "frame": "2",
        }
    )
    convert(exr, tmp_path / "command.dng", request)
    oiiotool(exr, *words_of(profile), "-o", tmp_path / "plugin.dng")
    files = [(tmp_path / f"{name}.dng").read_bytes() for name in ("command", "plugin")]
    assert files[0] == files[1]


def test_the_exposure_time_is_asked_for(oiiotool, tmp_path, profile, exr):
    out = tmp_path / "shot.dng"
    failed = oiiotool(exr, *words_of(profile), "-o", out, check=False)
    assert "hot_pixels needs an exposure time" in failed.stdout + failed.stderr
    assert "ExposureTime" in failed.stdout + failed.stderr
    assert not out.exists()
