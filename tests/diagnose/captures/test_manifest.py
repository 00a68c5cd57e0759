# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A bad manifest is told by its line, its field, and what would be right."""

import os
import sys

import numpy as np
import pytest

from cg2raw.diagnose.captures.manifest import read_manifest
from cg2raw.io.raw_file import open_raw

HEAD = "sensor: nikon-d40\nframes:\n"
DARK = HEAD + "  - {file: dark.npy, kind: dark}\n"


@pytest.fixture
def folder(tmp_path):
    """Return a folder with the files that manifests name."""
    np.save(tmp_path / "dark.npy", np.zeros((8, 8), np.uint16))
    np.save(tmp_path / "render.npy", np.zeros((8, 8, 3), np.float32))
    (tmp_path / "folder").mkdir()
    return tmp_path


def written(folder, text):
    """Write the manifest; return its path."""
    path = folder / "captures.yaml"
    path.write_text(text)
    return path


BAD = {
    "": ": is empty",
    "- 1\n": ":1: is a list; must be fields",
    "sensor: [1\nframes: 2": ":2: is no YAML: expected ',' or ']'",
    "sensor: x\n\tframes: 1": ":2: is no YAML",
    "frames: []": ":1: has no sensor: add it",
    "sensor: nikon-d40": ":1: has no frames",
    "sensor: x\nframes: []": ":2: frames has no frame; add",
    "sensor: x\nframes:\n": ":2: frames is one value; must be a",
    DARK + "nuisances: [exposure]": ":4: nuisances is no field; must be one of sensor",
    DARK + "iso: 1\niso: 2": ":5: iso is there twice, first in line 4; remove one",
    DARK + "nuisance: exposure": ":4: nuisance is one value",
    DARK + "nuisance:\n  - exposure\n  - sun": ':6: nuisance[1] is "sun"; must be one',
    DARK + "uncertainty: {light: 5 %}": ".light is '5 %'; must be a number, 0 to 1",
    DARK + "uncertainty: {registration: -1}": "'-1'; must be a number, 0 to 100",
    DARK + "uncertainty: {colour: 1}": "uncertainty.colour is no field; must be one of",
    HEAD + "  - {file: dark.npy}": ":3: frames[0] has no kind",
    HEAD + "  - {file: folder, kind: dark}": "a folder; name one file",
    HEAD + "  - {file: drak.npy, kind: dark}": ':3: frames[0].file is "drak.npy"; th',
    DARK.replace("dark}", "dark, kind: flat}"): ":3: frames[0].kind is there twice",
}
CHECKER = "kind: chart, chart: colorchecker"
AREA = "area: [0, 0, 4, 4]"
WHITE = "rgb: [1, 1, 1]"
# Fields of a frame, in line 3, beside its file.
BAD_FRAMES = {
    "kind: drak": 'kind is "drak"; must be one of dark, flat, scene, chart; did you',
    **{f"kind: dark, set: {none}": "set is empty" for none in ("", "~", "''")},
    "kind: dark, group: test": "must be one of fit, select, report",
    "kind: dark, temperature: -274": "'-274'; must be a number, -273.15 to 200 de",
    "kind: dark, iso: fast": "iso is 'fast'; must be a number, 1 to 1e+07",
    "kind: dark, iso: '100'": "iso is '100'; must be a number",
    "kind: dark, exposure_time: -1": "is '-1'; must be a number, 0 to 1e+06",
    "kind: dark, exposure_time: .nan": "exposure_time is '.nan'; must be a number",
    "kind: dark, gain: 2": "gain is not for a dark",
    "kind: dark, scene: 0": "scene is not for a dark",
    "kind: flat": " has no scene, which a flat needs",
    "kind: flat, scene: -1": "scene is '-1'; must be a number, 0 to 1e+06",
    "kind: flat, scene: [1, 2]": "scene has 2 values; must have 3",
    "kind: flat, scene: [1, 2, red]": "scene[2] is 'red'; must be a number",
    "kind: flat, scene: 1, gain: 0": "gain is '0'; must be a number, 1e-06 to 1e+06",
    "kind: flat, scene: unknown, gain: 2": "gain multiplies nothing",
    "kind: flat, scene: 1, patches: []": "patches is not for a flat",
    "kind: scene": "the render of it",
    "kind: scene, scene: 0.5": "kind: flat",
    "kind: scene, scene: unknown": "a flat alone may be",
    "kind: scene, scene: r.exr": "there is no file",
    "kind: chart": " has neither patches nor chart",
    CHECKER: " has chart; a chart needs patches, or chart: colorchecker with its co",
    "kind: chart, chart: it8, corners: []": 'chart is "it8"; must be one of color',
    CHECKER + ", corners: [[1, 2], [1, 2]]": "corners has 2 positions; must have 4",
    "kind: chart, patches: []": "patches has no patch",
}
BAD_PATCHES = {
    f"{{{AREA}}}": "[0] has no colour; needs one of rgb, xyz and lab",
    f"{{{AREA}, {WHITE}, lab: [1, 1, 1]}}": "[0] has rgb and lab",
    f"{{area: [0, 0, 3, 4], {WHITE}}}": "[0].area must be [row, column, hei",
    f"{{area: [0.5, 0, 4, 4], {WHITE}}}": "whole pixels",
    f"{{area: [0, 0, 4, -4], {WHITE}}}": "[3] is '-4'; must be a number, 0 to 65535",
    f"{{{AREA}, rgb: [-2, 0, 0]}}": "rgb[0] is '-2'; must be a number, -1 to 1e+06",
    f"{{{AREA}, xyz: [0, 2e6, 0]}}": "xyz[1] is '2e6'; must be a number, -1 to 1e+06",
    f"{{{AREA}, lab: [0, 0, 201]}}": "lab[2] is '201'; must be a number, -200 to 200",
    f"{{{AREA}, {WHITE}}}, {{area: [3, 3, 4, 4], {WHITE}}}": "[1].area overlaps that",
}


