# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Sensors of real DNGs: what a reference file makes of `dng:reference`."""

import numpy as np
import pytest

import cg2raw

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
