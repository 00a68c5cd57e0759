# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Sensors of real DNGs: what a reference file makes of `dng:reference`."""

import json

import numpy as np
import pytest
import rawpy

import cg2raw
from cg2raw import _core
from core.facts import DIALECT, facts
from dng import dng_files
from oracles import cameras

IDS = {
    "Hero6_GOPR0024.dng": "gopro-hero6-black",
    "Fusion_GPFR7066.dng": "gopro-fusion",
    "bmpcc_twelvemonkeys.dng": "blackmagic-pocket-cinema-camera",
    "canon550d_colorchart_tinydng.dng": "canon-eos-kiss-x4",
    "meta_only/canon350d_header_exiftool.dng": "canon-eos-350d",
}


@pytest.fixture(params=IDS)
def reference(request, camera_data):
    """Return the path of one real DNG and the id that its sensor must get."""
    path = camera_data / "real" / request.param
    if not path.exists():
        pytest.skip(f"no {path}")
    return str(path), IDS[request.param]


def test_the_sensor_is_the_files(reference):
    path, sensor_id = reference
    sensor, metadata = cg2raw.Sensor.from_dng(path), cg2raw.read_dng_metadata(path)
    assert sensor.id == sensor_id
    as_shot = sensor.illuminant("as-shot", as_shot=metadata.as_shot_neutral)
    np.testing.assert_allclose(as_shot.neutral, metadata.as_shot_neutral, atol=1e-6)


def test_a_photograph_s_raw_data_are_changed_and_written(reference, tmp_path):
    """As docs/python.md does it: what rawpy's issues 43, 95 and 245 ask for."""
    path, _ = reference
    sensor, said = cg2raw.Sensor.from_dng(path), cg2raw.read_dng_metadata(path)
    try:
        with rawpy.imread(path) as photograph:
            words = photograph.raw_image_visible.copy()
    except rawpy.LibRawError as error:
        pytest.skip(f"{path} has no pixels: {error}")
    words[10:20] //= 2
    words = np.minimum(words, sensor.white_level)
    light = sensor.illuminant("as-shot", as_shot=said.as_shot_neutral)
    shot, out = said.shot, tmp_path / "changed.dng"
    shot["pixel_aspect"] = shot["pixel_aspect"] or 1.0  # which a file may leave unsaid
    iso = shot.pop("iso")
    run = {"sensor": sensor, "illuminant": light}
    run["iso"] = iso if said.noise_profile else None
    cg2raw.write_dng(out, words, **run, shot=shot)
    with rawpy.imread(str(out)) as changed:
        np.testing.assert_array_equal(changed.raw_image, words)
    again = cg2raw.read_dng_metadata(str(out))
    assert (again.make, again.model) == (sensor.make, sensor.model)
    np.testing.assert_allclose(again.as_shot_neutral, said.as_shot_neutral, atol=1e-5)
    for name, value in shot.items():
        expected = pytest.approx(value) if isinstance(value, float) else value
        assert again.shot[name] == expected, name


SITES = [500 + 3 * site for site in range(36)]
SHIFTED = cameras.X_TRANS[13:] + cameras.X_TRANS[:13]  # rows and columns out of phase


@pytest.mark.parametrize("cfa", ["GBRG", cameras.QUAD, cameras.X_TRANS, SHIFTED])
@pytest.mark.parametrize("by_site", [False, True])
def test_a_written_file_gives_its_sensor_back(cfa, by_site, tmp_path):
    noise = [{"iso": 100, "beta1": [2e-4, 1e-4, 3e-4], "beta2": [1e-6, 2e-6, 3e-6]}]
    black = SITES[: len(cfa)] if by_site else 512.25
    sensor = dng_files.sensor(cfa=cfa, black_level=black, noise=noise)
    path = tmp_path / "shot.dng"
    dng_files.write(path, sensor, shape=(61, 47), iso=100)
    metadata, again = cg2raw.read_dng_metadata(str(path)), cg2raw.Sensor.from_dng(path)
    assert metadata.cfa == again.cfa == sensor.cfa
    assert list(metadata.black_level) == list(sensor.black_level)
    ours, theirs = (json.loads(s.to_json()) for s in (sensor, again))
    for field in ("cfa", "black_level", "white_level", "color_matrix_1"):
        assert ours[field] == theirs[field], field
    for field in ("beta1", "beta2"):
        np.testing.assert_allclose(
            theirs["noise"][0][field], ours["noise"][0][field], rtol=1e-12
        )


def test_measurements_of_another_cfa_do_not_fit(tmp_path):
    """Of one model by name, but its noise is of 4 sites and the mosaic of 36."""
    path = tmp_path / "f.dng"
    model = dng_files.fields_of("nikon-d850")["model"]
    x_trans = dng_files.sensor("fujifilm-x-m1", model=model)
    dng_files.write(path, x_trans, shape=(60, 96))
    given = {"reference": str(path), "sensor": "nikon-d850", "illuminant": "D65"}
    options = _core.ExportOptions(given, DIALECT)
    with pytest.raises(ValueError, match=f"^{path}: .*36 values each"):
        _core.resolve(facts([("", "RGB")]), options, DIALECT)
