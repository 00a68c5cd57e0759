# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Small images, data sets made of them, and what is compared of two data sets."""

import hashlib
import json
import os
import subprocess
import sys

import numpy as np
import OpenImageIO as oiio

COMMAND = [sys.executable, "-m", "cg2raw", "dataset"]
# 2 sensors x 2 lights x 2 gains: 8 files of each image.
OPTIONS = (
    "--sensors nikon-d40,samsung-s20fe --illuminants 2 --digital-gain 1,0.8".split()
)
FILES = 8
# Of a Plan, besides sensors.
FIELDS = {
    **{"illuminants": ("D65",), "digital_gains": (1.0,), "isos": (None,)},
    **{"noise": None, "exposure_time": None, "white_luminance": None},
    **{"convention": "dng", "method": "graphics2raw", "seed": 0},
    **{"format": "dng", "element_type": "float32", "compression": "ljpeg"},
    **{"crop": None, "patches": 1, "layer": None, "frame_from": "name"},
}
CENTRES = np.arange(400.0, 701.0, 20.0)  # nm, of spectral images


def scene(shape=(24, 36), seed=1):
    """Return a (H, W, 3) float32 image with highlights and negative values."""
    rgb = np.random.default_rng(seed).random((*shape, 3), dtype=np.float32)
    return rgb * 1.4 - 0.1


def write_image(path, pixels, kind="half", **attributes):
    """Write (H, W, C) pixels by OpenImageIO; return the path. a__b is attribute a:b."""
    path.parent.mkdir(parents=True, exist_ok=True)
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, kind)
    spec.attribute("DateTime", "2026:01:01 00:00:00")  # else now
    for name, value in attributes.items():
        spec.attribute(name.replace("__", ":"), value)
    file = oiio.ImageOutput.create(str(path))
    assert file.open(str(path), spec), file.geterror()
    assert file.write_image(pixels) and file.close(), file.geterror()
    return path


def write_deep(path, shape=(24, 36)):
    """Write a deep EXR of one sample in each pixel; return the path."""
    height, width = shape
    spec = oiio.ImageSpec(width, height, 5, "float")
    spec.channelnames = ("R", "G", "B", "A", "Z")
    spec.deep = True
    deep = oiio.DeepData()
    deep.init(
        width * height, 5, spec.channelformats or ["float"] * 5, spec.channelnames
    )
    for pixel in range(width * height):
        deep.set_samples(pixel, 1)
        for channel in range(5):
            deep.set_deep_value(pixel, channel, 0, 0.5)
    path.parent.mkdir(parents=True, exist_ok=True)
    file = oiio.ImageOutput.create(str(path))
    assert file.open(str(path), spec), file.geterror()
    assert file.write_deep_image(deep) and file.close(), file.geterror()
    return path


def write_spectra(path, seed=3, shape=(24, 32), **said):
    """Write an EXR of spectra, with attributes; return the path."""
    rng = np.random.default_rng(seed)
    spectra = rng.random((*shape, len(CENTRES)), dtype=np.float32)
    spec = oiio.ImageSpec(shape[1], shape[0], len(CENTRES), "float")
    spec.channelnames = tuple(f"S0.{nm:.0f}nm" for nm in CENTRES)
    for name, value in said.items():
        spec.attribute(name, value)
    file = oiio.ImageOutput.create(str(path))
    assert file.open(str(path), spec) and file.write_image(spectra) and file.close()
    return path


def folder_of_images(folder, count=4):
    """Write @count EXRs and a PNG, some in a folder of the folder; return it."""
    for number in range(count):
        name = f"{'shots/' if number % 2 else ''}{number}.exr"
        write_image(folder / name, scene(seed=number))
    write_image(folder / "photo.png", scene(seed=99), "uint8")
    return folder


def start(*arguments, **keywords):
    """Start the command as a process of its own."""
    words = [*COMMAND, *map(str, arguments)]
    pipe = subprocess.PIPE
    return subprocess.Popen(words, stdout=pipe, stderr=pipe, text=True, **keywords)


# What a process does that opens a file whose path ends so, and all that it runs.
HOOK = """
import os, sys, time

def look(event, words):
    if event == "open" and str(words[0]).endswith({ending!r}):
        {deed}

sys.addaudithook(look)
"""


def environment_where(folder, ending, deed):
    """Return variables by which Python does a deed when it opens certain files.

    folder : for a module. ending : of the files' paths. deed : a line of Python."""
    text = HOOK.format(ending=ending, deed=deed)
    (folder / "sitecustomize.py").write_text(text)
    paths = [str(folder), os.environ.get("PYTHONPATH", "")]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths))}


def workers_of(process):
    """Return the process ids of a command's workers."""
    with open(f"/proc/{process.pid}/task/{process.pid}/children") as stream:
        return [int(word) for word in stream.read().split()]


def files_in(out):
    """Return the paths of the image files that have their final name."""
    return [
        os.path.join(folder, name)
        for folder, _, names in os.walk(out)
        for name in names
        if ".cg2raw" not in folder and name.endswith((".dng", ".npy", ".exr"))
    ]


def contents(out):
    """Return {path: SHA-256} of what a data set's user sees."""
    return {
        str(path.relative_to(out)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(out.rglob("*"))
        if path.is_file() and ".cg2raw" not in path.parts
    }


def rows(out):
    """Return the rows of manifest.jsonl."""
    return [json.loads(line) for line in (out / "manifest.jsonl").open()]


def check_agreement(out):
    """Assert that the manifest lists the folder's files, and those alone."""
    found = contents(out)
    listed = {row["path"]: row["sha256"] for row in rows(out)}
    others = {"dataset.json", "manifest.jsonl", "manifest.parquet"}
    assert found.keys() - others == listed.keys()
    assert all(found[path] == digest for path, digest in listed.items())
    assert not list(out.rglob("*.part")) and not (out / ".cg2raw/parts").exists()
