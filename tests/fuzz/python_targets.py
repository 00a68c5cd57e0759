# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is fuzzed in Python: bytes of strangers through a reader, and what it accepts.

Each target is made of a folder for it alone, and called with bytes; it returns whether
they were accepted. What is neither accepted nor refused as `check` has it is a finding.
"""

import hashlib
import json
import os
from pathlib import Path

import numpy as np

import cg2raw
from cg2raw.dataset import job, journal, manifest, options
from cg2raw.diagnose.captures.reader import read_captures
from dataset import data_sets

LONGEST = 2000  # bytes of a message
TABLE = b"\n%%\n"  # between captures.yaml and a table of patch means


class Finding(AssertionError):
    """What no input may bring about."""


def check(error, start=""):
    """Raise Finding unless an error of a reader is one of ours, of one line."""
    message = str(error)
    if isinstance(error, UnicodeError) or not message.startswith(start):
        raise Finding(f"no message of ours: {error!r}") from error
    if len(message.splitlines()) != 1 or len(message.encode()) > LONGEST:
        raise Finding(f"no line of a message: {error!r}") from error


def accepted(read, start=""):
    """Return whether read() does not raise what a reader may."""
    try:
        read()
    except ValueError as error:
        check(error, start)
        return False
    except OSError as error:
        check(error)
        return False
    return True


class Captures:
    """captures.yaml, and after a line %% the table means.csv that it may name."""

    SHAPE = (16, 24)
    MEANS = (
        "patch,R,G1,G2,B,count\nwhite,9000,9500,9400,7000,100\nblack,700,710,,650,9\n"
    )

    def __init__(self, folder):
        self.folder = Path(folder)
        self.path = self.folder / "captures.yaml"
        rng = np.random.default_rng(1)
        for name in ("dark", "flat", "shot", "other"):
            plane = rng.integers(600, 4000, self.SHAPE).astype(np.uint16)
            np.save(self.folder / f"{name}.npy", plane)
        np.save(self.folder / "render.npy", np.full((*self.SHAPE, 3), 0.4, np.float32))
        np.save(self.folder / "mask.npy", np.ones(self.SHAPE, np.uint8))
        (self.folder / "folder").mkdir()
        os.mkfifo(self.folder / "pipe")

    def __call__(self, data):
        text, _, table = data.partition(TABLE)
        self.path.write_bytes(text)
        (self.folder / "means.csv").write_bytes(table or self.MEANS.encode())
        return accepted(self.read, str(self.folder))

    def read(self):
        captures = read_captures(self.path)
        for capture in captures.captures[:12]:
            for pixels in (capture.raw, capture.scene, capture.mask):
                if pixels and capture.means is None:
                    pixels()


class Journal:
    """An image's journal, as a run that goes on with a data set finds it.

    A line "+{JSON}" is the next of the true lines with fields of its own, "-NAME" that
    line without a field; "=BYTES" is a line as it is, "~BYTES" one without its end. Of
    all others the checksum is right, so that what they say is looked at."""

    def __init__(self, folder):
        self.out = Path(folder) / "out"
        pixels = np.full((6, 8, 3), 0.3, np.float32)
        image = data_sets.write_image(Path(folder) / "a.exr", pixels)
        plan = plan_of()
        self.out.mkdir()
        text = plan.to_json().encode()
        (self.out / "dataset.json").write_bytes(text)
        digest = hashlib.sha256(text).hexdigest()
        self.job = job.Job(str(self.out), digest, image.name, str(image), 0)
        self.path = Path(journal.path_of(self.job.out, self.job.image))
        self.images = [(self.job.image, self.job.path)]
        self.files = job.make(self.job)["made"]
        self.true = self.path.read_bytes().splitlines(keepends=True)
        self.entries = [journal.parsed(line) for line in self.true]
        self.made = self.contents()

    def __call__(self, data):
        self.path.write_bytes(self.journal(data))
        accepted(lambda: list(journal.headers(self.job.out)))
        accepted(lambda: list(manifest.bad_images(self.job.out, self.images)))
        accepted(self.listed)
        kept = self.run()
        if self.run() != self.files:
            raise Finding("a run that went on left what the next does not keep")
        if self.contents() != self.made:
            raise Finding("a run that went on left other files")
        if not accepted(self.listed):
            raise Finding("a run that went on left no manifest")
        return kept == self.files

    def run(self):
        """Go on with the data set; return how many files were kept."""
        result = job.make(self.job)
        if result["reason"] or result["made"] + result["kept"] != self.files:
            raise Finding(f"a run that went on made {result}")
        return result["kept"]

    def journal(self, data):
        """Return the bytes of a journal."""
        entries = iter(self.entries * 2)
        return b"".join(self.line(line, entries) for line in data.split(b"\n"))

    def line(self, line, entries):
        kind, rest = line[:1], line[1:]
        if kind in (b"=", b"~"):
            return rest + (b"\n" if kind == b"=" else b"")
        if kind in (b"+", b"-") and (entry := next(entries, None)):
            line = json.dumps(changed(kind, rest, entry)).encode()
        return journal.checksum_of(line) + b" " + line + b"\n"

    def listed(self):
        manifest.write(self.job.out, self.images, self.files)
        manifest.remove(self.job.out)

    def contents(self):
        """Return {path: bytes} of the data set."""
        return {
            str(path.relative_to(self.out)): path.read_bytes()
            for path in sorted(self.out.rglob("*"))
            if path.is_file() and path.suffix in (".dng", ".npy")
        }


def plan_of():
    """Return the plan of three small files of an image."""
    files = {"format": "dng", "element_type": "float32", "compression": "ljpeg"}
    pictures = {"crop": None, "patches": 1, "layer": None, "frame_from": "name"}
    light = {"illuminants": ("D65", "sample:0", "A"), "digital_gains": (1.0,)}
    noise = {"isos": (None,), "noise": None, "exposure_time": None, "seed": 0}
    how = {"white_luminance": None, "convention": "dng", "method": "graphics2raw"}
    sensor = cg2raw.Sensor("nikon-d40")
    return options.make_plan(
        [sensor], print, **files, **pictures, **light, **noise, **how
    )


def changed(kind, rest, entry):
    """Return an entry of a journal with other fields, or without one."""
    if kind == b"-":
        return {name: entry[name] for name in entry if name.encode() != rest}
    try:
        fields = json.loads(rest)
    except (ValueError, RecursionError):
        return entry
    return entry | fields if isinstance(fields, dict) else fields


TARGETS = {"captures": Captures, "journal": Journal}
