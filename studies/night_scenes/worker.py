# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A process that renders frames on request; it knows bpy, the run that asks does not.

Standard input: one JSON object a line, {index, path, width, samples, threads}.
Standard output: one a line, {index, error, seconds}; what Blender prints goes to
standard error. It ends with its input, so it never outlives the run by a frame."""

import json
import os
import sys
import time


def main():
    """Render until the input ends."""
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # Blender prints from C
    try:
        from .choices.scenes import scene
        from .frame import draw
    except ImportError as error:
        answers.write(json.dumps({"index": None, "error": str(error)}) + "\n")
        return
    for line in sys.stdin:
        asked = json.loads(line)
        start = time.monotonic()
        error = None
        try:
            draw(
                scene(asked["index"]),
                asked["path"],
                asked["width"],
                asked["samples"],
                asked["threads"],
            )
        except (RuntimeError, OSError) as failure:  # bpy's own errors are RuntimeError
            error = " ".join(str(failure).split())
        seconds = time.monotonic() - start
        answer = {"index": asked["index"], "error": error, "seconds": seconds}
        answers.write(json.dumps(answer) + "\n")


if __name__ == "__main__":
    main()
