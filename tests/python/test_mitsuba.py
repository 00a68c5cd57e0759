# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A spectral render of Mitsuba 3 becomes a DNG as docs/spectral.md says.

Run with --slow, where Mitsuba is: CG2RAW_MITSUBA_PYTHON names a Python that can import
mitsuba; else this Python, if it can."""

import json
import os
import subprocess
import sys

import numpy as np
import OpenImageIO as oiio
import pytest

import cg2raw
from cg2raw.profile.illuminant_spectra import illuminant_spectrum
from cg2raw.profile.spectral_file import WAVELENGTHS
from images import attributes, read_dn
from oracles import spectral

pytestmark = pytest.mark.slow

# The bands of docs/spectral.md: 400 to 700 nm, 20 wide.
CENTRES, WIDTH = np.arange(400, 701, 20), 20
SIDE = 32  # pixels; the left half is grey, the right one green
GREY = 0.5
SENSOR = "canon-600d"
FINE = np.linspace(380.0, 780.0, 8001)  # nm, of the oracle's integrals

# Under light from everywhere a diffuse surface has its reflectance times the light's
# radiance, exactly. Reads JSON of Mitsuba's dictionaries, writes the film's bands.
RENDER = """
import json, sys
import mitsuba
mitsuba.set_variant("scalar_spectral")
asked = json.load(sys.stdin)
T = mitsuba.ScalarTransform4f
def patch(reflectance, x):
    place = T().translate([x, 0, 0]).scale([0.5, 1, 1])
    bsdf = {"type": "diffuse", "reflectance": reflectance}
    return {"type": "rectangle", "to_world": place, "bsdf": bsdf}
scene = mitsuba.load_dict({
    "type": "scene",
    "integrator": {"type": "path", "max_depth": 2},
    "light": {"type": "constant", "radiance": asked["light"]},
    "grey": patch(asked["grey"], -0.5),
    "green": patch(asked["green"], 0.5),
    "camera": {
        "type": "orthographic",
        "to_world": T().look_at(origin=[0, 0, 2], target=[0, 0, 0], up=[0, 1, 0]),
        "sampler": {"type": "multijitter", "sample_count": 256},
        "film": {
            "type": "specfilm", "component_format": "float32",
            "width": asked["side"], "height": asked["side"],
            "rfilter": {"type": "box"}, **asked["bands"],
        },
    },
})
mitsuba.render(scene, seed=1)
scene.sensors()[0].film().bitmap().write(asked["path"])
"""


def curve(first, last, values):
    """Return Mitsuba's spectrum of values from first to last nm."""
    text = ", ".join(f"{value:.8g}" for value in values)
    return {
        "type": "regular",
        "wavelength_min": float(first),
        "wavelength_max": float(last),
        "values": text,
    }


@pytest.fixture(scope="module")
def mitsuba_python():
    """Return a Python that can import mitsuba, or skip."""
    named = os.environ.get("CG2RAW_MITSUBA_PYTHON")
    python = named or sys.executable
    found = subprocess.run([python, "-c", "import mitsuba"], capture_output=True)
    if found.returncode:
        if named:
            pytest.fail(f"CG2RAW_MITSUBA_PYTHON: {named} cannot import mitsuba")
        pytest.skip("no Mitsuba: CG2RAW_MITSUBA_PYTHON names a Python with mitsuba")
    return python


@pytest.fixture(scope="module")
def power():
    """Return the radiance (81,) of white at WAVELENGTHS, W/(m2 sr nm): D65's."""
    return illuminant_spectrum("D65") / 1000.0


@pytest.fixture(scope="module")
def exr(mitsuba_python, power, tmp_path_factory):
    """Return the path of the render: a band's value is the integral over it."""
    path = tmp_path_factory.mktemp("mitsuba") / "mitsuba.exr"
    half = WIDTH / 2
    asked = {
        "path": str(path),
        "side": SIDE,
        "light": curve(380, 780, power),
        "grey": curve(380, 780, np.full(81, GREY)),
        "green": curve(380, 780, spectral.held_out()["ColorChecker"][13]),
        "bands": {f"b{nm}": curve(nm - half, nm + half, (1, 1)) for nm in CENTRES},
    }
    done = subprocess.run(
        [mitsuba_python, "-c", RENDER],
        input=json.dumps(asked),
        text=True,
        capture_output=True,
    )
    assert done.returncode == 0, done.stderr
    return path


