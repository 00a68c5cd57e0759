# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is wrong with frames is found before they are diagnosed."""

import numpy as np
import pytest

import cg2raw
from cg2raw.diagnose.captures.check import check
from cg2raw.diagnose.captures.phase_correlation import shift_between
from cg2raw.diagnose.captures.reader import read_frames
from diagnose import capture_files as files


def smooth(shape, down=0.0, right=0.0, seed=1):
    """Return a band-limited periodic picture, shifted by any part of a pixel."""
    rng = np.random.default_rng(seed)
    v, u = np.fft.fftfreq(shape[0])[:, None], np.fft.rfftfreq(shape[1])[None, :]
    spectrum = np.fft.rfft2(rng.standard_normal(shape)) * np.exp(-40 * (u * u + v * v))
    return np.fft.irfft2(spectrum * np.exp(-2j * np.pi * (v * down + u * right)), shape)


@pytest.mark.parametrize("shift", [(0, 0), (0.3, -0.7), (-2.5, 1.25), (7, -4)])
@pytest.mark.parametrize("noise", [0, 0.2])
def test_a_planted_shift_is_found(shift, noise):
    shape = (128, 160)
    first = smooth(shape)
    second = smooth(shape, *shift)
    second = 3 * second + 1
    rng = np.random.default_rng(2)
    first = first + noise * first.std() * rng.standard_normal(shape)
    found = shift_between(first, second)
    assert (found.down, found.right) == pytest.approx(shift, abs=0.15)
    assert found.correlation > 0.75


def test_frames_that_are_right(tmp_path):
    path = files.standard_set(tmp_path)
    _, sensor, frames, _ = read_frames(path)
    for found in check(frames, sensor).integrities:
        assert found.complaints == (), found
        assert (found.shift is None) == (found.kind != "scene")
    assert abs(found.shift.down) < 0.2 and abs(found.shift.right) < 0.2
    raw = frames[-1].capture.raw()
    assert (found.low, found.high) == (raw.min(), raw.max())
    assert found.mean == pytest.approx(raw.mean())


def test_a_render_that_is_shifted(tmp_path):
    big = files.picture((192, 256), seed=4)
    cg2raw.write_dng(
        tmp_path / "a.dng",
        cg2raw.Sensor(files.SENSOR).simulate(big, illuminant="D65", iso=100),
    )
    np.save(tmp_path / "r.npy", np.roll(big, (6, -10), axis=(0, 1)))
    line = "{file: a.dng, kind: scene, scene: r.npy}"
    _, sensor, frames, _ = read_frames(files.manifest(tmp_path, [line]))
    for nuisances in ([], ["registration"]):
        every = check(frames, sensor, nuisances=nuisances)
        [found] = every.integrities
        assert (found.shift.down, found.shift.right) == pytest.approx((6, -10), abs=0.5)
        assert "a diagnosis takes up 4 px" in found.complaints[0]
        said = any("add registration to nuisance" in one for one in every.complaints)
        assert said == (not nuisances)


@pytest.mark.parametrize(
    ("iso", "light", "contrast", "corner"),
    [(3200, 0.01, 1.6, 1), (3200, 0.001, 1.6, 1), (100, 1, 0.1, 1), (100, 1, 0.1, 0.5)],
)
def test_a_render_with_less_contrast_than_its_capture(
    tmp_path, iso, light, contrast, corner
):
    """Noise has more of dim scenes, and vignetting of a wall."""
    scene = light * (0.25 + contrast * 0.25 * (files.picture((192, 256)) - 0.475))
    scene = scene * np.linspace(1, 1.3, 256)[:, None]
    falloff = np.linspace(1, corner, 256)[:, None]
    raw = cg2raw.Sensor(files.SENSOR).simulate(
        (scene * falloff).astype(np.float32), illuminant="D65", iso=iso
    )
    cg2raw.write_dng(tmp_path / "a.dng", raw)
    complaints = {}
    for turned in (1, -1):
        np.save(tmp_path / "r.npy", scene[::turned, ::turned].astype(np.float32))
        line = "{file: a.dng, kind: scene, scene: r.npy}"
        found = files.checked(tmp_path, [line])
        complaints[turned] = [*found.complaints, *found.integrities[0].complaints]
    assert not complaints[1]
    assert bool(complaints[-1]) == (light == 1)  # else noise hides which way up it is


@pytest.mark.parametrize(
    ("kind", "value", "words"),
    [
        ("dark", 500, "all pixels are 500 DN: holds no picture"),
        ("dark", 500, "its mean is 436 DN above black: is it dark?"),
        ("flat, scene: unknown, illuminant: A", 64, "holds no light: is it a dark?"),
        ("flat, scene: unknown, illuminant: A", 1023, "100% of the pixels are clipped"),
        ("dark", 4000, "4000 DN does not fit into 10 bits (1023)"),
    ],
)
def test_levels_that_are_wrong(tmp_path, kind, value, words):
    np.save(tmp_path / "a.npy", np.full(files.SHAPE, value, np.uint16))
    [found] = files.checked(tmp_path, [f"{{file: a.npy, kind: {kind}}}"]).integrities
    assert words in " ".join(found.complaints)


