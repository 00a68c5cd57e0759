# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Sensors to write DNGs of, and other people's programs to read them with."""

import json
import subprocess
from pathlib import Path

import numpy as np
import tifffile

import cg2raw

PROFILES = Path(__file__).resolve().parents[2] / "plugins" / "profiles"


def fields_of(profile="nikon-d40"):
    """Return the fields of a bundled profile."""
    return json.loads((PROFILES / f"{profile}.json").read_text())


def sensor(profile="nikon-d40", **changes):
    """Return a bundled sensor with fields of its profile changed; None drops one."""
    fields = {**fields_of(profile), **changes}
    fields = {name: value for name, value in fields.items() if value is not None}
    return cg2raw.Sensor.from_json(json.dumps(fields), "test.json")


def write(path, sensor, mosaic=None, shape=(64, 96), illuminant="A", **options):
    """Write a DNG of sensor and return its DN; mosaic replaces the simulated ones.

    options : those of Sensor.simulate and of write_dng."""
    names = {"compression", "preview", "matrices", "tone_curve"}
    shape = shape if mosaic is None else mosaic.shape
    run = {name: value for name, value in options.items() if name not in names}
    grey = np.full((*shape, 3), 0.3, np.float32)
    raw = sensor.simulate(grey, illuminant=illuminant, **run)
    if mosaic is not None:
        raw[:] = mosaic
    writing = {name: value for name, value in options.items() if name in names}
    cg2raw.write_dng(path, raw, **writing)
    return np.asarray(raw)


def random_mosaic(sensor, shape, seed=1):
    """Return (H, W) uint16 DN anywhere from 0 to white."""
    return np.random.default_rng(seed).integers(
        0, sensor.white_level + 1, shape, dtype=np.uint16
    )


def raw_page(tiff):
    """Return the page of an open TiffFile that holds the mosaic."""
    first = tiff.pages[0]
    return first.pages[0] if first.pages else first


def tags_of(path):
    """Return {name: value} of IFD0, the mosaic and Exif, as tifffile has them."""
    with tifffile.TiffFile(path) as tiff:
        first = {tag.name: tag.value for tag in tiff.pages[0].tags}
        mosaic = {tag.name: tag.value for tag in raw_page(tiff).tags}
    return first, mosaic, first.get("ExifTag", {})


def run(*command, **keywords):
    """Run a program and return what it printed; fails with its words if it fails."""
    done = subprocess.run(list(map(str, command)), capture_output=True, **keywords)
    assert done.returncode == 0, (done.stdout + done.stderr).decode(errors="replace")
    return done


def dcraw(path, out, *options):
    """Return dcraw's picture of a DNG, and what it said. out : a TIFF to write."""
    done = run("dcraw", *options, "-T", "-c", path)
    Path(out).write_bytes(done.stdout)
    return tifffile.imread(out), done.stderr.decode()
