# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""results.json: every frame of every study, and what it was measured with."""

import hashlib
import json
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

import cg2raw
from cg2raw import _core
from studies.cameras import Camera
from studies.places import files_hash
from studies.world.shots import World, array_hash

FOLDER = Path(__file__).parent
ROOMS = ("world", "sources", "learners", "tasks")
FILE = "results.json"
Results = dict[str, Any]


def fingerprint(world: World) -> dict[str, str]:
    """Return what numbers of one table must have in common."""
    sources = [FOLDER / name for name in ("cameras.py", "protocol.py", "protocol.toml")]
    for room in ROOMS:
        sources += sorted((FOLDER / room).rglob("*.py"))
    return {
        "cg2raw": cg2raw.__version__,
        "core": files_hash([Path(_core.__file__)]),
        "numpy": np.__version__,
        "torch": torch_version() or "none",
        "studies": files_hash(sources),
        **world.hashes(),
    }


def torch_version() -> str | None:
    """Return PyTorch's version, None without it: then some sources are missing."""
    try:
        return metadata.version("torch")
    except metadata.PackageNotFoundError:
        return None


def camera_hash(camera: Camera) -> str:
    """Return the hash of a camera's profile and sensitivities."""
    digest = hashlib.sha256(camera.sensor.to_json().encode())
    digest.update(array_hash([camera.sensitivities]).encode())
    return digest.hexdigest()[:16]


def read_results(folder: Path, expected: dict[str, str]) -> tuple[Results, list[str]]:
    """Return (what a folder holds of the same fingerprint, what differs otherwise).

    Numbers of another fingerprint are left out: no table mixes two versions. Raises
    ValueError for a file that is not of this study."""
    path = folder / FILE
    empty: Results = {"fingerprint": expected, "cameras": {}}
    if not path.exists():
        return empty, []
    try:
        found = json.loads(path.read_text())
        before = dict(found["fingerprint"])
        cameras = dict(found["cameras"])
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{path}: is no file of this study: {error}") from None
    names = sorted({*before, *expected})
    differs = [name for name in names if before.get(name) != expected.get(name)]
    return (empty, differs) if differs else ({**found, "cameras": cameras}, [])


def set_aside(folder: Path) -> Path:
    """Rename results of another fingerprint, so that no run writes over them.

    Return the new path."""
    path = folder / FILE
    kept = path.with_name(f"{path.stem}-{files_hash([path])}{path.suffix}")
    path.rename(kept)
    return kept


def add(results: Results, camera: Camera, study: str, entry: Any) -> None:
    """Put a study's entry of a camera into results, in place of an earlier one.

    What was measured with another profile or other sensitivities is dropped."""
    own, cameras = camera_hash(camera), results["cameras"]
    if cameras.get(camera.id, {}).get("hash") != own:
        cameras[camera.id] = {"hash": own, "studies": {}}
    cameras[camera.id]["studies"][study] = entry


def entry_of(results: Results, camera: Camera, study: str) -> Any:
    """Return a study's entry of a camera, {} if there is none of this very camera."""
    found = results["cameras"].get(camera.id, {})
    if found.get("hash") != camera_hash(camera):
        return {}
    return found["studies"].get(study, {})


def use(results: Results, what: str, digest: str) -> bool:
    """Note the hash of what some studies were made of, whose entries end with its name.

    Return whether such entries were dropped, since they had another."""
    before = results.setdefault("made of", {}).get(what, digest)
    results["made of"][what] = digest
    if before == digest:
        return False
    for found in results["cameras"].values():
        kept = {s: e for s, e in found["studies"].items() if what not in s.split(", ")}
        found["studies"] = kept
    return True


def draws_of(entry: Any) -> int:
    """Return how many draws an entry has."""
    while isinstance(entry, dict):
        if not entry:
            return 0
        entry = next(iter(entry.values()))
    return len(entry)


def appended(entry: Any, values: Any) -> Any:
    """Return an entry, {} if there is none, with the values of one more draw."""
    if isinstance(values, dict):
        return {name: appended(entry.get(name, {}), v) for name, v in values.items()}
    return [*(entry or []), values]


def of_study(results: Results, study: str) -> dict[str, Any]:
    """Return {camera: entry} of a study."""
    return {
        camera: found["studies"][study]
        for camera, found in results["cameras"].items()
        if study in found["studies"]
    }


def write_results(folder: Path, results: Results) -> None:
    """Write results.json; the same numbers are the same bytes."""
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(results, indent=1, sort_keys=True)
    (folder / FILE).write_text(text + "\n")
