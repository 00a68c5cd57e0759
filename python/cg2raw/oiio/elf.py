# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What an ELF shared library says of itself, without loading it."""

import os
import struct
from dataclasses import dataclass

# e_machine. Source: System V ABI and its processor supplements.
MACHINES = {3: "i386", 40: "arm", 62: "x86_64", 183: "aarch64", 243: "riscv64"}
SHT_DYNSYM = 11


@dataclass(frozen=True)
class Library:
    """One shared library: its machine, and the value of the int that was asked for."""

    machine: str
    value: int | None  # None: it exports no such int


def read_library(path: str | os.PathLike[str], symbol: str) -> Library:
    """Return the Library at @path with the value of its exported int @symbol.

    Raises ValueError if it is no 64-bit little-endian ELF file, OSError if unreadable.
    """
    with open(path, "rb") as file:
        data = file.read()
    if data[:4] != b"\x7fELF":
        raise ValueError("is not a shared library")
    if data[4:6] != b"\x02\x01":
        raise ValueError("is not a 64-bit little-endian shared library")
    try:
        (machine,) = struct.unpack_from("<H", data, 18)
        return Library(
            MACHINES.get(machine, f"machine {machine}"), int_of(data, symbol)
        )
    except (struct.error, IndexError, ValueError) as error:
        raise ValueError("is damaged: its ELF tables point outside the file") from error


def int_of(data: bytes, symbol: str) -> int | None:
    """Return the value of the exported int @symbol, or None."""
    sections = section_headers(data)
    for kind, _, offset, size, link in sections:
        if kind != SHT_DYNSYM:
            continue
        strings = sections[link][2]
        for at in range(offset, offset + size, 24):
            name, _, _, home, value, length = struct.unpack_from("<IBBHQQ", data, at)
            if length == 4 and home and text_at(data, strings + name) == symbol:
                _, address, start, _, _ = sections[home]
                (found,) = struct.unpack_from("<i", data, start + value - address)
                return int(found)
    return None


def section_headers(data: bytes) -> list[tuple[int, int, int, int, int]]:
    """Return (type, address, offset, size, link) of each section."""
    (start,) = struct.unpack_from("<Q", data, 40)
    size, count = struct.unpack_from("<HH", data, 58)
    headers = [
        struct.unpack_from("<IIQQQQI", data, start + size * index)
        for index in range(count)
    ]
    return [
        (kind, address, offset, length, link)
        for _, kind, _, address, offset, length, link in headers
    ]


def text_at(data: bytes, start: int) -> str:
    """Return the zero-terminated text at @start."""
    return data[start : data.index(b"\0", start)].decode("ascii", "replace")
