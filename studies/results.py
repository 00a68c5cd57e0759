# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""results.json: every frame of every study, and what it was measured with."""

import hashlib
import json
import os
import platform
from dataclasses import asdict
from importlib import metadata
from pathlib import Path
from typing import Any

import cg2raw
from cg2raw import _core
from studies.cameras import Camera
from studies.places import files_hash
from studies.world.shots import World, array_hash

FOLDER = Path(__file__).parent
ROOMS = ("world", "sources", "learners", "tasks")
FILE = "results.json"
REQUIREMENTS = FOLDER / "requirements-evidence.txt"
Results = dict[str, Any]


def fingerprint(world: World) -> dict[str, str]:
    """Return what numbers of one table must have in common."""
    sources = [FOLDER / name for name in ("cameras.py", "protocol.py", "protocol.toml")]
    for room in ROOMS:
        sources += sorted((FOLDER / room).rglob("*.py"))
    seeds = ", ".join(f"{k} {v}" for k, v in asdict(world.protocol.seeds).items())
    return {
        "cg2raw": cg2raw.__version__,
        "core": files_hash([Path(_core.__file__)]),
        "packages": ", ".join(
            f"{name} {version}" for name, version in installed().items() if version
        ),
        "seeds": seeds,
        "studies": files_hash(sources),
        **world.hashes(),
    }


def pinned() -> dict[str, str]:
    """Return the version of each package that the studies are run with."""
    lines = REQUIREMENTS.read_text().splitlines()
    pairs = (line.split("==") for line in lines if not line.startswith("#"))
    return {name.strip(): version.strip() for name, version in pairs}


def installed() -> dict[str, str | None]:
    """Return the installed version of each of pinned(), None of what is missing."""
    found: dict[str, str | None] = {}
    for name in pinned():
        try:
            found[name] = metadata.version(name).partition("+")[0]
        except metadata.PackageNotFoundError:
            found[name] = None
    return found


def need_pinned() -> None:
    """Raise ValueError for a package of another version than pinned()."""
    versions = installed()
    for name, version in pinned().items():
        if versions[name] not in (version, None):
            raise ValueError(
                f"{name} {versions[name]} is installed, and numbers are of {version} "
                f"(studies/{REQUIREMENTS.name}): ./scripts/evidence installs it"
            )


def host() -> str:
    """Return the machine and the system that numbers were made on."""
    return (
        f"{platform.machine()}, {platform.system()}, Python {platform.python_version()}"
    )


def torch_version() -> str | None:
    """Return PyTorch's version, None without it: then some sources are missing."""
    return installed()["torch"]


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


def write_results(folder: Path, results: Results) -> None:
    """Write results.json, whole or not at all; the same numbers are the same bytes."""
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(results, indent=1, sort_keys=True)
    part = folder / f"{FILE}.part"
    part.write_text(text + "\n")
    os.replace(part, folder / FILE)
