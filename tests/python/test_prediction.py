# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Predictions of blocks of a frame: those of the simulation, whatever the blocks."""

import numpy as np
import pytest
from scipy import ndimage

import cg2raw
from cg2raw import _core
from oracles import cameras

HEIGHT, WIDTH = 48, 64
LIGHT = "D65"
SHADING = {"r2": -0.6, "r4": 0.2, "r6": -0.1, "tilt_x": 0.05, "tilt_y": -0.03}
SHADING |= {"tilt_x_r2": 0.02, "tilt_y_r2": 0.01}
NOISE = [
    ("shot_noise", [4e-4, 3e-4, 2e-4, 5e-4]),
    ("read_noise", [1e-6, 2e-6, 3e-6, 4e-6]),
]
SETTINGS = [*NOISE, ("lens_shading", list(SHADING.values()))]


def sensor_of(settings=(), **fields):
    known = {effect["name"]: effect["parameters"] for effect in cg2raw.effects()}
    effects = [
        {
            "name": name,
            "parameters": {
                parameter["name"]: value
                for parameter, value in zip(known[name], values, strict=False)
            },
        }
        for name, values in settings
    ]
    return cg2raw.Sensor.from_json(cameras.profile_text(effects=effects, **fields))


def camera_rgb():
    """Below white: nothing clips. (H, W, 3)."""
    return np.random.default_rng(5).uniform(0, 0.9, (HEIGHT, WIDTH, 3)).astype("f4")


def predict(
    camera,
    settings=SETTINGS,
    sensor=None,
    origins=((0, 0),),
    margin=0,
    frame=(HEIGHT, WIDTH),
    exposure_time=None,
    glare_context=None,
    **options,
):
    """Blocks of (H, W, 3) camera RGB; the frame is one block unless told otherwise."""
    blocks = np.moveaxis(np.asarray(camera, np.float32), -1, -3)
    return _core.predict_blocks(
        (sensor or sensor_of())._profile,
        settings,
        blocks if blocks.ndim == 4 else blocks[None],
        np.array(origins),
        frame,
        margin,
        [0.5, 1.0, 0.7],
        exposure_time,
        glare_context,
        **options,
    )


@pytest.mark.parametrize("cfa", ["RGGB", "GBRG", cameras.X_TRANS])
def test_the_whole_frame_is_the_simulation(cfa):
    """Listed in any order; none of the profile's are added."""
    settings = SETTINGS if len(cfa) == 4 else SETTINGS[2:]
    listed = sensor_of(settings, cfa=cfa)
    camera = camera_rgb()
    mean, variance = listed.predict(camera, illuminant=LIGHT, camera_input=True)
    got = predict(camera, settings, listed)
    np.testing.assert_array_equal(got[0][0], mean)
    np.testing.assert_array_equal(got[1][0], variance)
    np.testing.assert_array_equal(got[2][0], mean)  # nothing moves it after the light
    assert len(cfa) > 4 or variance.min() > 0
    assert predict(camera, [], listed)[1].max() == 0


@pytest.mark.parametrize("margin", [0, 3])
@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("cfa", ["GRBG", cameras.X_TRANS])
def test_blocks_are_parts_of_the_whole(cfa, margin, threads):
    sensor = sensor_of(cfa=cfa)
    settings = SETTINGS if len(cfa) == 4 else SETTINGS[2:]
    camera = camera_rgb()
    whole = predict(camera, settings, sensor)
    origins = [(0, 0), (7, 11), (31, 43), (12, 1)]
    rows, cols = 17, 21
    blocks = [camera[r : r + rows, c : c + cols] for r, c in origins]
    parts = predict(
        blocks,
        settings,
        sensor,
        origins=np.add(origins, margin),
        margin=margin,
        threads=threads,
    )
    for full, part in zip(whole, parts, strict=True):
        assert part.shape == (4, rows - 2 * margin, cols - 2 * margin)
        for block, (r, c) in zip(part, origins, strict=True):
            inner = full[
                0, r + margin : r + rows - margin, c + margin : c + cols - margin
            ]
            np.testing.assert_array_equal(block, inner)


