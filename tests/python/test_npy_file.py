# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Damaged .npy and .npz files: a ValueError of one short line that names the file."""

import struct
import warnings
import zipfile

import numpy as np
import pytest

from cg2raw.io.npy_file import mapped
from cg2raw.io.raw_file import frames_in, open_raw
from python.commands import fails

LONGEST = 2000  # letters of a message


def npy(header, data=bytes(64), version=1):
    """Return the bytes of a .npy file with any text as its header."""
    text = header.encode("latin1")
    text += b" " * (-(len(text) + 11) % 64) + b"\n"
    start = b"\x93NUMPY" + bytes([version, 0]) + struct.pack("<H", len(text))
    return start + text + data


def of_shape(shape, kind="<f4"):
    return npy(f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}}}")


DAMAGED = {
    "a negative size": of_shape("(-1, 4)"),
    "two negative sizes": of_shape("(-2, -2)"),
    "more than memory has": of_shape("(1000000000, 1000000000, 3)"),
    "a size of 71 bits": of_shape(f"({2**70}, 4)"),
    "a truth as a size": of_shape("(True, 4)"),
    "a word as a size": of_shape("('x' * 9, 4)"),
    "objects": of_shape("(2, 2)", "|O"),
    "an unknown type": of_shape("(2, 2)", "<f99"),
    "a type of 20000 letters": of_shape("(2, 2)", "x" * 20000),
    "65 dimensions": of_shape("(" + "1," * 65 + ")"),
    "5000 dimensions": of_shape("(" + "1," * 5000 + ")"),
    "nested brackets": of_shape("(" * 200 + ")" * 200),
    "open brackets": npy("(" * 3000),
    "a header that goes on": npy("{'descr': 'f4' \\"),
    "a NUL": npy("\0"),
    "60 kB of spaces": npy("{" + " " * 60000 + "}"),
    "another version": npy("{}", version=9),
    "less than it says": of_shape("(200, 200)"),
    "nothing": b"",
    "a pickle": b"\x80\x04K\x01.",
    "a zip file": b"PK\3\4" + bytes(40),
}


@pytest.mark.parametrize("what", DAMAGED)
def test_a_damaged_npy_is_told_in_one_line(tmp_path, what):
    path = tmp_path / "frame.npy"
    path.write_bytes(DAMAGED[what])
    with warnings.catch_warnings(), pytest.raises(ValueError) as found:
        warnings.simplefilter("error")
        mapped(str(path))
    said = str(found.value)
    assert said.startswith(f"{path}: is no .npy file, or cut off: ")
    assert "\n" not in said and len(said) < LONGEST


def test_what_is_no_image_is_told(tmp_path):
    np.save(tmp_path / "row.npy", np.zeros(4))
    with pytest.raises(ValueError, match="row.npy: is no image: give one array"):
        mapped(str(tmp_path / "row.npy"))


def test_a_whole_file_is_read_where_it_lies(tmp_path):
    image = np.arange(24, dtype=np.uint16).reshape(4, 6)
    np.save(tmp_path / "frame.npy", image)
    array = mapped(str(tmp_path / "frame.npy"))
    assert isinstance(array, np.memmap) and (array == image).all()


@pytest.mark.parametrize("what", ["a zip file", "a negative size", "nothing"])
def test_a_damaged_npz_is_one_line_of_a_command(tmp_path, what):
    path = tmp_path / "frames.npz"
    path.write_bytes(DAMAGED[what])
    line = fails("calibrate", path, "--sensor", "nikon-d40")
    assert f"{path}: is no .npz file, or cut off: " in line


def test_the_arrays_of_an_npz_are_frames(tmp_path):
    path = str(tmp_path / "a.npz")
    dn = np.arange(12, dtype=np.uint16).reshape(3, 4)
    np.savez_compressed(path, b=dn, a=dn[:2] + 1, c=dn.astype(np.float32))
    first, second, third = frames_in(path)
    assert [f.header.name for f in (first, second, third)] == ["a", "b", "c"]
    assert first.header.shape == (2, 4)
    np.testing.assert_array_equal(second.mosaic(), dn)
    np.testing.assert_array_equal(open_raw(path, "a").mosaic(), dn[:2] + 1)
    with pytest.raises(ValueError, match="a.npz: c: .*uint16"):
        third.mosaic()
    with pytest.raises(ValueError, match="a.npz: has no array d; it has a, b, c"):
        frames_in(path, "d")


def test_an_array_of_an_npz_may_have_a_header_of_any_version(tmp_path):
    dn = np.arange(12, dtype=np.uint16).reshape(3, 4)
    path = str(tmp_path / "a.npz")
    with zipfile.ZipFile(path, "w") as stored:
        for version in (1, 2):
            with stored.open(f"v{version}.npy", "w") as member:
                np.lib.format.write_array(member, dn + version, (version, 0))
    for version, frame in zip((1, 2), frames_in(path), strict=True):
        assert (frame.header.name, frame.header.shape) == (f"v{version}", (3, 4))
        np.testing.assert_array_equal(frame.mosaic(), dn + version)


def test_an_npz_without_a_frame_is_refused(tmp_path):
    path = str(tmp_path / "a.npz")
    np.savez(path)
    with pytest.raises(ValueError, match="a.npz: holds no array"):
        frames_in(path)
    np.savez(path, a=np.zeros((2, 3, 4), np.uint16))
    with pytest.raises(ValueError, match=r"a.npz: a is \(2, 3, 4\); must be \(H, W\)"):
        frames_in(path)
