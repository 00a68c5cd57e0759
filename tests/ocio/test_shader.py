# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""RAW spaces on a GPU: GLSL without a texture, drawn without a window; and with one."""

import types

import numpy as np
import PyOpenColorIO as ocio
import pytest

from cg2raw import _core
from cg2raw_ocio import chain, spectral_chain
from ocio import shader_runner
from ocio.pixels import BLACK_AND_WHITE, kinds_of_pixels
from oracles import camera_transform

MAX_DN = 0.25 / 65535.0


def transform_of(profiles, light, convention):
    return _core.camera_from_scene(
        profiles[-2], profiles[-2].illuminant(light), convention, 0.9
    )


def shader_of(transform, direction="camera_from_scene"):
    ops = getattr(chain, direction)(transform)
    return shader_runner.shader_of(ocio.GroupTransform(ops))


@pytest.fixture(scope="module")
def context():
    """Return an OpenGL context without a window, or skip."""
    moderngl = pytest.importorskip("moderngl", reason="no moderngl: scripts/setup")
    try:
        return moderngl.create_context(standalone=True, backend="egl")
    except Exception as error:  # whatever EGL or its driver lacks
        pytest.skip(f"no OpenGL without a window (libegl1, libgl1-mesa-dri): {error}")


@pytest.mark.parametrize("convention", ["dng", "paper"])
@pytest.mark.parametrize("direction", ["camera_from_scene", "scene_from_camera"])
def test_no_texture(profiles, direction, convention):
    shader = shader_of(transform_of(profiles, "A", convention), direction)
    assert shader_runner.textures(shader) == 0
    assert "OCIOMain" in shader.getShaderText()
    assert "sampler" not in shader.getShaderText()


def test_numbers_are_those_of_glsl(profiles):
    """OpenColorIO writes large whole numbers as "1e+30.", which does not compile."""
    text = shader_of(transform_of(profiles, "A", "dng")).getShaderText()
    assert "e+" not in text


@pytest.mark.parametrize("convention", ["dng", "paper"])
@pytest.mark.parametrize("light", ["A", "D65", "9000K"])
def test_drawn_pixels(context, profiles, light, convention):
    transform = transform_of(profiles, light, convention)
    rgb = np.concatenate(list(kinds_of_pixels(1000).values()))[None]
    camera = shader_runner.drawn(context, shader_of(transform), rgb)
    expected = camera_transform.camera_from_scene(rgb, transform)
    assert np.abs(camera - expected).max() <= MAX_DN


@pytest.mark.parametrize("gains", [(0.05, 0.999, 1.3), (1.0, 1.0, 1.2), (0.6,) * 3])
def test_drawn_pixels_of_other_gains(context, gains):
    transform = types.SimpleNamespace(
        first=np.eye(3),
        two_steps=False,
        second=np.eye(3),
        gains=gains,
        keep_highlights=True,
        clip_result=False,
    )
    rgb = np.concatenate(list(kinds_of_pixels(1000).values()))[None]
    camera = shader_runner.drawn(context, shader_of(transform), rgb)
    expected = camera_transform.camera_from_scene(rgb, transform)
    assert np.abs(camera - expected).max() <= MAX_DN


def test_infinite_pixels_are_drawn_white(context, profiles):
    """GLSL leaves open what max() makes of NaN; of infinities it does not."""
    rgb = np.array([sum(BLACK_AND_WHITE.values(), [])], np.float32)
    rgb = rgb[:, ~np.isnan(rgb[0]).any(axis=-1)]
    transform = transform_of(profiles, "A", "dng")
    camera = shader_runner.drawn(context, shader_of(transform), rgb)
    expected = camera_transform.camera_from_scene(rgb, transform)
    assert np.abs(camera - expected).max() <= MAX_DN


def test_a_table_is_drawn(context):
    """Neutrals stand on nodes. Others are as near as the GPU's filter: Mesa's has the
    digits of float32, most hardware takes 8 bits between two nodes, 1 % of white."""
    profile = _core.load_profile("canon-600d")
    transform = _core.camera_from_scene(profile, profile.illuminant("FL2"), "spectral")
    ops = spectral_chain.camera_from_scene(transform)
    shader = shader_runner.shader_of(ocio.GroupTransform(ops))
    assert shader_runner.textures(shader) == 2 and "e+" not in shader.getShaderText()
    rgb = np.random.default_rng(2).random((1, 2000, 3)).astype(np.float32)
    rgb[:, 1000:] = rgb[:, 1000:, :1]
    expected = _core.to_camera(transform, rgb)
    error = np.abs(shader_runner.drawn(context, shader, rgb) - expected)
    assert error[:, 1000:].max() <= 1.5 / 65535.0
    exact = context.info["GL_RENDERER"].startswith("llvmpipe")
    assert error.max() <= (3.0 / 65535.0 if exact else 0.01)
