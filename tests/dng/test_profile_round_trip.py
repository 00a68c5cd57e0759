# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""profile -> DNGs, one per neutral -> profile: the same, to what the tags can hold."""

import json
import re

import numpy as np
import pytest

import cg2raw
from cg2raw import _core
from dng import dng_files
from oracles import cameras
from oracles.lens import irregular_terms

REAL = (
    "Hero6_GOPR0024.dng",
    "Fusion_GPFR7066.dng",
    "bmpcc_twelvemonkeys.dng",
    "canon550d_colorchart_tinydng.dng",
    "meta_only/canon350d_header_exiftool.dng",
)
# Our files keep matrices at 1e-4, neutrals at 1e-6, black levels at 1e-4 DN.
MATRIX, NEUTRAL, BLACK = 0.5e-4, 0.5e-6, 0.5e-4
ROUNDING = 1e-12
SHADING = 1e-5
PLANTED = {
    "r2": -0.31,
    "r4": 0.12,
    "r6": -0.08,
    "tilt_x": 0.015,
    "tilt_y": -0.03,
    "tilt_x_r2": -0.02,
    "tilt_y_r2": 0.04,
}
LENS = {"name": "lens_shading", "parameters": PLANTED}

COLORS = {
    "name": "color_shading",
    "parameters": {
        "red_r2": -0.11, "red_r4": 0.04, "red_x": 0.02, "red_y": -0.03,
        "blue_r2": 0.07, "blue_r4": -0.05, "blue_x": -0.01, "blue_y": 0.04,
    },
}  # fmt: skip


def sensor_of(fields):
    """Return the sensor of a profile's fields."""
    return cg2raw.Sensor.from_json(json.dumps(fields), "test.json")


def write_all(folder, fields, shape):
    """Write one DNG per neutral and ISO of a profile; return their metadata."""
    sensor = sensor_of(fields)
    dark = np.zeros((*shape, 3), np.float32)
    neutrals = fields["illuminants"]["neutrals"]
    isos = [row["iso"] for row in fields.get("noise", [])] or [None]
    written = []
    for i in range(max(len(neutrals), len(isos))):
        red, blue = neutrals[i % len(neutrals)]
        iso = isos[i % len(isos)]
        light = f"neutral:{red!r}:{blue!r}"
        raw = sensor.simulate(dark, illuminant=light, iso=iso)
        path = folder / f"{i}.dng"
        cg2raw.write_dng(path, raw, compression="none", preview=False)
        written.append(_core.read_dng_metadata(str(path)))
    return written


def by_light(fields):
    """Return {light: (color matrix, forward matrix or None)} of a profile's fields."""
    return {
        fields[f"calibration_illuminant_{i}"]: (
            fields[f"color_matrix_{i}"],
            fields.get(f"forward_matrix_{i}"),
        )
        for i in (1, 2)
        if f"color_matrix_{i}" in fields
    }


def check_same(ours, theirs):
    """Fail unless two profiles' fields are the same to the precision of the tags."""
    for name in ("id", "make", "model", "cfa", "bits", "white_level"):
        assert ours[name] == theirs[name], name
    np.testing.assert_allclose(ours["black_level"], theirs["black_level"], atol=BLACK)
    first, second = by_light(ours), by_light(theirs)
    assert first.keys() == second.keys()
    for light, matrices in first.items():
        for one, other in zip(matrices, second[light], strict=True):
            assert (one is None) == (other is None)
            if one is not None:
                np.testing.assert_allclose(one, other, rtol=0, atol=MATRIX + ROUNDING)
    np.testing.assert_allclose(
        ours["illuminants"]["neutrals"],
        theirs["illuminants"]["neutrals"],
        rtol=0,
        atol=NEUTRAL + ROUNDING,
    )
    assert ours.get("noise") == theirs.get("noise")
    check_same_shading(ours.get("effects", []), theirs.get("effects", []))


def check_same_shading(ours, theirs):
    """Fail unless two lists of effects are the same lens shading, or none."""
    assert len(ours) == len(theirs)
    for one, other in zip(ours, theirs, strict=True):
        assert one["name"] == other["name"] == "lens_shading"
        assert one["parameters"] == pytest.approx(other["parameters"], abs=SHADING)


@pytest.mark.parametrize("name", REAL)
def test_a_real_camera_comes_back(name, camera_data, tmp_path):
    path = camera_data / "real" / name
    if not path.exists():
        pytest.skip(f"no {path}")
    profile, _ = _core.profile_from_dngs([_core.read_dng_metadata(str(path))])
    fields = json.loads(profile.to_json())
    written = write_all(tmp_path, fields, (profile.height, profile.width))
    again, _ = _core.profile_from_dngs(written)
    assert (again.width, again.height) == (profile.width, profile.height)
    check_same(json.loads(again.to_json()), fields)