def test_nothing_is_clipped_and_noise_falls_everywhere():
    """A physical sensor: white is where its ADC ends, and no earlier."""
    mean, variance, exposed = predict(np.full((HEIGHT, WIDTH, 3), 3.0), NOISE)
    assert mean.min() == mean.max() == 3.0
    assert exposed.min() == 3.0
    sites = variance[0, :2, :2].ravel()
    np.testing.assert_allclose(
        sites, 3 * np.array(NOISE[0][1]) + NOISE[1][1], rtol=1e-6
    )


ERRORS = [
    (dict(settings=[("shot_nose", [0.0])]), "shot_nose.*unknown.*shot_noise"),
    (dict(settings=[NOISE[0], NOISE[0]]), "shot_noise is given twice"),
    (dict(settings=[("quantisation", [0.1, 0.2])]), "quantisation.*2 values.*1.*step"),
    (dict(settings=[("quantisation", [0.2])]), "quantisation: step 0.2.*0 to 0.1"),
    (dict(settings=[("quantisation", [float("nan")])]), "step nan is outside"),
    (dict(origins=[(0, 1)]), "48 x 64 pixels at row 0, col 1 leaves the frame"),
    (dict(origins=[(-1, 0)]), "row -1, col 0 leaves the frame"),
    (dict(origins=[(0, 0), (0, 0)]), r"origins.*\(1, 2\)"),
    (dict(margin=24), "margin 24 must.*48"),
    (dict(margin=1 << 30), "margin 1073741824 must.*48"),  # twice it is no int
    (dict(margin=-1), "margin -1"),
]


@pytest.mark.parametrize(("options", "message"), ERRORS)
def test_bad_arguments_are_named(options, message):
    with pytest.raises(ValueError, match=message):
        predict(camera_rgb(), **options)


def test_values_of_sites_need_a_cfa_of_such_sites():
    with pytest.raises(ValueError, match="shot_noise.*beta1_00.*2 x 2 CFA"):
        predict(camera_rgb(), NOISE, sensor_of(cfa=cameras.X_TRANS))


def test_camera_rgb_must_be_four_dimensional():
    with pytest.raises(ValueError, match="blocks, 3, height, width"):
        _core.predict_blocks(
            sensor_of()._profile, [], np.zeros((3, 8, 8), "f4"), [[0, 0]], (8, 8), 0,
            [1, 1, 1], None, None,
        )  # fmt: skip


def test_the_glare_context_is_the_frame_spread_over_a_sixth_of_its_height():
    """Against SciPy's Gaussian of the means of cells, of 8 x 8 pixels here."""
    camera = np.random.default_rng(6).uniform(0, 1, (256, 512, 3)).astype("f4")
    glare_context = _core.glare_context(camera)
    cells = camera.astype(float).reshape(32, 8, 64, 8, 3).mean((1, 3))
    want = ndimage.gaussian_filter(
        cells, 256 / 6 / 8, mode="reflect", truncate=4.0, axes=(0, 1)
    )
    np.testing.assert_allclose(
        glare_context.wide, np.moveaxis(want, -1, 0), rtol=0, atol=2e-6
    )
    np.testing.assert_allclose(
        glare_context.mean, camera.mean((0, 1), float), rtol=1e-12
    )


@pytest.mark.parametrize("shape", [(1, 1), (5, 3), (1, 200), (331, 7), (100, 131)])
def test_the_glare_context_of_a_flat_frame_is_flat(shape):
    flat = np.broadcast_to(np.float32([0.25, 0.5, 0.75]), (*shape, 3))
    glare_context = _core.glare_context(flat)
    assert glare_context.wide.shape[2] == min(64, shape[1])
    np.testing.assert_allclose(glare_context.mean, [0.25, 0.5, 0.75], rtol=1e-12)
    for plane, value in zip(glare_context.wide, [0.25, 0.5, 0.75], strict=True):
        np.testing.assert_allclose(plane, value, rtol=1e-6)


def test_planes_and_pixels_have_the_same_glare_context():
    camera = camera_rgb()
    planes = np.ascontiguousarray(np.moveaxis(camera, -1, 0))
    np.testing.assert_array_equal(
        _core.glare_context(camera).wide, _core.glare_context(planes).wide
    )
    with pytest.raises(ValueError, match="3, height, width"):
        _core.glare_context(camera[..., :2])
