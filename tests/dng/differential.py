# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Our DNGs against other people's readers: random files of ours, equal words.

    python -m dng.differential --files 10000 [--seed N]      in tests; or
    scripts/fuzz 600 differential

A file is a pure function of seed and number. LIMITS says what a reader is known not to
take, and why; that is tried all the same, and counted."""

import argparse
import collections
import dataclasses
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import rawpy
import tifffile

import cg2raw
from dng import dng_files
from oracles import cameras

BAYER = ("RGGB", "GRBG", "GBRG", "BGGR")
LIGHT = "D65"
AT_ONCE = 200  # files that are there at a time, which dcraw reads in one call
MOST_PIXELS = 40000
SMALLEST_OF_OTHERS = 22  # side of what dcraw and LibRaw take for a RAW
SHOWN = 5  # differences that are told in full


@dataclasses.dataclass(frozen=True)
class Case:
    """What decides a file beside its pixels. levels : black and white, DN."""

    cfa: str
    shape: tuple[int, int]
    bits: int
    levels: tuple[int, int]
    compression: str
    preview: bool
    crop: str
    frame_rate: str | None
    pixels: str

    @property
    def kind(self):
        """The family of the CFA."""
        sites = {4: "Bayer" if self.cfa != "MONO" else "monochrome", 36: "X-Trans"}
        return sites.get(len(self.cfa), "4 x 4")

    @property
    def is_small(self):
        return min(self.shape) < SMALLEST_OF_OTHERS


def cfa_of(rng):
    """Return a CFA: Bayer, X-Trans in any phase, Quad Bayer, or none."""
    kind = rng.choice(["bayer", "x-trans", "quad", "mono"], p=[0.5, 0.2, 0.15, 0.15])
    if kind == "mono":
        return "MONO"
    if kind == "x-trans":
        letters = np.array(list(cameras.X_TRANS)).reshape(6, 6)
        return "".join(np.roll(letters, rng.integers(0, 6, 2), (0, 1)).ravel())
    bayer = BAYER[rng.integers(4)]
    if kind == "bayer":
        return bayer
    letters = np.array(list(bayer)).reshape(2, 2)
    return "".join(letters.repeat(2, 0).repeat(2, 1).ravel())


def shape_of(rng, least):
    """Return (height, width), a fifth of them small, some of several tiles."""
    low = least if rng.random() < 0.2 else SMALLEST_OF_OTHERS
    sides = [int(rng.integers(low, most)) for most in rng.choice([24, 80, 320], 2)]
    if rng.random() < 0.15:
        sides[rng.integers(2)] = int(rng.integers(500, 1600))
    height, width = sides
    return min(height, max(low, MOST_PIXELS // width)), width


def drawn(rng):
    """Return a Case."""
    cfa = cfa_of(rng)
    bits = int(rng.integers(8, 17))
    white = int(rng.integers(2 ** (bits - 1), 2**bits))
    side = {"MONO": 2}.get(cfa, int(len(cfa) ** 0.5))
    return Case(
        cfa=cfa,
        shape=shape_of(rng, side),
        bits=bits,
        levels=(int(rng.integers(0, white // 4)), white),
        compression=str(rng.choice(["none", "ljpeg"])),
        preview=bool(rng.integers(2)),
        crop=str(rng.choice(["border", "none"])),
        frame_rate=None if rng.random() < 0.8 else "24000/1001",
        pixels=str(rng.choice(["any", "extremes", "dark", "smooth", "constant"])),
    )


def mosaic_of(rng, case):
    """Return (H, W) uint16 DN up to white."""
    white = case.levels[1]
    rows, cols = np.indices(case.shape)
    mosaics = {
        "any": lambda: rng.integers(0, white + 1, case.shape),
        "extremes": lambda: rng.integers(0, 2, case.shape) * white,
        "dark": lambda: rng.geometric(0.2, case.shape),
        "smooth": lambda: rows * 7 + cols * 3 + rng.integers(0, 9, case.shape),
        "constant": lambda: np.full(case.shape, rng.integers(0, white + 1)),
    }
    return np.minimum(mosaics[case.pixels](), white).astype(np.uint16)


def sensor_of(case):
    black, white = case.levels
    fields = {"bits": case.bits, "black_level": black, "white_level": white}
    if case.cfa == "MONO":
        return cg2raw.Sensor.from_json(
            cameras.mono_text(**fields, noise=None), "m.json"
        )
    return dng_files.sensor(cfa=case.cfa, noise=None, **fields)


def write(folder, seed, number):
    """Write a file; return (path, Case, DN)."""
    rng = np.random.default_rng([seed, number])
    case = drawn(rng)
    mosaic = mosaic_of(rng, case)
    path = Path(folder) / f"{number}.dng"
    cg2raw.write_dng(
        path,
        mosaic,
        sensor=sensor_of(case),
        illuminant=None if case.cfa == "MONO" else LIGHT,
        compression=case.compression,
        preview=case.preview,
        crop=case.crop,
        shot={"frame_rate": case.frame_rate} if case.frame_rate else None,
        threads=1,
        sync=False,
    )
    return path, case, mosaic


def libraw(path):
    with rawpy.imread(str(path)) as raw:
        return raw.raw_image.copy()


def dcraw(path):
    """Return what run_dcraw() left."""
    return tifffile.imread(path.with_suffix(".tiff"))


def run_dcraw(paths):
    """Write a .tiff of the DN of each DNG beside it."""
    command = ["dcraw", "-D", "-4", "-T", *map(str, paths)]
    subprocess.run(command, check=False, capture_output=True)


def with_tifffile(path):
    with tifffile.TiffFile(path) as tiff:
        return dng_files.raw_page(tiff).asarray()


def ours(path):
    """Return what our reader reads, by way of the wheel's OpenImageIO."""
    file = oiio.ImageInput.open(str(path))
    if file is None:
        raise OSError(oiio.geterror())
    try:
        if file.format_name() != "dng":
            raise OSError(f"{file.format_name()} reads it, not our plugin")
        words = file.read_image(oiio.UINT16)
        if words is None:
            raise OSError(file.geterror())
        return words[..., 0]
    finally:
        file.close()


