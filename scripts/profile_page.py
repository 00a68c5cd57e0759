# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""docs/profile.md, and the attributes of a profile in the stub of the core."""

import json

from cg2raw import _core

STUB = "python/cg2raw/_core.pyi"
BEGIN, END = "    # begin: fields, by scripts/generate.py\n", "    # end\n"
INTRO = """# The profile of a sensor

A sensor is one JSON file: give its path where a sensor is asked for, or put it into a
folder that `CG2RAW_PROFILE_PATH` names. `cg2raw profile` makes one of a camera's files,
`cg2raw calibrate` ([calibrate.md](calibrate.md)) measures its noise, and
`cg2raw diagnose` adds what is missing.

Editors that know JSON Schema complete fields and mark errors with it:

    cg2raw sensors --schema > cg2raw-profile.schema.json

A field that is not in the table is an error, and so is one that is there twice;
`null` is as if it were left out. Beyond the schema, the reader checks what fields are
to each other: black below white, white within `bits`, ISOs that rise, matrices that
have an inverse and see white. Parameters of effects are checked when they are
simulated. Names of lights may be in either case; the schema has them as they are
written.
"""
OUTRO = """## A small one

```json
{
  "schema": 1,
  "id": "my-camera", "make": "Maker", "model": "Model",
  "unique_camera_model": "Maker Model",
  "sources": {"color_matrix_1": "its DNGs", "noise": "darks and flats of 2026"},
  "cfa": "RGGB", "width": 6000, "height": 4000, "bits": 14,
  "black_level": 512, "white_level": 16383,
  "calibration_illuminant_1": "D65",
  "color_matrix_1": [0.70, -0.17, -0.08, -0.81, 1.57, 0.25, -0.09, 0.09, 0.79],
  "noise": [{"iso": 100, "beta1": 2.5e-5, "beta2": 4e-8}],
  "effects": [{"name": "prnu", "parameters": {"sigma": 0.005}}]
}
```

`beta1` is the signal of one electron, and `beta2` the variance of the read noise,
both as shares of the range from black to white. All effects and their parameters:
[effects.md](effects.md).
"""


def needed(name, whole):
    """Return when a field must be there."""
    if name in whole["required"]:
        return "yes"
    if name in ("calibration_illuminant_1", "color_matrix_1"):
        return "but for `mono`"
    return "with `color_matrix_2`" if name == "calibration_illuminant_2" else ""


def value_words(field):
    """Return in a few words what a field holds."""
    kinds = {"string": "text", "object": "object", "number": "number"}
    if "const" in field:
        return str(field["const"])
    if "enum" in field:
        return "a light"
    if "anyOf" in field:
        return "number or numbers"
    if "oneOf" in field:
        return "object"
    if field["type"] == "integer":
        return f"{field['minimum']} to {field['maximum']}"
    if field["type"] == "array":
        count = field.get("minItems")
        return f"{count} values" if count else "list of objects"
    return kinds[field["type"]]


def page():
    """Return the page's text."""
    whole = json.loads(_core.profile_schema())
    rows = ["| field | needed | value | |", "|---|---|---|---|"]
    for name, field in whole["properties"].items():
        cells = (f"`{name}`", needed(name, whole), value_words(field))
        rows.append(f"| {' | '.join(cells)} | {field['description']} |")
    lights = whole["properties"]["calibration_illuminant_1"]["enum"]
    named = f"Calibration illuminants: {', '.join(f'`{name}`' for name in lights)}."
    return "\n\n".join([INTRO.rstrip(), "\n".join(rows), named, OUTRO.rstrip()]) + "\n"


def stub(before):
    """Return the text of the stub, with the attributes of a profile."""
    properties = "".join(
        f"    @property\n    def {name}(self) -> {type_}: ...\n"
        for name, type_ in _core.profile_fields
    )
    before, begin, rest = before.partition(BEGIN)
    return before + begin + properties + END + rest.partition(END)[2]


def texts(root):
    """Return {path: text} of what is written below a root."""
    return {"docs/profile.md": page(), STUB: stub((root / STUB).read_text())}
