# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A process that renders frames on request; it has mitsuba, the run that asks has not.

Standard input: one JSON object a line, {path, seed, threads, cameras, film, scene}.
Standard output: one a line, {error, seconds}; what Mitsuba prints goes to standard
error. A frame is an .npz of camera RGB (H, W, 3) float32 by camera. It imports nothing
but build, NumPy and Mitsuba."""

import json
import os
import sys
import time
from typing import Any

import numpy as np

VARIANT = "scalar_spectral"  # llvm needs LLVM 16 or later, cuda a GPU


def softened(image: Any) -> Any:
    """Return an image (H, W, n) as a lens shows it: weights 1, 2, 1 on each side.

    It takes five eighths of the grain of paths, too."""
    padded = np.pad(image, ((1, 1), (1, 1), (0, 0)), mode="edge")
    down = padded[:-2] + 2.0 * padded[1:-1] + padded[2:]
    return (down[:, :-2] + 2.0 * down[:, 1:-1] + down[:, 2:]) / 16.0


def draw(mitsuba: Any, asked: dict[str, Any]) -> None:
    """Render what is asked to its path. Raises RuntimeError, OSError."""
    from .build import built

    # Not optimized: that puts the lights in an order of its own in every process.
    scene = mitsuba.load_dict(built(asked), optimize=False)
    image = np.array(mitsuba.render(scene, seed=asked["seed"]), np.float32)
    cameras = asked["cameras"]
    if image.shape[2] != 3 * len(cameras) + 1:  # see build.film
        raise RuntimeError(f"Mitsuba made {image.shape[2]} channels of {cameras}")
    image = softened(image).astype(np.float32)
    parts = np.split(image[..., :-1], len(cameras), axis=2)
    with open(asked["path"], "wb") as file:
        np.savez(file, **dict(zip(cameras, parts, strict=True)))


def main() -> None:
    """Render until the input ends."""
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # Mitsuba prints from C++
    try:
        import drjit
        import mitsuba

        mitsuba.set_variant(VARIANT)
    except ImportError as error:
        answers.write(json.dumps({"error": str(error), "seconds": 0.0}) + "\n")
        return
    for line in sys.stdin:
        asked = json.loads(line)
        drjit.set_thread_count(asked["threads"])
        start, failure = time.monotonic(), None
        try:
            draw(mitsuba, asked)
        except (RuntimeError, OSError) as error:  # Mitsuba's own are RuntimeError
            failure = " ".join(str(error).split())
        answer = {"error": failure, "seconds": time.monotonic() - start}
        answers.write(json.dumps(answer) + "\n")


if __name__ == "__main__":
    main()