@pytest.mark.parametrize("shape", [(60, 90), (90, 60), (61, 61)])
def test_all_neutrals_isos_and_shading_come_back(shape, tmp_path):
    rows = [
        {"iso": iso, "beta1": [b, c, c, d], "beta2": [b / 1e3, c / 1e3, c / 1e3, d / 9]}
        for iso, b, c, d in ((100, 1e-4, 1.1e-4, 1.3e-4), (1600, 2e-3, 1.9e-3, 2.2e-3))
    ]
    neutrals = [[0.41, 0.83], [0.523456, 0.612345], [0.7, 0.5], [0.45, 0.63]]
    fields = {
        **dng_files.fields_of("nikon-d40"),
        "id": "my-camera",
        "illuminants": {"neutrals": neutrals},
        "noise": rows,
        "effects": [LENS],
    }
    written = write_all(tmp_path, fields, shape)
    assert [len(file.gain_maps) for file in written] == [4] * len(neutrals)
    profile, notes = _core.profile_from_dngs(written, id="my-camera")
    again = json.loads(profile.to_json())
    check_same(again, fields)
    evidence = again["effects"][0]["evidence"]
    assert evidence["rms_residual"] < 1e-6
    assert evidence["rms_between_files"] == evidence["rms_between_sites"] == 0
    assert not [note for note in notes if "GainMaps of the" in note]


@pytest.mark.parametrize("listed", [[COLORS, LENS], [COLORS]])
@pytest.mark.parametrize("cfa", ["RGGB", "BGGR", cameras.X_TRANS])
def test_color_shading_comes_back(cfa, listed, tmp_path):
    fields = {
        **dng_files.fields_of("nikon-d40"),
        "id": "my-camera",
        "cfa": cfa,
        "black_level": 512,
        "illuminants": {"neutrals": [[0.41, 0.83], [0.7, 0.5]]},
        "effects": listed,
    }
    written = write_all(tmp_path, fields, (66, 96))
    assert {len(file.gain_maps) for file in written} == {len(cfa)}
    profile, notes = _core.profile_from_dngs(written, id="my-camera")
    again = json.loads(profile.to_json())["effects"]
    assert [one["name"] for one in again] == [one["name"] for one in listed]
    for one, other in zip(again, listed, strict=True):
        assert one["parameters"] == pytest.approx(other["parameters"], abs=SHADING)
    evidence = again[0]["evidence"]
    assert evidence["rms_residual"] < 1e-6 < 0.01 < evidence["rms_between_colors"]
    assert any("became the effect color_shading" in note for note in notes)
    assert not [note for note in notes if "not simulated" in note]


def test_evidence_and_notes_say_what_the_effect_leaves(camera_data):
    path = camera_data / "real" / "Hero6_GOPR0024.dng"
    if not path.exists():
        pytest.skip(f"no {path}")
    metadata = _core.read_dng_metadata(str(path))
    maps = np.array([one["gains"] for one in metadata.gain_maps], float)
    assert maps.shape == (4, 23, 23) and [m["sites"] for m in metadata.gain_maps] == [
        [0],
        [1],
        [2],
        [3],
    ]
    profile, notes = _core.profile_from_dngs([metadata])
    (effect,) = json.loads(profile.to_json())["effects"]
    # The same least squares by NumPy.
    shading = np.mean(1 / maps, 0).ravel()
    at = np.linspace(-0.5, 0.5, 23) * 2 / np.hypot(4000, 3000)
    u, v = (grid.ravel() for grid in np.meshgrid(at * 4000, at * 3000))
    square = u * u + v * v
    tilts = [u, v, u * square, v * square]
    irregular = irregular_terms(u, v)
    terms = [np.ones_like(u), square, square**2, square**3, *tilts]
    terms = np.stack([*terms, *irregular.values()], 1)
    found = np.linalg.lstsq(terms, shading, rcond=None)[0]
    expected = dict(zip([*PLANTED, *irregular], found[1:] / found[0], strict=True))
    assert effect["parameters"] == pytest.approx(expected, abs=1e-10)
    residual = terms @ found / shading - 1  # of the brightness at the same place
    evidence = effect["evidence"]
    assert evidence["rms_residual"] == pytest.approx(np.sqrt(np.mean(residual**2)))
    assert evidence["largest_residual"] == pytest.approx(abs(residual).max())
    colour = np.sqrt(np.mean((1 / maps / np.mean(1 / maps, 0) - 1) ** 2))
    assert evidence["rms_between_sites"] == pytest.approx(colour)
    corners = [0, 22, -23, -1]
    assert 0.004 < evidence["rms_residual"] < 0.005
    assert 0.025 < abs(residual[corners]).max() < 0.032
    (said,) = [note for note in notes if note.startswith("lens_shading leaves")]
    rms, most = (float(word) for word in re.findall(r"([0-9.]+) %", said))
    assert rms == pytest.approx(100 * evidence["rms_residual"], rel=0.01)
    assert most == pytest.approx(100 * evidence["largest_residual"], rel=0.01)
    assert any("became the effect lens_shading" in note for note in notes)


def test_files_of_two_cameras_are_one_error(camera_data):
    paths = [camera_data / "real" / name for name in REAL[:2]]
    for path in paths:
        if not path.exists():
            pytest.skip(f"no {path}")
    files = [_core.read_dng_metadata(str(path)) for path in paths]
    with pytest.raises(ValueError, match="the camera is not the same") as caught:
        _core.profile_from_dngs(files)
    for word in (*map(str, paths), "GoPro HERO6 Black", "GoPro FUSION"):
        assert word in str(caught.value)
