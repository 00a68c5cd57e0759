# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The images of a FITS file, and which of them is the frame.

Standard: FITS 4.0, IAU FITS Working Group, 2018: extensions have EXTNAME and EXTVER
(4.4.2.6), and may inherit keywords of the primary header (appendix K). SCI, ERR, DQ:
Space Telescope Science Institute, "HST Data Handbooks", section 2.2; VAR: Gemini
Observatory, DRAGONS.
"""

import os
import threading
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from cg2raw.system import check_readable

MISSING = "astropy, which reads FITS files, is missing: pip install 'cg2raw[fits]'"
PICTURE = "SCI"
OF_PICTURES = ("ERR", "DQ", "VAR", "MASK")  # errors and quality of another image

_warnings = threading.Lock()  # the process has one list of filters of warnings


class Cards:
    """Keywords of an image, and of the primary header what the image does not have."""

    def __init__(self, image: Any, primary: Any) -> None:
        own, first = image.header, primary.header
        inherits = image is not primary and own.get("INHERIT", True)
        self._headers = (own, first) if inherits else (own,)

    def __contains__(self, name: str) -> bool:
        return self.get(name) is not None

    def __getitem__(self, name: str) -> Any:
        return self.get(name)

    def get(self, name: str, default: Any = None) -> Any:
        """Return the value of a keyword, if it has one, else a default."""
        for header in self._headers:
            value = header.get(name)  # of a type of its own if it is undefined
            if isinstance(value, (bool, int, float)):
                return value
            if isinstance(value, str) and value.strip():
                return value
        return default

    def comment(self, name: str) -> str:
        """Return what a header says beside a value."""
        found = next((h for h in self._headers if name in h), None)
        return str(found.comments[name]) if found else ""


@contextmanager
def opened(path: str) -> Iterator[Any]:
    """Yield the HDUs of a file. Raises ValueError, OSError."""
    try:
        fits: Any = import_module("astropy.io.fits")
    except ImportError:
        raise ValueError(f"{path}: {MISSING}") from None
    check_readable(path)  # of a missing file, the error that all readers raise
    with _warnings, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # each that matters is an error here
        try:
            file = fits.open(path, memmap=False, lazy_load_hdus=False)
        except (ValueError, TypeError, KeyError, IndexError, EOFError, OSError) as why:
            text = " ".join(str(why).split())
            raise ValueError(f"{path}: is no FITS file, or cut off: {text}") from None
        with file:
            yield file


def chosen_images(path: str, file: Any, image: str | None) -> tuple[list[int], str]:
    """Return (numbers of the images that make the frame, what is said of the others).

    image : as of fits_file.frames. Raises ValueError if it is not clear."""
    known = {n: hdu for n, hdu in enumerate(file) if hdu.is_image and hdu.shape}
    if not known:
        raise ValueError(f"{path}: holds no image; give the file of one RAW frame")
    pictures = {n: h for n, h in known.items() if h.name.upper() not in OF_PICTURES}
    if image == "all":
        return list(pictures or known), ""
    if image is not None:
        return [numbered(path, known, image)], ""
    for numbers in (
        [n for n, hdu in pictures.items() if hdu.name.upper() == PICTURE],
        list(pictures or known),
    ):
        if len(numbers) == 1:
            others = [words_of(n, hdu) for n, hdu in known.items() if n != numbers[0]]
            chosen = words_of(numbers[0], known[numbers[0]])
            if not others:
                return numbers, ""
            return numbers, f"image {chosen} is used, not {', '.join(others)}"
    raise ValueError(unclear(path, known))


def numbered(path: str, known: Mapping[int, Any], image: str) -> int:
    """Return the number of the image that a word names. Raises ValueError."""
    name, _, version = image.strip().upper().partition(",")
    if name.isdecimal():
        found = [n for n in known if n == int(name)]
    else:
        found = [
            n
            for n, hdu in known.items()
            if hdu.name.upper() == name and version in ("", str(hdu.ver))
        ]
    if len(found) == 1:
        return found[0]
    raise ValueError(
        f"{path}: has {'several images' if found else 'no image'} {image}; it holds "
        + ", ".join(words_of(n, hdu) for n, hdu in known.items())
    )


def unclear(path: str, known: Mapping[int, Any]) -> str:
    """Return the message for a file of which several images may be the frame."""
    listed = ", ".join(words_of(n, hdu) for n, hdu in known.items())
    names = [name_of(n, hdu) for n, hdu in known.items()]
    word = names[-1] if names.count(names[-1]) == 1 else str(list(known)[-1])
    words = f"{path}: holds {len(known)} images: {listed}; choose one (--image {word})"
    if all(hdu.header.get("DETSEC") for hdu in known.values()):
        return (
            f"{words} and then the next, since amplifiers differ in gain; or all, put "
            "together by DETSEC, if they have one gain (--image all)"
        )
    return words


def words_of(number: int, hdu: Any) -> str:
    """Return "2 (SCI, 1024x512)" of an image."""
    size = "x".join(str(n) for n in reversed(hdu.shape))
    name = name_of(number, hdu)
    return f"{number} ({size})" if name == str(number) else f"{number} ({name}, {size})"


def name_of(number: int, hdu: Any) -> str:
    """Return the name of an image, its number if it has none."""
    name = str(hdu.name).strip()
    return name if name and name not in ("PRIMARY", "COMPRESSED_IMAGE") else f"{number}"


def check_length(path: str, image: Any) -> None:
    """Raise ValueError if a file ends before its image does."""
    place = image.fileinfo()
    if place is None or path.lower().endswith(".gz"):
        return
    missing = place["datLoc"] + image.size - os.path.getsize(path)
    if image.name != "COMPRESSED_IMAGE" and missing > 0:
        raise ValueError(
            f"{path}: is cut off: {missing} bytes of its image are missing; copy it "
            "again"
        )
