# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Chains applied to pixels, in this process or by another version of OpenColorIO.

As a program: chain_runner.py INPUT.npz OUTPUT.npz. It needs neither the core nor the
packages of the test environment, but PyOpenColorIO, NumPy and the modules of chains in
cg2raw_ocio."""

import importlib
import json
import sys
import types

import numpy as np
import PyOpenColorIO as ocio

FIELDS = ("first", "two_steps", "second", "gains", "keep_highlights", "clip_result")


def plain(transform):
    """Return the fields of a CameraTransform as JSON can hold them."""
    values = {name: getattr(transform, name) for name in FIELDS}
    values["uplift"] = getattr(transform, "uplift", None)
    return {name: np.asarray(value).tolist() for name, value in values.items()}


def applied(direction, transform, pixels):
    """Return (N, 3) float32 of a chain on (N, 3) pixels.

    direction : name of a function of cg2raw_ocio.chain, or <module>.<name> of another.
    """
    module, _, name = direction.rpartition(".")
    module = importlib.import_module(f"cg2raw_ocio.{module or 'chain'}")
    group = ocio.GroupTransform(getattr(module, name)(transform))
    processor = ocio.Config.CreateRaw().getProcessor(group).getDefaultCPUProcessor()
    out = np.array(pixels, np.float32, order="C")
    processor.applyRGB(out)
    return out


def main():
    """Apply each (direction, fields) of the JSON text in INPUT to its pixels."""
    given = np.load(sys.argv[1])
    results = {}
    for number, (direction, fields) in enumerate(json.loads(str(given["chains"]))):
        for name in ("first", "second"):
            fields[name] = np.array(fields[name])
        transform = types.SimpleNamespace(**fields)
        results[str(number)] = applied(direction, transform, given["pixels"])
    np.savez(sys.argv[2], version=ocio.__version__, **results)


if __name__ == "__main__":
    main()