def refusal(folder, text):
    """Return the message by which a manifest is refused."""
    path = written(folder, text)
    with pytest.raises(ValueError) as error:
        read_manifest(path)
    message = str(error.value)
    assert message.startswith(str(path)) and "\n" not in message
    return message


@pytest.mark.parametrize(("text", "words"), BAD.items(), ids=range(len(BAD)))
def test_a_bad_manifest_says_where_and_why(folder, text, words):
    assert words in refusal(folder, text)


@pytest.mark.parametrize(("fields", "words"), BAD_FRAMES.items())
def test_a_bad_frame_says_its_field(folder, fields, words):
    said = refusal(folder, f"{HEAD}  - {{file: dark.npy, {fields}}}\n")
    assert ":3: frames[0]" in said and words in said


@pytest.mark.parametrize(("patches", "words"), BAD_PATCHES.items())
def test_a_bad_patch_says_which(folder, patches, words):
    fields = f"file: dark.npy, kind: chart, patches: [{patches}]"
    said = refusal(folder, f"{HEAD}  - {{{fields}}}\n")
    assert ":3: frames[0].patches" in said and words in said


def test_a_manifest_that_is_no_text(folder):
    path = folder / "captures.yaml"
    path.write_bytes(b"sensor: \xff\xfe\n")
    with pytest.raises(ValueError, match=r"captures\.yaml: is no"):
        read_manifest(path)


def test_every_field_arrives(folder):
    path = written(
        folder,
        """\
sensor: nikon-d40
iso: 200
illuminant: D65
nuisance: [exposure, light]
uncertainty: {light: 1, registration: 0}
mask: dark.npy
frames:
  - {file: dark.npy, kind: dark, exposure_time: 1e-3, iso: 800, group: fit, set: 7}
  - {file: dark.npy, kind: dark, exposure_time: 0}
  - {file: dark.npy, kind: flat, scene: [0.1, 0.2, 3e-1], gain: 2, illuminant: A}
  - {file: dark.npy, kind: flat, scene: unknown}
  - {file: dark.npy, kind: scene, scene: render.npy, mask: dark.npy}
""",
    )
    found = read_manifest(path)
    assert found.nuisances == {"exposure", "light"}
    assert found.uncertainty == {"light": 1.0, "registration": 0.0}
    assert found.mask == str(folder / "dark.npy")
    dark, bias, flat, unknown, scene = found.frames
    assert (dark.exposure_time, dark.iso, dark.group, dark.set) == (
        1e-3,
        800,
        "fit",
        "7",
    )
    assert dark.scene is None and bias.exposure_time == 0.0
    assert (flat.scene, flat.gain, flat.illuminant) == ((0.1, 0.2, 0.3), 2.0, "A")
    assert (flat.iso, flat.exposure_time) == (200, None)
    assert (unknown.scene, unknown.illuminant) == ("unknown", "D65")
    assert (scene.scene, scene.gain) == (str(folder / "render.npy"), 1.0)
    assert scene.mask == str(folder / "dark.npy")


def test_paths_are_relative_to_the_manifest(folder, monkeypatch):
    monkeypatch.chdir(folder)
    [entry] = read_manifest(written(folder, DARK).name).frames
    assert open_raw(entry.file).header.shape == (8, 8)


def test_a_library_that_is_missing_is_named(folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "yaml", None)
    with pytest.raises(ValueError, match=r"cg2raw\[diagnose\]"):
        read_manifest(written(folder, DARK))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no pipes")
def test_a_pipe_is_no_frame(folder):
    os.mkfifo(folder / "pipe.npy")
    said = refusal(folder, DARK.replace("dark.npy", "pipe.npy"))
    assert ':3: frames[0].file is "pipe.npy", no regular file; name one that is' in said
