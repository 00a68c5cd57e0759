# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""results.json: every frame of every study, each study with what it was made by."""

import json
import os
import platform
from pathlib import Path
from typing import Any

from studies.cameras import Camera
from studies.fingerprint import MadeBy, hashed
from studies.places import files_hash
from studies.world.shots import array_hash

FILE = "results.json"
# {study's entry: {"made by": MadeBy, "cameras": {id: {"hash": str, "entry": numbers}}}}
Results = dict[str, dict[str, Any]]


def host() -> str:
    """Return the machine and the system that numbers are made on."""
    return (
        f"{platform.machine()}, {platform.system()}, Python {platform.python_version()}"
    )


def camera_hash(camera: Camera) -> str:
    """Return the hash of a camera's profile, sensitivities and grey cards."""
    cards = camera.cards
    arrays = [camera.sensitivities, cards.neutrals, cards.sensitivities]
    return hashed(camera.sensor.to_json() + array_hash(arrays))


def read_results(folder: Path) -> Results:
    """Return what a folder holds. Raises ValueError for a file that is not of this
    command."""
    path = folder / FILE
    if not path.exists():
        return {}
    try:
        found = json.loads(path.read_text())["studies"]
        return {
            name: {"made by": dict(of["made by"]), "cameras": dict(of["cameras"])}
            for name, of in found.items()
        }
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(
            f"{path}: is no file of this study: {error!r}; another --out starts afresh"
        ) from None


def others(results: Results, name: str, made_by: MadeBy) -> list[str]:
    """Return in what an entry was made otherwise, [] if there is none.

    A JSON file has lists where settings have tuples."""
    if name not in results:
        return []
    both = results[name]["made by"], made_by
    before, now = (json.loads(json.dumps(found)) for found in both)
    keys = sorted({*before, *now} - {"host"})
    return [key for key in keys if before.get(key) != now.get(key)]


def set_aside(folder: Path) -> Path:
    """Keep a copy of results of which some are about to be dropped. Return its path."""
    path = folder / FILE
    kept = path.with_name(f"{path.stem}-{files_hash([path])}{path.suffix}")
    kept.write_bytes(path.read_bytes())
    return kept


def add(
    results: Results, camera: Camera, name: str, entry: Any, made_by: MadeBy
) -> None:
    """Put an entry of a camera into results, in place of an earlier one.

    What was made otherwise is dropped: no entry mixes two versions."""
    if others(results, name, made_by):
        del results[name]
    made_here = {**made_by, "host": host()}
    study = results.setdefault(name, {"made by": made_here, "cameras": {}})
    study["cameras"][camera.id] = {"hash": camera_hash(camera), "entry": entry}


def entry_of(results: Results, camera: Camera, name: str) -> Any:
    """Return the entry of a camera, {} if there is none of this very camera."""
    found = results.get(name, {"cameras": {}})["cameras"].get(camera.id, {})
    return found["entry"] if found.get("hash") == camera_hash(camera) else {}


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
    text = json.dumps({"studies": results}, indent=1, sort_keys=True)
    part = folder / f"{FILE}.part"
    part.write_text(text + "\n")
    os.replace(part, folder / FILE)
