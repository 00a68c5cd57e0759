# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Chains applied to pixels, in this process or by another version of OpenColorIO.

As a program: chain_runner.py INPUT.npz OUTPUT.npz. It needs neither the core nor the
packages of the test environment, but PyOpenColorIO, NumPy and cg2raw_ocio."""

import json
import sys
import types

import numpy as np

FIELDS = ("first", "two_steps", "second", "gains", "keep_highlights", "clip_result")


def plain(transform):
    """Return the fields of a CameraTransform as JSON can hold them."""
    values = {name: getattr(transform, name) for name in FIELDS}
    return {name: np.asarray(value).tolist() for name, value in values.items()}


def applied(direction, transform, pixels):
    """Return (N, 3) float32 of a chain of cg2raw_ocio.chain on (N, 3) pixels."""
    from cg2raw_ocio import chain, spaces

    out = np.array(pixels, np.float32, order="C")
    cpu = processor(spaces.group(getattr(chain, direction)(transform)))
    cpu.getDefaultCPUProcessor().applyRGB(out)
    return out


def processor(transform):
    """Return an OCIO processor of one transform."""
    import PyOpenColorIO as ocio

    return ocio.Config.CreateRaw().getProcessor(transform)


def main():
    """Apply each (direction, fields) of the JSON text in INPUT to its pixels."""
    import PyOpenColorIO as ocio

    given = np.load(sys.argv[1])
    results = {
        str(number): applied(
            direction, types.SimpleNamespace(**fields), given["pixels"]
        )
        for number, (direction, fields) in enumerate(json.loads(str(given["chains"])))
    }
    np.savez(sys.argv[2], version=ocio.__version__, **results)


if __name__ == "__main__":
    main()