READERS = {"LibRaw": libraw, "dcraw": dcraw, "tifffile": with_tifffile, "ours": ours}
SMALL = f"takes no picture with a side below {SMALLEST_OF_OTHERS} pixels for a RAW"
NO_BAYER = (
    "takes a CFA of 4 x 4 for a Bayer one whose second greens it moves to the first "
    "(its pre_interpolate(), also in document mode)"
)
# (reader, whether it is known not to take a case, why)
LIMITS = (
    ("LibRaw", lambda case: case.is_small, SMALL),
    ("dcraw", lambda case: case.is_small, SMALL),
    ("dcraw", lambda case: case.kind == "4 x 4", NO_BAYER),
)


def limit_of(reader, case):
    """Return why a reader does not take a case; None if it does."""
    return next(
        (why for name, holds, why in LIMITS if name == reader and holds(case)), None
    )


def difference(reader, path, mosaic):
    """Return how the words of a reader differ; None if they are equal."""
    try:
        words = READERS[reader](path)
    except Exception as error:  # of anyone's code
        return f"{type(error).__name__}: {error}"
    if words.shape != mosaic.shape:
        return f"{words.shape} words, not {mosaic.shape}"
    count = np.count_nonzero(words != mosaic)
    return f"{count} of {mosaic.size} words differ" if count else None


@dataclasses.dataclass
class Result:
    """Counts of (reader, kind of CFA, word), and sentences on what differs."""

    counts: collections.Counter = dataclasses.field(default_factory=collections.Counter)
    differences: list[str] = dataclasses.field(default_factory=list)
    files: int = 0

    def add(self, seed, path, case, mosaic):
        self.files += 1
        for reader in READERS:
            found = difference(reader, path, mosaic)
            limit = limit_of(reader, case)
            word = "equal" if found is None else "limit" if limit else "differs"
            self.counts[reader, case.kind, word] += 1
            if word == "differs":
                where = f"file {path.stem} of seed {seed}, {case}"
                self.differences.append(f"{reader}: {found}: {where}")

    def table(self):
        """Return lines of a table, and of what is known."""
        yield f"{self.files} files"
        for reader in READERS:
            words = collections.Counter()
            for (name, kind, word), count in sorted(self.counts.items()):
                if name == reader:
                    words[word] += count
                    words[f"{word} {kind}"] += count
            kinds = [f"{n} {w[6:]}" for w, n in words.items() if w.startswith("equal ")]
            line = f"{reader}: equal words {words['equal']} ({', '.join(kinds)})"
            yield f"{line}, known limits {words['limit']}, differs {words['differs']}"
        yield from (f"known limit of {reader}: {why}" for reader, _, why in LIMITS)


def compare(files, seed=0, seconds=None):
    """Return the Result of so many files, or of those that there is time for."""
    cg2raw.register_oiio_plugin()
    result = Result()
    end = None if seconds is None else time.monotonic() + seconds
    memory = "/dev/shm" if os.path.isdir("/dev/shm") else None
    for first in range(0, files, AT_ONCE):
        if end is not None and time.monotonic() > end:
            break
        with tempfile.TemporaryDirectory(dir=memory) as folder:
            numbers = range(first, min(files, first + AT_ONCE))
            written = [write(folder, seed, number) for number in numbers]
            run_dcraw([path for path, *_ in written])
            for path, case, mosaic in written:
                result.add(seed, path, case, mosaic)
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--files", type=int, default=10000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, help="stop after about so many")
    arguments = parser.parse_args()
    result = compare(arguments.files, arguments.seed, arguments.seconds)
    print("\n".join(result.table()))
    for line in result.differences[:SHOWN]:
        print(line)
    sys.exit(1 if result.differences else 0)


if __name__ == "__main__":
    main()
