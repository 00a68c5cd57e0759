# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""docs/effects.md, the page of the effects, from their registry."""

import cg2raw
from cg2raw.cli.effects import OPTIONAL, PATTERNS
from cg2raw.diagnose.effects import catalogue

INTRO = """\
# Effects

`scripts/generate.py` writes this page from the registry; `cg2raw effects` and
`cg2raw effects NAME` print the same; `cg2raw effects --json` prints it for programs.

An effect is one physical departure of a camera from an ideal one. A profile switches it
on in its `effects`, with its parameters, within their bounds; only those marked so may
be left out:

```json
"effects": [{"name": "row_noise", "parameters": {"sigma": 0.0002}}]
```

The order in a profile does not matter: effects act in the order of this page, stage by
stage. Signals are in 0..1 above black, so that 1 is white. `Sensor.apply_effect`
applies one of them to an array ([python.md](python.md)), and `cg2raw diagnose` finds
which of them a profile lacks ([diagnose.md](diagnose.md)).
"""
STAGES = {
    "color": "camera RGB, as light that enters the lens",
    "optics": "camera RGB, as light that reaches the filters",
    "pixel": "the mosaic, from here on: light that falls on a pixel",
    "response": "charge",
    "noise": "charge, with the noise of its photons",
    "saturation": "charge with its noise, at the full well",
    "readout": "the output of the amplifiers",
    "adc": "the output of the ADC",
    "processing": "the numbers, before the camera writes them to the file",
}


def overview(effects):
    """Return the table of all effects, one line each."""
    lines = ["| effect | stage | pattern | what it is |", "|---|---|---|---|"]
    for effect in effects:
        name = effect["name"]
        lines.append(
            f"| [`{name}`](#{name}) | {effect['stage']} | {effect['pattern']} "
            f"| {effect['meaning']} |"
        )
    return "\n".join(lines)


def legend():
    """Return what the words of the overview mean."""
    stages = "\n".join(f"| {name} | {words} |" for name, words in STAGES.items())
    patterns = "\n".join(f"- {words}" for words in PATTERNS.values())
    return f"Patterns:\n\n{patterns}\n\n| stage | acts on |\n|---|---|\n{stages}"


def effect_section(effect, searched):
    """Return the lines on one effect.

    searched : effect -> parameters that a diagnosis fits in its place."""
    lines = [
        f"## {effect['name']}",
        "",
        f"{sentence(effect['meaning'])} Source: {sentence(effect['source'])}",
        "",
        "| parameter | unit | from | to | none at | |",
        "|---|---|---|---|---|---|",
    ]
    for parameter in effect["parameters"]:
        numbers = " | ".join(f"{parameter[key]:g}" for key in ("min", "max", "null"))
        lines.append(
            f"| `{parameter['name']}` | {parameter['unit']} | {numbers} "
            f"| {parameter['meaning']}{OPTIONAL * parameter['optional']} |"
        )
    names = tuple(parameter["name"] for parameter in effect["parameters"])
    fitted = searched.get(effect["name"])
    if fitted is None:
        lines += ["", "No diagnosis names it."]
    elif fitted != names:
        lines += [
            "",
            f"Reported in verdicts as {', '.join(f'`{name}`' for name in fitted)}.",
        ]
    return "\n".join(lines)


def sentence(text):
    """Return text as a sentence."""
    return f"{text[0].upper()}{text[1:]}."


def page():
    """Return the whole page."""
    effects = cg2raw.effects()
    searched = {c.name: c.parameters for c in catalogue.candidates("RGGB")}
    parts = [INTRO.rstrip(), overview(effects), legend()]
    parts += [effect_section(effect, searched) for effect in effects]
    return "\n\n".join(parts) + "\n"


def texts(root):
    """Return {path: text} of what is written below a root."""
    return {"docs/effects.md": page()}
