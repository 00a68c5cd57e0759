# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Translators on disk: each is trained once, and a training that was stopped goes on.

FOLDER/translation/CAMERA-KIND-SEED.pt is the state, .json curve and settings."""

import hashlib
import json
import sys
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from studies.learners.checkpoint import Checkpoint
from studies.learners.translation import Image, Sets, Trained, train
from studies.protocol import PROTOCOL, TranslationRules
from studies.sources.sets import Material
from studies.sources.translation import balanced
from studies.world.exposure import exposed

FOLDER = "translation"
CODE = (
    "checkpoint.py",
    "colour_distance.py",
    "translation.py",
    "translation_networks.py",
)
DIGITS = 4  # of frames' moments, which machines agree on


def translator_for(
    material: Material,
    camera: str,
    kind: str,
    seed: int,
    mode: str,
    folder: Path,
    *,
    rules: TranslationRules = PROTOCOL.translation,
    say: Callable[[str], None] | None = None,
) -> Trained:
    """Return the translator of a draw's material, trained or read.

    camera : its id. kind : one of studies.world.shots.KINDS. mode : quick or full.
    say : told that a file was of other settings; by default it goes to stderr.
    Raises ValueError for a file that is no checkpoint."""
    sets = sets_of(material)
    settings = {
        "camera": camera,
        "kind": kind,
        "seed": seed,
        **asdict(rules),
        "steps": rules.steps[mode],
        "frames": moments(sets),
        "code": code_hash(),
    }
    path = folder / FOLDER / f"{camera}-{kind}-{seed}.pt"
    checkpoint = Checkpoint(path, hashed(json.dumps(settings, sort_keys=True).encode()))
    if path.exists() and checkpoint.read() is None:
        (say or to_stderr)(f"{path}: is of other settings; the translator is trained")
    trained = train(sets, rules, rules.steps[mode], seed, checkpoint)
    write_curve(path.with_suffix(".json"), trained, checkpoint.key, settings)
    return trained


def sets_of(material: Material) -> Sets:
    """Return what training sees of a draw's material."""
    return Sets(
        np.stack([exposed(image) for image in material.renders]),
        np.stack(balanced(material.captures)),
        np.stack(balanced(material.other_captures)),
    )


def moments(sets: Sets) -> dict[str, list[float]]:
    """Return count, means and sds of each set's channels: other frames have others."""

    def of(images: Image) -> list[float]:
        pixels = images.reshape(-1, 3).astype(np.float64)
        values = np.concatenate([pixels.mean(axis=0), pixels.std(axis=0)])
        return [len(images), *values.round(DIGITS).tolist()]

    return {name: of(getattr(sets, name)) for name in Sets.__annotations__}


def code_hash() -> str:
    """Return the hash of the modules that a training runs through."""
    folder = Path(__file__).parent
    return hashed(b"".join((folder / name).read_bytes() for name in CODE))


def hashed(data: bytes) -> str:
    """Return the first digits of SHA-256."""
    return hashlib.sha256(data).hexdigest()[:16]


def write_curve(
    path: Path, trained: Trained, key: str, settings: dict[str, Any]
) -> None:
    """Write how a training went, for figures and for doubts."""
    found = {
        "key": key,
        "settings": settings,
        "floor": trained.floor,
        "curve": trained.curve,
    }
    path.write_text(json.dumps(found, indent=1, sort_keys=True) + "\n")


def to_stderr(message: str) -> None:
    """Print one line on stderr."""
    print(f"evidence: {message}", file=sys.stderr)
