# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What docs/portability.md says of sizes: the least, and what a DNG shows."""

import json
from pathlib import Path

import numpy as np
import pytest
import tifffile

import cg2raw
from dng import dng_files

ROOT = Path(__file__).parents[2]
PAGE = " ".join((ROOT / "docs/portability.md").read_text().split())
LEAST = {"BGGR": ("Bayer", 2), "X-Trans": ("X-Trans", 6), "mono": ("monochrome", 2)}


def sensor_of(cfa):
    """Return a sensor of a CFA."""
    if cfa == "X-Trans":
        return cg2raw.Sensor("fujifilm-x-m1")
    fields = {**dng_files.fields_of("nikon-d40"), "cfa": cfa}
    if cfa == "mono":
        fields["black_level"] = 0
        for name in ("color_matrix", "forward_matrix", "calibration_illuminant"):
            for number in "12":
                fields.pop(f"{name}_{number}", None)
        fields.pop("illuminants", None)
    return cg2raw.Sensor.from_json(json.dumps(fields))


@pytest.mark.parametrize("cfa", LEAST)
def test_the_least_size_is_that_of_the_page(tmp_path, cfa):
    kind, least = LEAST[cfa]
    assert f"{kind} {least}x{least}" in PAGE
    sensor = sensor_of(cfa)
    light = {} if cfa == "mono" else {"illuminant": "D65"}
    path = tmp_path / "least.dng"
    raw = sensor.simulate(np.ones((least, least, 3), np.float32), **light)
    cg2raw.write_dng(path, raw)
    with tifffile.TiffFile(path) as file:
        assert file.pages
    raw = sensor.simulate(np.ones((least, least - 1, 3), np.float32), **light)
    with pytest.raises(ValueError, match="width is .*, but must be"):
        cg2raw.write_dng(tmp_path / "less.dng", raw)


@pytest.mark.parametrize(
    ("shape", "shown"), [((480, 640), (636, 476)), ((15, 640), (640, 15))]
)
def test_the_crop_is_that_of_the_page(tmp_path, shape, shown):
    assert "636x476 of 640x480" in PAGE and "below 16 pixels are not cropped" in PAGE
    path = tmp_path / "shot.dng"
    raw = cg2raw.Sensor("nikon-d40").simulate(
        np.full((*shape, 3), 0.2, np.float32), illuminant="D65"
    )
    cg2raw.write_dng(path, raw, preview=False)
    with tifffile.TiffFile(path) as file:
        value = file.pages[0].tags["DefaultCropSize"].value
    assert (value[0], value[2]) == shown
