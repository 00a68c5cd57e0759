# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A shared library's number, read from the smallest ELF file that has one."""

import struct

import pytest

from cg2raw.oiio.elf import SHT_DYNSYM, Library, read_library

ADDRESS = 0x4000  # of the data, where the system would load it
NAMES = b"\0other\0version\0"
X86, ARM = 0x3E, 0xB7  # Source: ELF gABI, e_machine


def elf(value=27, machine=X86, length=4, home=3):
    """Return an ELF file of four sections: none, symbols, their names, data.

    The symbol "version" is 4 bytes into the data. Source: ELF-64 Object File Format."""
    data = struct.pack("<ii", -1, value)
    symbols = bytes(24)
    for name, at in ((1, 0), (7, 4)):
        symbols += struct.pack("<IBBHQQ", name, 0, 0, home, ADDRESS + at, length)
    parts = [symbols, NAMES, data]
    starts = [64 + sum(map(len, parts[:n])) for n in range(4)]
    kinds = [(SHT_DYNSYM, 0, 2), (3, 0, 0), (1, ADDRESS, 0)]
    headers = bytes(64)
    for (kind, address, link), start, part in zip(kinds, starts, parts, strict=False):
        headers += struct.pack(
            "<IIQQQQIIQQ", 0, kind, 0, address, start, len(part), link, 0, 1, 0
        )
    head = bytearray(64)
    head[:6] = b"\x7fELF\x02\x01"
    struct.pack_into("<H", head, 18, machine)
    struct.pack_into("<Q", head, 40, starts[3])
    struct.pack_into("<HH", head, 58, 64, 4)
    return bytes(head) + b"".join(parts) + headers


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (elf(), ("x86_64", 27)),
        (elf(-3, ARM), ("aarch64", -3)),
        (elf(machine=7), ("machine 7", 27)),
        (elf(length=8), ("x86_64", None)),  # no int
        (elf(home=0), ("x86_64", None)),  # another library's
    ],
)
def test_the_number_of_a_symbol(tmp_path, data, expected):
    (tmp_path / "a.so").write_bytes(data)
    assert read_library(tmp_path / "a.so", "version") == Library(*expected)
    assert read_library(tmp_path / "a.so", "number").value is None


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"MZ" + bytes(100), "is not a shared library"),
        (b"", "is not a shared library"),
        (elf().replace(b"ELF\x02", b"ELF\x01", 1), "is not a 64-bit little-endian"),
        (elf().replace(b"ELF\x02\x01", b"ELF\x02\x02", 1), "is not a 64-bit little-en"),
        (elf()[:-40], "is damaged: its ELF tables point outside the file"),
        (elf()[:60], "is damaged"),
    ],
)
def test_other_files_say_what_they_are_not(tmp_path, data, words):
    (tmp_path / "a.so").write_bytes(data)
    with pytest.raises(ValueError, match=words):
        read_library(tmp_path / "a.so", "version")
