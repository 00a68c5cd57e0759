# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A bad manifest is told by its line, its field, and what would be right."""

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


def frame(fields):
    """Return a manifest of one frame with fields, in line 3."""
    return HEAD + "  - {file: dark.npy, " + fields + "}\n"


def chart(patches):
    """Return a manifest of a chart, the patches in line 3."""
    return frame(f"kind: chart, patches: [{patches}]")


BAD = {
    "nothing": ("", [": is empty"]),
    "a list": ("- 1\n", [":1: is a list; must be fields"]),
    "no YAML": ("sensor: [1\nframes: 2", [":2: is no YAML", "expected ',' or ']'"]),
    "tab": ("sensor: x\n\tframes: 1", [":2: is no YAML"]),
    "no sensor": ("frames: []", [":1: has no sensor: add it"]),
    "no frames": ("sensor: nikon-d40", ["has no frames"]),
    "empty frames": ("sensor: x\nframes: []", [":2: frames has no frame; add"]),
    "frames: null": ("sensor: x\nframes:\n", [":2: frames is one value; must be a"]),
    "unknown field": (
        DARK + "nuisances: [exposure]",
        [":4: nuisances is no field", "one of sensor, frames", "mean nuisance?"],
    ),
    "temperature": (
        frame("kind: dark, temperature: -274"),
        ["[0].temperature is '-274'; must be a number, -273.15 to 200 degrees Celsius"],
    ),
    "double field": (
        DARK + "iso: 1\niso: 2",
        [":5: iso is there twice, first in line 4; remove one"],
    ),
    "double in frame": (
        HEAD + "  - file: dark.npy\n    kind: dark\n    kind: flat",
        [":5: frames[0].kind is there twice, first in line 4"],
    ),
    "frame without kind": (
        HEAD + "  - {file: dark.npy}",
        [":3: frames[0] has no kind"],
    ),
    "no file": (
        HEAD + "  - {file: drak.npy, kind: dark}",
        [':3: frames[0].file is "drak.npy"; there is no file', "drak.npy"],
    ),
    "a folder": (HEAD + "  - {file: folder, kind: dark}", ["a folder; name one file"]),
    "bad kind": (
        frame("kind: drak"),
        ['kind is "drak"; must be one of dark, flat, scene, chart; did you mean dark?'],
    ),
    "empty word": (frame("kind: dark, set: "), [":3: frames[0].set is empty"]),
    "bad group": (frame("kind: dark, group: test"), ["one of fit, select, report"]),
    "bad nuisance": (
        DARK + "nuisance:\n  - exposure\n  - registrations",
        [":6: nuisance[1]", "must be one of exposure", "mean registration?"],
    ),
    "nuisance is a word": (DARK + "nuisance: exposure", [":4: nuisance is one value"]),
    "bad uncertainty": (
        DARK + "uncertainty: {light: 5 %}",
        [":4: uncertainty.light is '5 %'; must be a number, 0 to 1"],
    ),
    "uncertainty of what": (
        DARK + "uncertainty: {colour: 1}",
        ["uncertainty.colour is no field; must be one of light, radiance, reg"],
    ),
    "iso is no number": (
        frame("kind: dark, iso: fast"),
        ["iso is 'fast'", "1 to 1e+07"],
    ),
    "iso is quoted": (
        frame("kind: dark, iso: '100'"),
        ["iso is '100'; must be a number"],
    ),
    "time is negative": (
        frame("kind: dark, exposure_time: -1"),
        ["exposure_time is '-1'"],
    ),
    "time is no number": (frame("kind: dark, exposure_time: .nan"), ["is '.nan'"]),
    "flat without scene": (
        frame("kind: flat"),
        [":3: frames[0] has no scene, which a flat needs", "or unknown"],
    ),
    "scene without render": (frame("kind: scene"), ["the render of it"]),
    "scene is a number": (frame("kind: scene, scene: 0.5"), ["kind: flat"]),
    "scene is unknown": (frame("kind: scene, scene: unknown"), ["a flat alone may be"]),
    "scene is not there": (frame("kind: scene, scene: r.exr"), ["there is no file"]),
    "negative light": (frame("kind: flat, scene: -1"), ["scene is '-1'; must be a"]),
    "two colours": (frame("kind: flat, scene: [1, 2]"), ["has 2 values; must have 3"]),
    "colour is a word": (
        frame("kind: flat, scene: [1, 2, red]"),
        ["frames[0].scene[2] is 'red'; must be a number"],
    ),
    "gain 0": (
        frame("kind: flat, scene: 1, gain: 0"),
        ["gain is '0'; must be a number"],
    ),
    "gain of unknown": (
        frame("kind: flat, scene: unknown, gain: 2"),
        ["gain multiplies nothing"],
    ),
    "gain of a dark": (frame("kind: dark, gain: 2"), ["gain is not for a dark"]),
    "scene of a dark": (frame("kind: dark, scene: 0"), ["scene is not for a dark"]),
    "patches of a flat": (
        frame("kind: flat, scene: 1, patches: []"),
        ["patches is not for a flat"],
    ),
    "chart of nothing": (frame("kind: chart"), ["has neither patches nor chart"]),
    "chart without corners": (
        frame("kind: chart, chart: colorchecker"),
        ["has chart; a chart needs patches, or chart: colorchecker with its corners"],
    ),
    "unknown chart": (
        frame("kind: chart, chart: it8, corners: []"),
        ['chart is "it8"; must be one of colorchecker'],
    ),
    "three corners": (
        frame("kind: chart, chart: colorchecker, corners: [[1, 2], [1, 2], [1, 2]]"),
        ["corners has 3 positions; must have 4"],
    ),
    "no patch": (chart(""), ["patches has no patch"]),
    "patch without colour": (
        chart("{area: [0, 0, 4, 4]}"),
        ["frames[0].patches[0] has no colour; needs one of rgb, xyz and lab"],
    ),
    "patch of two colours": (
        chart("{area: [0, 0, 4, 4], rgb: [1, 1, 1], lab: [1, 1, 1]}"),
        ["has rgb and lab"],
    ),
    "small patch": (
        chart("{area: [0, 0, 3, 4], rgb: [1, 1, 1]}"),
        ["area must be [row, column, height, width]", "at least 4"],
    ),
    "half a pixel": (chart("{area: [0.5, 0, 4, 4], rgb: [1, 1, 1]}"), ["whole pixels"]),
    "overlap": (
        chart(
            "{area: [0, 0, 4, 4], rgb: [1, 1, 1]}, {area: [3, 3, 4, 4], lab: [50,0,0]}"
        ),
        ["frames[0].patches[1].area overlaps that of patches[0]"],
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_manifest_says_where_and_why(folder, name):
    text, words = BAD[name]
    path = written(folder, text)
    with pytest.raises(ValueError) as error:
        read_manifest(path)
    message = str(error.value)
    assert message.startswith(str(path)) and "\n" not in message
    for word in words:
        assert word in message


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
uncertainty: {light: 0.005, registration: 0.2}
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
    assert found.uncertainty == {"light": 0.005, "registration": 0.2}
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
