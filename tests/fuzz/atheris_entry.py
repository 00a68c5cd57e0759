# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A target of python_targets.py under libFuzzer, by Atheris; scripts/fuzz runs it.

    python -m fuzz.atheris_entry TARGET FOLDER [what libFuzzer takes ...]

FOLDER is empty or not there yet, and is the target's own."""

import os
import sys

import atheris

with atheris.instrument_imports(include=["cg2raw", "yaml"]):
    import yaml  # noqa: F401  # which readers import when they need it

    from fuzz import python_targets


def main():
    name, folder, *arguments = sys.argv[1:]
    os.makedirs(folder, exist_ok=True)
    target = python_targets.TARGETS[name](folder)

    def one_input(data):
        target(data)

    atheris.Setup([sys.argv[0], *arguments], one_input)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
