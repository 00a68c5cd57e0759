# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Write the seeds of the Python targets: python -m fuzz.python_seeds FOLDER, in tests.

FOLDER/captures and FOLDER/journal are made; python_targets.py says what is in them."""

import json
import sys

from fuzz.seed_folders import write_seeds

HEAD = "sensor: nikon-d40\nframes:\n"
LINES = {
    "dark": "{file: dark.npy, kind: dark, iso: 200, exposure_time: 0.5}",
    "flat": "{file: flat.npy, kind: flat, scene: 0.4, illuminant: D65}",
    "scene": "{file: shot.npy, kind: scene, scene: render.npy, illuminant: A}",
    "chart": "{file: other.npy, kind: chart, illuminant: D65, patches: "
    "[{area: [0, 0, 4, 4], rgb: [0.1, 0.2, 1]}, {area: [8, 8, 4, 4], lab: [5, 0, 0]}]}",
    "means": "{file: means.csv, kind: chart, illuminant: D65, count: 50, patches: "
    "[{patch: white, xyz: [0.9, 0.9, 0.8]}, {patch: black, rgb: [0.03, 0.03, 0.03]}]}",
    "colorchecker": "{file: means.csv, kind: chart, illuminant: A, chart: colorchecker,"
    " unit: DN, cut_below: 10, cut_above: 16000}",
    "corners": "{file: other.npy, kind: chart, illuminant: D65, chart: colorchecker, "
    "corners: [[2, 2], [2, 20], [13, 20], [13, 2]]}",
}
TABLE = "\n%%\npatch,R,G1,G2,B,R_sd,cut\n1,100,200,200,90,3,\n24,,,,,,low\n"


def frames(*names, top=""):
    """Return a manifest of frames of LINES."""
    return HEAD + "".join(f"  - {LINES.get(name, name)}\n" for name in names) + top


def captures():
    """Return {name: text}."""
    all_of_them = frames(*("dark", "flat", "scene", "chart", "means"))
    with_scene = "{file: flat.npy, kind: flat, illuminant: D65, scene: "
    return {
        **{name: frames(name) for name in LINES},
        "all": all_of_them,
        "top": all_of_them + "nuisance: [exposure, white_balance]\n"
        "uncertainty: {light: 0.02, registration: 0.5}\nmask: mask.npy\niso: 400\n"
        "temperature: 21.5\n",
        "sets": frames(
            "{file: dark.npy, kind: dark, set: a, group: fit}",
            "{file: other.npy, kind: dark, set: b, group: report}",
        ),
        "unknown_scene": frames(with_scene + "unknown}"),
        "colour": frames(with_scene + "[0.1, 0.2, 0.3], gain: 2}"),
        "table": frames("colorchecker") + TABLE,
        "anchors": HEAD + "  - &one {file: dark.npy, kind: dark}\n  - *one\n",
        "nothing": "",
        "list": "- 1\n",
        "no_yaml": "sensor: [1\nframes: 2\n",
        "unknown_field": frames("dark") + "nuisances: [exposure]\n",
        "lines_in_a_word": frames('{file: "a\\nb", kind: dark}'),
        "half_of_a_pair": 'sensor: "\\ud800"\nframes: [{file: dark.npy, kind: dark}]\n',
        "beyond_unicode": 'sensor: "\\UFFFFFFFF"\n',
        "version": "%YAML 1" + "9" * 4400 + ".1\n---\na: b\n",
        "deep": "[" * 1500,
        "pipe": frames("{file: pipe, kind: dark}"),
        "long_word": frames("{file: dark.npy, kind: " + "k" * 3000 + "}"),
        "long_number": frames("means")
        + "\n%%\npatch,R,G1,G2,B\n"
        + "9" * 3500
        + ",,,,\n",
    }


def journals():
    """Return {name: text} of lines of a journal."""

    def row(**fields):
        return f"+{{}}\n+{json.dumps(fields)}\n+{{}}\n+{{}}"

    header = json.dumps({"image": "a.exr", "reason": "is no image"})
    rows = {
        "types": {"neutral": "x", "cct": "y"},
        "order": {"order": "0"},
        "order_of_none": {"order": None},
        "other_field": {"ord_r": "0"},
        "true": {"order": True, "white_level": False},
        "large": {"cct": 10**400, "seed": -1},
        "lists": {"crop": [1, 2.5], "xy": [None], "noise_effects": [1]},
        "half_of_a_pair": {"cfa": "\ud800", "spectrum": "\ud800"},
        "none": {"sha256": None, "bytes": None},
        "not_finite": {"cct": float("nan"), "duv": float("inf")},
        "other_path": {"path": "../elsewhere.dng"},
        "path_of_a_list": {"path": ["a"]},
    }
    return {
        "true": "+{}\n+{}\n+{}\n+{}",
        "empty": "",
        **{f"row_{name}": row(**fields) for name, fields in rows.items()},
        "header_alone": "+{}",
        "given_up": header,
        "reason_of_a_list": '{"image": "a.exr", "reason": ["x"]}',
        "reason_of_lines": '{"image": "a.exr", "reason": "a\\nb"}',
        "sha_of_a_list": '+{"sha256": ["x"]}\n+{"input_sha256": ["x"]}\n+{}',
        "other_image": '{"image": "b.exr", "sha256": "0"}',
        "image_of_a_number": '{"image": 5}',
        "without_a_field": "+{}\n-path\n-sha256",
        "no_json": "{\n=\n~{",
        "no_checksum": '={"image": "a.exr"}',
        "cut": "+{}\n~0123456789abcdef {",
        "number": "5\n[]\nnull",
        "deep": "[" * 3000,
        "digits": '{"image": "a", "n": ' + "9" * 3900 + "}",
        "twice": "+{}\n+{}\n+{}\n+{}\n+{}",
    }


def main(folder):
    """Write all seeds to a folder of folder for each target."""
    write_seeds(folder, {"captures": captures(), "journal": journals()})


if __name__ == "__main__":
    main(sys.argv[1])
