# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the reader says of real DNGs, against what exiftool says of them."""

import json
import re
import subprocess

import numpy as np
import pytest

import cg2raw
from python.counted_reads import bytes_read

MOSAICS = (
    "Hero6_GOPR0024.dng",
    "Fusion_GPFR7066.dng",
    "bmpcc_twelvemonkeys.dng",
    "canon550d_colorchart_tinydng.dng",
    "meta_only/canon350d_header_exiftool.dng",
)
REFUSED = {
    "oiio_testsuite_bayer_r5.dng": r"ColorMatrix1 \(50721\) is missing",
    "canon6d_lossy_linear_photoprism.dng": r"LinearRaw \(34892\), .*--cfa RGGB",
    "meta_only/iphone12pro_proraw_header_exiv2.dng": r"LinearRaw \(34892\)",
    "nikon_d1_imagemeta.nef": r"DNGVersion \(50706\) is missing: the file is no DNG",
    "meta_only/CanonRaw.cr2": r"DNGVersion \(50706\) is missing: the file is no DNG",
}
# exiftool prints ten significant digits.
PRINTED = 1e-9


class Tags:
    """exiftool's numbers of one file, by group and name."""

    def __init__(self, exiftool, path):
        done = subprocess.run(
            [exiftool, "-j", "-n", "-G1", "-a", path],
            capture_output=True,
            text=True,
            check=True,
        )
        self.tags = json.loads(done.stdout)[0]
        self.raw = next(
            group
            for group in ("IFD0", "SubIFD", "SubIFD1", "SubIFD2")
            if self.numbers("PhotometricInterpretation", group) == [32803]
        )

    def numbers(self, name, group="IFD0", default=None):
        """Return a tag's numbers as a list, or @default if it is absent."""
        value = self.tags.get(f"{group}:{name}")
        if value is None:
            return default
        return [float(word) for word in str(value).split()]

    def text(self, name, group="IFD0"):
        """Return a tag's text without outer blanks; empty if there is none."""
        return str(self.tags.get(f"{group}:{name}", "")).strip()

    def in_raw(self, name, default=None):
        """Return numbers of the directory that holds the mosaic."""
        return self.numbers(name, self.raw, default)


@pytest.fixture(scope="module", params=MOSAICS)
def pair(request, camera_data, program):
    """Return what cg2raw and what exiftool say of one real DNG."""
    path = camera_data / "real" / request.param
    if not path.exists():
        pytest.skip(f"no {path}")
    return cg2raw.read_dng_metadata(str(path)), Tags(program("exiftool"), path)


def test_names_are_exiftools(pair):
    metadata, tags = pair
    assert metadata.make == tags.text("Make")
    assert metadata.model == tags.text("Model")
    assert metadata.unique_camera_model == tags.text("UniqueCameraModel")


def test_geometry_is_exiftools(pair):
    metadata, tags = pair
    whole = [0, 0, *tags.in_raw("ImageHeight"), *tags.in_raw("ImageWidth")]
    top, left, bottom, right = tags.in_raw("ActiveArea", whole)
    assert list(metadata.active_area) == [right - left, bottom - top]
    assert metadata.cfa == "".join("RGB"[int(c)] for c in tags.in_raw("CFAPattern2"))


def test_levels_are_exiftools(pair):
    metadata, tags = pair
    assert tags.in_raw("BlackLevelRepeatDim", [1, 1]) in ([1, 1], [2, 2])
    black = np.broadcast_to(tags.in_raw("BlackLevel"), 4)
    np.testing.assert_allclose(metadata.black_level, black, rtol=PRINTED)
    assert [metadata.white_level] == tags.in_raw("WhiteLevel")
    assert 2 ** (metadata.bits - 1) <= metadata.white_level < 2**metadata.bits


def test_matrices_are_exiftools_with_calibration_folded_in(pair):
    metadata, tags = pair
    balance = np.diag(tags.numbers("AnalogBalance", default=[1, 1, 1]))
    count = 0
    for calibration, number in zip(metadata.calibrations, "12", strict=False):
        expected = np.reshape(tags.numbers(f"ColorMatrix{number}"), (3, 3))
        single = tags.numbers(f"CameraCalibration{number}")
        signature = tags.text("CameraCalibrationSig")
        if single and signature == tags.text("ProfileCalibrationSig"):
            expected = np.reshape(single, (3, 3)) @ expected
        np.testing.assert_allclose(
            calibration["camera_from_xyz"], balance @ expected, rtol=PRINTED, atol=1e-12
        )
        assert [calibration["light_source"]] == tags.numbers(
            f"CalibrationIlluminant{number}", default=[21]
        )
        assert calibration["xyz_d50_from_camera"] is None  # none of these files has one
        count += 1
    assert count == (2 if tags.numbers("ColorMatrix2") else 1)


def test_neutral_and_noise_are_exiftools(pair):
    metadata, tags = pair
    neutral = np.array(tags.numbers("AsShotNeutral"))
    neutral /= neutral[1]
    np.testing.assert_allclose(metadata.as_shot_neutral, neutral, rtol=PRINTED)
    noise = np.reshape(tags.numbers("NoiseProfile", default=[]), (-1, 2))
    expected = np.broadcast_to(noise, (3, 2)) if len(noise) else np.empty((0, 2))
    np.testing.assert_allclose(
        np.reshape(metadata.noise_profile, (-1, 2)), expected, rtol=PRINTED
    )


def test_exif_is_exiftools(pair):
    metadata, tags = pair
    for field, name in (
        ("exposure_time", "ExposureTime"),
        ("f_number", "FNumber"),
        ("focal_length", "FocalLength"),
        ("iso", "ISO"),
    ):
        (expected,) = tags.numbers(name, "ExifIFD", default=[0.0])
        # Exif says 0 for unknown.
        known = pytest.approx(expected, rel=PRINTED) if expected else None
        assert metadata.shot[field] == known, field
    date = tags.text("DateTimeOriginal", "ExifIFD")
    assert metadata.shot["date_time_original"] == date
    assert [metadata.shot["orientation"]] == tags.numbers("Orientation", default=[1])


def test_the_place_in_a_shot_is_exiftools(pair):
    """Of these, the Blackmagic's is a frame of a shot; exiftool -n shows the digits of
    frames, seconds, minutes and hours."""
    metadata, tags = pair
    (rate,) = tags.numbers("FrameRate", default=[None])
    assert metadata.shot["frame_rate"] == (rate and f"{rate:g}")
    digits = re.findall(r"\d\d", tags.text("TimeCodes"))
    code = ":".join(digits[3::-1]) or None
    assert metadata.shot["time_code"] == code
    assert metadata.shot["reel_name"] == tags.text("ReelName")
    assert metadata.shot["camera_label"] == tags.text("CameraLabel")
    if "blackmagic" in metadata.unique_camera_model.lower():
        assert (rate, code) == (30.0, "02:16:10:01")


@pytest.mark.parametrize(("name", "message"), REFUSED.items(), ids=list(REFUSED))
def test_refuses_with_the_reason(name, message, camera_data):
    path = camera_data / "real" / name
    if not path.exists():
        pytest.skip(f"no {path}")
    with pytest.raises(ValueError, match="^" + re.escape(str(path)) + ": .*" + message):
        cg2raw.read_dng_metadata(str(path))


def test_reads_little_of_a_large_file(camera_data):
    path = camera_data / "real" / "Hero6_GOPR0024.dng"
    if not path.exists():
        pytest.skip(f"no {path}")
    before = bytes_read()
    cg2raw.read_dng_metadata(str(path))
    assert path.stat().st_size > 20e6
    assert bytes_read() - before < 1e6