@pytest.mark.parametrize(
    ("above", "words"), [(0.5, ("holds no light: is it a dark?",)), (1.5, ())]
)
def test_a_flat_is_a_dn_above_black_or_more(tmp_path, above, words):
    values = np.random.default_rng(9).normal(64 + above, 3, files.SHAPE)
    np.save(tmp_path / "a.npy", np.rint(values).astype(np.uint16))
    line = "{file: a.npy, kind: flat, scene: unknown, illuminant: A}"
    [found] = files.checked(tmp_path, [line]).integrities
    assert found.complaints == words


def test_shares_of_clipped_and_empty_pixels(tmp_path):
    raw = files.frame(tmp_path, "a.npy", files.picture())
    raw = raw.copy()
    raw[:12] = 1023
    raw[12:24] = 0
    np.save(tmp_path / "a.npy", raw)
    line = "{file: a.npy, kind: flat, scene: unknown, illuminant: A}"
    [found] = files.checked(tmp_path, [line]).integrities
    assert found.clipped == pytest.approx(0.25, abs=0.01)
    assert found.below == pytest.approx(0.25)


def dark(folder, values):
    """Return the Integrity of a dark of values, DN."""
    np.save(folder / "a.npy", np.rint(values).clip(0).astype(np.uint16))
    return files.checked(folder, ["{file: a.npy, kind: dark}"]).integrities[0]


@pytest.mark.parametrize(
    ("sigma", "scale", "complaint", "remark"),
    [
        (3.0, 1, "", ""),
        (0.3, 1, "", "its read noise is below 0.4 DN: its size and tails"),
        (3.0, 4, "only one in 4 codes occurs: scaled from fewer bits", ""),
        (0.7, 16, "only one in 16 codes occurs: scaled from fewer bits", ""),
        (0.15, 16, "codes occur, most of them without a neighbour: a copy of few", ""),
        (3.0, 1.5, "of the codes between frequent ones are missing", ""),
    ],
)
def test_codes_that_are_scaled_or_coarse(tmp_path, sigma, scale, complaint, remark):
    rng = np.random.default_rng(7)
    plain = np.rint(rng.normal(64.4 / scale, sigma, files.SHAPE))
    found = dark(tmp_path, np.floor(scale * plain))
    assert len(found.complaints) == bool(complaint)
    assert complaint in "".join(found.complaints)
    assert len(found.remarks) == bool(remark) and remark in "".join(found.remarks)


def test_a_small_frame_that_is_clipped_is_no_copy(tmp_path):
    """White is then the one code that many pixels have."""
    sensor = files.other_sensor(bits=14, white_level=16383)
    (tmp_path / "s.json").write_text(sensor.to_json())
    values = np.random.default_rng(7).uniform(100, 16000, files.SHAPE)
    values[:2] = sensor.white_level
    np.save(tmp_path / "a.npy", np.rint(values).astype(np.uint16))
    line = "{file: a.npy, kind: flat, scene: unknown, illuminant: A}"
    path = files.manifest(tmp_path, [line], "sensor: s.json")
    _, sensor, frames, _ = read_frames(path)
    [found] = check(frames, sensor).integrities
    assert found.clipped == pytest.approx(2 / 48) and found.complaints == ()


@pytest.mark.parametrize(
    ("sigma", "remarks"), [(3.0, []), (0.6, []), (0.3, ["its read noise is below 1.6"])]
)
def test_codes_in_the_steps_of_the_profile_are_its_own(tmp_path, sigma, remarks):
    effect = {"name": "quantisation", "parameters": {"step": 4 / (1023 - 64)}}
    (tmp_path / "s.json").write_text(files.other_sensor(effects=[effect]).to_json())
    values = 4 * np.rint(np.random.default_rng(7).normal(16.1, sigma, files.SHAPE))
    np.save(tmp_path / "a.npy", values.astype(np.uint16))
    lines = ["{file: a.npy, kind: dark}"]
    _, sensor, frames, _ = read_frames(
        files.manifest(tmp_path, lines, "sensor: s.json")
    )
    [found] = check(frames, sensor).integrities
    assert (found.step, found.complaints) == (4, ())
    assert len(found.remarks) == len(remarks)
    assert all(map(str.startswith, found.remarks, remarks))


@pytest.mark.parametrize(
    ("black", "words"),
    [
        (64, []),
        (9, []),  # 0.13 % at 0
        (1, ["more than 1% of the pixels are 0"]),
        (-2, ["more than 1% of the pixels are 0", "most pixels are 0: its read noi"]),
    ],
)
def test_blacks_that_are_cut_off(tmp_path, black, words):
    values = np.random.default_rng(8).normal(black, 3, files.SHAPE)
    found = dark(tmp_path, values)
    assert len(found.remarks) == len(words)
    for text, word in zip(found.remarks, words, strict=True):
        assert word in text


def test_an_eight_bit_copy(tmp_path):
    raw = files.frame(tmp_path, "a.npy", files.picture())
    line = "{file: a.npy, kind: flat, scene: unknown, illuminant: A}"
    assert files.checked(tmp_path, [line]).integrities[0].complaints == ()
    np.save(tmp_path / "a.npy", np.minimum(raw, 255))
    [words] = files.checked(tmp_path, [line]).integrities[0].complaints
    assert words.startswith("nothing is above 255 DN, where pixels pile up, and white")