def luminance(power):
    """Return cd/m2 of white."""
    eye = np.interp(FINE, WAVELENGTHS, spectral.observer()[:, 1])
    return 683.0 * np.trapezoid(eye * np.interp(FINE, WAVELENGTHS, power), FINE)


@pytest.fixture
def raw(exr, power, oiiotool, tmp_path):
    """Return the DN of the DNG that the page's command makes of the render."""
    asked = {
        "sensor": SENSOR,
        "illuminant": "D65",
        "exposure": f"{luminance(power):.9g}",
    }
    names = ",".join(f"S0.{nm}nm" for nm in CENTRES)
    words = (exr, "--chnames", names, "--divc", WIDTH, *attributes(**asked))
    oiiotool(*words, "-o", tmp_path / "shot.dng")
    return read_dn(tmp_path / "shot.dng").astype(np.float64)


def seen_by_sensor(power):
    """Return bins (16, 3): camera RGB of a radiance of 1 in each, white's highest 1."""
    sensor = cg2raw.Sensor(SENSOR).spectral_sensitivities
    curves = [np.interp(FINE, sensor["wavelengths"], c) for c in sensor["rgb"].T]
    white = [
        np.trapezoid(c * np.interp(FINE, WAVELENGTHS, power), FINE) for c in curves
    ]
    bins = np.empty((len(CENTRES), 3))
    for i, nm in enumerate(CENTRES):
        inside = np.abs(FINE - nm) <= WIDTH / 2 + 1e-6
        bins[i] = [np.trapezoid(c[inside], FINE[inside]) for c in curves]
    return bins / max(white)


def mosaic_of(camera, profile):
    """Return DN (H, W) float64, not rounded, of camera RGB (H, W, 3)."""
    sites = ["RGB".index(letter) for letter in profile["cfa"].upper()]
    dn = np.empty(camera.shape[:2])
    for i, channel in enumerate(sites):
        at = (slice(i // 2, None, 2), slice(i % 2, None, 2))
        dn[at] = np.clip(camera[..., channel][at], 0.0, 1.0)
    black = np.mean(profile["black_level"])
    return black + dn * (profile["white_level"] - black)


def test_the_raw_is_the_integral_of_the_renders_bands(exr, raw, power):
    """In float64, over the bands as the file has them; DN are rounded."""
    image = oiio.ImageBuf(str(exr))
    assert list(image.spec().channelnames) == [f"b{nm}" for nm in CENTRES]
    bands = image.get_pixels(oiio.FLOAT).astype(np.float64)
    profile = json.loads(cg2raw.Sensor(SENSOR).to_json())
    camera = bands / WIDTH @ seen_by_sensor(power)
    wanted = mosaic_of(camera, profile)
    # Rounding, and the five digits that the core has of D65 and of the eye's V.
    full = profile["white_level"] - np.mean(profile["black_level"])
    assert np.abs(raw - wanted).max() < 0.5 + 4e-5 * full
    assert wanted.max() - wanted.min() > 1000.0


def test_a_grey_patch_is_as_bright_as_its_share_of_the_stated_white(raw, power):
    """Bins of 20 nm and the noise of 131,072 paths leave about 1 %."""
    profile = json.loads(cg2raw.Sensor(SENSOR).to_json())
    response = (
        illuminant_spectrum("D65") @ cg2raw.Sensor(SENSOR).spectral_sensitivities["rgb"]
    )
    grey = np.broadcast_to(GREY * response / response.max(), (SIDE, SIDE, 3))
    black = np.mean(profile["black_level"])
    wanted = mosaic_of(grey, profile) - black
    left = (slice(None), slice(0, SIDE // 2))
    for row, column in np.ndindex(2, 2):
        site = (slice(row, None, 2), slice(column, None, 2))
        found = (raw - black)[left][site].mean()
        assert found == pytest.approx(wanted[left][site].mean(), rel=0.02)
