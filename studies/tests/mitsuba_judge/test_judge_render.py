# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What Mitsuba makes of the second judge's scenes. Skipped where Mitsuba is not.

CG2RAW_MITSUBA_PYTHON names a Python that has mitsuba; else this one, if it has."""

import json
import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from cg2raw.profile.spectral_file import WAVELENGTHS
from studies.mitsuba_judge.folder import Settings, frame_path, judge_frames, part_path
from studies.mitsuba_judge.plans import View
from studies.mitsuba_judge.run import Renderer, answered, render, request
from studies.mitsuba_judge.scene import scene
from studies.mitsuba_judge.spectra import Material
from studies.mitsuba_judge.things import Thing

pytestmark = pytest.mark.slow
CAMERAS = ("sony-a7s-ii", "canon-600d")
LAMP = 0  # whose light the uniform scene has


@pytest.fixture(scope="module")
def renderer():
    named = os.environ.get("CG2RAW_MITSUBA_PYTHON")
    python = named or sys.executable
    if subprocess.run([python, "-c", "import mitsuba"], capture_output=True).returncode:
        if named:
            pytest.fail(f"CG2RAW_MITSUBA_PYTHON: {named} cannot import mitsuba")
        pytest.skip("no Mitsuba: CG2RAW_MITSUBA_PYTHON names a Python with mitsuba")
    return Renderer(python, 1)


@pytest.fixture(scope="module")
def cameras(camera_of):
    return [camera_of(name) for name in CAMERAS]


def settings(world, samples):
    return Settings(32, samples, 0, CAMERAS, world.hashes())


def test_a_frame_is_rendered_once_and_alike(renderer, world, cameras, tmp_path):
    said = []
    for folder in (tmp_path / "one", tmp_path / "one", tmp_path / "other"):
        render(folder, [1], settings(world, 16), world, cameras, renderer, said.append)
    assert len(said) == 2  # the second time it was there
    one, other = (
        judge_frames(tmp_path / name, CAMERAS[0]) for name in ("one", "other")
    )
    assert one.images[0].shape == (24, 32, 3)
    assert (one.images[0] == other.images[0]).all()
    assert one.images[0].min() >= 0.0 and one.images[0].mean() > 0.0
    what = scene(1, world)
    wanted = cameras[0].neutrals(what.spectra.lights[[what.main]])
    assert one.neutrals == pytest.approx(wanted, abs=1e-6)
    described = json.loads(
        frame_path(tmp_path / "one", 1).with_suffix(".json").read_text()
    )
    assert described["scene"]["kind"] == "square"


def uniform(world):
    """Return a scene of one matt plane under one light from everywhere."""
    found = scene(0, world)
    measured = world.reflectances["test"]
    row = measured[np.argmax(measured.std(axis=1))]
    plane = Thing("box", (0.0, -0.5, 0.0), (200.0, 1.0, 200.0), material=0)
    return row, replace(
        found,
        view=View((0.0, 2.0, 0.0), (0.0, 0.0, 1.0), 40.0),
        things=(plane,),
        sky_light=LAMP,
        sky_level=0.3,
        flux=np.eye(len(found.spectra.lights))[LAMP],
        spectra=replace(found.spectra, materials=(Material(row),)),
    )


def integral(*curves):
    """Return the integral of a product of curves (81,), linear between their points."""
    fine = np.linspace(WAVELENGTHS[0], WAVELENGTHS[-1], 8001)
    product = np.prod([np.interp(fine, WAVELENGTHS, curve) for curve in curves], axis=0)
    return np.trapezoid(product, fine)


def test_a_uniform_reflector_is_the_integral_of_its_spectra(
    renderer, world, cameras, tmp_path
):
    """Reflectance times light times sensitivity, in each channel of each camera: the
    channels have no scale of their own, as the study's own frames have none."""
    row, what = uniform(world)
    part = part_path(tmp_path, 0)
    asked = request(what, part, settings(world, 400), cameras, 1)
    with renderer.start() as worker:
        answered(worker, asked, part)
    light = 0.3 * what.spectra.lights[LAMP]
    with np.load(part) as file:
        for camera in cameras:
            found = file[camera.id].mean(axis=(0, 1))
            curves = camera.sensitivities.T
            assert found == pytest.approx(
                [integral(row, light, curve) for curve in curves], rel=3e-3
            )
            # The study's sums over 5 nm are those integrals but for steep lines.
            summed = 5.0 * (row * light) @ camera.sensitivities
            assert found / found[1] == pytest.approx(summed / summed[1], rel=0.02)
