# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A chart through simulation, DNG and a reader of the specification, back to sRGB."""

import numpy as np
import pytest

import cg2raw

pytest.importorskip("tifffile", reason="tifffile is not installed")

from oracles import cameras, de2000, dng_convention, dng_renderer  # noqa: E402

LIGHTS = ("2856K", "4000K", "5000K", "6504K", "7500K")
PATCH = 4  # pixels; two CFA patterns
DARKEST = 0.02  # linear: below, quantisation alone is visible
COLUMNS = 16


def chart(camera, neutral):
    """Linear sRGB (224, 3): 24 patches and 200 random colours, inside both gamuts.

    Cyan's red is negative in sRGB: it is drawn as 0. Above a grey of 0.9 the highlights
    turn white on purpose: nothing is drawn there."""
    rng = np.random.default_rng(24)
    drawn = rng.uniform(0.0, 1.0, (4000, 3)) ** 1.5
    xy = camera.xy_from_neutral(neutral)[0]
    balanced = drawn @ dng_convention.balanced_from_srgb(camera, xy).T
    inside = (balanced >= 0.0).all(1) & (balanced <= 1.0).all(1)
    inside &= balanced.mean(axis=1) <= 0.9
    checker = np.clip(cameras.colorchecker() * 0.98, 0.0, 1.0)
    return np.concatenate([checker, drawn[inside][:200]])


def image_of(colors):
    rows = len(colors) // COLUMNS
    tiles = colors.reshape(rows, COLUMNS, 3)
    return np.repeat(np.repeat(tiles, PATCH, 0), PATCH, 1).astype(np.float32)


def differences(tmp_path, camera, spec, bits=14, matrix=None, **options):
    """dE2000 of every colour of the chart that is bright enough, after a round trip."""
    sensor = cg2raw.Sensor.from_json(cameras.profile_of(camera, bits=bits))
    neutral = np.array(sensor.illuminant(spec).neutral)
    colors = chart(cameras.oracle(camera), neutral)
    path = tmp_path / "chart.dng"
    raw = sensor.simulate(image_of(colors), illuminant=spec)
    cg2raw.write_dng(str(path), raw, **options)
    dng = dng_renderer.read(path)
    matrix = (matrix or dng_renderer.srgb_from_camera)(dng)
    seen = (dng_renderer.patch_means(dng, PATCH) @ matrix.T).reshape(-1, 3)
    bright = colors.min(axis=1) >= DARKEST
    assert bright.sum() > 150
    return de2000.between_linear_srgb(colors, np.clip(seen, 0.0, 1.0))[bright]


@pytest.mark.parametrize("spec", LIGHTS)
@pytest.mark.parametrize("camera", cameras.NINE)
def test_a_reader_gives_the_render_back(tmp_path, camera, spec):
    seen = differences(tmp_path, camera, spec)
    assert seen.mean() <= 0.03
    assert seen.max() <= 0.3


def test_the_rest_is_quantisation(tmp_path):
    means = [
        differences(tmp_path, "NikonD40", "2856K", b).mean() for b in (10, 12, 14, 16)
    ]
    for coarse, fine in zip(means[:-1], means[1:], strict=True):
        assert fine == pytest.approx(coarse / 4.0, rel=0.35)


@pytest.mark.parametrize("spec", ["2856K", "5000K", "7500K"])
@pytest.mark.parametrize(
    "reader", [dng_renderer.srgb_from_camera, dng_renderer.cool_matrix_srgb_from_camera]
)
@pytest.mark.parametrize("camera", ["NikonD40", "SonyA57", "PanasonicGX1"])
def test_with_exact_matrices_every_reader_gives_it_back(tmp_path, camera, reader, spec):
    seen = differences(tmp_path, camera, spec, matrix=reader, matrices="exact")
    assert seen.mean() <= 0.05


def test_with_camera_matrices_a_reader_of_one_matrix_does_not(tmp_path):
    """As with the camera's own files; this is what exact matrices are for."""
    reader = dng_renderer.cool_matrix_srgb_from_camera
    assert differences(tmp_path, "NikonD40", "2856K", matrix=reader).mean() > 0.5


@pytest.mark.parametrize("fields", [{"cfa": "GRBG"}, {"cfa": "GBRG"}, {"cfa": "BGGR"}])
def test_the_phase_does_not_matter(tmp_path, fields):
    sensor = cg2raw.Sensor.from_json(cameras.profile_of("SonyA57", **fields))
    neutral = np.array(sensor.illuminant("A").neutral)
    colors = chart(cameras.oracle("SonyA57"), neutral)
    path = tmp_path / "chart.dng"
    cg2raw.write_dng(str(path), sensor.simulate(image_of(colors), illuminant="A"))
    dng = dng_renderer.read(path)
    matrix = dng_renderer.srgb_from_camera(dng)
    seen = (dng_renderer.patch_means(dng, PATCH) @ matrix.T).reshape(-1, 3)
    bright = colors.min(axis=1) >= DARKEST
    assert de2000.between_linear_srgb(colors, seen)[bright].mean() <= 0.03


def test_one_matrix_and_forward_matrices(tmp_path):
    forward = [0.70, 0.20, 0.064, 0.28, 0.80, -0.08, 0.02, -0.10, 0.905]
    one = {"calibration_illuminant_2": None, "color_matrix_2": None}
    both = {"forward_matrix_1": forward, "forward_matrix_2": forward}
    rgb = image_of(np.random.default_rng(0).uniform(0.2, 0.5, (32, 3)))
    for fields in (one, both):
        sensor = cg2raw.Sensor.from_json(cameras.profile_of("NikonD40", **fields))
        path = tmp_path / "chart.dng"
        cg2raw.write_dng(str(path), sensor.simulate(rgb, illuminant="4000K"))
        dng = dng_renderer.read(path)
        seen = (
            dng_renderer.patch_means(dng, PATCH) @ dng_renderer.srgb_from_camera(dng).T
        )
        assert de2000.between_linear_srgb(rgb[::PATCH, ::PATCH], seen).mean() <= 0.03
